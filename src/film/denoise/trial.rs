//! A trial of the filter, to time it.

use super::{SampleFilms, denoise};
use crate::base::color::Rgb;
use crate::film::{AovSet, Film};
use crate::sampling::hash;

/// The side of the picture: that of the largest windows, twice.
const SIDE: u32 = 64;

/// Denoises a small picture of noise with so many layers of light, and returns the number of its pixels. The time per pixel
/// hardly depends on what is in a picture.
pub fn trial(layers: usize) -> usize {
    let film = |part: u32| {
        let guides = part < 2;
        let mut film =
            Film::with_aovs(SIDE, SIDE, vec![Rgb::ONE; layers], AovSet { guides, ..AovSet::default() });
        for (index, value) in film.data_mut().iter_mut().enumerate() {
            let word = |channel: u32| hash([index as u32, part, channel]) as f32 / u32::MAX as f32;
            *value = Rgb::new(word(0), word(1), word(2));
        }
        film
    };
    let [first, second, a, b] = [0, 1, 2, 3].map(film);
    let films = SampleFilms { halves: [&first, &second], audits: [&a, &b] };
    let film = denoise(&films, 1.0);
    std::hint::black_box(&film);
    (SIDE * SIDE) as usize
}
