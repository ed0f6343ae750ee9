//! A block of pixels, and the error estimate from its samples.
//!
//! Each round doubles the samples. The means of the samples before and after give the squared error
//! ([`super::halves`]).

use super::halves::SampleHalves;
use super::layer_products::LayerProducts;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::film::{ErrorVariance, Variances};
use crate::trace::settings::Moment;
use std::ops::Range;
use std::sync::Arc;

/// The layers of a pixel, the same in all blocks of a frame.
#[derive(Debug)]
pub struct PixelLayers {
    /// The number of all of them.
    pub count: usize,
    /// The indices of those that hold light.
    pub held: Vec<usize>,
}

/// A block of pixels.
pub struct Block {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
    layers: Arc<PixelLayers>,
    /// The layers of each pixel: the sums of all samples; and of those before this round, while some of its moments are
    /// still to be traced.
    sums: Box<[DVec3]>,
    before: Option<Box<[DVec3]>>,
    /// The number of samples before this round.
    drawn: u32,
    /// The number of samples after the current round, if the block takes part in it.
    next: Option<u32>,
    /// Its rays so far. Blocks that are traced together share theirs by their pixels.
    rays: u64,
    /// The mean over the pixels of each layer that holds light.
    means: Box<[DVec3]>,
    /// The error from the halves of the last round, not yet combined with earlier rounds.
    last_round: Option<SquaredErrors>,
    /// The error from all rounds that have been combined.
    combined: Option<SquaredErrors>,
    pub trend: Option<Trend>,
}

/// The squared error of a block, if samples were independent: a mean over its pixels.
#[derive(Clone, Debug)]
struct SquaredErrors {
    products: LayerProducts,
    /// Relative to the squared estimate.
    variances: Variances,
}

/// The error of a block with one weighting, as means over pixels and colours.
#[derive(Clone, Copy, Debug, Default)]
pub struct SquaredError {
    /// The squared error, if samples were independent.
    pub square: f64,
    pub variances: Variances,
}

/// The squared error of a block before and after its last round, with all light weighted equally, and the variances of
/// these estimates as far as they were measured.
#[derive(Clone, Copy, Debug)]
pub struct Trend {
    pub before: (f64, f64),
    pub after: (f64, f64),
}

impl SquaredErrors {
    fn weighted(&self, weights: &[Rgb]) -> SquaredError {
        let square = self.products.weighted(weights);
        SquaredError { square, variances: self.variances.scaled(square * square) }
    }
}

impl Block {
    /// A block without samples, whose first round takes `first` samples per pixel.
    pub fn new(
        (left, top): (u32, u32),
        (width, height): (u32, u32),
        layers: Arc<PixelLayers>,
        first: u32,
    ) -> Self {
        let sums = vec![DVec3::ZERO; layers.count * (width * height) as usize];
        Self {
            left,
            top,
            width,
            height,
            means: vec![DVec3::ZERO; layers.held.len()].into(),
            layers,
            sums: sums.into(),
            before: None,
            drawn: 0,
            next: Some(first),
            rays: 0,
            last_round: None,
            combined: None,
            trend: None,
        }
    }

    pub fn pixels(&self) -> u32 {
        self.width * self.height
    }

    /// Samples of each pixel.
    pub fn drawn(&self) -> u32 {
        self.drawn
    }

    pub fn is_open(&self) -> bool {
        self.next.is_some()
    }

    /// Rays per sample of all pixels: the cost of a sample.
    pub fn cost(&self) -> f64 {
        self.rays.max(1) as f64 / f64::from(self.drawn.max(1))
    }

    /// The positions of its pixels, row by row, in the order of the sums.
    pub fn places(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (left, top, width) = (self.left, self.top, self.width);
        (0..self.pixels()).map(move |index| (left + index % width, top + index / width))
    }

    /// Takes samples that have been traced as two halves, with so many rays in all, as those of a round that is about to end.
    /// `read` writes the layers of a place in one of the halves: means over its samples.
    pub fn take_halves(&mut self, samples: u32, rays: u64, read: impl Fn((u32, u32), usize, &mut [DVec3])) {
        let (count, layers) = (f64::from(samples / 2), self.layers.count);
        let (places, mut all) = (self.places(), self.sums.clone());
        let pixels = self.sums.chunks_exact_mut(layers).zip(all.chunks_exact_mut(layers));
        for (place, (first, all)) in places.zip(pixels) {
            read(place, 0, first);
            read(place, 1, all);
            for (first, all) in first.iter_mut().zip(all) {
                *first *= count;
                *all = *first + *all * count;
            }
        }
        (self.drawn, self.next) = (samples / 2, Some(samples));
        self.take_sums(&all, rays, Moment::ONLY);
    }

    /// Starts a round that ends at `next` samples per pixel.
    pub fn start_round(&mut self, next: u32) {
        self.next = Some(next);
    }

    /// Discards the samples of the current round. Returns whether an earlier round exists; without one, nothing
    /// happens.
    pub fn discard_round(&mut self) -> bool {
        let is_later = self.drawn > 0;
        if is_later {
            self.next = None;
            if let Some(before) = self.before.take() {
                self.sums = before;
            }
        }
        is_later
    }

    /// The samples of each pixel that the current round takes; none if the block does not take part in it.
    pub fn round(&self) -> Range<u32> {
        self.drawn..self.after()
    }

    /// The sums of all samples: for each pixel, those of its layers.
    pub fn sums(&self) -> &[DVec3] {
        &self.sums
    }

    /// Takes the sums of all samples after a moment of the current round, which has cost it this number of rays. After the
    /// last moment, the sums before and after the round give its error.
    pub fn take_sums(&mut self, sums: &[DVec3], rays: u64, moment: Moment) {
        let before = self.before.take();
        if moment.index + 1 < moment.of {
            self.before = Some(before.unwrap_or_else(|| self.sums.clone()));
        } else {
            self.last_round = self.errors(before.as_deref().unwrap_or(&self.sums), sums);
            self.means = self.means(sums);
        }
        self.sums.copy_from_slice(sums);
        self.rays += rays;
    }

    /// The number of samples after the current round.
    fn after(&self) -> u32 {
        self.next.unwrap_or(self.drawn)
    }

    fn means(&self, sums: &[DVec3]) -> Box<[DVec3]> {
        let factor = 1.0 / (f64::from(self.after()) * f64::from(self.pixels()));
        let mean = |&layer: &usize| factor * sums[layer..].iter().step_by(self.layers.count).sum::<DVec3>();
        self.layers.held.iter().map(mean).collect()
    }

    /// Ends a round in which it took part.
    pub fn end_round(&mut self) {
        (self.drawn, self.next) = (self.after(), None);
        let weights = self.unit_weights();
        let [before, after] = [&self.combined, &self.last_round].map(|errors| {
            let error = errors.as_ref().map_or(SquaredError::default(), |errors| errors.weighted(&weights));
            (error.square, error.variances.measured.estimate)
        });
        self.trend = (before.0 > 0.0).then_some(Trend { before, after });
    }

    /// Combines the error of the last round with that of earlier rounds, scaled by the factor `fall`. Each counts half,
    /// so recent rounds count most, and no single round decides that the block is good enough.
    pub fn join(&mut self, fall: f64) {
        let Some(mut last_round) = self.last_round.take() else { return };
        if let Some(before) = self.combined.take() {
            let weights = self.unit_weights();
            let parts = [last_round.products.weighted(&weights), fall * before.products.weighted(&weights)];
            let sum = parts[0] + parts[1];
            if sum > 0.0 {
                let shares = parts.map(|part| part * part / (sum * sum));
                let estimate = |last: f64, before: f64| shares[0] * last + shares[1] * before;
                let (last, before) = (&mut last_round.variances, &before.variances);
                last.bound.estimate = estimate(last.bound.estimate, before.bound.estimate);
                last.measured.estimate = estimate(last.measured.estimate, before.measured.estimate);
            }
            last_round.products.mean(&before.products, fall);
        }
        self.combined = Some(last_round);
    }

    /// The squared error with these weights.
    pub fn square(&self, weights: &[Rgb]) -> SquaredError {
        self.combined.as_ref().map_or(SquaredError::default(), |combined| combined.weighted(weights))
    }

    /// The mean over pixels and colours.
    pub fn mean(&self, weights: &[Rgb]) -> f64 {
        let sum: DVec3 = self.means.iter().zip(weights).map(|(mean, weight)| *mean * weight.as_dvec3()).sum();
        sum.element_sum() / 3.0
    }

    /// The mean of a layer over all samples of a pixel.
    pub fn value(&self, pixel: usize, layer: usize) -> DVec3 {
        self.sums[pixel * self.layers.count + layer] / f64::from(self.drawn.max(1))
    }

    fn unit_weights(&self) -> Vec<Rgb> {
        vec![Rgb::ONE; self.layers.held.len()]
    }

    /// The error by the sums before and after the current round. None if it has no samples, or nothing was before.
    fn errors(&self, before: &[DVec3], after: &[DVec3]) -> Option<SquaredErrors> {
        if self.drawn == 0 || self.after() == self.drawn {
            return None;
        }
        let halves = SampleHalves::new(self.drawn, self.after());
        let factor = halves.factor() / f64::from(self.pixels());
        let held = &self.layers.held;
        let mut products = LayerProducts::new(held.len());
        let mut apart = vec![DVec3::ZERO; held.len()];
        let (mut sum, mut fourth, mut differences, mut left) = (0.0, 0.0, 0.0, None);
        let [before, after] = [before, after].map(|sums| sums.chunks_exact(self.layers.count));
        for (before, after) in before.zip(after) {
            for (apart, &layer) in apart.iter_mut().zip(held) {
                *apart = halves.difference(before[layer], after[layer]);
            }
            products.add(&apart, factor);
            let square = apart.iter().sum::<DVec3>().length_squared();
            sum += square;
            fourth += square * square;
            // The mean squared difference of two independent numbers is the sum of their variances, plus the squared
            // difference of their means.
            left = match left {
                None => Some(square),
                Some(other) => {
                    differences += (square - other) * (square - other);
                    None
                }
            };
        }
        differences += left.map_or(0.0, |alone: f64| alone * alone);
        // The variance of a mean of independent numbers is their variance over their count, and each variance is at
        // most the mean square. This bound holds even if pixels differ widely or few of them are far off.
        let [bound, measured] = [fourth, differences].map(|part| {
            let variance = if sum > 0.0 { part / (sum * sum) } else { 0.0 };
            ErrorVariance { estimate: variance, truth: variance }
        });
        Some(SquaredErrors { products, variances: Variances { bound, measured } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of two pixels after four samples, in a round that ends at eight.
    fn block() -> Block {
        let layers = Arc::new(PixelLayers { count: 2, held: vec![1] });
        let mut block = Block::new((0, 0), (2, 1), layers, 4);
        block.take_sums(&[1.0, 4.0, 2.0, 8.0].map(DVec3::splat), 10, Moment::ONLY);
        block.end_round();
        block.join(0.5);
        block.start_round(8);
        block
    }

    const AFTER: [f64; 4] = [3.0, 12.0, 5.0, 12.0];

    /// The second layer of the first pixel has means of 1 and 2 in the halves, that of the second one 2 and 1.
    #[test]
    fn moments_make_one_round() {
        let mut once = block();
        once.take_sums(&AFTER.map(DVec3::splat), 6, Moment::ONLY);
        let mut parts = block();
        parts.take_sums(&[2.0, 9.0, 3.0, 8.0].map(DVec3::splat), 4, Moment { index: 0, of: 2 });
        parts.take_sums(&AFTER.map(DVec3::splat), 2, Moment { index: 1, of: 2 });
        for mut block in [once, parts] {
            block.end_round();
            block.join(0.5);
            let weights = [Rgb::ONE];
            assert_eq!((block.drawn(), block.mean(&weights), block.cost()), (8, 1.5, 2.0));
            assert_eq!((block.value(0, 0), block.value(1, 1)), (DVec3::splat(0.375), DVec3::splat(1.5)));
            assert_eq!(block.square(&weights).square, 0.25);
        }
    }

    #[test]
    fn rounds_that_are_discarded_leave_what_was_before() {
        let before = block().sums().to_vec();
        let mut block = block();
        block.take_sums(&AFTER.map(DVec3::splat), 4, Moment { index: 0, of: 2 });
        assert!(block.discard_round() && !block.is_open());
        assert_eq!((block.sums(), block.drawn()), (&before[..], 4));
        assert_eq!(block.value(1, 1), DVec3::splat(2.0));
        let mut first = Block::new((0, 0), (1, 1), Arc::new(PixelLayers { count: 1, held: vec![0] }), 4);
        assert!(!first.discard_round() && first.is_open());
    }
}
