//! Samplers: the source of random numbers.
//!
//! Every number is a function of the pixel, the sample, the dimension (its use) and the seed of the sequence. So
//! results do not depend on threads, tiles or the order of work. The numbers of a dimension are stratified over the
//! samples of a pixel: they are points of an Owen-scrambled Sobol sequence (Burley, *Practical Hash-based Owen
//! Scrambling*, 2020), four coordinates at a time. Different dimensions are scrambled independently.

use super::hash::{hash, hash_from, hash_lanes, hash_start};
use super::sobol;
use crate::base::digest::Content;
use crate::base::lanes::{LaneKernel, Level, Real, Row};
use std::ops::Range;

/// The uses of random numbers. Different uses never share numbers.
pub mod dimension {
    use super::hash_lanes;
    use crate::base::lanes::Bits;

    /// Two numbers for the position in the pixel, two for the position on the lens.
    pub const CAMERA: u32 = 0;
    /// Two numbers for a scattered direction, one for the choice of its lobe, one more for the direction.
    pub const SCATTER: u32 = 2;
    /// Two numbers for a point on a light.
    pub const LIGHT: u32 = 3;
    /// The choice of one among many lights.
    pub const CHOICE: u32 = 4;
    /// Two numbers for a microfacet of a surface.
    pub const GLOSSY: u32 = 5;
    /// Russian roulette.
    pub const ROULETTE: u32 = 6;

    /// The dimension of the use `of` at the surface with this key, for the item `which` of several alike.
    #[inline(always)]
    pub fn at_surface<U: Bits>(of: u32, key: U, which: u32) -> U {
        hash_lanes([U::splat(of), key, U::splat(which)])
    }
}

/// How the numbers of the samples of a pixel are distributed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Content)]
pub enum SamplerKind {
    /// Stratified: points of an Owen-scrambled Sobol sequence.
    #[default]
    Sobol,
    /// Independent random numbers. They are noisier, and serve as a reference.
    Independent,
}

/// The random numbers of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSampler(u32);

/// The random numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    pixel_hash: u32,
    sample: u32,
}

/// The number of samples of one stratified run. More samples take several runs.
const RUN_LENGTH: u32 = 1 << 16;

impl PixelSampler {
    /// The random numbers of the pixel at (`x`, `y`).
    pub fn new((x, y): (u32, u32), seed: u32) -> Self {
        Self(hash([seed, x, y]))
    }

    /// The random numbers of one sample of the pixel.
    pub fn sample(self, sample: u32) -> Sampler {
        let pixel = if sample < RUN_LENGTH { self.0 } else { hash([self.0, sample / RUN_LENGTH, 0]) };
        Sampler { pixel_hash: hash_start(pixel), sample: sample % RUN_LENGTH }
    }

    /// The one of `count` equal parts of a time interval that a sample sees: the radical inverse of its number (van
    /// der Corput) with a random shift. So even few samples are spread over the interval.
    pub fn part_of_time(self, sample: u32, count: u32) -> u32 {
        let fraction = sample.reverse_bits() ^ self.time_shift();
        ((u64::from(fraction) * u64::from(count)) >> 32) as u32
    }

    fn time_shift(self) -> u32 {
        self.0.wrapping_mul(0x9e37_79b9)
    }
}

/// One of `count` equal parts of a time interval.
///
/// Its samples are found without trying all. The part is an interval of the fractions in
/// [`PixelSampler::part_of_time`]. Of 2^k cells, with the smallest k for which there are at least as many cells as parts,
/// it touches at most three. The first k bits of a fraction are its cell, and are the last k bits of the sample's number,
/// in reverse and shifted.
#[derive(Clone, Copy, Debug)]
pub struct TimePart {
    part: u32,
    count: u32,
    bits: u32,
    first_cell: u64,
    cells: usize,
}

impl TimePart {
    /// The part with this index.
    pub fn new(part: u32, count: u32) -> Self {
        let bits = u32::BITS - count.saturating_sub(1).leading_zeros();
        let start_of = |part: u64| (part << 32).div_ceil(u64::from(count));
        let [first_cell, last_cell] = [start_of(part.into()), start_of(u64::from(part) + 1) - 1]
            .map(|fraction| fraction >> (32 - bits));
        Self { part, count, bits, first_cell, cells: (last_cell - first_cell + 1) as usize }
    }

    /// Passes the samples of a pixel in a range that see this part to `take`, ascending.
    pub fn each_sample(self, pixel: PixelSampler, range: Range<u32>, mut take: impl FnMut(u32)) {
        let (start, end) = (u64::from(range.start), u64::from(range.end));
        let (stride, mut tried) = (1u64 << self.bits, [u64::MAX; 3]);
        let tried = &mut tried[..self.cells];
        for (cell, number) in (self.first_cell..).zip(&mut *tried) {
            let fraction = (cell << (32 - self.bits)) as u32 ^ pixel.time_shift();
            // The first number of the range with these last bits.
            let last_bits = u64::from(fraction.reverse_bits());
            *number = start + (last_bits.wrapping_sub(start) & (stride - 1));
        }
        tried.sort_unstable();
        loop {
            for number in &mut *tried {
                if *number >= end {
                    return;
                }
                if pixel.part_of_time(*number as u32, self.count) == self.part {
                    take(*number as u32);
                }
                *number += stride;
            }
        }
    }
}

impl Sampler {
    /// The state of the pixel's hashes after their first number. The random numbers depend on it.
    pub fn pixel_hash(&self) -> u32 {
        self.pixel_hash
    }

    /// The index of the sample in its run, below 2^16.
    pub fn sample(&self) -> u32 {
        self.sample
    }

    /// The sampler of one lane.
    pub fn lanes(&self) -> LaneSampler<f64> {
        LaneSampler { pixel_hash: self.pixel_hash, sample: self.sample, kind: SamplerKind::Sobol }
    }
}

/// The random numbers of one sample in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneSampler<F: Real> {
    /// [`Sampler::pixel_hash`].
    pub pixel_hash: F::U32,
    pub sample: F::U32,
    pub kind: SamplerKind,
}

impl<F: Real> LaneSampler<F> {
    /// The first N of the four numbers in 0..1 of the dimension `of`. The first two are stratified best.
    #[inline(always)]
    pub fn numbers<const N: usize>(&self, of: F::U32) -> [F; N] {
        F::Level::call_with(Numbers::<F, N> { sampler: self, of })
    }
}

struct Numbers<'a, F: Real, const N: usize> {
    sampler: &'a LaneSampler<F>,
    of: F::U32,
}

impl<F: Real, const N: usize> LaneKernel<F::Level> for Numbers<'_, F, N> {
    type Output = [F; N];

    #[inline(always)]
    fn run(self) -> [F; N] {
        let LaneSampler { pixel_hash, sample, kind } = *self.sampler;
        let seed = hash_from(pixel_hash, [self.of, F::U32::splat(0)]);
        match kind {
            SamplerKind::Sobol => sobol::point::<F, N>(sample, seed),
            SamplerKind::Independent => {
                let mut numbers = [F::splat(0.0); N];
                for (dimension, number) in (0..).zip(&mut numbers) {
                    let bits = hash_lanes([seed, sample, F::U32::splat(dimension)]);
                    *number = sobol::in_unit_interval(bits);
                }
                numbers
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_below_one_and_never_shared() {
        let at = |of, surface, which| dimension::at_surface(of, surface, which);
        let uses = [
            dimension::CAMERA,
            at(dimension::SCATTER, 0, 0),
            at(dimension::SCATTER, 1, 0),
            at(dimension::LIGHT, 0, 0),
            at(dimension::LIGHT, 0, 1),
            at(dimension::LIGHT, 1, 0),
            at(dimension::CHOICE, 0, 1),
        ];
        let mut seen = std::collections::HashSet::new();
        for (pixel, of) in [(0, 0), (1, 0), (0, 1)].into_iter().flat_map(|p| uses.map(|of| (p, of))) {
            let four = PixelSampler::new(pixel, 7).sample(0).lanes().numbers::<4>(of);
            assert!(four.iter().all(|u| (0.0..1.0).contains(u)));
            assert!(seen.insert(four.map(f64::to_bits)), "{pixel:?} {of:?}");
        }
    }

    #[test]
    fn a_pixels_samples_spread_over_time() {
        for (samples, parts) in [(64, 32), (16, 16), (8, 32)] {
            let pixel = PixelSampler::new((9, 2), 4);
            let parts: std::collections::HashSet<_> =
                (0..samples).map(|sample| pixel.part_of_time(sample, parts)).collect();
            assert_eq!(parts.len() as u32, samples.min(32), "{samples} samples");
        }
    }

    #[test]
    fn samples_are_found_by_their_part_of_time() {
        let long = [1000..5001, RUN_LENGTH - 9..RUN_LENGTH + 90, u32::MAX - 70..u32::MAX];
        let ranges = [&[0..64, 17..200, 3..3][..], &long].concat();
        for count in [1, 2, 3, 5, 7, 8, 16, 31, 32, 33, 100, 1024, 1500, 4096] {
            for (x, samples) in (0..).zip(&ranges) {
                let pixel = PixelSampler::new((x, 3), 4);
                for part in (0..count).filter(|part| count < 50 || part % 37 == 0 || part + 1 == count) {
                    let all: Vec<_> =
                        samples.clone().filter(|sample| pixel.part_of_time(*sample, count) == part).collect();
                    let mut found = Vec::new();
                    TimePart::new(part, count)
                        .each_sample(pixel, samples.clone(), |sample| found.push(sample));
                    assert_eq!(found, all, "{part} of {count}, {samples:?}");
                }
            }
        }
    }

    #[test]
    fn a_pixels_samples_are_stratified() {
        // 64 samples are in 64 different cells of an 8 x 8 grid, for both pairs of coordinates.
        for run in [0, 64, RUN_LENGTH, 3 * RUN_LENGTH + 128] {
            for pair in [0, 2] {
                let cell = |sample| {
                    let of = dimension::at_surface(dimension::SCATTER, 2, 0);
                    let four = PixelSampler::new((3, 5), 1).sample(run + sample).lanes().numbers::<4>(of);
                    ((four[pair] * 8.0) as u32, (four[pair + 1] * 8.0) as u32)
                };
                let cells: std::collections::HashSet<_> = (0..64).map(cell).collect();
                assert_eq!(cells.len(), 64, "samples from {run}, coordinates from {pair}");
            }
        }
    }
}
