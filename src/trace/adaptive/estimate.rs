//! What blocks say of the error of a frame, for all weights that it is shown with.
//!
//! What halves say ([`super::block`]) is for independent samples. Points of one sequence complete each other, so the true
//! error is less. With squared errors that fall as samples double by the factor q, the halves of n samples have E(n / 2) = E(n) / q,
//! and as (A² + B²) / 2 = ((A + B) / 2)² + ((A - B) / 2)² for their errors A and B, what is left is q / (1 - q) of what the halves
//! say: all of it for the 1/2 of independent samples, less the faster the error falls. A frame whose parts differ falls more
//! slowly than it did, so the truth lies between the two.

use super::block::Block;
use crate::base::color::Rgb;
use crate::film::Noise;

/// The least factor by which squared errors are taken to fall as samples double: 2^-1.5, as they do in the smoothest parts.
const LEAST_FALL: f64 = 0.353_553_390_593_273_8;

/// What is known of a frame.
#[derive(Clone, Debug, Default)]
pub struct Estimate {
    /// The weightings, and the error with each of them.
    weightings: Vec<Vec<Rgb>>,
    errors: Vec<Error>,
    /// The factor by which the squared error is less than that of independent samples, at best.
    gain: f64,
}

/// Squares are shares of the squared mean of the frame.
#[derive(Clone, Copy, Debug, Default)]
struct Error {
    /// The mean of the frame.
    mean: f64,
    /// Were samples independent.
    square: f64,
    /// Bounds of the variance of that, and of what the squared error really is.
    variance: f64,
    truth: f64,
}

impl Estimate {
    /// Of blocks that have ended a round: joins what is new with what was known.
    pub fn new(blocks: &mut [Block], weightings: &[Vec<Rgb>]) -> Self {
        let sum = |part: fn(&Block) -> f64| -> f64 {
            blocks.iter().map(|block| f64::from(block.pixels()) * part(block)).sum()
        };
        let before = sum(|block| block.trend.map_or(0.0, |trend| trend.before));
        let after = sum(|block| block.trend.map_or(0.0, |trend| trend.after));
        let fall = if before > 0.0 { (after / before).clamp(LEAST_FALL, 0.5) } else { 0.5 };
        blocks.iter_mut().for_each(|block| block.join(fall));
        let errors = weightings.iter().map(|weights| Error::new(blocks, weights)).collect();
        Self { weightings: weightings.to_vec(), errors, gain: fall / (1.0 - fall) }
    }

    /// How many weightings there are.
    pub fn weightings(&self) -> usize {
        self.errors.len()
    }

    /// The weighting with the largest squared error, and that, by more than one standard deviation of what is known of it:
    /// where few pixels are far off, others may be without having shown it yet.
    pub fn worst(&self) -> (usize, f64) {
        let bounds = self.errors.iter().map(|error| self.gain() * (error.square + error.variance.sqrt()));
        bounds.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
    }

    /// The squared error that is told, over that of independent samples.
    pub fn gain(&self) -> f64 {
        (1.0 + self.gain) / 2.0
    }

    /// What a block of a frame of so many pixels adds to its squared error with a weighting, were samples independent.
    pub fn part(&self, weighting: usize, block: &Block, pixels: f64) -> f64 {
        let mean = self.errors[weighting].mean;
        let square = block.square(&self.weightings[weighting]).square;
        if mean > 0.0 { square * f64::from(block.pixels()) / (pixels * mean * mean) } else { 0.0 }
    }

    /// What is told of a weighting.
    pub fn noise(&self, weighting: usize) -> Noise {
        let Error { square, variance, truth, .. } = self.errors[weighting];
        Noise::of_square(square, (variance, truth), self.gain)
    }
}

impl Error {
    fn new(blocks: &[Block], weights: &[Rgb]) -> Self {
        let pixels: f64 = blocks.iter().map(|block| f64::from(block.pixels())).sum();
        let mut all = Self::default();
        for block in blocks {
            let share = f64::from(block.pixels()) / pixels;
            let part = block.square(weights);
            all.mean += share * block.mean(weights);
            all.square += share * part.square;
            all.variance += share * share * part.variance;
            all.truth += share * share * part.truth;
        }
        let Self { mean, square, variance, truth } = all;
        let (unit, fourth) = (mean * mean, mean * mean * mean * mean);
        if fourth > 0.0 {
            Self { mean, square: square / unit, variance: variance / fourth, truth: truth / fourth }
        } else {
            Self::default()
        }
    }
}
