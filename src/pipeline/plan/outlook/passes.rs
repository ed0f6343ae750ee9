//! What passes over a film's blocks say together, each of which doubles their samples.

use super::film::{BlockNoise, FilmNoise};
use crate::base::color::Rgb;
use crate::trace::{BlockError, Probe};

/// What the passes over a film have said so far.
#[derive(Default)]
pub struct Passes {
    /// Of the worst weighting: each block's squared error, joined from all passes; by the last one alone, and by those before
    /// it.
    weighting: usize,
    blocks: Vec<BlockError>,
    apart: Vec<[f64; 2]>,
    mean: f64,
    samples: f64,
    /// By which powers of two the squared error fell from one pass to the next.
    falls: Vec<f64>,
}

impl Passes {
    /// What halves of so many samples, and so many in all, say.
    pub fn add(&mut self, probe: &Probe, weightings: &[Vec<Rgb>], (before, after): (u32, u32)) {
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
        // What was known of another weighting does not count.
        if std::mem::replace(&mut self.weighting, weighting) != weighting {
            self.blocks.clear();
        }
        self.apart = blocks.iter().map(|block| [block.square; 2]).collect();
        let now = sum(&blocks, |block| block.square);
        let last = sum(&self.blocks, |block| block.square);
        if now > 0.0 && last > 0.0 {
            let fall = libm::log2(last / now);
            self.falls.push(fall);
            // Half of what is known is of the passes before.
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

    /// For a film of so many pixels.
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
