//! How much memory a run takes.

use crate::base::color::Rgb;
use crate::base::machine;
use crate::base::math::DVec3;
use crate::film::Extras;
use crate::sequence::Sequence;
use crate::trace::bytes_of_pixel;

/// Films alive at once: the one being traced, those that wait for the encoder, and the one it develops.
const FILMS: u64 = 4;

/// Bytes of a pixel besides its layers: the developed picture in 8 and 16 bits, with and without alpha, and what each
/// animation keeps of its last frame with the codings of the next.
const BESIDES: u64 = 48;

/// Bytes that the pictures of a run take at once. The scene itself is not counted.
pub fn needed(sequence: &Sequence, extras: Extras) -> u64 {
    let (width, height) = sequence.output.size;
    // What several moments add up to is kept besides.
    let sums = if sequence.blurs_motion() { size_of::<DVec3>() as u64 } else { 0 };
    let layers = sequence.layers() + extras.layers() as u64;
    let pixel = layers.saturating_mul(size_of::<Rgb>() as u64 * FILMS + sums).saturating_add(BESIDES);
    // What is sampled until it is good keeps more.
    let rounds = if sequence.quality.noise.is_some() { bytes_of_pixel(layers) } else { 0 };
    let pixel = pixel.saturating_add(rounds);
    (u64::from(width) * u64::from(height)).saturating_mul(pixel)
}

/// Bytes of a pixel of a filmstrip: the sheet, the codes that are handed to the encoder, and what comes of them, which
/// may be no smaller.
const SHEET: u64 = 9;

/// Bytes that a filmstrip of this size takes, besides the frames that are put into it.
pub fn for_sheet((width, height): (u32, u32)) -> u64 {
    (u64::from(width) * u64::from(height)).saturating_mul(SHEET)
}

/// The part of the memory that is left, as a divisor, which films that are kept for other frames may have.
const SHARE: u64 = 4;

/// Bytes that films may have that are kept for other frames, where nobody says how many.
pub fn for_films(sequence: &Sequence, extras: Extras) -> u64 {
    machine::free_memory().saturating_sub(needed(sequence, extras)) / SHARE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_blur_takes_sums() {
        let needed = |camera: &str| {
            let text = format!("(output: (size: (10, 10)), camera: ({camera}))");
            needed(&crate::sequence::parse("a.ron", &text).expect("a sequence"), Extras::default())
        };
        assert_eq!(needed("") + 100 * 24, needed("shutter: [(0, 0), (1, 0.5)]"));
        assert_eq!(needed(""), needed("shutter: 0"));
    }
}
