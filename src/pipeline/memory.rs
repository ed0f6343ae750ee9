//! Estimates the memory of a run.

use super::schedule::REACH;
use crate::base::color::Rgb;
use crate::base::machine;
use crate::base::math::DVec3;
use crate::film::{AovSet, denoise};
use crate::sequence::Sequence;
use crate::sequence::quality::Denoise;
use crate::trace::{PrimaryHits, bytes_of_pixel, bytes_of_sums};

/// Films in memory at once: one is being traced, some wait for the encoder, and the encoder develops one.
const FILMS: u64 = 4;

/// Bytes per pixel besides the layers: the developed picture in 8 and 16 bits, with and without alpha, plus the last
/// frame of each animation and its encodings of the next.
const BESIDES: u64 = 48;

/// Bytes that all pictures of a run take at the same time. Excludes the scene.
pub fn needed(sequence: &Sequence, aovs: AovSet) -> u64 {
    let (width, height) = sequence.output.size;
    let (blurs, adapts) = (sequence.blurs_motion(), sequence.quality.noise.is_some());
    // Motion blur also keeps the sums over a frame's moments.
    let sums = if blurs && !adapts { size_of::<DVec3>() as u64 } else { 0 };
    let samples = if aovs.samples { sequence.layers() } else { 0 };
    let layers = sequence.layers() + aovs.layers() as u64 + samples;
    // Films that share samples have weighted sums.
    let sums = if sequence.quality.shares_views() { sums.max(bytes_of_sums(1, layers)) } else { sums };
    // The films of both cameras of a cross-fade are kept until the next frame, besides their mean.
    let films = if sequence.active_camera.fades() { FILMS + 3 } else { FILMS };
    let pixel = layers.saturating_mul(size_of::<Rgb>() as u64 * films + sums).saturating_add(BESIDES);
    // Sampling towards an error target keeps more data per pixel.
    let rounds = if adapts { bytes_of_pixel(layers, blurs) } else { 0 };
    let neighbors = if sequence.quality.uses_neighbors() { 2 * u64::from(REACH) } else { 0 };
    let hits = if neighbors > 0 { (1 + neighbors) * PrimaryHits::BYTES_PER_PIXEL } else { 0 };
    let filter = match sequence.quality.denoise {
        Denoise::Off => 0,
        Denoise::Auto | Denoise::Alone => denoise::bytes((width, height), layers, neighbors),
    };
    let pixel = pixel.saturating_add(rounds).saturating_add(hits);
    (u64::from(width) * u64::from(height)).saturating_mul(pixel).saturating_add(filter)
}

/// Bytes per pixel of a filmstrip: the sheet, the pixels passed to the encoder, and the encoded file, which may be as
/// large.
const SHEET: u64 = 9;

/// Bytes of a filmstrip of this size, without the frames that are drawn into it.
pub fn for_sheet((width, height): (u32, u32)) -> u64 {
    (u64::from(width) * u64::from(height)).saturating_mul(SHEET)
}

/// Bytes of pictures that a program keeps in memory, with their radiance if that is requested.
pub fn for_pictures(sequence: &Sequence, count: usize, radiance: bool) -> u64 {
    let (width, height) = sequence.output.size;
    let codes = if sequence.output.transparent { 4 } else { 3 };
    let pixel = codes + if radiance { size_of::<Rgb>() as u64 } else { 0 };
    (u64::from(width) * u64::from(height)).saturating_mul(pixel).saturating_mul(count as u64)
}

/// Divisor of the free memory. The quotient is the default size of the film cache.
const SHARE: u64 = 4;

/// Default size of the film cache in bytes.
pub fn for_films(sequence: &Sequence, aovs: AovSet) -> u64 {
    machine::free_memory().saturating_sub(needed(sequence, aovs)) / SHARE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_blur_takes_sums() {
        let needed = |camera: &str| {
            let text = format!("(output: (size: (10, 10)), camera: ({camera}))");
            needed(&crate::sequence::parse("a.ron", &text).expect("a sequence"), AovSet::default())
        };
        assert_eq!(needed("") + 100 * 24, needed("shutter: [(0, 0), (1, 0.5)]"));
        assert_eq!(needed(""), needed("shutter: 0"));
    }
}
