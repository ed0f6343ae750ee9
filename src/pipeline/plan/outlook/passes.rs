//! Combines the passes over a film's blocks. Each pass doubles the samples.

use super::film::{BlockNoise, FilmNoise, PassEstimates};
use crate::base::color::Rgb;
use crate::trace::{BlockError, PilotBlocks, allocation};

/// Results of all passes over a film so far.
#[derive(Default)]
pub struct Passes {
    /// One for each weighting of layers.
    weighted: Vec<WeightingErrors>,
    samples: f64,
    /// Exponents of two by which the squared error of the worst weighting fell from one pass to the next.
    pub falls: Vec<f64>,
}

/// What is known of the blocks with a weighting.
#[derive(Default)]
struct WeightingErrors {
    /// Each block's squared error combined from all passes.
    blocks: Vec<BlockError>,
    /// The same from the last pass, and from those before it.
    apart: Vec<[f64; 2]>,
}

impl WeightingErrors {
    /// The mean over all pixels.
    fn mean(&self, part: fn(&BlockError) -> f64) -> f64 {
        let pixels: f64 = self.blocks.iter().map(|block| block.pixels).sum();
        self.blocks.iter().map(|block| part(block) * block.pixels / pixels).sum()
    }

    /// The squared mean of the picture; 1 if it is black.
    fn unit(&self) -> f64 {
        let mean = self.mean(|block| block.mean);
        if mean > 0.0 { mean * mean } else { 1.0 }
    }

    /// The squared error, relative to the squared mean.
    fn relative(&self) -> f64 {
        self.mean(|block| block.square) / self.unit()
    }

    /// Adds a pass whose squared errors are `fall` powers of two below those of the passes before, if there were any.
    fn add(&mut self, mut blocks: Vec<BlockError>, fall: Option<f64>) {
        self.apart = blocks.iter().map(|block| [block.square; 2]).collect();
        if let Some(fall) = fall {
            // Earlier passes contribute half of the estimate.
            let factor = libm::exp2(-fall.clamp(1.0, 1.5));
            let parts = blocks.iter_mut().zip(&self.blocks).zip(&mut self.apart);
            for ((block, before), apart) in parts {
                apart[1] = factor * before.square;
                block.square = (block.square + factor * before.square) / 2.0;
                block.variance = (block.variance + factor * factor * before.variance) / 4.0;
            }
        }
        self.blocks = blocks;
    }
}

impl Passes {
    /// Adds a pass. `before` and `after` are the numbers of samples per pixel before and after it.
    pub fn add(&mut self, probe: &PilotBlocks, weightings: &[Vec<Rgb>], (before, after): (u32, u32)) {
        let found: Vec<Vec<BlockError>> =
            weightings.iter().map(|weights| probe.errors(weights, (before, after))).collect();
        self.weighted.resize_with(weightings.len(), WeightingErrors::default);
        let sum = |blocks: &[BlockError]| blocks.iter().map(|block| block.square * block.pixels).sum::<f64>();
        let worst = self.worst();
        let (now, last) = (sum(&found[worst]), sum(&self.weighted[worst].blocks));
        let fall = (now > 0.0 && last > 0.0).then(|| libm::log2(last / now));
        self.falls.extend(fall);
        self.weighted.iter_mut().zip(found).for_each(|(weighted, blocks)| weighted.add(blocks, fall));
        self.samples = f64::from(after);
    }

    /// The blocks, at most `count`, with the largest squared errors.
    pub fn noisiest(&self, count: usize) -> Vec<usize> {
        let worst = &self.weighted[self.worst()];
        let mut places: Vec<usize> = (0..worst.blocks.len()).collect();
        places.sort_by(|a, b| worst.blocks[*b].square.total_cmp(&worst.blocks[*a].square));
        places.truncate(count);
        places
    }

    /// The weighting with the largest error. There are weightings once a pass was added.
    pub fn worst(&self) -> usize {
        let all = self.weighted.iter().map(WeightingErrors::relative).enumerate();
        all.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(worst, _)| worst)
    }

    /// The exponent with which the squared error falls. The more samples, the closer it is to that of a target: every
    /// pass counts twice as much as the one before.
    fn power(&self) -> f64 {
        let (sum, weights) = (self.falls.iter().zip(0..)).fold((0.0, 0.0), |(sum, weights), (fall, pass)| {
            let weight = libm::exp2(f64::from(pass));
            (sum + fall * weight, weights + weight)
        });
        if weights > 0.0 { sum / weights } else { 1.0 }
    }

    /// The noise of a film of `whole` pixels. `near` are the neighbourhoods of the blocks.
    pub fn noise(&self, near: &[Vec<usize>], whole: f64) -> FilmNoise {
        let worst = &self.weighted[self.worst()];
        let (pixels, unit) = (worst.blocks.iter().map(|block| block.pixels).sum::<f64>(), worst.unit());
        let rays = worst.mean(|block| block.rays);
        let cost = |block: &BlockError| (block.rays / rays).max(1e-3);
        let work: Vec<f64> = worst.blocks.iter().map(|block| cost(block) * block.pixels / pixels).collect();
        let around = [0, 1].map(|of| variances(worst, of, near));
        let allocated = [0, 1].map(|of| {
            let all = self.weighted.iter().map(|frame| variances(frame, of, near));
            allocation::of_frames(&around[of], all, &work)
        });
        let of_place =
            |[last, before]: &[Vec<f64>; 2], place: usize| PassEstimates([last[place], before[place]]);
        let blocks = worst.blocks.iter().enumerate().map(|(place, block)| {
            let share = block.pixels / pixels;
            BlockNoise {
                squares: PassEstimates(worst.apart[place].map(|square| share * square / unit)),
                around: of_place(&around, place),
                allocated: of_place(&allocated, place),
                share,
                cost: cost(block),
            }
        });
        let variance = |block: &BlockError| {
            let part = block.pixels / (pixels * unit);
            part * part * block.variance
        };
        let variance: f64 = worst.blocks.iter().map(variance).sum();
        let square = worst.relative();
        let spread = if square > 0.0 { variance.sqrt() / square } else { 0.0 };
        FilmNoise {
            samples: self.samples,
            blocks: blocks.collect(),
            power: self.power(),
            spread,
            whole_spread: spread * (pixels / whole).sqrt(),
        }
    }
}

/// The parts of the blocks in the squared error, as the sampler sees them, with those around as far as they are probed: by the
/// last pass, or by those before it.
fn variances(weighted: &WeightingErrors, of: usize, near: &[Vec<usize>]) -> Vec<f64> {
    let WeightingErrors { blocks, apart } = weighted;
    let unit = weighted.unit() * blocks.iter().map(|block| block.pixels).sum::<f64>();
    let own: Vec<f64> =
        blocks.iter().zip(apart).map(|(block, apart)| apart[of] * block.pixels / unit).collect();
    allocation::with_neighbors(&own, |place| near[place].iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(square: f64) -> BlockError {
        BlockError { pixels: 16.0, mean: 1.0, square, rays: 2.0, ..BlockError::default() }
    }

    /// The sampler allocates by a quarter of a block's noise and three quarters of that around it.
    #[test]
    fn noise_is_mixed_with_that_of_neighbours() {
        let mut weighted = WeightingErrors::default();
        weighted.add([0.02, 0.0, 0.04].map(block).into(), None);
        let passes = Passes { weighted: vec![weighted], samples: 8.0, falls: Vec::new() };
        let noise = passes.noise(&[vec![0, 1], vec![0, 1, 2], vec![1, 2]], 3.0 * 16.0);
        let [first, middle, last] = &noise.blocks[..] else { panic!("three blocks") };
        let near = |found: PassEstimates, expected: f64| {
            found.0.iter().all(|found| (found - expected / 3.0).abs() < 1e-15)
        };
        assert!(near(first.around, 0.0125) && near(middle.around, 0.015) && near(last.around, 0.025));
        assert!(near(first.squares, 0.02) && near(middle.squares, 0.0) && near(last.squares, 0.04));
        // Samples are proportional to the root of this; all blocks cost the same.
        let ratio = first.allocated.0[0] / middle.allocated.0[0];
        assert!((ratio - 12.5 / 15.0).abs() < 1e-12, "{ratio}");
    }

    /// Passes are kept apart, so that those that allocate samples can differ from those that judge them.
    #[test]
    fn earlier_passes_are_scaled_to_the_samples_of_the_last() {
        let mut weighted = WeightingErrors::default();
        weighted.add(vec![block(0.04)], None);
        weighted.add(vec![block(0.01)], Some(1.0));
        assert_eq!((weighted.apart[0], weighted.blocks[0].square), ([0.01, 0.02], 0.015));
    }

    #[test]
    fn later_passes_count_more() {
        let mut passes = Passes { falls: vec![0.9, 1.2, 1.5], ..Passes::default() };
        assert!((passes.power() - (0.9 + 2.4 + 6.0) / 7.0).abs() < 1e-15);
        passes.falls.clear();
        assert_eq!(passes.power(), 1.0);
    }
}
