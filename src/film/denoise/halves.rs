//! The samples of a picture.

use super::super::{Film, LayerId};
use super::guides::{PixelGuides, guides_of};
use super::memory::Memory;
use super::outliers::dimmed;
use super::planes::Planes;
use crate::base::color::Rgb;

/// The samples of a picture as two films with guides, half of the samples each.
pub struct Halves {
    pub(super) films: [Film; 2],
    /// Their light without outliers.
    pub(super) dimmed: [Planes; 2],
    /// Their guides once more, so that those of a pixel are read at once.
    pub(super) guides: [Vec<PixelGuides>; 2],
}

impl Halves {
    /// Both films must have the same size and layers. What is made of them has its memory from `memory`.
    pub fn new(films: [Film; 2], memory: &Memory) -> Self {
        let light = |film: &Film| dimmed(&Planes::of_film(memory, film, 0..film.held.len()));
        let [first, second] = &films;
        let dimmed = rayon::join(|| light(first), || light(second)).into();
        let guides = films.each_ref().map(guides_of);
        Self { films, dimmed, guides }
    }

    /// Bytes per pixel of what is kept besides the films.
    pub(super) const fn bytes_of_pixel(layers: u64) -> u64 {
        2 * (layers * size_of::<Rgb>() as u64 + size_of::<PixelGuides>() as u64)
    }

    /// Where planes of these samples have their memory.
    pub(super) fn memory(&self) -> &Memory {
        self.dimmed[0].memory()
    }

    /// The size and the layers of the films.
    pub(super) fn film(&self) -> &Film {
        &self.films[0]
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
