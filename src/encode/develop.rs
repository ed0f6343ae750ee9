//! Film → picture: linear radiance to display values.

#[cfg(test)]
mod tests;

use super::picture::{Code, Picture};
use super::tonemap::{Tonemap, compressed};
use crate::base::color::Rgb;
use crate::film::Film;

/// Below this, every tone map gives code 0 (the sRGB code 1 starts at 1.5e-4). A power of two.
const LOWEST: f32 = 1.0 / 8192.0;
/// From here on, every tone map gives code 255 (filmic white is at 7.25). The last value below a power of two.
const HIGHEST: f32 = 8.0_f32.next_down();
/// Bits of an f32 below those that select a step: 7 bits of mantissa are left, 128 steps per octave. That is
/// fine enough that no step holds two thresholds.
const STEP_BITS: u32 = 16;
/// Steps of the 16 octaves from `LOWEST` to `HIGHEST`. A power of two: an index cut to it is never out of range.
const STEPS: usize = 16 * 128;

/// A lookup table from linear values to display codes: exactly `floor(255 · displayed(x) + 1/2)`.
///
/// The threshold of a code is the smallest f32 that maps to it. Thresholds are found by bisection on the exact curve,
/// `Tonemap::displayed`. The exponent and the leading mantissa bits of a value select a step, and a step contains at
/// most one threshold. A step stores the code at its start, shifted by `STEP_BITS`, plus an offset. The offset is
/// chosen so that adding the remaining bits carries into the code at the threshold. So a code costs one load and one
/// addition instead of a power. 800x800 pixels take 2.8 ms on one core, of which [`Film::radiance`] takes 1.1 ms.
pub struct ToneTable {
    /// Whether colours are compressed before the lookup of their channels.
    compresses: bool,
    steps: Box<[u32; STEPS]>,
}

impl ToneTable {
    pub fn new(tonemap: Tonemap) -> Self {
        let thresholds: Vec<u32> = (1..=255).map(|code| threshold(tonemap, code).to_bits()).collect();
        let step = |i: usize| {
            let first = LOWEST.to_bits() + ((i as u32) << STEP_BITS);
            let code = thresholds.partition_point(|&t| t <= first);
            let to_carry = match thresholds.get(code) {
                Some(t) if t - first < 1 << STEP_BITS => (1 << STEP_BITS) - (t - first),
                _ => 0,
            };
            ((code as u32) << STEP_BITS) + to_carry
        };
        let mut steps = Box::new([0; STEPS]);
        for (i, slot) in steps.iter_mut().enumerate() {
            *slot = step(i);
        }
        Self { compresses: tonemap.compresses(), steps }
    }

    /// The code of a linear value. NaN gives 0; values out of range are clamped.
    pub fn code(&self, linear: f32) -> u8 {
        self.at(offset(linear))
    }

    /// The code at an [`offset`].
    fn at(&self, offset: u32) -> u8 {
        let rest = offset & ((1 << STEP_BITS) - 1);
        ((self.steps[(offset >> STEP_BITS) as usize % STEPS] + rest) >> STEP_BITS) as u8
    }

    /// Develops a film. Also returns the number of its NaN pixels, which are shown as 0.
    pub fn develop(&self, film: &Film) -> (Picture, u64) {
        let mut rgb = vec![0; film.width as usize * film.height as usize * 3];
        let (mut nan_pixels, mut first) = (0, 0);
        let mut radiance = film.radiance();
        // Several passes over small blocks of pixels, because the compiler vectorizes such simple loops.
        let mut buffer = [[0.0; 3]; 256];
        let mut indices = [0; 3 * 256];
        for out in rgb.chunks_mut(3 * buffer.len()) {
            let count = out.len() / 3;
            for (slot, pixel) in buffer.iter_mut().zip(radiance.by_ref().take(count)) {
                *slot = (pixel * film.exposure).to_array();
            }
            if film.aovs.coverage {
                for (slot, pixel) in buffer[..count].iter_mut().zip(first..) {
                    *slot = unpremultiplied(Rgb::from_array(*slot), film.alpha_at(pixel)).to_array();
                }
            }
            first += count;
            let is_nan = |pixel: &&[f32; 3]| pixel[0].is_nan() | pixel[1].is_nan() | pixel[2].is_nan();
            nan_pixels += buffer[..count].iter().filter(is_nan).count() as u64;
            if self.compresses {
                buffer[..count].iter_mut().for_each(|pixel| *pixel = compressed(*pixel));
            }
            let values = buffer[..count].as_flattened();
            for (index, value) in indices.iter_mut().zip(values) {
                *index = offset(*value);
            }
            for (code, index) in out.iter_mut().zip(&indices) {
                *code = self.at(*index);
            }
        }
        (Picture { width: film.width, height: film.height, rgb, alpha: alpha(film) }, nan_pixels)
    }
}

/// Develops a film to 16 bits per channel with the exact curves. 640x360 pixels take about 50 ms.
pub fn develop_deep(tonemap: Tonemap, film: &Film) -> Picture<u16> {
    let pixel = |(index, radiance): (usize, Rgb)| {
        let mut light = radiance * film.exposure;
        if film.aovs.coverage {
            light = unpremultiplied(light, film.alpha_at(index));
        }
        displayed(tonemap, light).map(u16::of)
    };
    let rgb = film.radiance().enumerate().flat_map(pixel).collect();
    Picture { width: film.width, height: film.height, rgb, alpha: alpha(film) }
}

/// The display value of a linear colour, 0..=1, by the exact curves.
pub fn displayed(tonemap: Tonemap, light: Rgb) -> [f64; 3] {
    let light = light.to_array();
    let light = if tonemap.compresses() { compressed(light) } else { light };
    // Written so that NaN fails the comparison.
    light.map(|linear| if linear > 0.0 { tonemap.displayed(linear.into()) } else { 0.0 })
}

/// Divides a premultiplied colour by its alpha.
fn unpremultiplied(light: Rgb, alpha: f32) -> Rgb {
    if alpha > 0.0 { light / alpha } else { Rgb::ZERO }
}

/// The coverage of each pixel, if the film has it.
fn alpha<C: Code>(film: &Film) -> Option<Vec<C>> {
    let pixels = film.width as usize * film.height as usize;
    film.aovs.coverage.then(|| (0..pixels).map(|i| C::of(film.alpha_at(i).into())).collect())
}

/// The number of f32 between `LOWEST` and a value, which is clamped to `LOWEST..=HIGHEST`. NaN gives 0.
fn offset(linear: f32) -> u32 {
    // Written so that NaN fails the first comparison.
    let x = if linear > LOWEST { linear } else { LOWEST };
    let x = if x < HIGHEST { x } else { HIGHEST };
    x.to_bits() - LOWEST.to_bits()
}

/// The code of a linear value by the exact formula.
fn exact_code(tonemap: Tonemap, linear: f32) -> u32 {
    (tonemap.displayed(linear.into()) * 255.0 + 0.5) as u32
}

/// The smallest f32 in 0..=HIGHEST whose code is at least `code`. It is found by bisection over the bits, whose order
/// is that of the values.
fn threshold(tonemap: Tonemap, code: u32) -> f32 {
    let (mut below, mut reached) = (0, HIGHEST.to_bits());
    while reached - below > 1 {
        let middle = below + (reached - below) / 2;
        if exact_code(tonemap, f32::from_bits(middle)) >= code { reached = middle } else { below = middle }
    }
    f32::from_bits(reached)
}
