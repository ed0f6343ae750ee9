//! A block of pixels, and the error estimate from its samples.
//!
//! Each round doubles the samples. The means of the samples before and after give the squared error
//! ([`super::halves`]).

use super::halves::SampleHalves;
use super::layer_products::LayerProducts;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::trace::pixels::{PixelTracer, SampleSet};
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
    /// Bounds, relative to the squared estimate: of the variance of the estimate, and of the variance of the true
    /// error.
    variance: f64,
    truth: f64,
}

/// The error of a block with one weighting, as means over pixels and colours.
#[derive(Clone, Copy, Debug, Default)]
pub struct SquaredError {
    /// The squared error, if samples were independent.
    pub square: f64,
    /// Bounds of the variance of the estimate, and of the variance of the true squared error.
    pub variance: f64,
    pub truth: f64,
}

/// The squared error of a block before and after its last round, with all light weighted equally.
#[derive(Clone, Copy, Debug)]
pub struct Trend {
    pub before: f64,
    pub after: f64,
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

    /// Traces the samples of the round that belong to the moment of `pixels`.
    pub fn trace(&mut self, pixels: &PixelTracer, seed: u32) -> Counts {
        let samples: Range<u32> = self.drawn..self.next.unwrap_or(self.drawn);
        let places: Vec<_> = self.places().collect();
        let counts = pixels.add(&places, &SampleSet { samples, seed }, &mut self.all);
        self.rays += counts.rays.total();
        counts
    }

    /// Ends a round in which it took part.
    pub fn end_round(&mut self) {
        self.drawn = self.next.take().unwrap_or(self.drawn);
        let factor = 1.0 / (f64::from(self.drawn) * f64::from(self.pixels()));
        for (mean, &layer) in self.means.iter_mut().zip(&self.held) {
            *mean = factor * self.all[layer..].iter().step_by(self.layers).sum::<DVec3>();
        }
        self.last_round = self.halves();
        let sum = |errors: &Option<SquaredErrors>| {
            errors.as_ref().map_or(0.0, |errors| errors.products.weighted(&self.unit_weights()))
        };
        let (before, after) = (sum(&self.combined), sum(&self.last_round));
        self.trend = (before > 0.0).then_some(Trend { before, after });
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
                let part = |part: f64, variance: f64| part * part * variance / (sum * sum);
                last_round.variance = part(parts[0], last_round.variance) + part(parts[1], before.variance);
            }
            last_round.products.mean(&before.products, fall);
        }
        self.combined = Some(last_round);
    }

    /// The squared error with these weights.
    pub fn square(&self, weights: &[Rgb]) -> SquaredError {
        let Some(combined) = &self.combined else { return SquaredError::default() };
        let square = combined.products.weighted(weights);
        let unit = square * square;
        SquaredError { square, variance: combined.variance * unit, truth: combined.truth * unit }
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
        let (mut sum, mut fourth) = (0.0, 0.0);
        for (all, first) in self.all.chunks_exact(self.layers).zip(self.first.chunks_exact(self.layers)) {
            for (apart, &layer) in apart.iter_mut().zip(&self.held) {
                *apart = halves.difference(first[layer], all[layer]);
            }
            products.add(&apart, factor);
            let square = apart.iter().sum::<DVec3>().length_squared();
            sum += square;
            fourth += square * square;
        }
        // The variance of a mean of independent numbers is their variance over their count, and each variance is at
        // most the mean square. This bound holds even if pixels differ widely or few of them are far off.
        let variance = if sum > 0.0 { fourth / (sum * sum) } else { 0.0 };
        Some(SquaredErrors { products, variance, truth: variance })
    }
}
