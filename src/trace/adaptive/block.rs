//! A block of pixels, and the error estimate from its samples.
//!
//! Each round doubles the samples. The means of the samples before and after give the squared error
//! ([`super::halves`]).

use super::halves::SampleHalves;
use super::layer_products::LayerProducts;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::film::{ErrorVariance, Variances};
use std::ops::Range;

/// A block of pixels.
pub struct Block {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
    /// All layers, and the indices of those that hold light.
    layers: usize,
    held: Vec<usize>,
    /// The layers of each pixel: the sums of all samples, and of the samples before the last round.
    all: Vec<DVec3>,
    first: Vec<DVec3>,
    /// The numbers of samples in these sums.
    drawn: u32,
    before: u32,
    /// The number of samples after the current round, if the block takes part in it.
    next: Option<u32>,
    /// Its rays so far. Blocks that are traced together share theirs by their pixels.
    rays: u64,
    /// The mean over the pixels of each layer that holds light.
    means: Vec<DVec3>,
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

/// The squared error of a block before and after its last round, with all light weighted equally.
#[derive(Clone, Copy, Debug)]
pub struct Trend {
    pub before: SquaredError,
    pub after: SquaredError,
}

impl SquaredErrors {
    fn weighted(&self, weights: &[Rgb]) -> SquaredError {
        let square = self.products.weighted(weights);
        SquaredError { square, variances: self.variances.scaled(square * square) }
    }
}

impl Block {
    /// A block with the layers `held` out of `layers`, whose first round takes `first` samples per pixel.
    pub fn new(
        (left, top): (u32, u32),
        (width, height): (u32, u32),
        held: &[usize],
        layers: usize,
        first: u32,
    ) -> Self {
        let sums = vec![DVec3::ZERO; layers * (width * height) as usize];
        Self {
            left,
            top,
            width,
            height,
            layers,
            held: held.to_vec(),
            first: sums.clone(),
            all: sums,
            drawn: 0,
            before: 0,
            next: Some(first),
            rays: 0,
            means: vec![DVec3::ZERO; held.len()],
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
        let count = f64::from(samples / 2);
        let places: Vec<_> = self.places().collect();
        for (place, (first, all)) in places
            .into_iter()
            .zip(self.first.chunks_exact_mut(self.layers).zip(self.all.chunks_exact_mut(self.layers)))
        {
            read(place, 0, first);
            read(place, 1, all);
            for (first, all) in first.iter_mut().zip(all) {
                *first *= count;
                *all = *first + *all * count;
            }
        }
        (self.drawn, self.before, self.next) = (samples / 2, samples / 2, Some(samples));
        self.rays = rays;
    }

    /// Starts a round that ends at `next` samples per pixel.
    pub fn start_round(&mut self, next: u32) {
        self.first.copy_from_slice(&self.all);
        self.before = self.drawn;
        self.next = Some(next);
    }

    /// Discards the samples of the current round. Returns whether an earlier round exists; without one, nothing
    /// happens.
    pub fn discard_round(&mut self) -> bool {
        let before = self.drawn > 0;
        if before {
            self.all.copy_from_slice(&self.first);
            self.next = None;
        }
        before
    }

    /// The samples of each pixel that the current round takes; none if the block does not take part in it.
    pub fn round(&self) -> Range<u32> {
        self.drawn..self.next.unwrap_or(self.drawn)
    }

    /// The sums of all samples: for each pixel, those of its layers.
    pub fn sums(&self) -> &[DVec3] {
        &self.all
    }

    /// Takes new sums, which have cost it this number of rays.
    pub fn take_sums(&mut self, sums: &[DVec3], rays: u64) {
        self.all.copy_from_slice(sums);
        self.rays += rays;
    }

    /// Ends a round in which it took part.
    pub fn end_round(&mut self) {
        self.drawn = self.next.take().unwrap_or(self.drawn);
        let factor = 1.0 / (f64::from(self.drawn) * f64::from(self.pixels()));
        for (mean, &layer) in self.means.iter_mut().zip(&self.held) {
            *mean = factor * self.all[layer..].iter().step_by(self.layers).sum::<DVec3>();
        }
        self.last_round = self.halves();
        let weights = self.unit_weights();
        let sum = |errors: &Option<SquaredErrors>| {
            errors.as_ref().map_or(SquaredError::default(), |errors| errors.weighted(&weights))
        };
        let (before, after) = (sum(&self.combined), sum(&self.last_round));
        self.trend = (before.square > 0.0).then_some(Trend { before, after });
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
        self.all[pixel * self.layers + layer] / f64::from(self.drawn.max(1))
    }

    fn unit_weights(&self) -> Vec<Rgb> {
        vec![Rgb::ONE; self.held.len()]
    }

    fn halves(&self) -> Option<SquaredErrors> {
        if self.before == 0 || self.drawn == self.before {
            return None;
        }
        let halves = SampleHalves::new(self.before, self.drawn);
        let factor = halves.factor() / f64::from(self.pixels());
        let mut products = LayerProducts::new(self.held.len());
        let mut apart = vec![DVec3::ZERO; self.held.len()];
        let (mut sum, mut fourth, mut differences, mut left) = (0.0, 0.0, 0.0, None);
        for (all, first) in self.all.chunks_exact(self.layers).zip(self.first.chunks_exact(self.layers)) {
            for (apart, &layer) in apart.iter_mut().zip(&self.held) {
                *apart = halves.difference(first[layer], all[layer]);
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
