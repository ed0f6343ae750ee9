//! Where samples go: to where they lower the error of the frame most per ray.
//!
//! A block of n samples per pixel with the variance v per sample adds v / n, in units of what it is compared with, to the
//! squared error of the frame, and costs c n rays. The least work for a given sum has n in proportion to √(v / c)
//! (Neyman, *On the Two Different Aspects of the Representative Method*, 1934, with costs).
//!
//! Where the frames that a film is shown in differ, half of what a block counts with is its part in the worst of them, and
//! half its part in all: so that none of them takes many times the samples that it needed by itself.
//!
//! Blocks know too little by themselves: half of what a block counts with is the mean of its neighbourhood, so that light
//! which few of its samples could have met is looked for where it was met nearby.

use super::block::Block;
use super::estimate::Estimate;
use crate::sequence::quality::NoiseTarget;
use std::f64::consts::SQRT_2;

/// Which blocks, in rows of so many, are to have twice the samples: none if the frame is good enough.
pub fn wanted(blocks: &[Block], estimate: &Estimate, target: &NoiseTarget, columns: usize) -> Vec<bool> {
    let goal = target.error * target.error;
    let open = |block: &Block| block.drawn() < target.most;
    if estimate.worst().1 <= goal || !blocks.iter().any(open) {
        return vec![false; blocks.len()];
    }
    let shares = Shares::new(blocks, estimate, columns);
    let mut scale = estimate.gain() * shares.square / goal;
    loop {
        let enough = |share: f64, block: &Block| scale * share < SQRT_2 * f64::from(block.drawn());
        let wanted = shares.samples.iter().zip(blocks);
        let wanted: Vec<bool> = wanted.map(|(&share, block)| open(block) && !enough(share, block)).collect();
        // Where none is far enough from what it should have, the next ones are.
        if wanted.contains(&true) {
            return wanted;
        }
        if !scale.is_finite() || scale == 0.0 {
            return blocks.iter().map(open).collect();
        }
        scale *= 1.25;
    }
}

/// How samples are shared out.
struct Shares {
    /// For each block.
    samples: Vec<f64>,
    /// The squared error of the worst frame with these numbers of samples, were they independent.
    square: f64,
}

impl Shares {
    fn new(blocks: &[Block], estimate: &Estimate, columns: usize) -> Self {
        let costs: Vec<f64> = blocks.iter().map(Block::cost).collect();
        let worst = variances(blocks, estimate, estimate.worst().0, columns);
        let mut mixed = vec![0.0; blocks.len()];
        let mut mix = |variances: &[f64], share: f64| {
            let parts = variances.iter().zip(&costs).map(|(variance, cost)| (variance * cost).sqrt());
            let work = parts.sum::<f64>();
            if work > 0.0 {
                let factor = share / (work * work);
                mixed.iter_mut().zip(variances).for_each(|(mixed, variance)| *mixed += factor * variance);
            }
        };
        mix(&worst, 0.5);
        let each = 0.5 / estimate.weightings() as f64;
        for weighting in 0..estimate.weightings() {
            mix(&variances(blocks, estimate, weighting, columns), each);
        }
        let samples: Vec<f64> = mixed.iter().zip(&costs).map(|(mixed, cost)| (mixed / cost).sqrt()).collect();
        let left = worst.iter().zip(&samples).filter(|(variance, _)| **variance > 0.0);
        Self { square: left.map(|(variance, samples)| variance / samples).sum(), samples }
    }
}

/// The variance per sample of each block with a weighting, half by its neighbourhood.
fn variances(blocks: &[Block], estimate: &Estimate, weighting: usize, columns: usize) -> Vec<f64> {
    let pixels: f64 = blocks.iter().map(|block| f64::from(block.pixels())).sum();
    let own = |block: &Block| estimate.part(weighting, block, pixels) * f64::from(block.drawn());
    let own: Vec<f64> = blocks.iter().map(own).collect();
    let around = around(&own, columns);
    own.iter().zip(&around).map(|(own, around)| (own + around) / 2.0).collect()
}

/// The mean of each number and its up to eight neighbours.
fn around(all: &[f64], columns: usize) -> Vec<f64> {
    let rows = all.len() / columns.max(1);
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let mean = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let (mut sum, mut count) = (0.0, 0.0);
        for y in near(row, rows) {
            for x in near(column, columns) {
                sum += all[y * columns + x];
                count += 1.0;
            }
        }
        sum / count
    };
    (0..all.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_those_that_there_are() {
        assert_eq!(around(&[4.0, 0.0, 2.0, 8.0, 0.0, 4.0], 3), [3.0, 3.0, 1.5, 3.0, 3.0, 1.5]);
    }
}
