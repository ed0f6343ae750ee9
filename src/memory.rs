//! How much memory a run takes, and how much there is.

use crate::color::Rgb;
use crate::film::Extras;
use crate::math::DVec3;
use crate::sequence::Sequence;
use crate::trace::SETS;

/// Films alive at once: the one being traced, those that wait for the encoder, and the one it develops.
const FILMS: u64 = 4;

/// Bytes of a pixel besides its layers: the developed picture in 8 and 16 bits, with and without alpha, and what each
/// animation keeps of its last frame with the codings of the next.
const BESIDES: u64 = 48;

/// What a machine that does not tell is taken to have free.
const UNKNOWN: u64 = 4 << 30;

/// Bytes that the pictures of a run take at once. The scene itself is not counted.
pub fn needed(sequence: &Sequence, extras: Extras) -> u64 {
    let (width, height) = sequence.output.size;
    // What several moments add up to is kept besides.
    let sums = if sequence.blurs_motion() { size_of::<DVec3>() as u64 } else { 0 };
    // Where an error is asked for, every set of a pixel's samples has its sum.
    let sets = if sequence.quality.noise.is_some() { SETS as u64 * size_of::<DVec3>() as u64 } else { sums };
    let layer = size_of::<Rgb>() as u64 * FILMS + sets;
    let pixel = (sequence.layers() + extras.layers() as u64).saturating_mul(layer).saturating_add(BESIDES);
    (u64::from(width) * u64::from(height)).saturating_mul(pixel)
}

/// Bytes that can be had without swapping, as Linux tells; elsewhere a cautious guess.
pub fn available() -> u64 {
    std::fs::read_to_string("/proc/meminfo").ok().as_deref().and_then(available_in).unwrap_or(UNKNOWN)
}

fn available_in(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kibibytes.checked_mul(1024)
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

    #[test]
    fn reads_what_linux_tells() {
        let text = "MemTotal:       24000000 kB\nMemAvailable:   1000 kB\n";
        assert_eq!(available_in(text), Some(1_024_000));
        assert_eq!(available_in("nothing"), None);
        assert!(available() > 0);
    }
}
