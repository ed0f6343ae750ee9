//! Cards: a text on a background that fills the picture.

use super::block::MarkBlock;
use super::painter::Painter;
use super::panel::wrapped;
use super::style::Pen;
use crate::base::color::Rgb;
use crate::base::math::DVec2;
use crate::drawing::{Align, Ink, Mark};
use crate::encode::Template;
use crate::track::Animated;

/// A title and a text in the middle of the picture, for the start and between scenes.
#[derive(Clone, Debug, PartialEq)]
pub struct Card {
    pub title: Animated<Template>,
    pub text: Animated<Template>,
    pub background: Animated<Rgb>,
}

/// The size of titles relative to that of texts, and the space between them relative to the height of letters.
const TITLE: f64 = 1.8;
const GAP: f64 = 0.6;
/// The part of the picture's width that lines may fill.
const WIDTH: f64 = 0.86;

impl Card {
    pub(super) fn paint(&self, painter: &mut Painter<'_>) {
        let view = painter.view;
        let whole = DVec2::new(view.width(), view.height());
        let background = Ink::new(self.background.at(view.time), 1.0);
        painter.push(Mark::rectangle(DVec2::ZERO, whole, background));
        let pen = painter.pen.clone();
        let title_pen = Pen { size: TITLE * pen.size, ..pen.clone() };
        let block = |pen: &Pen, text: &Animated<Template>| {
            let text = wrapped(pen, &painter.expand(&text.at(view.time)), WIDTH * whole.x);
            MarkBlock::lines_of_text(pen, &text, Align::Center)
        };
        let blocks = [block(&title_pen, &self.title), block(&pen, &self.text)];
        let gap = if blocks.iter().all(|block| block.size.y > 0.0) { GAP * pen.size } else { 0.0 };
        let height = blocks[0].size.y + gap + blocks[1].size.y;
        let mut top = 0.5 * (whole.y - height);
        for block in blocks {
            let corner = DVec2::new(0.5 * (whole.x - block.size.x), top).round();
            top += block.size.y + gap;
            block.moved(corner).for_each(|mark| painter.push(mark));
        }
    }
}
