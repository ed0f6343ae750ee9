//! Allocation of samples: to where they reduce the error of the frame most per ray.
//!
//! A block with n samples per pixel and variance v per sample adds v / n to the squared error of the frame, in relative
//! units, and costs c n rays. For a given sum of squared errors, the work is least if n is proportional to √(v / c)
//! (Neyman, *On the Two Different Aspects of the Representative Method*, 1934, with costs).
//!
//! If a film serves several frames, half of a block's variance comes from the worst frame, and half from the mean of
//! all frames. So no frame takes many times the samples that it needs alone.
//!
//! Three quarters of a block's variance are the mean of its neighbourhood (`OWN`). So a block whose few samples have
//! missed a light is refined if its neighbours have met that light.

use super::block::Block;
use super::estimate::ErrorEstimate;
use crate::sequence::quality::NoiseTarget;
use rayon::prelude::*;
use std::f64::consts::SQRT_2;

/// Which of the blocks, in rows of `columns`, get twice the samples. None if the frame has reached its target.
pub(super) fn blocks_to_refine(
    blocks: &[Block],
    estimate: &ErrorEstimate,
    target: &NoiseTarget,
    columns: usize,
) -> Vec<bool> {
    let goal = target.error * target.error;
    let drawn: Vec<u32> = blocks.iter().map(Block::drawn).collect();
    if estimate.worst().1 <= goal || drawn.iter().all(|&drawn| drawn >= target.most) {
        return vec![false; blocks.len()];
    }
    let allocation = Allocation::new(blocks, estimate, columns);
    wanted(&allocation.samples, &drawn, target.most, estimate.gain() * allocation.square / goal)
}

/// Which blocks get twice the samples that they have drawn: those below the limit `most` and far enough below their
/// allocation, which is `scale` times `samples`.
pub fn wanted(samples: &[f64], drawn: &[u32], most: u32, mut scale: f64) -> Vec<bool> {
    loop {
        let enough = |samples: f64, drawn: u32| scale * samples < SQRT_2 * f64::from(drawn);
        let both = samples.iter().zip(drawn);
        let wanted: Vec<bool> =
            both.map(|(&samples, &drawn)| drawn < most && !enough(samples, drawn)).collect();
        // If no block is far enough below its allocation, the scale grows until some are.
        if wanted.contains(&true) {
            return wanted;
        }
        if !scale.is_finite() || scale == 0.0 {
            return drawn.iter().map(|&drawn| drawn < most).collect();
        }
        scale *= 1.25;
    }
}

/// Mixes the variances of blocks in the worst frame and in all frames: half of the samples follow each. A block's number
/// of samples is proportional to the root of what is returned over its cost.
pub fn of_frames(worst: &[f64], all: impl ExactSizeIterator<Item = Vec<f64>>, costs: &[f64]) -> Vec<f64> {
    let (mut mixed, each) = (vec![0.0; worst.len()], 0.5 / all.len() as f64);
    mix(&mut mixed, worst, costs, 0.5);
    all.for_each(|frame| mix(&mut mixed, &frame, costs, each));
    mixed
}

/// Adds the variances of a frame, so that this share of all samples follows them.
fn mix(mixed: &mut [f64], variances: &[f64], costs: &[f64], share: f64) {
    let parts = variances.iter().zip(costs).map(|(variance, cost)| (variance * cost).sqrt());
    let work = parts.sum::<f64>();
    if work > 0.0 {
        let factor = share / (work * work);
        mixed.iter_mut().zip(variances).for_each(|(mixed, variance)| *mixed += factor * variance);
    }
}

/// The samples per pixel that blocks will still take until the target, as a mean over the pixels, if the variances are what
/// the samples show and no limit is in the way.
pub(super) fn samples_left(
    blocks: &[Block],
    estimate: &ErrorEstimate,
    target: &NoiseTarget,
    columns: usize,
) -> f64 {
    let goal = target.error * target.error;
    let allocation = Allocation::new(blocks, estimate, columns);
    let scale = estimate.gain() * allocation.square / goal;
    let (mut left, mut pixels) = (0.0, 0.0);
    for (share, block) in allocation.samples.iter().zip(blocks) {
        left += f64::from(block.pixels()) * (scale * share - f64::from(block.drawn())).max(0.0);
        pixels += f64::from(block.pixels());
    }
    left / pixels
}

/// The number of samples of each block, up to a common factor.
struct Allocation {
    /// One number per block.
    samples: Vec<f64>,
    /// The squared error of the worst frame with these numbers of samples, if samples were independent.
    square: f64,
}

impl Allocation {
    fn new(blocks: &[Block], estimate: &ErrorEstimate, columns: usize) -> Self {
        let costs: Vec<f64> = blocks.par_iter().map(Block::cost).collect();
        let pixels: f64 = blocks.iter().map(|block| f64::from(block.pixels())).sum();
        let of_frame = |frame: usize| variances(blocks, estimate, (frame, pixels), columns);
        let worst = of_frame(estimate.worst().0);
        let all = (0..estimate.weightings()).map(of_frame);
        let mixed = of_frames(&worst, all, &costs);
        let samples: Vec<f64> = mixed.iter().zip(&costs).map(|(mixed, cost)| (mixed / cost).sqrt()).collect();
        let left = worst.iter().zip(&samples).filter(|(variance, _)| **variance > 0.0);
        Self { square: left.map(|(variance, samples)| variance / samples).sum(), samples }
    }
}

/// The variance per sample of each block with a weighting, as its own samples and its neighbourhood show it.
fn variances(
    blocks: &[Block],
    estimate: &ErrorEstimate,
    (weighting, pixels): (usize, f64),
    columns: usize,
) -> Vec<f64> {
    let own = |block: &Block| estimate.part(weighting, block, pixels) * f64::from(block.drawn());
    let own: Vec<f64> = blocks.par_iter().map(own).collect();
    with_neighbors(&own, |block| neighbourhood(block, columns, blocks.len()))
}

/// The part of a block's own variance in that by which it is sampled. The rest is the mean of its neighbourhood. With a
/// half and blocks of 4 x 4 pixels, those that look quiet by chance get too few samples, and true errors exceed what
/// pictures state.
const OWN: f64 = 0.25;

/// `OWN` of each number, and the rest of the mean of those near it, which `near` gives, itself included.
pub fn with_neighbors<N: IntoIterator<Item = usize>>(
    own: &[f64],
    near: impl Fn(usize) -> N + Sync,
) -> Vec<f64> {
    let around = |place: usize| {
        let numbers = near(place).into_iter().map(|other| own[other]);
        let (sum, count) = numbers.fold((0.0, 0.0), |(sum, count), number| (sum + number, count + 1.0));
        sum / count
    };
    own.par_iter().enumerate().map(|(place, own)| OWN * own + (1.0 - OWN) * around(place)).collect()
}

/// A place among `all` in rows of `columns`, and those next to it, at most eight.
fn neighbourhood(place: usize, columns: usize, all: usize) -> impl Iterator<Item = usize> {
    let (row, column) = (place / columns, place % columns);
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    near(row, all / columns).flat_map(move |y| near(column, columns).map(move |x| y * columns + x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_those_that_there_are() {
        let own = [4.0, 0.0, 2.0, 8.0, 0.0, 4.0];
        let mixed = with_neighbors(&own, |place| neighbourhood(place, 3, own.len()));
        let means = [3.0, 3.0, 1.5, 3.0, 3.0, 1.5];
        let expected: Vec<f64> =
            own.iter().zip(means).map(|(own, mean)| OWN * own + (1.0 - OWN) * mean).collect();
        assert_eq!(mixed, expected);
    }
}
