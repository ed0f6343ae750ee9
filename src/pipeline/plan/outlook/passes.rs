//! Combines the passes over a film's blocks. Each pass doubles the samples.

use super::film::{BlockNoise, FilmNoise};
use crate::base::color::Rgb;
use crate::trace::{BlockError, PilotBlocks};

/// Results of all passes over a film so far.
#[derive(Default)]
pub struct Passes {
    /// Index of the worst weighting of layers. For it: each block's squared error combined from all passes (`blocks`),
    /// and separately from the last pass and from those before it (`apart`).
    weighting: usize,
    blocks: Vec<BlockError>,
    apart: Vec<[f64; 2]>,
    mean: f64,
    samples: f64,
    /// Exponents of two by which the squared error fell from one pass to the next.
    falls: Vec<f64>,
}

impl Passes {
    /// Adds a pass. `before` and `after` are the numbers of samples per pixel before and after it.
    pub fn add(&mut self, probe: &PilotBlocks, weightings: &[Vec<Rgb>], (before, after): (u32, u32)) {
        let sum = |blocks: &[BlockError], part: fn(&BlockError) -> f64| -> f64 {
            let pixels: f64 = blocks.iter().map(|block| block.pixels).sum();
            blocks.iter().map(|block| part(block) * block.pixels / pixels).sum()
        };
        let found = weightings.iter().map(|weights| probe.errors(weights, (before, after)));
        let relative = |blocks: &Vec<BlockError>| {
            let mean = sum(blocks, |block| block.mean);
            if mean > 0.0 { sum(blocks, |block| block.square) / (mean * mean) } else { 0.0 }
        };
        let worst = found.enumerate().max_by(|(_, a), (_, b)| relative(a).total_cmp(&relative(b)));
        let Some((weighting, mut blocks)) = worst else { return };
        // Results of another weighting are discarded.
        if std::mem::replace(&mut self.weighting, weighting) != weighting {
            self.blocks.clear();
        }
        self.apart = blocks.iter().map(|block| [block.square; 2]).collect();
        let now = sum(&blocks, |block| block.square);
        let last = sum(&self.blocks, |block| block.square);
        if now > 0.0 && last > 0.0 {
            let fall = libm::log2(last / now);
            self.falls.push(fall);
            // Earlier passes contribute half of the estimate.
            let factor = libm::exp2(-fall.clamp(1.0, 1.5));
            let parts = blocks.iter_mut().zip(&self.blocks).zip(&mut self.apart);
            for ((block, before), apart) in parts {
                apart[1] = factor * before.square;
                block.square = (block.square + factor * before.square) / 2.0;
                block.variance = (block.variance + factor * factor * before.variance) / 4.0;
            }
        }
        self.mean = sum(&blocks, |block| block.mean);
        (self.blocks, self.samples) = (blocks, f64::from(after));
    }

    /// The noise of a film of `whole` pixels.
    pub fn noise(&self, whole: f64) -> FilmNoise {
        let pixels: f64 = self.blocks.iter().map(|block| block.pixels).sum();
        let rays = self.blocks.iter().map(|block| block.rays * block.pixels).sum::<f64>() / pixels;
        let unit = if self.mean > 0.0 { self.mean * self.mean } else { 1.0 };
        let block = |(block, apart): (&BlockError, &[f64; 2])| {
            let share = block.pixels / pixels;
            let squares = apart.map(|square| share * square / unit);
            BlockNoise { squares, share, cost: (block.rays / rays).max(1e-3) }
        };
        let blocks: Vec<BlockNoise> = self.blocks.iter().zip(&self.apart).map(block).collect();
        let square: f64 = self.blocks.iter().map(|block| block.square * block.pixels / (pixels * unit)).sum();
        let variance = |block: &BlockError| {
            let part = block.pixels / (pixels * unit);
            part * part * block.variance
        };
        let variance: f64 = self.blocks.iter().map(variance).sum();
        let spread = if square > 0.0 { variance.sqrt() / square } else { 0.0 };
        let count = self.falls.len().max(1) as f64;
        let power = if self.falls.is_empty() { 1.0 } else { self.falls.iter().sum::<f64>() / count };
        FilmNoise {
            samples: self.samples,
            blocks,
            power,
            spread,
            whole_spread: spread * (pixels / whole).sqrt(),
        }
    }
}
