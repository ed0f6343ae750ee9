//! Where random numbers come from.
//!
//! Every number is a function of the pixel, the sample, what it is used for and the sequence's seed, so that
//! threads, tiles and the order of work do not show. Numbers of one use are stratified over a pixel's
//! samples: they are points of an Owen-scrambled Sobol sequence (Burley, *Practical Hash-based Owen
//! Scrambling*, 2020), four dimensions at a time; different uses are scrambled independently.

use super::hash::{hash, hash_lanes};
use super::sobol;
use crate::base::digest::content;
use crate::base::lanes::{LaneKernel, Level, Real, Row};

/// What random numbers are used for. Different uses never share numbers.
pub mod dimension {
    use super::hash_lanes;
    use crate::base::lanes::Bits;

    /// Two numbers for the place in the pixel, two for that on the lens.
    pub const CAMERA: u32 = 0;
    /// Two for a direction from a surface, one for the lobe that it is drawn from, one more for the direction.
    pub const SCATTER: u32 = 2;
    /// Two for a place on a light.
    pub const LIGHT: u32 = 3;
    /// Which of many lights is sampled.
    pub const CHOICE: u32 = 4;
    /// Two for a small mirror of a surface.
    pub const GLOSSY: u32 = 5;
    /// Whether a path goes on.
    pub const ROULETTE: u32 = 6;

    /// The number of a use at a surface of this key, and there for one of several things alike.
    #[inline(always)]
    pub fn at_surface<U: Bits>(of: u32, key: U, which: u32) -> U {
        hash_lanes([U::splat(of), key, U::splat(which)])
    }
}

/// How the numbers of a pixel's samples lie among each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Points {
    /// Stratified, points of a scrambled Sobol sequence.
    #[default]
    Sobol,
    /// Each by itself, as dice fall. Noisier, and good to compare with.
    Independent,
}

content!(
    enum Points {
        Sobol,
        Independent,
    }
);

/// The random numbers of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSampler(u32, Points);

/// The random numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    pixel: u32,
    sample: u32,
    points: Points,
}

/// Longest stratified run of samples; longer ones are made of several.
const RUN: u32 = 1 << 16;

impl PixelSampler {
    /// The numbers of the pixel at (`x`, `y`).
    pub fn new((x, y): (u32, u32), seed: u32) -> Self {
        Self(hash([seed, x, y]), Points::Sobol)
    }

    /// The same, but that they lie so among each other.
    pub fn with(self, points: Points) -> Self {
        Self(self.0, points)
    }

    /// The numbers of one of the pixel's samples.
    pub fn sample(self, sample: u32) -> Sampler {
        let pixel = if sample < RUN { self.0 } else { hash([self.0, sample / RUN, 0]) };
        Sampler { pixel, sample: sample % RUN, points: self.1 }
    }

    /// Which of `count` equal parts of a time a sample looks at: the radical inverse of its number, shifted at
    /// random, so that samples spread over the time however few they are (van der Corput).
    pub fn part_of_time(self, sample: u32, count: u32) -> u32 {
        let fraction = sample.reverse_bits() ^ self.0.wrapping_mul(0x9e37_79b9);
        ((u64::from(fraction) * u64::from(count)) >> 32) as u32
    }
}

impl Sampler {
    /// The number of the pixel that its random numbers depend on.
    pub fn pixel(&self) -> u32 {
        self.pixel
    }

    /// The number of the sample, below 2^16.
    pub fn sample(&self) -> u32 {
        self.sample
    }

    /// The same in the one lane that there is.
    pub fn lanes(&self) -> LaneSampler<f64> {
        LaneSampler { pixel: self.pixel, sample: self.sample, points: self.points }
    }
}

/// The random numbers of one sample in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneSampler<F: Real> {
    pub pixel: F::U32,
    pub sample: F::U32,
    pub points: Points,
}

impl<F: Real> LaneSampler<F> {
    /// The first N of the four numbers in 0..1 of a use. Of them, the first two are stratified best.
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
        let LaneSampler { pixel, sample, points } = *self.sampler;
        let seed = hash_lanes([pixel, self.of, F::U32::splat(0)]);
        match points {
            Points::Sobol => sobol::point::<F, N>(sample, seed),
            Points::Independent => {
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
    fn a_pixels_samples_are_stratified() {
        // 64 samples fall into 64 different cells of an 8 x 8 grid, in both pairs of dimensions.
        for run in [0, 64, RUN, 3 * RUN + 128] {
            for pair in [0, 2] {
                let cell = |sample| {
                    let of = dimension::at_surface(dimension::SCATTER, 2, 0);
                    let four = PixelSampler::new((3, 5), 1).sample(run + sample).lanes().numbers::<4>(of);
                    ((four[pair] * 8.0) as u32, (four[pair + 1] * 8.0) as u32)
                };
                let cells: std::collections::HashSet<_> = (0..64).map(cell).collect();
                assert_eq!(cells.len(), 64, "samples from {run}, dimensions from {pair}");
            }
        }
    }
}
