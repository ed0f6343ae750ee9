//! Where random numbers come from.
//!
//! Every number is a function of the pixel, the sample, what it is used for and the sequence's seed, so that
//! threads, tiles and the order of work do not show. Numbers of one use are stratified over a pixel's
//! samples: they are points of an Owen-scrambled Sobol sequence (Burley, *Practical Hash-based Owen
//! Scrambling*, 2020), four dimensions at a time; different uses are scrambled independently.

use super::sobol;
use crate::digest::content;
use crate::math::DVec2;

/// What random numbers are used for. Different uses never share numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Two numbers for the place in the pixel, two for that on the lens.
    Camera,
    /// Which lobe is followed at the `n`-th surface, and in which direction.
    Scatter(u32),
    /// In which of its small mirrors the `n`-th surface is looked at.
    Glossy(u32),
    /// Whether a path goes on after the `n`-th surface.
    Roulette(u32),
    /// Towards light `light` from the `n`-th surface.
    Light { surface: u32, light: u32 },
    /// Which light of a layer is asked at the `n`-th surface.
    Choice { surface: u32, layer: u32 },
}

impl Use {
    fn number(self) -> u32 {
        match self {
            Self::Camera => 0,
            Self::Scatter(n) => hash([2, n, 0]),
            Self::Glossy(n) => hash([5, n, 0]),
            Self::Roulette(n) => hash([6, n, 0]),
            Self::Light { surface, light } => hash([3, surface, light]),
            Self::Choice { surface, layer } => hash([4, surface, layer]),
        }
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
    /// Four numbers in 0..1.
    pub fn four(&self, of: Use) -> [f64; 4] {
        let seed = hash([self.pixel, of.number(), 0]);
        match self.points {
            Points::Sobol => sobol::point(self.sample, seed).map(f64::from),
            Points::Independent => independent(seed, self.sample),
        }
    }

    /// [`Sampler::four`] of eight samplers, a row for each of the four. To be inlined where lanes are at work.
    #[inline(always)]
    pub fn four_together(eight: &[Self; 8], of: Use) -> [[f64; 8]; 4] {
        let number = of.number();
        let (mut samples, mut seeds) = ([0; 8], [0; 8]);
        for lane in 0..8 {
            samples[lane] = eight[lane].sample;
            seeds[lane] = hash([eight[lane].pixel, number, 0]);
        }
        if eight[0].points == Points::Independent {
            let lanes: [[f64; 4]; 8] = std::array::from_fn(|lane| independent(seeds[lane], samples[lane]));
            return std::array::from_fn(|row| std::array::from_fn(|lane| lanes[lane][row]));
        }
        sobol::points(&samples, &seeds).map(|row| row.map(f64::from))
    }

    /// Two numbers in 0..1.
    pub fn two(&self, of: Use) -> DVec2 {
        let [x, y, ..] = self.four(of);
        DVec2::new(x, y)
    }
}

/// Four numbers in 0..1 that have nothing to do with those of other samples.
fn independent(seed: u32, sample: u32) -> [f64; 4] {
    std::array::from_fn(|dimension| f64::from(hash([seed, sample, dimension as u32])) / 4_294_967_296.0)
}

/// A well-mixed number from three: a round of multiplications and shifts for each (the finalizer of
/// MurmurHash3, Appleby 2011).
#[inline(always)]
pub fn hash(words: [u32; 3]) -> u32 {
    words.iter().fold(0x9e37_79b9, |state, &word| {
        let mut h = state.rotate_left(13).wrapping_mul(5).wrapping_add(0xe654_6b64) ^ word;
        h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
        h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
        h ^ (h >> 16)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_below_one_and_never_shared() {
        let uses = [
            Use::Camera,
            Use::Scatter(0),
            Use::Scatter(1),
            Use::Light { surface: 0, light: 0 },
            Use::Light { surface: 0, light: 1 },
            Use::Light { surface: 1, light: 0 },
            Use::Choice { surface: 0, layer: 1 },
        ];
        let mut seen = std::collections::HashSet::new();
        for (pixel, of) in [(0, 0), (1, 0), (0, 1)].into_iter().flat_map(|p| uses.map(|of| (p, of))) {
            let four = PixelSampler::new(pixel, 7).sample(0).four(of);
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
                    let four = PixelSampler::new((3, 5), 1).sample(run + sample).four(Use::Scatter(2));
                    ((four[pair] * 8.0) as u32, (four[pair + 1] * 8.0) as u32)
                };
                let cells: std::collections::HashSet<_> = (0..64).map(cell).collect();
                assert_eq!(cells.len(), 64, "samples from {run}, dimensions from {pair}");
            }
        }
    }
}
