//! Lengths and angles.

use super::anchor::Anchor;
use super::line::{HeadStyle, arrow};
use super::painter::Painter;
use crate::base::math::{DMat3, DVec2, DVec3, atan2, cos_sin_of_turns};
use crate::encode::Template;
use crate::track::Animated;

/// The distance of two points, between lines that lead to them.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    pub from: Anchor,
    pub to: Anchor,
    /// The distance of the line from the points, in heights of the picture: to the left of the way from the first to
    /// the second.
    pub offset: f64,
    /// Its last value is the length.
    pub text: Animated<Template>,
}

/// The angle between the directions from a point to two others.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleArc {
    pub at: Anchor,
    pub from: Anchor,
    pub to: Anchor,
    /// In world units.
    pub radius: f64,
    /// Its last value is the angle in degrees.
    pub text: Animated<Template>,
}

/// How far lines to the points reach beyond the line of the length, relative to the height of letters.
const BEYOND: f64 = 0.35;
/// Pieces of an arc.
const PIECES: u32 = 48;

impl Dimension {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let view = painter.view;
        let ends = [&self.from, &self.to].map(|anchor| anchor.world(view, view.time));
        let [Some(from), Some(to)] = ends else { return };
        let (Some(a), Some(b)) = (view.project(from), view.project(to)) else { return };
        painter.values.push((to - from).length());
        let text = painter.expand(&self.text.at(view.time));
        let Some(direction) = (b - a).try_normalize() else { return };
        // To the left as the picture shows it; y points down.
        let left = DVec2::new(direction.y, -direction.x);
        let shift = left * (self.offset * view.height());
        let beyond = left * (BEYOND * painter.pen.size * self.offset.signum());
        if self.offset != 0.0 {
            painter.strokes(vec![vec![a, a + shift + beyond], vec![b, b + shift + beyond]]);
        }
        arrow(painter, a + shift, b + shift, [HeadStyle::Arrow; 2]);
        let outward = if self.offset < 0.0 { -left } else { left };
        let gap = 0.2 * painter.pen.size;
        let beside_line = |share: f64, side: DVec2| (a.lerp(b, share) + shift + side * gap, beside(side));
        let places = [0.5, 0.25, 0.75].into_iter().flat_map(|share| [(share, outward), (share, -outward)]);
        let mut places = places.map(|(share, side)| beside_line(share, side));
        let free = places.find(|(place, align)| painter.has_room_for(&text, *place, *align));
        let (place, align) = free.unwrap_or_else(|| beside_line(0.5, outward));
        painter.text_around(&text, place, align);
    }
}

impl AngleArc {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let view = painter.view;
        let points = [&self.at, &self.from, &self.to].map(|anchor| anchor.world(view, view.time));
        let [Some(at), Some(from), Some(to)] = points else { return };
        let (Some(a), Some(b)) = ((from - at).try_normalize(), (to - at).try_normalize()) else { return };
        let normal = a.cross(b);
        // Exact for small angles and for those near half a turn (Kahan, *Miscalculating Area and Angles of a
        // Needle-like Triangle*, 2014).
        let angle = 2.0 * atan2((a - b).length(), (a + b).length());
        painter.values.push(angle.to_degrees());
        let text = painter.expand(&self.text.at(view.time));
        // Any side will do for half a turn.
        let side = normal.cross(a).try_normalize().unwrap_or_else(|| a.any_orthonormal_vector());
        let frame = DMat3::from_cols(a, side, DVec3::ZERO);
        let turn = angle / std::f64::consts::TAU;
        let point = |index: u32| {
            let (cos, sin) = cos_sin_of_turns(turn * f64::from(index) / f64::from(PIECES));
            at + frame * DVec3::new(cos, sin, 0.0) * self.radius
        };
        let arc: Vec<DVec3> = (0..=PIECES).map(point).collect();
        let mut lines = view.project_line(&[from, at, to]);
        lines.extend(view.project_line(&arc));
        painter.strokes(lines);
        let (Some(vertex), Some(middle)) = (view.project(at), view.project(arc[PIECES as usize / 2])) else {
            return;
        };
        let outward = (middle - vertex).normalize_or_zero();
        painter.text_around(&text, middle + outward * (0.3 * painter.pen.size), beside(outward));
    }
}

/// The alignment of a text that lies in a direction from its point.
pub fn beside(outward: DVec2) -> DVec2 {
    // Continuous, so that texts do not jump while they turn.
    DVec2::splat(0.5) - outward * 0.5 / outward.abs().max_element().max(0.5)
}
