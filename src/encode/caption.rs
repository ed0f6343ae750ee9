//! Captions that are drawn into a corner of every picture.

use super::info::FrameInfo;
use super::picture::{Code, Picture};
use crate::base::units::counted;
use crate::drawing::{Align, Canvas, TextMask, line_height};

mod number_format;
mod template;
#[cfg(test)]
mod tests;

pub use number_format::NumberFormat;
pub use template::{CaptionError, Template, listed as listed_letters};

/// The text of a caption and its position.
#[derive(Clone, Debug, PartialEq)]
pub struct Caption {
    pub text: Template,
    pub corner: Corner,
    /// Height of the letters relative to the picture's height.
    pub size: f32,
}

/// The corner of a caption.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Corner {
    TopLeft,
    TopRight,
    #[default]
    BottomLeft,
    BottomRight,
}

impl Corner {
    /// All corners with the names that users write.
    pub const NAMED: [(&'static str, Self); 4] = [
        ("TopLeft", Self::TopLeft),
        ("TopRight", Self::TopRight),
        ("BottomLeft", Self::BottomLeft),
        ("BottomRight", Self::BottomRight),
    ];

    fn is_right(self) -> bool {
        matches!(self, Self::TopRight | Self::BottomRight)
    }

    fn is_bottom(self) -> bool {
        matches!(self, Self::BottomLeft | Self::BottomRight)
    }
}

/// Minimum height of letters in pixels, for legibility.
const MIN_HEIGHT: f32 = 9.0;
/// Opacity of the black background behind the letters.
const BACKGROUND_OPACITY: f64 = 0.55;
/// Space around the letters, relative to their height.
const PADDING: f32 = 0.3;

impl Caption {
    /// A caption in the default corner and size.
    pub fn new(text: Template) -> Self {
        Self { text, corner: Corner::default(), size: 0.045 }
    }

    /// A warning if the caption has more lines than fit into pictures of this height.
    pub fn overflow_warning(&self, height: u32) -> Option<String> {
        let (size, lines) = (self.letter_height(height), u64::from(self.text.lines()));
        let room = (height as usize).saturating_sub(padding(size) / 2);
        let fit = room.checked_div(line_height(size))? as u64;
        (fit < lines).then(|| {
            let lines = counted(lines, "line");
            format!(
                "the caption has {lines}; pictures {height} pixels high have room for {fit}, and the rest is cut off"
            )
        })
    }

    /// The height of the letters in a picture of this height, in pixels.
    fn letter_height(&self, height: u32) -> f32 {
        (self.size * height as f32).max(MIN_HEIGHT)
    }

    /// Draws the caption of a frame into its picture: white letters on a translucent black background.
    pub fn draw<C: Code>(&self, picture: &mut Picture<C>, info: &FrameInfo) {
        let size = self.letter_height(picture.height);
        let align = if self.corner.is_right() { Align::Right } else { Align::Left };
        let line = TextMask::block(&self.text.expand(info), size, align);
        if line.width == 0 {
            return;
        }
        let padding = padding(size);
        let (width, height) = (line.width + 2 * padding, line.height + padding);
        let left = if self.corner.is_right() { (picture.width as usize).saturating_sub(width) } else { 0 };
        let top = if self.corner.is_bottom() { (picture.height as usize).saturating_sub(height) } else { 0 };
        for y in 0..height.min(picture.height as usize) {
            for x in 0..width.min(picture.width as usize) {
                let at = (top + y) * picture.width as usize + left + x;
                picture.blend(at, [0.0; 3], BACKGROUND_OPACITY);
                let letter = (x.checked_sub(padding), y.checked_sub(padding / 2));
                if let (Some(x), Some(y)) = letter
                    && x < line.width
                    && y < line.height
                {
                    picture.blend(at, [1.0; 3], line.coverage[y * line.width + x].into());
                }
            }
        }
    }
}

/// Space around letters of this height, in pixels.
fn padding(size: f32) -> usize {
    (PADDING * size).round() as usize
}
