//! Text at points of the world, of objects and of the picture.

use super::anchor::Anchor;
use super::block::{MarkBlock, stroke};
use super::painter::{PADDING, Painter, PixelBox};
use crate::base::math::DVec2;
use crate::drawing::{Align, Mark};
use crate::encode::Template;
use crate::track::Animated;

/// A text beside a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    pub text: Animated<Template>,
    pub at: Anchor,
    /// From the point to the nearest corner, side or middle of the text.
    pub offset: Offset,
    /// Whether a line leads from the text to the point.
    pub leader: bool,
    pub behind: Behind,
    /// Whether it moves to another side of its point if it would lie on an earlier text or on a block.
    pub avoid: bool,
}

/// A distance in the picture, to the right and up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offset {
    /// In heights of the picture.
    Relative(DVec2),
    Pixels(DVec2),
}

impl Offset {
    pub const ZERO: Self = Self::Pixels(DVec2::ZERO);

    /// In pixels to the right and down.
    pub fn pixels(self, height: f64) -> DVec2 {
        let offset = match self {
            Self::Relative(offset) => offset * height,
            Self::Pixels(offset) => offset,
        };
        DVec2::new(offset.x, 0.0 - offset.y)
    }
}

/// What becomes of a label whose point is behind a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Behind {
    Hide,
    Fade,
    #[default]
    Show,
}

/// The part of the opacity that faded labels keep.
const FADED: f64 = 0.3;

impl Label {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let view = painter.view;
        let Some(point) = self.at.pixel(view).filter(|point| view.shows(*point)) else { return };
        if self.behind != Behind::Show
            && let Some(world) = self.at.world(view, view.time)
            && (view.is_hidden)(world, self.at.object())
        {
            match self.behind {
                Behind::Hide => return,
                _ => painter.fade_by(FADED),
            }
        }
        let text = painter.expand(&self.text.at(view.time));
        let offset = self.offset.pixels(view.height());
        let align = match offset.x {
            x if x > 0.0 => Align::Left,
            x if x < 0.0 => Align::Right,
            _ => Align::Center,
        };
        if text.trim().is_empty() {
            return;
        }
        let block = MarkBlock::lines_of_text(&painter.pen, &text, align);
        let padding = if painter.pen.panel.is_some() { PADDING * painter.pen.size } else { 0.0 };
        let size = block.size + 2.0 * padding;
        let outer = self.place(painter, point, offset, size);
        if self.leader {
            self.lead(painter, point, outer);
        }
        let inner = outer[0] + padding;
        painter.panel([inner, block.size]);
        painter.take(outer);
        block.moved(inner).for_each(|mark| painter.push(mark));
    }

    /// The rectangle of the label: the first one in a fixed order that touches no earlier text and no block, or else the
    /// one that the offset asks for. All are within the picture.
    fn place(&self, painter: &Painter<'_>, point: DVec2, offset: DVec2, size: DVec2) -> PixelBox {
        let whole = DVec2::new(painter.view.width(), painter.view.height());
        let at = |offset: DVec2| {
            let before = |x: f64| {
                if x > 0.0 {
                    0.0
                } else if x < 0.0 {
                    1.0
                } else {
                    0.5
                }
            };
            let corner = point + offset - DVec2::new(before(offset.x), before(offset.y)) * size;
            [corner.min(whole - size).max(DVec2::ZERO), size]
        };
        let wanted = at(offset);
        if !self.avoid || painter.is_free_for_labels(wanted) {
            return wanted;
        }
        // At least as far as a text without an offset needs.
        let reach = offset.abs().max(DVec2::splat(0.5 * painter.pen.size));
        let sides = |far: f64| {
            let signs = [offset.x, offset.y].map(|part| if part < 0.0 { -far } else { far });
            let [x, y] = [reach.x * signs[0], reach.y * signs[1]];
            [(x, y), (x, -y), (-x, y), (-x, -y), (0.0, y), (0.0, -y), (x, 0.0), (-x, 0.0)]
        };
        let all = [1.0, 2.0, 3.0].into_iter().flat_map(sides).map(|(x, y)| at(DVec2::new(x, y)));
        all.into_iter().find(|place| painter.is_free_for_labels(*place)).unwrap_or(wanted)
    }

    /// The line between the point and the nearest point of the label, and a dot at the point.
    fn lead(&self, painter: &mut Painter<'_>, point: DVec2, [corner, size]: PixelBox) {
        let near = point.clamp(corner, corner + size);
        let mut marks = Vec::new();
        if near != point {
            stroke(&mut marks, &painter.pen, vec![vec![point, near]]);
        }
        let dot = 1.6 * painter.pen.width;
        if let Some(halo) = painter.pen.halo {
            marks.push(Mark::disk(point, dot + painter.pen.halo_width(), halo));
        }
        marks.push(Mark::disk(point, dot, painter.pen.ink));
        marks.into_iter().for_each(|mark| painter.push(mark));
    }
}
