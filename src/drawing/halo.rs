//! The halos of letters.
//!
//! A halo ends at a distance from the outlines of its letters, so its coverage is computed from distances. Stroking the
//! outlines gives the same but takes longer, because each of their many short chords gets round joins.

use super::coverage::CoverageMask;
use super::curve::Curve;
use super::text::{PlacedGlyph, PlacedLine};
use ab_glyph::{Font as _, Point};
use std::ops::Range;

/// How far chords may lie from the curves of letters, in pixels.
const FLATNESS: f32 = 0.04;

impl PlacedLine<'_> {
    /// The coverage by everything within `radius` pixels of the letters' outlines, in a picture of this size. At the edge
    /// it falls from 1 to 0 over one pixel.
    pub fn halo(&self, radius: f32, size: (u32, u32)) -> CoverageMask {
        let mut mask = self.mask(radius.ceil() as i64 + 1, size);
        if mask.values.is_empty() {
            return mask;
        }
        mask.values.fill(f32::INFINITY);
        let corner = [self.corner[0] - mask.left, self.corner[1] - mask.top].map(|shift| shift as f32);
        let mut squares = SquaredDistances { mask: &mut mask, reach: radius + 0.5 };
        for glyph in &self.glyphs {
            let x = corner[0] + self.start[0] + glyph.along;
            squares.near_glyph(glyph, [x, corner[1] + self.start[1] - glyph.raised]);
        }
        for value in &mut mask.values {
            *value = (radius + 0.5 - value.sqrt()).clamp(0.0, 1.0);
        }
        mask
    }
}

/// The squares of the distances from the centres of pixels to the outlines so far, where they are within `reach`.
struct SquaredDistances<'m> {
    mask: &'m mut CoverageMask,
    reach: f32,
}

impl SquaredDistances<'_> {
    /// Adds the outline of a glyph that begins at a point of the baseline.
    fn near_glyph(&mut self, placed: &PlacedGlyph<'_>, [x, y]: [f32; 2]) {
        let PlacedGlyph { face, glyph, size, .. } = placed;
        let (Some(outline), unit) = (face.outline(*glyph), face.height_unscaled()) else { return };
        let scale = size / unit;
        let at = |point: Point| [x + point.x * scale, y - point.y * scale];
        let [min, max] = [outline.bounds.min, outline.bounds.max].map(at);
        let [left, right] = [min[0].min(max[0]), min[0].max(max[0])];
        if left - self.reach >= self.mask.width as f32 || right + self.reach <= 0.0 {
            return;
        }
        for curve in &outline.curves {
            let curve = Curve::new(curve, at);
            let mut from = curve.first();
            for to in curve.chords(FLATNESS) {
                self.near_segment(from, to);
                from = to;
            }
        }
    }

    fn near_segment(&mut self, from: [f32; 2], to: [f32; 2]) {
        let width = self.mask.width;
        let columns = self.around(from[0], to[0], width);
        let along = [to[0] - from[0], to[1] - from[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        // A segment without length is a point.
        let along_per_square = along.map(|part| if square > 0.0 { part / square } else { 0.0 });
        for row in self.around(from[1], to[1], self.mask.height) {
            let down = row as f32 + 0.5 - from[1];
            let pixels = &mut self.mask.values[row * width..][columns.clone()];
            for (column, pixel) in (columns.start as i32..).zip(pixels) {
                let right = column as f32 + 0.5 - from[0];
                let share = (right * along_per_square[0] + down * along_per_square[1]).clamp(0.0, 1.0);
                let away = [right - share * along[0], down - share * along[1]];
                let square = away[0] * away[0] + away[1] * away[1];
                *pixel = if square < *pixel { square } else { *pixel };
            }
        }
    }

    /// The pixels of a row or column of `count` that are within reach of a coordinate between two others.
    fn around(&self, a: f32, b: f32, count: usize) -> Range<usize> {
        let (first, last) = (a.min(b) - self.reach, a.max(b) + self.reach);
        // Conversions to integers are clamped.
        let (first, last) = ((first.floor() as usize).min(count), (last.ceil() as usize).min(count));
        first..last.max(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::DVec2;
    use crate::drawing::Font;

    fn value_at(mask: &CoverageMask, x: i64, y: i64) -> f32 {
        let (x, y) = (x - mask.left, y - mask.top);
        let within = (0..mask.width as i64).contains(&x) && (0..mask.height as i64).contains(&y);
        if within { mask.values[y as usize * mask.width + x as usize] } else { 0.0 }
    }

    #[test]
    fn halos_reach_around_letters() {
        let font = Font::default();
        let line = PlacedLine::new(&font, "l", 40.0, DVec2::new(20.3, 5.6));
        let (letters, halo) = (line.letters((60, 60)), line.halo(3.0, (60, 60)));
        // Whatever is a pixel away from the letter is covered, and what is five pixels away is not.
        let near = |x: i64, y: i64, reach: i64| {
            let pixels = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (x + dx, y + dy)));
            pixels.map(|(x, y)| value_at(&letters, x, y)).fold(0.0, f32::max)
        };
        for (x, y) in (0..60).flat_map(|y| (0..60).map(move |x| (x, y))) {
            let covered = value_at(&halo, x, y).max(value_at(&letters, x, y));
            assert!(near(x, y, 1) < 1.0 || covered == 1.0, "{x} {y} {covered}");
            assert!(near(x, y, 5) > 0.0 || covered == 0.0, "{x} {y} {covered}");
        }
    }

    #[test]
    fn halos_end_at_their_radius() {
        // The letter l is an upright rectangle: its halo covers a rectangle with round corners but for the inside, which
        // is further away than the radius.
        let font = Font::default();
        let line = PlacedLine::new(&font, "l", 200.0, DVec2::new(20.25, 5.5));
        let letter = line.letters((300, 300));
        let area = |mask: &CoverageMask| mask.values.iter().map(|value| f64::from(*value)).sum::<f64>();
        let rows: Vec<f64> =
            letter.values.chunks(letter.width).map(|row| row.iter().map(|v| f64::from(*v)).sum()).collect();
        let width = rows.iter().copied().fold(0.0, f64::max);
        let height = area(&letter) / width;
        for radius in [1.0, 2.5, 4.0] {
            let halo = line.halo(radius as f32, (300, 300));
            let outer = 2.0 * radius * (width + height) + std::f64::consts::PI * radius * radius;
            let inner = (width - 2.0 * radius).max(0.0) * (height - 2.0 * radius);
            let expected = outer + width * height - inner;
            assert!((area(&halo) / expected - 1.0).abs() < 2e-3, "{} {expected}", area(&halo));
        }
    }
}
