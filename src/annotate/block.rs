//! Marks that keep together, and their places in the picture.

use super::label::Offset;
use super::style::Pen;
use crate::base::math::DVec2;
use crate::drawing::{Align, Line, Mark, TextMark, text_width};

/// Where a block of marks stands in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelPlace {
    TopLeft,
    Top,
    TopRight,
    Left,
    Center,
    Right,
    BottomLeft,
    Bottom,
    BottomRight,
}

impl PanelPlace {
    /// All places with the names that users write.
    pub const NAMED: [(&'static str, Self); 9] = [
        ("TopLeft", Self::TopLeft),
        ("Top", Self::Top),
        ("TopRight", Self::TopRight),
        ("Left", Self::Left),
        ("Center", Self::Center),
        ("Right", Self::Right),
        ("BottomLeft", Self::BottomLeft),
        ("Bottom", Self::Bottom),
        ("BottomRight", Self::BottomRight),
    ];

    /// 0, 0.5 or 1 from the left, and from the top.
    pub fn shares(self) -> DVec2 {
        let index = self as usize;
        DVec2::new((index % 3) as f64, (index / 3) as f64) * 0.5
    }
}

/// Where a block stands: at a place, moved by an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelPosition {
    pub place: PanelPlace,
    pub offset: Offset,
}

/// Marks around an origin, and the size of the rectangle that they fill from there to the right and down.
#[derive(Clone, Debug, Default)]
pub struct MarkBlock {
    pub marks: Vec<Mark>,
    pub size: DVec2,
}

impl MarkBlock {
    /// Adds a line of text with its box's left top corner at a point.
    pub fn text(&mut self, pen: &Pen, text: &str, at: DVec2) {
        self.marks.push(text_mark(pen, text, at));
    }

    /// Lines of text below each other.
    pub fn lines_of_text(pen: &Pen, text: &str, align: Align) -> Self {
        let width = width_of(pen, text);
        let mut block = Self::default();
        for (index, line) in text.lines().enumerate() {
            let free = width - width_of(pen, line);
            let left = match align {
                Align::Left => 0.0,
                Align::Center => 0.5 * free,
                Align::Right => free,
            };
            block.text(pen, line, DVec2::new(left, index as f64 * pen.size));
        }
        block.size = DVec2::new(width, text.lines().count() as f64 * pen.size);
        block
    }

    /// Adds lines, over a halo if the pen has one.
    pub fn strokes(&mut self, pen: &Pen, lines: Vec<Vec<DVec2>>) {
        stroke(&mut self.marks, pen, lines);
    }

    /// The marks, moved by a vector.
    pub fn moved(self, by: DVec2) -> impl Iterator<Item = Mark> {
        self.marks.into_iter().map(move |mark| moved(mark, by))
    }
}

/// Adds lines, over a halo if the pen has one.
pub fn stroke(marks: &mut Vec<Mark>, pen: &Pen, lines: Vec<Vec<DVec2>>) {
    if lines.is_empty() {
        return;
    }
    if let Some(halo) = pen.halo {
        marks.push(Mark::lines(lines.clone(), pen.width + 2.0 * pen.halo_width(), halo.faded(0.6)));
    }
    marks.push(Mark::lines(lines, pen.width, pen.ink));
}

/// The width of the longest line of a text.
pub fn width_of(pen: &Pen, text: &str) -> f64 {
    text_width(&pen.font, text, pen.size as f32).into()
}

pub fn text_mark(pen: &Pen, text: &str, at: DVec2) -> Mark {
    Mark::Text(TextMark {
        text: text.to_owned(),
        font: pen.font.clone(),
        size: pen.size,
        at,
        ink: pen.ink,
        halo: pen.text_halo(),
    })
}

fn moved(mark: Mark, by: DVec2) -> Mark {
    let shifted = |points: Vec<DVec2>| points.into_iter().map(|point| point + by).collect::<Vec<_>>();
    match mark {
        Mark::Fill { outlines, ink } => {
            Mark::Fill { outlines: outlines.into_iter().map(shifted).collect(), ink }
        }
        Mark::Stroke { lines, width, ink } => {
            let line = |line: Line| Line { points: shifted(line.points), ..line };
            Mark::Stroke { lines: lines.into_iter().map(line).collect(), width, ink }
        }
        Mark::Text(text) => Mark::Text(TextMark { at: text.at + by, ..text }),
        Mark::Steps { place: [left, top, width, height], colors, upwards, opacity } => {
            let place = [left + by.x.round() as i64, top + by.y.round() as i64, width, height];
            Mark::Steps { place, colors, upwards, opacity }
        }
        Mark::Image { image, place: [left, top, width, height], opacity } => {
            Mark::Image { image, place: [left + by.x, top + by.y, width, height], opacity }
        }
        Mark::Group { marks, opacity } => {
            Mark::Group { marks: marks.into_iter().map(|mark| moved(mark, by)).collect(), opacity }
        }
    }
}
