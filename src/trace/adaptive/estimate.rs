//! The error of a frame from the errors of its blocks, for each weighting of the film.
//!
//! The estimate from halves ([`super::halves`]) assumes independent samples. The points of one sequence complement each
//! other, so the true error is smaller. Let the squared error fall by the factor q when samples double. Then the halves
//! of n samples have the squared error E(n / 2) = E(n) / q each. With (A² + B²) / 2 = ((A + B) / 2)² + ((A - B) / 2)²
//! for the errors A and B of the halves, the true squared error is q / (1 - q) times the estimate: 1 for q = 1/2, as
//! with independent samples, and less if the error falls faster. In a frame of different parts, the error later falls
//! more slowly. So the truth is between the two.

use super::block::Block;
use crate::base::color::Rgb;
use crate::base::math::max;
use crate::film::{Noise, StratificationGain, Variances, Z_95};
use rayon::prelude::*;

/// The least factor by which squared errors are assumed to fall when samples double: 2^-1.5, as in the smoothest parts.
const LEAST_FALL: f64 = 0.353_553_390_593_273_8;

/// The error estimates of a frame.
#[derive(Clone, Debug, Default)]
pub struct ErrorEstimate {
    /// The weightings, and the error with each of them.
    weightings: Vec<Vec<Rgb>>,
    errors: Vec<FrameError>,
    gain: StratificationGain,
    /// Whether all blocks show their errors. Those of a run that is stopped early may not.
    is_known: bool,
}

/// How the squared error falls when samples double.
struct ErrorDecay {
    factor: f64,
    /// The relative variance of this estimate.
    variance: f64,
}

impl ErrorDecay {
    /// Measured by the blocks that took part in the last round and one before it.
    fn of(blocks: &[Block]) -> Self {
        let add = |[before, after]: &mut [(f64, f64); 2], block: &Block| {
            let Some(trend) = &block.trend else { return };
            let pixels = f64::from(block.pixels());
            for (sum, (square, variance)) in [(before, trend.before), (after, trend.after)] {
                *sum = (sum.0 + pixels * square, sum.1 + pixels * pixels * variance);
            }
        };
        let join = |all: &mut [(f64, f64); 2], part: &[(f64, f64); 2]| {
            all.iter_mut().zip(part).for_each(|(all, part)| *all = (all.0 + part.0, all.1 + part.1));
        };
        let [(before, of_before), (after, of_after)] = sum_of(blocks, add, join);
        if before == 0.0 || after == 0.0 {
            return Self { factor: 0.5, variance: f64::INFINITY };
        }
        Self {
            factor: (after / before).clamp(LEAST_FALL, 0.5),
            variance: of_before / (before * before) + of_after / (after * after),
        }
    }

    fn gain(&self) -> StratificationGain {
        let ratio = |factor: f64| factor / (1.0 - factor);
        let low = self.factor * libm::exp(-Z_95 * self.variance.sqrt());
        StratificationGain { ratio: ratio(self.factor), low: ratio(max(low, LEAST_FALL)) }
    }
}

/// Squared errors are relative to the squared mean of the frame.
#[derive(Clone, Copy, Debug, Default)]
struct FrameError {
    /// The mean of the frame.
    mean: f64,
    /// The squared error, if samples were independent.
    square: f64,
    variances: Variances,
}

impl ErrorEstimate {
    /// Combines the errors of blocks that have ended a round.
    pub fn new(blocks: &mut [Block], weightings: &[Vec<Rgb>]) -> Self {
        let decay = ErrorDecay::of(blocks);
        blocks.par_iter_mut().for_each(|block| block.join(decay.factor));
        let errors = weightings.iter().map(|weights| FrameError::new(blocks, weights)).collect();
        let is_known = blocks.iter().all(Block::is_measured);
        Self { weightings: weightings.to_vec(), errors, gain: decay.gain(), is_known }
    }

    /// The number of weightings.
    pub fn weightings(&self) -> usize {
        self.errors.len()
    }

    /// The weighting with the largest squared error, and this error plus one standard deviation of the estimate. The
    /// addition covers pixels that are as far off as a few others but have not shown it yet. Infinite if it is unknown.
    pub fn worst(&self) -> (usize, f64) {
        let bounds = self
            .errors
            .iter()
            .map(|error| self.gain() * (error.square + error.variances.bound.estimate.sqrt()))
            .map(|square| if self.is_known { square } else { f64::INFINITY });
        bounds.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
    }

    /// The ratio of the reported squared error to that of independent samples.
    pub fn gain(&self) -> f64 {
        self.gain.reported()
    }

    /// The part of a block in the squared error of a frame of `pixels` pixels with a weighting, if samples were
    /// independent.
    pub fn part(&self, weighting: usize, block: &Block, pixels: f64) -> f64 {
        let mean = self.errors[weighting].mean;
        let square = block.square(&self.weightings[weighting]).square;
        if mean > 0.0 { square * f64::from(block.pixels()) / (pixels * mean * mean) } else { 0.0 }
    }

    /// The reported error with a weighting. It is infinite if it is unknown.
    pub fn noise(&self, weighting: usize) -> Noise {
        if !self.is_known {
            return Noise { error: f64::INFINITY, high: f64::INFINITY, ..Noise::default() };
        }
        let FrameError { square, variances, .. } = self.errors[weighting];
        Noise::of_square(square, variances, self.gain)
    }
}

impl FrameError {
    fn new(blocks: &[Block], weights: &[Rgb]) -> Self {
        let add = |(pixels, all): &mut (f64, Self), block: &Block| {
            let (count, part) = (f64::from(block.pixels()), block.square(weights));
            *pixels += count;
            all.mean += count * block.mean(weights);
            all.square += count * part.square;
            all.variances.add_scaled(&part.variances, count * count);
        };
        let join = |(pixels, all): &mut (f64, Self), (more, part): &(f64, Self)| {
            *pixels += more;
            all.mean += part.mean;
            all.square += part.square;
            all.variances.add_scaled(&part.variances, 1.0);
        };
        let (pixels, all) = sum_of(blocks, add, join);
        let (mean, square) = (all.mean / pixels, all.square / pixels);
        let variances = all.variances.scaled(1.0 / (pixels * pixels));
        let (unit, fourth) = (mean * mean, mean * mean * mean * mean);
        if fourth > 0.0 {
            Self { mean, square: square / unit, variances: variances.scaled(1.0 / fourth) }
        } else {
            Self::default()
        }
    }
}

/// Adds up something of all blocks, in parts that depend on the number of blocks alone, not on threads.
fn sum_of<T: Default + Send>(
    blocks: &[Block],
    add: impl Fn(&mut T, &Block) + Sync,
    join: impl Fn(&mut T, &T),
) -> T {
    const PART: usize = 512;
    let parts = blocks.par_chunks(PART).map(|part| {
        let mut sum = T::default();
        part.iter().for_each(|block| add(&mut sum, block));
        sum
    });
    let (parts, mut all): (Vec<T>, T) = (parts.collect(), T::default());
    parts.iter().for_each(|part| join(&mut all, part));
    all
}
