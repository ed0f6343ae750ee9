//! Text, progress and images at the edges of the picture.

use super::block::{MarkBlock, PanelPosition};
use super::painter::Painter;
use crate::base::math::DVec2;
use crate::drawing::{Align, Bitmap, Mark};
use crate::encode::Template;
use crate::track::Animated;

/// A text at a place of the picture: captions and clocks.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptionText {
    pub text: Animated<Template>,
    pub position: PanelPosition,
}

/// A bar that fills from the first frame to the last.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgressBar {
    pub position: PanelPosition,
    /// Relative to the width of the picture.
    pub length: f64,
    /// Relative to the height of the picture.
    pub thickness: f64,
}

/// An image with alpha.
#[derive(Clone, Debug, PartialEq)]
pub struct Logo {
    pub image: Bitmap,
    pub position: PanelPosition,
    /// Relative to the height of the picture.
    pub height: f64,
}

impl CaptionText {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let text = painter.expand(&self.text.at(painter.view.time));
        let align = match self.position.place.shares().x {
            0.0 => Align::Left,
            1.0 => Align::Right,
            _ => Align::Center,
        };
        let block = MarkBlock::lines_of_text(&painter.pen, &text, align);
        if !block.marks.is_empty() {
            painter.put(block, self.position);
        }
    }
}

impl ProgressBar {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let (view, ink) = (painter.view, painter.pen.ink);
        let last = f64::from(view.info.sequence.frames.saturating_sub(1));
        let share = if last > 0.0 { (f64::from(view.info.frame) / last).min(1.0) } else { 1.0 };
        let size = DVec2::new(self.length * view.width(), self.thickness * view.height()).max(DVec2::ONE);
        let mut block = MarkBlock { marks: Vec::new(), size };
        block.marks.push(Mark::rectangle(DVec2::ZERO, size, ink.contrast(0.5)));
        block.marks.push(Mark::rectangle(DVec2::ZERO, DVec2::new(size.x * share, size.y), ink));
        painter.put(block, self.position);
    }
}

impl Logo {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let height = (self.height * painter.view.height()).max(1.0);
        let size = DVec2::new(height * self.image.aspect(), height);
        let image =
            Mark::Image { image: self.image.clone(), place: [0.0, 0.0, size.x, size.y], opacity: 1.0 };
        let block = MarkBlock { marks: vec![image], size };
        painter.put(block, self.position);
    }
}
