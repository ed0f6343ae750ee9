//! Lines through many points: drawn curves, and the paths of objects over time.

use super::anchor::Anchor;
use super::painter::Painter;
use super::view::FrameView;
use crate::base::math::DVec3;
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

impl CurveMark {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let points = match &self.points {
            CurvePoints::Points(points) => points.clone(),
            CurvePoints::Trail(anchor, span) => trail(anchor, *span, painter.view),
        };
        let lines = painter.view.project_line(&points);
        painter.strokes(lines);
        let end = points.last().and_then(|end| painter.view.project(*end));
        if let (true, Some(end)) = (self.dot, end) {
            let (radius, ink) = (2.0 * painter.pen.width, painter.pen.ink);
            painter.push(Mark::disk(end, radius, ink));
        }
    }
}

/// The places of an anchor at equal steps up to the current time. The steps lie at the same times in all frames, so a
/// trail does not flicker while it grows.
fn trail(anchor: &Anchor, span: Option<Time>, view: &FrameView<'_>) -> Vec<DVec3> {
    let start = span.map_or(Time::from_integer(0), |span| (view.time - span).max(Time::from_integer(0)));
    let step = view.info.rate.time_of(1) / Time::from_integer(STEPS_PER_FRAME.into());
    let first = (start / step).ceil().to_integer();
    let last = (view.time / step).floor().to_integer();
    let steps = (first..=last).map(|index| step * Time::from_integer(index));
    let begin = Some(start).filter(|start| *start < step * Time::from_integer(first));
    let end = Some(view.time).filter(|end| *end > step * Time::from_integer(last));
    let times = begin.into_iter().chain(steps).chain(end);
    times.filter_map(|time| anchor.world(view, time)).collect()
}
