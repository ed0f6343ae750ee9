//! The outlines of text as polygons.

use super::curve::Curve;
use super::font::Font;
use super::text::{Align, glyphs, text_width};
use ab_glyph::{Font as _, Point, PxScale, ScaleFont};

/// Units per height of a line. Outlines are whole numbers of units, so that areas can be computed exactly.
pub const OUTLINE_UNITS: f64 = 65_536.0;
/// How far polygons may lie from the curves of letters, in units: a two-thousandth of the height of a line.
const FLATNESS: f32 = 32.0;

/// The outlines of all letters of a text, as closed polygons whose nonzero winding is the letters' area. The first line
/// stands on the axis y = 0; x = 0 is where its lines are aligned.
pub fn text_outlines(font: &Font, text: &str, align: Align) -> Vec<Vec<[i32; 2]>> {
    let (mut outlines, units) = (Vec::new(), OUTLINE_UNITS as f32);
    for (index, line) in text.lines().enumerate() {
        let width = text_width(font, line, units);
        let left = match align {
            Align::Left => 0.0,
            Align::Center => -0.5 * width,
            Align::Right => -width,
        };
        for placed in glyphs(font, line, units).0 {
            let scaled = placed.face.as_scaled(PxScale::from(placed.size));
            let Some(outline) = placed.face.outline(placed.glyph) else { continue };
            let (across, up) = (scaled.h_scale_factor(), scaled.v_scale_factor());
            let start = [left + placed.along, placed.raised - index as f32 * units];
            let at = |point: Point| [start[0] + point.x * across, start[1] + point.y * up];
            flatten(outline.curves.into_iter().map(|curve| Curve::new(&curve, at)), &mut outlines);
        }
    }
    outlines
}

/// Adds the polygons of curves that follow each other; a curve that begins elsewhere begins a polygon.
fn flatten(curves: impl Iterator<Item = Curve>, outlines: &mut Vec<Vec<[i32; 2]>>) {
    let rounded = |[x, y]: [f32; 2]| [x.round() as i32, y.round() as i32];
    let (mut last, first_new) = (None, outlines.len());
    for curve in curves {
        let from = curve.first();
        if last != Some(from) || outlines.len() == first_new {
            outlines.push(vec![rounded(from)]);
        }
        last = Some(curve.last());
        let Some(polygon) = outlines.last_mut() else { continue };
        polygon.extend(curve.chords(FLATNESS).map(rounded));
    }
    for polygon in &mut outlines[first_new..] {
        polygon.dedup();
        if polygon.len() > 1 && polygon.first() == polygon.last() {
            polygon.pop();
        }
    }
    outlines.retain(|polygon| polygon.len() > 2);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the area, in square units.
    fn doubled_area(polygons: &[Vec<[i32; 2]>]) -> i128 {
        let one = |polygon: &Vec<[i32; 2]>| -> i128 {
            let pairs = polygon.iter().zip(polygon.iter().cycle().skip(1));
            pairs
                .map(|(a, b)| i128::from(a[0]) * i128::from(b[1]) - i128::from(a[1]) * i128::from(b[0]))
                .sum()
        };
        polygons.iter().map(one).sum()
    }

    #[test]
    fn letters_have_their_outlines() {
        let font = Font::default();
        let outlines = |text: &str| text_outlines(&font, text, Align::Left);
        assert_eq!(["l", "o", "i", "B", " ", ""].map(|text| outlines(text).len()), [1, 2, 2, 3, 0, 0]);
        assert_eq!(outlines("oo\no").len(), 6);
        // The letter l is a rectangle, upright on the base line.
        let [letter] = &outlines("l")[..] else { panic!("one outline") };
        assert_eq!(letter.len(), 4);
        assert_eq!(letter.iter().map(|point| point[1]).min(), Some(0));
        // As much as the pixels that are drawn, at 200 pixels a line.
        let mask = crate::drawing::TextMask::new("kinora 8", 200.0);
        let drawn: f64 = mask.coverage.iter().map(|value| f64::from(*value)).sum::<f64>() / (200.0 * 200.0);
        let area = doubled_area(&outlines("kinora 8")).abs() as f64 / (2.0 * OUTLINE_UNITS * OUTLINE_UNITS);
        assert!((area / drawn - 1.0).abs() < 2e-3, "{area} {drawn}");
    }

    #[test]
    fn lines_are_aligned() {
        let middle = |align| {
            let outlines = text_outlines(&Font::default(), "o", align);
            let all = outlines.iter().flatten().map(|point| point[0]);
            (all.clone().min().zip(all.max())).map(|(least, most)| (least + most) / 2)
        };
        let [left, center, right] = [Align::Left, Align::Center, Align::Right].map(middle);
        assert!(left > Some(1000) && right < Some(-1000), "{left:?} {right:?}");
        assert!(center.is_some_and(|center| center.abs() < 1000), "{center:?}");
    }
}
