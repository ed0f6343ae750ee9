//! Areas and lines as coverage.

use super::clip::Window;
use super::coverage::CoverageMask;
use super::mark::Line;
use crate::base::math::{DVec2, cos_sin_of_turns};
use zeno::{Cap, Command, Join, Mask, Scratch, Stroke, Style, Vector};

/// Pixels beyond the picture at which paths are cut off.
const BORDER: f64 = 16.0;
/// Corners of a circle of one pixel's radius, and more for larger ones.
const CORNERS: f64 = 12.0;

/// A polygon that looks like a circle: its sagitta is below a twentieth of a pixel.
pub fn circle(center: DVec2, radius: f64) -> Vec<DVec2> {
    // A corner less than the radius allows moves the edge by r (1 - cos(π / n)) ≈ 5 r / n².
    let corners = (CORNERS * libm::sqrt(radius.max(1.0))).ceil().min(720.0) as u32;
    let corner = |index: u32| {
        let (cos, sin) = cos_sin_of_turns(f64::from(index) / f64::from(corners));
        center + DVec2::new(cos, sin) * radius
    };
    (0..corners).map(corner).collect()
}

/// The coverage by the areas within outlines (nonzero winding), in a picture of this size.
pub fn fill(outlines: &[Vec<DVec2>], size: (u32, u32), scratch: &mut Scratch) -> CoverageMask {
    let window = Window::around(size, BORDER);
    let outlines: Vec<_> = outlines.iter().map(|outline| window.clip_area(outline)).collect();
    covered(&outlines, true, 0.0, size, zeno::Fill::NonZero, scratch)
}

/// The coverage by lines of a width.
pub fn stroke(lines: &[Line], width: f64, size: (u32, u32), scratch: &mut Scratch) -> CoverageMask {
    // Ends at the border of the window are too far away to be seen.
    let window = Window::around(size, width + BORDER);
    let clipped = |line: &Line| {
        let back = line.points.first().filter(|_| line.closed);
        window.clip_line(line.points.iter().chain(back).copied())
    };
    let lines: Vec<_> = lines.iter().flat_map(clipped).collect();
    let mut style = Stroke::new(width as f32);
    style.join(Join::Round).cap(Cap::Round);
    covered(&lines, false, 0.5 * width, size, style, scratch)
}

/// Adds a path through points. They are clipped near the picture, where f32 suffices: at 8192 pixels its steps are 1/1024
/// of one.
fn push(commands: &mut Vec<Command>, points: &[DVec2], closed: bool) {
    let point = |point: &DVec2| Vector::new(point.x as f32, point.y as f32);
    let Some((first, rest)) = points.split_first() else { return };
    // A line that ends where it begins has a corner there.
    let returns = !closed && rest.len() > 1 && rest.last() == Some(first);
    let rest = if returns { &rest[..rest.len() - 1] } else { rest };
    commands.push(Command::MoveTo(point(first)));
    commands.extend(rest.iter().map(|next| Command::LineTo(point(next))));
    if closed || returns {
        commands.push(Command::Close);
    }
}

/// The coverage by a path through points that reaches `border` pixels beyond them, where it lies within the picture.
fn covered<'s>(
    paths: &[Vec<DVec2>],
    closed: bool,
    border: f64,
    (width, height): (u32, u32),
    style: impl Into<Style<'s>>,
    scratch: &mut Scratch,
) -> CoverageMask {
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for point in paths.iter().flatten() {
        (min, max) = (min.min(*point), max.max(*point));
    }
    let end = DVec2::new(width.into(), height.into());
    // One pixel more, for rounding.
    let min = (min - (border + 1.0)).floor().max(DVec2::ZERO);
    let max = (max + (border + 1.0)).ceil().min(end);
    let size = max - min;
    if !(size.x >= 1.0 && size.y >= 1.0) {
        return CoverageMask::default();
    }
    let mut commands = Vec::new();
    paths.iter().for_each(|points| push(&mut commands, points, closed));
    let (width, height) = (size.x as usize, size.y as usize);
    let mut bytes = vec![0; width * height];
    Mask::with_scratch(commands.as_slice(), scratch)
        .style(style)
        .offset(Vector::new(-min.x as f32, -min.y as f32))
        .size(width as u32, height as u32)
        .render_into(&mut bytes, None);
    let values = bytes.iter().map(|byte| f32::from(*byte) / 255.0).collect();
    CoverageMask { left: min.x as i64, top: min.y as i64, width, height, values }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(coverage: &CoverageMask) -> f64 {
        coverage.values.iter().map(|value| f64::from(*value)).sum()
    }

    /// The centre of what is covered.
    fn centroid(coverage: &CoverageMask) -> DVec2 {
        let at = |index: usize| {
            let (x, y) = (index % coverage.width, index / coverage.width);
            DVec2::new(coverage.left as f64 + x as f64 + 0.5, coverage.top as f64 + y as f64 + 0.5)
        };
        let weighted = coverage.values.iter().enumerate();
        weighted.map(|(index, value)| at(index) * f64::from(*value)).sum::<DVec2>() / total(coverage)
    }

    #[test]
    fn disks_have_their_place_and_area() {
        let mut scratch = Scratch::new();
        for (x, y, radius) in [(20.3, 31.7, 6.0), (7.0, 40.5, 2.5), (50.0, 50.01, 14.2)] {
            let center = DVec2::new(x, y);
            let disk = fill(&[circle(center, radius)], (100, 100), &mut scratch);
            let area = std::f64::consts::PI * radius * radius;
            assert!((total(&disk) / area - 1.0).abs() < 0.02, "{} {area}", total(&disk));
            assert!((centroid(&disk) - center).length() < 0.02);
        }
    }

    #[test]
    fn lines_are_as_long_and_wide_as_asked() {
        let mut scratch = Scratch::new();
        let (from, to) = (DVec2::new(10.25, 12.5), DVec2::new(70.0, 55.75));
        let line = Line { points: vec![from, to], closed: false };
        let drawn = stroke(&[line], 3.0, (100, 100), &mut scratch);
        let area = 3.0 * (to - from).length() + std::f64::consts::PI * 1.5 * 1.5;
        assert!((total(&drawn) / area - 1.0).abs() < 0.02, "{} {area}", total(&drawn));
        assert!((centroid(&drawn) - (from + to) / 2.0).length() < 0.02);
    }

    #[test]
    fn marks_beyond_the_picture_are_cut_off() {
        let mut scratch = Scratch::new();
        let line = |from, to| vec![Line { points: vec![from, to], closed: false }];
        let far = line(DVec2::new(-4000.0, 50.0), DVec2::new(5000.0, 50.0));
        let across = stroke(&far, 2.0, (100, 100), &mut scratch);
        assert!((total(&across) - 200.0).abs() < 1.0);
        let outside = line(DVec2::new(300.0, 50.0), DVec2::new(500.0, 50.0));
        assert_eq!(stroke(&outside, 2.0, (100, 100), &mut scratch), CoverageMask::default());
        assert_eq!(fill(&[], (100, 100), &mut scratch), CoverageMask::default());
    }
}
