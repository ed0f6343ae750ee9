//! What a drawing consists of.

use super::bitmap::Bitmap;
use super::font::Font;
use super::ink::Ink;
use super::path;
use super::text::{PlacedLine, text_width};
use crate::base::digest::Content;
use crate::base::math::DVec2;

/// Marks in their order: later ones cover earlier ones. Coordinates are pixels from the top left corner of the picture
/// to the right and down; the centre of the first pixel is (0.5, 0.5).
#[derive(Clone, Debug, Default, PartialEq, Content)]
pub struct Drawing {
    pub marks: Vec<Mark>,
}

/// A line through points.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct Line {
    pub points: Vec<DVec2>,
    /// Whether it returns to its first point.
    pub closed: bool,
}

#[derive(Clone, Debug, PartialEq, Content)]
pub enum Mark {
    /// The areas within closed lines.
    Fill {
        outlines: Vec<Vec<DVec2>>,
        ink: Ink,
    },
    /// Lines of a width with round ends and corners. Where they cross, they cover once.
    Stroke {
        lines: Vec<Line>,
        width: f64,
        ink: Ink,
    },
    Text(TextMark),
    /// Equal steps of colours, from the left or from the bottom: left, top, width and height in whole pixels.
    Steps {
        place: [i64; 4],
        colors: Vec<[f64; 3]>,
        upwards: bool,
        opacity: f64,
    },
    /// An image in a rectangle: left, top, width and height.
    Image {
        image: Bitmap,
        place: [f64; 4],
        opacity: f64,
    },
    /// Marks that fade as a whole: what one of them covers does not show through it.
    Group {
        marks: Vec<Mark>,
        opacity: f64,
    },
}

/// One line of text.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct TextMark {
    pub text: String,
    pub font: Font,
    /// From the lowest descender to the highest ascender, in pixels.
    pub size: f64,
    /// The top left corner of its box.
    pub at: DVec2,
    pub ink: Ink,
    pub halo: Option<Halo>,
}

/// A border around letters, by which they stand out from any picture.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct Halo {
    pub ink: Ink,
    /// In pixels.
    pub width: f64,
}

impl TextMark {
    /// The box of the text: its top left corner and its size.
    pub fn bounds(&self) -> [DVec2; 2] {
        let width = text_width(&self.font, &self.text, self.size as f32);
        [self.at, DVec2::new(width.into(), self.size)]
    }

    /// The letters at their places.
    pub(super) fn placed(&self) -> PlacedLine<'_> {
        PlacedLine::new(&self.font, &self.text, self.size as f32, self.at)
    }
}

impl Mark {
    /// The area of a rectangle.
    pub fn rectangle(min: DVec2, max: DVec2, ink: Ink) -> Self {
        Self::Fill { outlines: vec![rectangle(min, max)], ink }
    }

    /// The outline of a rectangle.
    pub fn frame(min: DVec2, max: DVec2, width: f64, ink: Ink) -> Self {
        let lines = vec![Line { points: rectangle(min, max), closed: true }];
        Self::Stroke { lines, width, ink }
    }

    /// A disk.
    pub fn disk(center: DVec2, radius: f64, ink: Ink) -> Self {
        Self::Fill { outlines: vec![path::circle(center, radius)], ink }
    }

    /// Lines that do not return to their first points.
    pub fn lines(lines: Vec<Vec<DVec2>>, width: f64, ink: Ink) -> Self {
        let lines = lines.into_iter().map(|points| Line { points, closed: false }).collect();
        Self::Stroke { lines, width, ink }
    }
}

fn rectangle(min: DVec2, max: DVec2) -> Vec<DVec2> {
    vec![min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
}

impl Drawing {
    pub fn is_empty(&self) -> bool {
        self.marks.is_empty()
    }

    /// All texts, those of groups included.
    fn texts(&self) -> Vec<&TextMark> {
        let (mut texts, mut rest) = (Vec::new(), self.marks.iter().rev().collect::<Vec<_>>());
        while let Some(mark) = rest.pop() {
            match mark {
                Mark::Text(text) => texts.push(text),
                Mark::Group { marks, .. } => rest.extend(marks.iter().rev()),
                _ => {}
            }
        }
        texts
    }

    /// The boxes of all texts: top left corners and sizes.
    pub fn text_boxes(&self) -> impl Iterator<Item = (&TextMark, [DVec2; 2])> {
        self.texts().into_iter().map(|text| (text, text.bounds()))
    }

    /// The colours of opaque marks besides those of steps.
    pub fn solid_colors(&self) -> impl Iterator<Item = [u8; 3]> {
        self.marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Fill { ink, .. } | Mark::Stroke { ink, .. } => Some(*ink),
                Mark::Text(text) => Some(text.ink),
                Mark::Steps { .. } | Mark::Image { .. } | Mark::Group { .. } => None,
            })
            .filter(|ink| ink.opacity == 1.0)
            .map(Ink::codes)
    }

    /// The colours of opaque steps.
    pub fn step_colors(&self) -> impl Iterator<Item = [u8; 3]> {
        self.marks
            .iter()
            .flat_map(|mark| match mark {
                Mark::Steps { colors, opacity: 1.0, .. } => colors.as_slice(),
                _ => &[],
            })
            .map(|color| Ink { color: *color, opacity: 1.0 }.codes())
    }
}
