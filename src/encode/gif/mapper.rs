//! Picture → palette indices.

use super::dither::{Mixer, PARTS};
use super::threshold;
use crate::encode::picture::Picture;

/// Entries of the cache of mixes, as a power of two. 2^15 entries take 0.6 MB, which fits into the processor's cache.
const CACHE_BITS: u32 = 15;
/// The key of an empty entry. No colour has it.
const NO_KEY: u32 = u32::MAX;

/// Maps pictures to palette indices and caches mixes. The index of a pixel depends on its colour and position only, so
/// static parts of the animation do not flicker.
pub struct Mapper<'a> {
    mixer: &'a Mixer,
    /// For each cell of the threshold matrix, `threshold::SIDE`² of them, the part of the mix that it selects.
    parts: Vec<u8>,
    cache: Cache,
}

/// A direct-mapped cache of mixes by their colours.
struct Cache(Vec<(u32, [u8; PARTS])>);

impl<'a> Mapper<'a> {
    pub fn new(mixer: &'a Mixer) -> Self {
        let ranks_of_a_part = threshold::SIDE * threshold::SIDE / PARTS;
        let part = |&rank: &u16| (usize::from(rank) / ranks_of_a_part) as u8;
        let parts = threshold::RANKS.iter().map(part).collect();
        Self { mixer, parts, cache: Cache(vec![(NO_KEY, [0; PARTS]); 1 << CACHE_BITS]) }
    }

    /// One palette index per pixel. Transparent pixels get the index `clear`, if there is one. Pixels of `flat` are not
    /// dithered.
    pub fn map(&mut self, picture: &Picture, clear: Option<u8>, flat: Option<&[bool]>) -> Vec<u8> {
        let mut indices = self.opaque(picture);
        if let Some(flat) = flat {
            self.flatten(picture, flat, &mut indices);
        }
        if let (Some(clear), Some(alpha)) = (clear, &picture.alpha) {
            let out = indices.iter_mut().zip(alpha).filter(|(_, alpha)| **alpha == 0);
            out.for_each(|(index, _)| *index = clear);
        }
        indices
    }

    /// Maps the pixels of `flat` to the palette colours nearest to them.
    fn flatten(&self, picture: &Picture, flat: &[bool], indices: &mut [u8]) {
        let pixels = picture.rgb.as_chunks::<3>().0;
        // Neighbours are often equal.
        let mut last = ([0; 3], self.mixer.flat([0; 3]));
        for ((index, &color), _) in indices.iter_mut().zip(pixels).zip(flat).filter(|(_, flat)| **flat) {
            if last.0 != color {
                last = (color, self.mixer.flat(color));
            }
            *index = last.1;
        }
    }

    fn opaque(&mut self, picture: &Picture) -> Vec<u8> {
        let pixels = picture.rgb.as_chunks::<3>().0;
        let width = picture.width.max(1) as usize;
        let mut indices = Vec::with_capacity(pixels.len());
        for (y, row) in pixels.chunks(width).enumerate() {
            let place = y % threshold::SIDE * threshold::SIDE;
            let parts = &self.parts[place..place + threshold::SIDE];
            for (x, &color) in row.iter().enumerate() {
                let part = parts[x % threshold::SIDE];
                indices.push(self.cache.mix(self.mixer, color)[usize::from(part) % PARTS]);
            }
        }
        indices
    }
}

impl Cache {
    fn mix(&mut self, mixer: &Mixer, color: [u8; 3]) -> &[u8; PARTS] {
        let key = u32::from_be_bytes([0, color[0], color[1], color[2]]);
        let slot = &mut self.0[(key.wrapping_mul(0x9E37_79B1) >> (32 - CACHE_BITS)) as usize];
        if slot.0 != key {
            *slot = (key, mixer.mix(color));
        }
        &slot.1
    }
}
