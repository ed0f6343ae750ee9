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

/// A pixel is an outlier if it has this share of the squared error of its patch.
const OUTLIER: f64 = 0.9;

/// What is known of the blocks with a weighting.
#[derive(Default)]
struct WeightingErrors {
    /// Each block's squared error combined from all passes.
    blocks: Vec<BlockError>,
    /// The same from the last pass and from those before it, with outliers and without.
    apart: Vec<PassEstimates>,
}

/// One of the estimates of a block.
type Part = fn(&PassEstimates) -> f64;

impl PassEstimates {
    /// Computes something from each of the estimates.
    fn for_each<T>(compute: impl Fn(Part) -> T) -> [T; 4] {
        let all: [Part; 4] = [|of| of.all[0], |of| of.all[1], |of| of.regular[0], |of| of.regular[1]];
        all.map(compute)
    }

    /// What was computed for a block.
    fn of_place([last, before, regular, regular_before]: &[&Vec<f64>; 4], place: usize) -> Self {
        Self { all: [last[place], before[place]], regular: [regular[place], regular_before[place]] }
    }

    fn map(self, change: impl Fn(f64) -> f64) -> Self {
        Self { all: self.all.map(&change), regular: self.regular.map(&change) }
    }
}

/// The squared error of a block without an outlier.
fn regular(block: &BlockError) -> f64 {
    block.square - if block.largest > OUTLIER * block.patch { block.largest } else { 0.0 }
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
        let both =
            |block: &BlockError| PassEstimates { all: [block.square; 2], regular: [regular(block); 2] };
        self.apart = blocks.iter().map(both).collect();
        if let Some(fall) = fall {
            // Earlier passes contribute half of the estimate.
            let factor = libm::exp2(-fall.clamp(1.0, 1.5));
            let parts = blocks.iter_mut().zip(&self.blocks).zip(&mut self.apart);
            for ((block, before), apart) in parts {
                (apart.all[1], apart.regular[1]) = (factor * before.square, factor * regular(before));
                block.largest = (block.largest + factor * before.largest) / 2.0;
                block.square = (block.square + factor * before.square) / 2.0;
                block.patch = (block.patch + factor * before.patch) / 2.0;
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
        let estimates = PassEstimates::for_each(|of| {
            let around = variances(worst, of, near);
            let all = self.weighted.iter().map(|frame| variances(frame, of, near));
            let mixed = allocation::of_frames(&around, all, &work);
            [around, mixed]
        });
        let [around, allocated] = [0, 1].map(|kind| estimates.each_ref().map(|both| &both[kind]));
        let blocks = worst.blocks.iter().enumerate().map(|(place, block)| {
            let share = block.pixels / pixels;
            BlockNoise {
                squares: worst.apart[place].map(|square| share * square / unit),
                around: PassEstimates::of_place(&around, place),
                allocated: PassEstimates::of_place(&allocated, place),
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

/// The parts of the blocks in the squared error, as the sampler sees them, with those around.
fn variances(weighted: &WeightingErrors, of: Part, near: &[Vec<usize>]) -> Vec<f64> {
    let WeightingErrors { blocks, apart } = weighted;
    let unit = weighted.unit() * blocks.iter().map(|block| block.pixels).sum::<f64>();
    let own = |(block, apart): (&BlockError, &PassEstimates)| of(apart) * block.pixels / unit;
    let own: Vec<f64> = blocks.iter().zip(apart).map(own).collect();
    allocation::with_neighbors(&own, |place| near[place].iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(square: f64, largest: f64) -> BlockError {
        BlockError {
            pixels: 64.0,
            mean: 1.0,
            square,
            patch: square,
            largest,
            rays: 2.0,
            ..BlockError::default()
        }
    }

    /// The sampler allocates by a quarter of a block's noise and three quarters of that around it.
    #[test]
    fn noise_is_mixed_with_that_of_neighbours() {
        let mut weighted = WeightingErrors::default();
        weighted.add(vec![block(0.02, 0.001), block(0.0, 0.0), block(0.04, 0.039)], None);
        let passes = Passes { weighted: vec![weighted], samples: 8.0, falls: Vec::new() };
        let noise = passes.noise(&[vec![0, 1], vec![0, 1, 2], vec![1, 2]], 3.0 * 64.0);
        let [first, middle, last] = &noise.blocks[..] else { panic!("three blocks") };
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-15;
        assert!(near(first.around.all[0], 0.0125 / 3.0) && near(last.around.all[1], 0.025 / 3.0));
        assert!(near(middle.around.all[0], 0.015 / 3.0) && near(middle.squares.all[0], 0.0));
        // Without the pixel that holds most of the error.
        assert!(near(last.squares.regular[0], 0.001 / 3.0) && near(first.squares.regular[0], 0.02 / 3.0));
        // Samples are proportional to the root of this; all blocks cost the same.
        let ratio = first.allocated.all[0] / middle.allocated.all[0];
        assert!((ratio - 12.5 / 15.0).abs() < 1e-12, "{ratio}");
    }

    #[test]
    fn later_passes_count_more() {
        let mut passes = Passes { falls: vec![0.9, 1.2, 1.5], ..Passes::default() };
        assert!((passes.power() - (0.9 + 2.4 + 6.0) / 7.0).abs() < 1e-15);
        passes.falls.clear();
        assert_eq!(passes.power(), 1.0);
    }
}
