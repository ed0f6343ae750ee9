//! Developed pictures with display codes of 8 or 16 bits per channel.

use crate::base::color::{Rgb, linear_to_srgb, srgb_to_linear};
use crate::drawing::Canvas;

/// An integer that encodes a display value.
pub trait Code: Copy + Default + PartialEq + Send + Sync + 'static {
    /// The largest code.
    const WHITE: f64;

    /// The code nearest to a display value in 0..=1.
    fn of(displayed: f64) -> Self {
        Self::rounded(displayed * Self::WHITE)
    }

    /// The code nearest to a number of codes, in 0..=WHITE.
    fn rounded(codes: f64) -> Self;

    /// The code as a number.
    fn number(self) -> f64;

    /// The display value in 0..=1.
    fn displayed(self) -> f64 {
        self.number() / Self::WHITE
    }
}

impl Code for u8 {
    const WHITE: f64 = 255.0;

    fn rounded(codes: f64) -> Self {
        (codes + 0.5) as Self
    }

    fn number(self) -> f64 {
        self.into()
    }
}

impl Code for u16 {
    const WHITE: f64 = 65535.0;

    fn rounded(codes: f64) -> Self {
        (codes + 0.5) as Self
    }

    fn number(self) -> f64 {
        self.into()
    }
}

/// A developed picture, in rows from the top left pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture<C = u8> {
    pub width: u32,
    pub height: u32,
    /// Three codes per pixel. They are not premultiplied by alpha.
    pub rgb: Vec<C>,
    /// One code per pixel: its coverage. `None` if the picture has a background.
    pub alpha: Option<Vec<C>>,
}

impl<C: Code> Picture<C> {
    /// A picture without alpha.
    pub fn opaque(width: u32, height: u32, rgb: Vec<C>) -> Self {
        Self { width, height, rgb, alpha: None }
    }

    /// A picture of a single colour.
    pub fn filled(width: u32, height: u32, color: [C; 3]) -> Self {
        let pixels = width as usize * height as usize;
        Self::opaque(width, height, color.iter().copied().cycle().take(3 * pixels).collect())
    }

    /// The codes as RGB or RGBA, interleaved.
    pub fn interleaved(&self) -> Vec<C> {
        let Some(alpha) = &self.alpha else { return self.rgb.clone() };
        let pixels = self.rgb.as_chunks::<3>().0.iter().zip(alpha);
        pixels.flat_map(|(&[r, g, b], &a)| [r, g, b, a]).collect()
    }

    /// The picture over a linear background colour, without alpha. Linear light is blended, not codes, so the result is
    /// the same as if the scene had this background.
    pub fn over(&self, background_color: Rgb) -> Self {
        let Some(alpha) = &self.alpha else { return self.clone() };
        let background_color = background_color.to_array().map(|part| f64::from(part).clamp(0.0, 1.0));
        let shown = background_color.map(|part| C::of(linear_to_srgb(part)));
        let mix = |(color, &alpha): (&[C; 3], &C)| {
            if alpha == C::default() {
                return shown;
            }
            let alpha = alpha.displayed();
            if alpha == 1.0 {
                return *color;
            }
            std::array::from_fn(|i| {
                let light =
                    srgb_to_linear(color[i].displayed()) * alpha + background_color[i] * (1.0 - alpha);
                C::of(linear_to_srgb(light))
            })
        };
        let pixels = self.rgb.as_chunks::<3>().0.iter().zip(alpha);
        Self::opaque(self.width, self.height, pixels.flat_map(mix).collect())
    }

    /// Copies another picture into this one, with its top left corner at (`left`, `top`). Pixels outside are cut off.
    pub fn place(&mut self, other: &Self, left: u32, top: u32) {
        let (width, theirs) = (self.width as usize, other.width as usize);
        let (left, top) = (left as usize, top as usize);
        let count = theirs.min(width.saturating_sub(left));
        let rows = self.rgb.chunks_exact_mut(3 * width).skip(top);
        for (row, source) in rows.zip(other.rgb.chunks_exact(3 * theirs.max(1))) {
            row[3 * left..][..3 * count].copy_from_slice(&source[..3 * count]);
        }
    }
}

/// Blends display values, because marks are not light.
impl<C: Code> Canvas for Picture<C> {
    fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    #[inline]
    fn blend(&mut self, pixel: usize, color: [f64; 3], opacity: f64) {
        let codes = &mut self.rgb[3 * pixel..3 * pixel + 3];
        let Some(alpha) = &mut self.alpha else {
            // What is below is there as a whole, so that nothing needs to be divided.
            let below = 1.0 - opacity;
            for (code, shown) in codes.iter_mut().zip(color) {
                *code = C::rounded(opacity * C::WHITE * shown + below * code.number());
            }
            return;
        };
        let below = alpha[pixel].displayed();
        let whole = opacity + below * (1.0 - opacity);
        if opacity == 0.0 || whole == 0.0 {
            return;
        }
        for (code, shown) in codes.iter_mut().zip(color) {
            *code = C::of((opacity * shown + below * (1.0 - opacity) * code.displayed()) / whole);
        }
        alpha[pixel] = C::of(whole);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_light_is_blended_over_a_background() {
        let rgb: Vec<u8> = vec![255, 255, 255, 10, 20, 30, 200, 0, 0];
        let picture = Picture { width: 3, height: 1, rgb, alpha: Some(vec![128, 255, 0]) };
        let over = picture.over(Rgb::new(0.0, 1.0, 0.0));
        // Half white light shows as 188; the codes' mean would be 128.
        assert_eq!(over.rgb, [188, 255, 188, 10, 20, 30, 0, 255, 0]);
        assert_eq!(over.alpha, None);
        assert_eq!(over.over(Rgb::ONE), over);
        assert_eq!(picture.interleaved()[..8], [255, 255, 255, 128, 10, 20, 30, 255]);
    }

    #[test]
    fn pictures_are_placed_and_cut_off() {
        let mut sheet = Picture::<u8>::filled(3, 2, [1, 2, 3]);
        sheet.place(&Picture::filled(2, 2, [9, 9, 9]), 2, 1);
        assert_eq!(sheet.rgb[..9], [1, 2, 3, 1, 2, 3, 1, 2, 3]);
        assert_eq!(sheet.rgb[9..], [1, 2, 3, 1, 2, 3, 9, 9, 9]);
    }

    #[test]
    fn codes_round() {
        assert_eq!([0.0, 0.5, 1.0].map(u8::of), [0, 128, 255]);
        assert_eq!([0.0, 0.5, 1.0].map(u16::of), [0, 32768, 65535]);
    }
}
