//! Lines and arrows between points.

use super::anchor::Anchor;
use super::painter::Painter;
use crate::base::math::DVec2;
use crate::drawing::Mark;

/// A straight line between two points.
#[derive(Clone, Debug, PartialEq)]
pub struct LineMark {
    pub from: Anchor,
    pub to: Anchor,
    /// Heads at its start and its end.
    pub heads: [HeadStyle; 2],
}

/// The end of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HeadStyle {
    #[default]
    None,
    Arrow,
}

/// The length of an arrow's head relative to the width of its line, and half its width relative to its length.
const HEAD: f64 = 5.0;
const SLIM: f64 = 0.36;

impl LineMark {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let view = painter.view;
        let ends = [&self.from, &self.to].map(|anchor| anchor.world(view, view.time));
        if let [Some(from), Some(to)] = ends {
            let places = [view.project(from), view.project(to)];
            for line in view.project_line(&[from, to]) {
                if let [from, to] = line[..] {
                    // Ends that are cut off have no heads.
                    let head = |end: usize, at| match places[end] == Some(at) {
                        true => self.heads[end],
                        false => HeadStyle::None,
                    };
                    arrow(painter, from, to, [head(0, from), head(1, to)]);
                }
            }
        } else if let (Some(from), Some(to)) = (self.from.pixel(view), self.to.pixel(view)) {
            arrow(painter, from, to, self.heads);
        }
    }
}

/// A line in pixels with heads.
pub fn arrow(painter: &mut Painter<'_>, from: DVec2, to: DVec2, heads: [HeadStyle; 2]) {
    let pen = painter.pen.clone();
    let along = to - from;
    let length = along.length();
    if length == 0.0 {
        return;
    }
    let direction = along / length;
    let count = heads.iter().filter(|head| **head == HeadStyle::Arrow).count();
    let head = (HEAD * pen.width).min(length / count.max(1) as f64);
    // Lines end within their heads, so that the points stay sharp.
    let inset = |style| if style == HeadStyle::Arrow { 0.8 * head } else { 0.0 };
    painter.strokes(vec![vec![from + direction * inset(heads[0]), to - direction * inset(heads[1])]]);
    for (tip, toward, style) in [(from, -direction, heads[0]), (to, direction, heads[1])] {
        if style == HeadStyle::Arrow {
            let (base, side) = (tip - toward * head, DVec2::new(-toward.y, toward.x) * (SLIM * head));
            painter.push(Mark::Fill { outlines: vec![vec![tip, base + side, base - side]], ink: pen.ink });
        }
    }
}
