//! The samples of a picture.

use super::super::{Film, LayerId};
use super::guides::{OF_PIXEL, guides_of};
use super::memory::{Held, Memory};
use super::outliers::factors;
use super::planes::Planes;
use crate::base::color::Rgb;
use rayon::prelude::*;

/// Numbers of a pixel in a layer of light: the channels of the first half and a zero, and those of the second one.
pub const OF_LAYER: usize = 2 * OF_HALF;

const OF_HALF: usize = 4;

/// The samples of a picture as two films with guides, half of the samples each.
pub struct Halves {
    pub(super) films: [Film; 2],
    /// Their light without outliers. All that is known of a pixel is read at once.
    pub(super) dimmed: Held<f32>,
    /// Their guides once more, likewise.
    pub(super) guides: Held<f32>,
}

impl Halves {
    /// Both films must have the same size and layers. What is made of them has its memory from `memory`.
    pub fn new(films: [Film; 2], memory: &Memory) -> Self {
        let (dimmed, guides) = rayon::join(|| dimmed(memory, &films), || guides_of(memory, &films));
        Self { films, dimmed, guides }
    }

    /// Bytes per pixel of what is kept besides the films.
    pub(super) const fn bytes_of_pixel(layers: u64) -> u64 {
        (layers * OF_LAYER as u64 + OF_PIXEL as u64) * size_of::<f32>() as u64
    }

    /// Where planes of these samples have their memory.
    pub(super) fn memory(&self) -> &Memory {
        self.dimmed.memory()
    }

    /// The size and the layers of the films.
    pub(super) fn film(&self) -> &Film {
        &self.films[0]
    }

    /// Columns and rows of the films.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.film().width as usize, self.film().height as usize)
    }

    /// The light of both halves without outliers.
    pub(super) fn dimmed(&self) -> [Planes; 2] {
        let ((width, _), layers) = (self.size(), self.film().held.len());
        let mut both = [(); 2].map(|()| Planes::unset(self.memory(), self.size(), 3 * layers));
        let [first, second] = &mut both;
        let stride = first.stride;
        first.par_lines_mut().zip(second.par_lines_mut()).enumerate().for_each(|(y, (first, second))| {
            let pixels = &self.dimmed[y * width * layers * OF_LAYER..][..width * layers * OF_LAYER];
            let pixels = pixels.as_chunks::<OF_LAYER>().0;
            for (half, line) in [first, second].into_iter().enumerate() {
                for (plane, row) in line.chunks_exact_mut(stride).enumerate() {
                    let (layer, number) = (plane / 3, half * OF_HALF + plane % 3);
                    let (inside, beside) = row.split_at_mut(width);
                    let light = pixels[layer..].iter().step_by(layers);
                    inside.iter_mut().zip(light).for_each(|(into, light)| *into = light[number]);
                    beside.fill(0.0);
                }
            }
        });
        both
    }

    /// The place of a layer of light among those that the films hold.
    pub(super) fn place_of(&self, layer: LayerId) -> Option<usize> {
        self.film().held.binary_search(&layer).ok()
    }

    /// The mean of both films, in a layer of light or of an AOV.
    pub(super) fn mean(&self, pixel: usize, layer: usize) -> Rgb {
        let [first, second] = self.films.each_ref().map(|film| film.pixel(pixel)[layer]);
        (first + second) * 0.5
    }
}

/// The light of both films without outliers.
fn dimmed(memory: &Memory, films: &[Film; 2]) -> Held<f32> {
    let [Film { width, height, held, .. }, _] = films;
    let (width, height, layers) = (*width as usize, *height as usize, held.len());
    let brightness = films.each_ref().map(|film| brightness(memory, film));
    let mut dimmed = memory.unset(width * height * layers * OF_LAYER);
    dimmed.par_chunks_mut((width * layers * OF_LAYER).max(1)).enumerate().for_each(|(y, line)| {
        let pixels = line.as_chunks_mut::<OF_LAYER>().0;
        for (half, (film, brightness)) in films.iter().zip(&brightness).enumerate() {
            for layer in 0..layers {
                let factors = factors(brightness, layer, y);
                let pixels = pixels[layer..].iter_mut().step_by(layers);
                for (x, (into, factor)) in pixels.zip(factors).enumerate() {
                    let light = film.pixel(y * width + x)[layer] * factor;
                    into[half * OF_HALF..][..OF_HALF].copy_from_slice(&[light.x, light.y, light.z, 0.0]);
                }
            }
        }
    });
    dimmed
}

/// The sums over the channels of each layer of light.
fn brightness(memory: &Memory, film: &Film) -> Planes {
    let (width, layers) = (film.width as usize, film.held.len());
    let mut brightness = Planes::unset(memory, (width, film.height as usize), layers);
    let stride = brightness.stride;
    brightness.par_lines_mut().enumerate().for_each(|(y, line)| {
        for (layer, row) in line.chunks_exact_mut(stride).enumerate() {
            let (inside, beside) = row.split_at_mut(width);
            for (x, sum) in inside.iter_mut().enumerate() {
                *sum = film.pixel(y * width + x)[layer].element_sum();
            }
            beside.fill(0.0);
        }
    });
    brightness
}
