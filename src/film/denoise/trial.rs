//! A trial of the filter, to time it.

use super::{Halves, Memory, Neighbor, Reprojection, SampleFilms, denoise};
use crate::base::color::Rgb;
use crate::film::{AovSet, Film};
use crate::sampling::hash;

/// The size of the picture: wide enough to fill lanes, and high enough for a batch of rows.
const SIZE: (u32, u32) = (256, 64);

/// Denoises a small picture of noise with so many layers of light and that many neighbours, and returns the number of its
/// pixels. The time per pixel hardly depends on what is in a picture.
pub fn trial(layers: usize, neighbors: usize, memory: &Memory) -> usize {
    let film = |part: u32| {
        let guides = part < 2;
        let mut film =
            Film::with_aovs(SIZE.0, SIZE.1, vec![Rgb::ONE; layers], AovSet { guides, ..AovSet::default() });
        for (index, value) in film.data_mut().iter_mut().enumerate() {
            // Ten bits of one hash for each channel: the time to make the picture counts too.
            let word = hash([index as u32, part, 0]);
            *value = Rgb::from_array([0, 10, 20].map(|from| (word >> from & 0x3ff) as f32 / 1023.0));
        }
        film
    };
    let [first, second, a, b] = [0, 1, 2, 3].map(film);
    let halves = Halves::new([first, second], memory);
    let neighbors: Vec<Neighbor> =
        (0..neighbors).map(|_| Neighbor { halves: &halves, reprojection: shifted(memory) }).collect();
    let film = denoise(&SampleFilms { halves: &halves, neighbors: &neighbors, audits: [&a, &b] }, 1.0);
    std::hint::black_box(&film);
    (SIZE.0 * SIZE.1) as usize
}

/// Points that lie between four pixels, which takes the most time.
fn shifted(memory: &Memory) -> Reprojection {
    let place = |pixel: usize| [pixel % SIZE.0 as usize, pixel / SIZE.0 as usize].map(|place| place as f64);
    Reprojection::unhidden(memory, SIZE, place)
}
