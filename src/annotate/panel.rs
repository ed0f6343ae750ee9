//! Text, progress and images at the edges of the picture.

use super::block::{MarkBlock, PanelPosition, width_of};
use super::painter::{Painter, space_around};
use super::style::Pen;
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
    /// Lines of its longest text, and how many fit between an edge of the picture and the other.
    pub(super) fn lines_and_room(&self, pen: &Pen, height: f64) -> [u64; 2] {
        let lines = self.text.values().map(Template::lines).max().unwrap_or(0);
        let room = (height - space_around(pen)) / pen.size;
        [lines.into(), room.max(0.0) as u64]
    }

    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let text = painter.expand(&self.text.at(painter.view.time));
        let align = match self.position.place.shares().x {
            0.0 => Align::Left,
            1.0 => Align::Right,
            _ => Align::Center,
        };
        if text.trim().is_empty() {
            return;
        }
        let room = painter.view.width() - 2.0 * space_around(&painter.pen);
        let text = wrapped(&painter.pen, &text, room);
        painter.put(MarkBlock::lines_of_text(&painter.pen, &text, align), self.position);
    }
}

/// A text with more line breaks, in place of spaces, so that no line is longer than the room for it. Words that are
/// longer stay as they are.
pub(super) fn wrapped(pen: &Pen, text: &str, room: f64) -> String {
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines() {
        if width_of(pen, line) <= room {
            lines.push(line.to_owned());
            continue;
        }
        let mut current = String::new();
        for word in line.split(' ') {
            let longer = if current.is_empty() { word.to_owned() } else { format!("{current} {word}") };
            if !current.is_empty() && width_of(pen, &longer) > room {
                lines.push(std::mem::replace(&mut current, word.to_owned()));
            } else {
                current = longer;
            }
        }
        lines.push(current);
    }
    lines.join("\n")
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
