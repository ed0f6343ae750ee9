//! Parts of lines and areas near the picture.
//!
//! Whatever coordinates a mark has, the path that is rendered stays within a few thousand pixels: its cost is bounded
//! and its coordinates fit into f32.

use crate::base::math::DVec2;

/// The part of a segment inside some borders, from the distances of its ends to each of them (0 or more inside): where
/// that part begins and ends as shares of the segment, 0 to 1. None if nothing is inside (Liang and Barsky, *A New
/// Concept and Method for Line Clipping*, 1984).
pub fn shares_inside(distances: impl IntoIterator<Item = (f64, f64)>) -> Option<[f64; 2]> {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (from, to) in distances {
        match (from < 0.0, to < 0.0) {
            (true, true) => return None,
            (true, false) => first = first.max(from / (from - to)),
            (false, true) => last = last.min(from / (from - to)),
            (false, false) => {}
        }
    }
    (first <= last).then_some([first, last])
}

/// A rectangle: its least and its greatest coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    pub min: DVec2,
    pub max: DVec2,
}

impl Window {
    /// The picture and a border around it.
    pub fn around((width, height): (u32, u32), border: f64) -> Self {
        let size = DVec2::new(width.into(), height.into());
        Self { min: DVec2::splat(-border), max: size + border }
    }

    /// The parts of a line through points that lie within. Parts with a coordinate that is not finite are left out.
    pub fn clip_line(&self, points: impl IntoIterator<Item = DVec2>) -> Vec<Vec<DVec2>> {
        let (mut lines, mut last): (Vec<Vec<DVec2>>, _) = (Vec::new(), None);
        for to in points {
            if let Some(from) = last
                && let Some([a, b]) = self.clip_segment(from, to)
            {
                match lines.last_mut().filter(|line| line.last() == Some(&a)) {
                    Some(line) => line.push(b),
                    None => lines.push(vec![a, b]),
                }
            }
            last = Some(to);
        }
        lines
    }

    fn clip_segment(&self, from: DVec2, to: DVec2) -> Option<[DVec2; 2]> {
        if !(from.is_finite() && to.is_finite()) {
            return None;
        }
        let distances = |point: DVec2| {
            let (after, before) = (point - self.min, self.max - point);
            [after.x, after.y, before.x, before.y]
        };
        let [first, last] = shares_inside(distances(from).into_iter().zip(distances(to)))?;
        let at = |share: f64| match share {
            0.0 => from,
            1.0 => to,
            // From either end, rounding may lead out of the window.
            share => from.lerp(to, share).clamp(self.min, self.max),
        };
        Some([at(first), at(last)])
    }

    /// The part of an area that lies within; empty if a coordinate is not finite (Sutherland and Hodgman, *Reentrant
    /// Polygon Clipping*, 1974). Parts of the area may be joined by lines along the border.
    pub fn clip_area(&self, outline: &[DVec2]) -> Vec<DVec2> {
        let mut outline = outline.to_vec();
        if !outline.iter().all(|point| point.is_finite()) {
            return Vec::new();
        }
        for axis in 0..2 {
            for (sign, bound) in [(1.0, self.min[axis]), (-1.0, self.max[axis])] {
                let depth = |point: &DVec2| sign * (point[axis] - bound);
                let mut inside = Vec::with_capacity(outline.len() + 4);
                for (index, to) in outline.iter().enumerate() {
                    let from = outline[index.checked_sub(1).unwrap_or(outline.len() - 1)];
                    let (a, b) = (depth(&from), depth(to));
                    if (a < 0.0) != (b < 0.0) {
                        let mut crossing = from.lerp(*to, a / (a - b));
                        crossing[axis] = bound;
                        inside.push(crossing);
                    }
                    if b >= 0.0 {
                        inside.push(*to);
                    }
                }
                outline = inside;
            }
        }
        outline
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window { min: DVec2::ZERO, max: DVec2::new(10.0, 5.0) };

    #[test]
    fn lines_end_at_the_border() {
        let far = [DVec2::new(-1e9, -1e9), DVec2::new(1e9, 1e9), DVec2::new(1e9, 2.0), DVec2::new(4.0, 2.0)];
        let lines = WINDOW.clip_line(far);
        assert_eq!(lines.len(), 2);
        assert!(
            (lines[0][0] - DVec2::ZERO).length() < 1e-6 && (lines[0][1] - DVec2::splat(5.0)).length() < 1e-6
        );
        assert_eq!(lines[1], [DVec2::new(10.0, 2.0), DVec2::new(4.0, 2.0)]);
        assert!(WINDOW.clip_line([DVec2::NAN, DVec2::ONE, DVec2::INFINITY]).is_empty());
        let inside = [DVec2::ONE, DVec2::new(2.0, 3.0), DVec2::new(4.0, 1.0)];
        assert_eq!(WINDOW.clip_line(inside), [inside.to_vec()]);
    }

    #[test]
    fn areas_keep_their_part_of_the_window() {
        let area = |outline: &[DVec2]| {
            let pairs = outline.iter().zip(outline.iter().cycle().skip(1));
            0.5 * pairs.map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
        };
        let square = |half: f64| {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| DVec2::new(x * half + 5.0, y * half + 2.5))
        };
        for (half, expected) in [(1.0, 4.0), (4.0, 40.0), (1e9, 50.0)] {
            assert!((area(&WINDOW.clip_area(&square(half))) - expected).abs() < 1e-6, "{half}");
        }
        assert!(WINDOW.clip_area(&square(1.0).map(|point| point + 20.0)).is_empty());
    }
}
