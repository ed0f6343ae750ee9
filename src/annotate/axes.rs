//! Axes around a box, and grids on planes.

use super::anchor::Anchor;
use super::dimension::beside;
use super::painter::Painter;
use super::ticks::ticks;
use super::view::FrameView;
use crate::appearance::texture::DataScale;
use crate::base::math::{Aabb, DAffine3, DMat3, DVec2, DVec3};
use crate::drawing::Mark;

/// Three axes with ticks and numbers along edges of a box.
#[derive(Clone, Debug, PartialEq)]
pub struct Axes {
    pub around: AxesBox,
    /// The names of the axes; empty for none.
    pub titles: [String; 3],
    /// Ticks of an axis at most.
    pub ticks: usize,
    /// Whether thin lines show all edges of the box.
    pub edges: bool,
}

/// The box of axes.
#[derive(Clone, Debug, PartialEq)]
pub enum AxesBox {
    /// In the axes of the file.
    Box(Aabb),
    /// Around the shape of an object, by its index, in its own coordinates.
    Object(usize),
    /// From a point along the three axes, with their lengths.
    From(Anchor, DVec3),
}

/// Lines on a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct GridMark {
    pub center: DVec3,
    /// The directions of its lines, of length 1.
    pub sides: [DVec3; 2],
    /// Its size along them, and the distance of its lines.
    pub size: [f64; 2],
    pub step: f64,
}

/// Lines of a grid along each side at most.
pub const MAX_LINES: f64 = 1000.0;
/// The part of the opacity of a box's other edges, and the length of ticks relative to the height of letters.
const FAINT: f64 = 0.35;
const TICK: f64 = 0.3;

impl Axes {
    /// The box and the transform of its coordinates.
    fn bounds(&self, view: &FrameView<'_>) -> Option<(Aabb, DAffine3)> {
        let axes = DAffine3::from_mat3(DMat3::from_cols(view.axes[0], view.axes[1], view.axes[2]));
        match &self.around {
            AxesBox::Box(bounds) => Some((*bounds, axes)),
            AxesBox::Object(index) => {
                let object = (view.object)(*index, view.time);
                Some((object.bounds.filter(|_| object.visible)?, object.to_world))
            }
            AxesBox::From(anchor, lengths) => {
                let origin = anchor.world(view, view.time)?;
                let to_world = DAffine3::from_mat3_translation(axes.matrix3, origin);
                Some((Aabb { min: DVec3::ZERO, max: *lengths }, to_world))
            }
        }
    }

    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let view = painter.view;
        let Some((bounds, to_world)) = self.bounds(view) else { return };
        let corner = |index: usize| to_world.transform_point3(bounds.corners()[index & 7]);
        let edges =
            BoxEdges::new(|start, axis| view.project_line(&[corner(start), corner(start | 1 << axis)]));
        if self.edges && !matches!(self.around, AxesBox::From(..)) {
            let lines = edges.ends().map(|ends| ends.to_vec()).collect();
            painter.push(Mark::lines(lines, painter.pen.width * 0.5, painter.pen.ink.faded(FAINT)));
        }
        let center = view.project(to_world.transform_point3(bounds.center()));
        let Some(middle) = center.or_else(|| edges.middle()) else { return };
        for axis in 0..3 {
            let start = match self.around {
                AxesBox::From(..) => Some(0),
                _ => edges.outer(axis, middle),
            };
            if let Some(start) = start.filter(|_| bounds.max[axis] > bounds.min[axis]) {
                let ends = [corner(start), corner(start | 1 << axis)];
                self.axis(painter, axis, [bounds.min[axis], bounds.max[axis]], ends, middle);
            }
        }
    }

    /// An axis between two points of the world.
    fn axis(&self, painter: &mut Painter<'_>, axis: usize, range: [f64; 2], ends: [DVec3; 2], middle: DVec2) {
        let view = painter.view;
        let mut lines = view.project_line(&ends);
        // The part that is near the picture.
        let Some([a, b]) = lines.first().and_then(|line| ends_of(line)) else { return };
        let Some(direction) = (b - a).try_normalize() else { return };
        let left = DVec2::new(direction.y, -direction.x);
        let away = (a + b) * 0.5 - middle;
        let out = if away.dot(left) < 0.0 { -left } else { left };
        let size = painter.pen.size;
        let room = (b - a).length() / (1.6 * size);
        let marks = ticks(DataScale::Linear, range, (room as usize).clamp(1, self.ticks));
        // Ticks beyond the part that is drawn have no line to stand on; half a pixel is for rounding.
        let is_drawn = |place: &DVec2| (-0.5..=(b - a).length() + 0.5).contains(&(*place - a).dot(direction));
        let places: Vec<_> = marks
            .iter()
            .filter_map(|tick| Some((view.project(ends[0].lerp(ends[1], tick.share))?, &tick.label)))
            .filter(|(place, _)| is_drawn(place))
            .collect();
        lines.extend(places.iter().map(|(place, _)| vec![*place, *place + out * (TICK * size)]));
        painter.strokes(lines);
        let align = beside(out);
        for (place, label) in &places {
            let at = *place + out * (2.0 * TICK * size);
            // Numbers of two axes may meet at a corner: the first one stays.
            if painter.has_room_for(label, at, align) {
                painter.text_around(label, at, align);
            }
        }
        let title = &self.titles[axis];
        if !title.is_empty() {
            let widest = places.iter().map(|(_, label)| super::block::width_of(&painter.pen, label));
            let beyond = 3.0 * TICK * size + out.x.abs() * widest.fold(0.0, f64::max) + out.y.abs() * size;
            let at = (a + b) * 0.5 + out * beyond;
            if painter.has_room_for(title, at, align) {
                painter.text_around(title, at, align);
            }
        }
    }
}

/// The corners at which the four edges along an axis start: bits are the axes of whose ends they are.
fn starts(axis: usize) -> impl Iterator<Item = usize> {
    (0..8).filter(move |corner| corner >> axis & 1 == 0)
}

/// The two ends of a straight line.
fn ends_of(line: &[DVec2]) -> Option<[DVec2; 2]> {
    Some([*line.first()?, *line.last()?])
}

/// The edges of a box in the picture.
struct BoxEdges {
    /// For each axis and the corner at which the edge starts, the ends of what is near the picture.
    lines: [[Option<[DVec2; 2]>; 8]; 3],
}

impl BoxEdges {
    /// `line` projects the edge from a corner along an axis.
    fn new(line: impl Fn(usize, usize) -> Vec<Vec<DVec2>>) -> Self {
        let mut lines = [[None; 8]; 3];
        for (axis, lines) in lines.iter_mut().enumerate() {
            for start in starts(axis) {
                lines[start] = line(start, axis).first().and_then(|line| ends_of(line));
            }
        }
        Self { lines }
    }

    fn ends(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.lines.iter().flatten().copied().flatten()
    }

    /// The mean of all ends.
    fn middle(&self) -> Option<DVec2> {
        let count = self.ends().count();
        (count > 0).then(|| self.ends().map(|[a, b]| (a + b) * 0.5).sum::<DVec2>() / count as f64)
    }

    /// The start of the edge along an axis at the outline of what is seen: the lower one, or the left one of upright
    /// edges.
    fn outer(&self, axis: usize, middle: DVec2) -> Option<usize> {
        // All ends lie on one side of an edge of the outline.
        let is_outer = |a: DVec2, b: DVec2| {
            let sides = || self.ends().flatten().map(|place| (b - a).perp_dot(place - a));
            sides().all(|side| side >= 0.0) || sides().all(|side| side <= 0.0)
        };
        let score = |[a, b]: [DVec2; 2]| {
            let (away, direction) = ((a + b) * 0.5 - middle, (b - a).normalize_or_zero().abs());
            (is_outer(a, b), away.y * direction.x - away.x * direction.y)
        };
        let scored = starts(axis).filter_map(|start| Some((start, score(self.lines[axis][start]?))));
        scored.reduce(|best, next| if next.1 > best.1 { next } else { best }).map(|(start, _)| start)
    }
}

impl GridMark {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let [across, along] = self.sides;
        let [width, length] = self.size.map(|size| 0.5 * size);
        let mut lines = Vec::new();
        for (side, other, half, reach) in [(across, along, width, length), (along, across, length, width)] {
            // A quotient that is whole but for its rounding counts as whole.
            let count = (half / self.step * (1.0 + 4.0 * f64::EPSILON)).floor().min(MAX_LINES / 2.0) as i64;
            for index in -count..=count {
                let at = self.center + side * (index as f64 * self.step);
                lines.extend(painter.view.project_line(&[at - other * reach, at + other * reach]));
            }
        }
        painter.push(Mark::lines(lines, painter.pen.width, painter.pen.ink));
    }
}
