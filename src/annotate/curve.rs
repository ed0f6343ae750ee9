//! Lines through many points: drawn curves, and the paths of objects over time.

use super::anchor::Anchor;
use super::painter::Painter;
use super::view::FrameView;
use crate::base::math::{DVec2, DVec3};
use crate::base::time::Time;
use crate::drawing::Mark;

/// A line through points of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveMark {
    pub points: CurvePoints,
    /// Whether a dot marks its end.
    pub dot: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum CurvePoints {
    /// Fixed points.
    Points(Vec<DVec3>),
    /// The way of a point up to the current time: since the start, or for as many seconds.
    Trail(Anchor, Option<Time>),
}

/// Points of a trail per frame.
const STEPS_PER_FRAME: u32 = 4;

/// Points left out one after the other at most.
const MAX_SKIPPED: usize = 64;
/// Points of a line that are left out are at most this many pixels away from it.
pub const FLATNESS: f64 = 0.02;

impl CurveMark {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let view = painter.view;
        let pieces = match &self.points {
            CurvePoints::Points(points) => vec![points.clone()],
            CurvePoints::Trail(anchor, span) => trail(anchor, *span, view),
        };
        let lines = pieces.iter().flat_map(|points| view.project_line(points));
        painter.strokes(lines.map(|line| simplified(&line, FLATNESS)).collect());
        let end = match &self.points {
            CurvePoints::Points(points) => points.last().copied(),
            CurvePoints::Trail(anchor, _) => anchor.world(view, view.time),
        };
        if let (true, Some(end)) = (self.dot, end.and_then(|end| view.project(end))) {
            let (radius, ink) = (2.0 * painter.pen.width, painter.pen.ink);
            painter.push(Mark::disk(end, radius, ink));
        }
    }
}

/// The places of an anchor at equal steps up to the current time, in a piece for each time in which it is visible. The
/// steps lie at the same times in all frames, so a trail does not flicker while it grows.
fn trail(anchor: &Anchor, span: Option<Time>, view: &FrameView<'_>) -> Vec<Vec<DVec3>> {
    let start = span.map_or(Time::from_integer(0), |span| (view.time - span).max(Time::from_integer(0)));
    let step = view.info.rate.time_of(1) / Time::from_integer(STEPS_PER_FRAME.into());
    let first = (start / step).ceil().to_integer();
    let last = (view.time / step).floor().to_integer();
    let steps = (first..=last).map(|index| step * Time::from_integer(index));
    let begin = Some(start).filter(|start| *start < step * Time::from_integer(first));
    let end = Some(view.time).filter(|end| *end > step * Time::from_integer(last));
    let places = begin.into_iter().chain(steps).chain(end).map(|time| anchor.world(view, time));
    let mut pieces = vec![Vec::new()];
    for place in places {
        match (place, pieces.last_mut()) {
            (Some(point), Some(piece)) => piece.push(point),
            (None, Some(piece)) if !piece.is_empty() => pieces.push(Vec::new()),
            _ => {}
        }
    }
    pieces
}

/// A line without the points that are nearly on the way between others, from the first point on. So a line that grows
/// keeps its points. Each kept point is the last one from which all points left out before it are within `flatness`.
pub fn simplified(line: &[DVec2], flatness: f64) -> Vec<DVec2> {
    let Some((first, rest)) = line.split_first() else { return Vec::new() };
    let (mut kept, mut from, mut skipped) = (vec![*first], *first, 0..0);
    for (index, point) in rest.iter().enumerate() {
        let is_near = |other: &DVec2| distance(*other, from, *point) <= flatness;
        // Bounds the work for lines that stay at one place.
        if skipped.len() < MAX_SKIPPED && rest[skipped.clone()].iter().all(is_near) {
            skipped.end = index + 1;
            continue;
        }
        from = rest[index - 1];
        kept.push(from);
        skipped = index..index + 1;
    }
    kept.extend(rest.last());
    kept
}

/// The distance of a point from a line between two others.
fn distance(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let (along, away) = (to - from, point - from);
    let length = along.length_squared();
    let share = if length > 0.0 { (away.dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (away - along * share).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simplified_lines_stay_near() {
        let curve = |count: u32| -> Vec<DVec2> {
            let at = |k: u32| f64::from(k) * 0.01;
            (0..count).map(|k| DVec2::new(at(k) * 3.0, 20.0 * libm::sin(at(k)))).collect()
        };
        let line = curve(2000);
        let kept = simplified(&line, FLATNESS);
        assert!(kept.len() < 400, "{}", kept.len());
        for point in &line {
            let near = kept.array_windows().map(|[a, b]| distance(*point, *a, *b));
            assert!(near.fold(f64::INFINITY, f64::min) <= FLATNESS);
        }
        // A line that grows keeps its points.
        let before = simplified(&curve(1500), FLATNESS);
        assert_eq!(before[..before.len() - 1], kept[..before.len() - 1]);
        assert_eq!(simplified(&[DVec2::ONE; 5], FLATNESS), [DVec2::ONE; 2]);
        assert!(simplified(&[], FLATNESS).is_empty());
    }
}
