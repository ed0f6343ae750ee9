//! Colours of marks.

use crate::base::color::{Rgb, linear_to_srgb};
use crate::base::digest::Content;

/// A colour as it is displayed, with its opacity. Marks are not light: exposure and tone maps do not change them.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct Ink {
    /// Display values in 0..=1.
    pub color: [f64; 3],
    /// In 0..=1.
    pub opacity: f64,
}

impl Ink {
    /// Shows a linear colour. Values above 1 are shown as 1.
    pub fn new(linear: Rgb, opacity: f64) -> Self {
        let color = linear.to_array().map(|part| linear_to_srgb(f64::from(part).clamp(0.0, 1.0)));
        Self { color, opacity }
    }

    /// The same colour with a part of the opacity.
    pub fn faded(self, part: f64) -> Self {
        Self { opacity: self.opacity * part, ..self }
    }

    /// Black or white, whichever stands out from this colour.
    pub fn contrast(self, opacity: f64) -> Self {
        // Luma of display values (Rec. 709).
        let [r, g, b] = self.color;
        let luma = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        Self { color: [if luma < 0.5 { 1.0 } else { 0.0 }; 3], opacity }
    }

    /// The 8-bit codes of the colour.
    pub fn codes(self) -> [u8; 3] {
        self.color.map(|part| (part * 255.0 + 0.5) as u8)
    }
}
