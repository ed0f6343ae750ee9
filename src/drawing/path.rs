//! Areas and lines as coverage.

use super::coverage::CoverageMask;
use super::mark::Line;
use crate::base::math::{DVec2, cos_sin_of_turns};
use zeno::{Cap, Command, Join, Mask, Scratch, Stroke, Style, Vector};

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
    let points = outlines.iter().flatten().copied();
    covered(
        points,
        0.0,
        size,
        |shift| {
            let mut commands = Vec::new();
            outlines.iter().for_each(|outline| push(&mut commands, outline, true, shift));
            (commands, zeno::Fill::NonZero.into())
        },
        scratch,
    )
}

/// The coverage by lines of a width.
pub fn stroke(
    lines: &[Line],
    (width, dashes): (f64, &[f64]),
    size: (u32, u32),
    scratch: &mut Scratch,
) -> CoverageMask {
    let points = lines.iter().flat_map(|line| line.points.iter().copied());
    let dashes: Vec<f32> = dashes.iter().map(|length| *length as f32).collect();
    let mut style = Stroke::new(width as f32);
    style.join(Join::Round).cap(Cap::Round);
    if !dashes.is_empty() {
        style.cap(Cap::Butt).dash(&dashes, 0.0);
    }
    covered(
        points,
        0.5 * width,
        size,
        |shift| {
            let mut commands = Vec::new();
            lines.iter().for_each(|line| push(&mut commands, &line.points, line.closed, shift));
            (commands, style.into())
        },
        scratch,
    )
}

fn push(commands: &mut Vec<Command>, points: &[DVec2], closed: bool, shift: DVec2) {
    let point = |point: &DVec2| Vector::new((point.x - shift.x) as f32, (point.y - shift.y) as f32);
    let Some((first, rest)) = points.split_first() else { return };
    commands.push(Command::MoveTo(point(first)));
    commands.extend(rest.iter().map(|next| Command::LineTo(point(next))));
    if closed {
        commands.push(Command::Close);
    }
}

/// Renders a path that reaches `border` pixels beyond its points, where it lies within the picture. `path` gets the
/// place of the coverage's top left corner, and gives commands relative to it.
fn covered<'s>(
    points: impl Iterator<Item = DVec2>,
    border: f64,
    (width, height): (u32, u32),
    path: impl FnOnce(DVec2) -> (Vec<Command>, Style<'s>),
    scratch: &mut Scratch,
) -> CoverageMask {
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for point in points {
        (min, max) = (min.min(point), max.max(point));
    }
    let end = DVec2::new(width.into(), height.into());
    // One pixel more, for rounding.
    let min = (min - (border + 1.0)).floor().max(DVec2::ZERO);
    let max = (max + (border + 1.0)).ceil().min(end);
    let size = max - min;
    if !(size.x >= 1.0 && size.y >= 1.0) {
        return CoverageMask::default();
    }
    let (commands, style) = path(min);
    let (width, height) = (size.x as usize, size.y as usize);
    let mut bytes = vec![0; width * height];
    Mask::with_scratch(commands.as_slice(), scratch)
        .style(style)
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
        let drawn = stroke(&[line], (3.0, &[]), (100, 100), &mut scratch);
        let area = 3.0 * (to - from).length() + std::f64::consts::PI * 1.5 * 1.5;
        assert!((total(&drawn) / area - 1.0).abs() < 0.02, "{} {area}", total(&drawn));
        assert!((centroid(&drawn) - (from + to) / 2.0).length() < 0.02);
    }

    #[test]
    fn marks_beyond_the_picture_are_cut_off() {
        let mut scratch = Scratch::new();
        let line = |from, to| vec![Line { points: vec![from, to], closed: false }];
        let far = line(DVec2::new(-4000.0, 50.0), DVec2::new(5000.0, 50.0));
        let across = stroke(&far, (2.0, &[]), (100, 100), &mut scratch);
        assert!((total(&across) - 200.0).abs() < 1.0);
        let outside = line(DVec2::new(300.0, 50.0), DVec2::new(500.0, 50.0));
        assert_eq!(stroke(&outside, (2.0, &[]), (100, 100), &mut scratch), CoverageMask::default());
        assert_eq!(fill(&[], (100, 100), &mut scratch), CoverageMask::default());
    }
}
