//! A block of pixels, and what its samples say of its error.
//!
//! Of a samples in the first half and b in the second, the means A and B are 1 / a + 1 / b times as far from each other, in
//! squares, as a single sample is from the truth, and the mean of all is 1 / (a + b) times as far: were samples independent, the
//! squared error of all was ab / (a + b)² (A - B)².

use super::squares::Squares;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::Counts;
use crate::trace::pixels::{Pixels, SampleSet};
use std::ops::Range;

/// A few pixels.
pub struct Block {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
    /// Layers that are summed up, and those among them that hold light.
    layers: usize,
    held: Vec<usize>,
    /// Each pixel's layers: sums of all samples, and of those that there were before the last round.
    all: Vec<DVec3>,
    first: Vec<DVec3>,
    /// How many samples these are.
    drawn: u32,
    before: u32,
    /// How many there will be after the round in hand, if the block takes part in it.
    next: Option<u32>,
    rays: u64,
    /// Mean over the pixels of each layer that holds light.
    means: Vec<DVec3>,
    /// What the halves of the last round say, not yet joined with what was known before.
    fresh: Option<Spread>,
    /// What all rounds say, and what they said before the last one of its latest samples.
    known: Option<Spread>,
    pub trend: Option<Trend>,
}

/// The squared error of a block, were samples independent: a mean over its pixels.
#[derive(Clone, Debug)]
struct Spread {
    squares: Squares,
    /// Bounds of the variance of that estimate, and of what the error really is, as shares of their squares.
    variance: f64,
    truth: f64,
}

/// What is known of a block with some weights, as means over pixels and colours.
#[derive(Clone, Copy, Debug, Default)]
pub struct Square {
    /// The squared error, were samples independent.
    pub square: f64,
    /// A bound of the variance of that estimate, and of what the squared error really is.
    pub variance: f64,
    pub truth: f64,
}

/// How the squared error of a block has changed with its last round, all light weighted alike.
#[derive(Clone, Copy, Debug)]
pub struct Trend {
    pub before: f64,
    pub after: f64,
}

impl Block {
    /// With so many layers, of which some hold light, and of which the first round takes so many samples.
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
            fresh: None,
            known: None,
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

    pub fn has_halves(&self) -> bool {
        self.known.is_some()
    }

    /// Rays of a sample of all pixels: what it costs.
    pub fn cost(&self) -> f64 {
        self.rays.max(1) as f64 / f64::from(self.drawn.max(1))
    }

    /// The places of its pixels, row by row, as they are kept.
    pub fn places(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (left, top, width) = (self.left, self.top, self.width);
        (0..self.pixels()).map(move |index| (left + index % width, top + index / width))
    }

    /// Has it take part in the next round, up to so many samples.
    pub fn open(&mut self, next: u32) {
        self.first.copy_from_slice(&self.all);
        self.before = self.drawn;
        self.next = Some(next);
    }

    /// Leaves the round, if there was one before; what it has taken of this one is gone.
    pub fn give_up(&mut self) -> bool {
        let before = self.drawn > 0;
        if before {
            self.all.copy_from_slice(&self.first);
            self.next = None;
        }
        before
    }

    /// Takes the round's samples that fall on the moment of `pixels`.
    pub fn trace(&mut self, pixels: &Pixels, seed: u32) -> Counts {
        let samples: Range<u32> = self.drawn..self.next.unwrap_or(self.drawn);
        let places: Vec<_> = self.places().collect();
        let counts = pixels.add(&places, &SampleSet { samples, seed }, &mut self.all);
        self.rays += counts.rays.total();
        counts
    }

    /// Ends a round that it has taken part in.
    pub fn end_round(&mut self) {
        self.drawn = self.next.take().unwrap_or(self.drawn);
        let factor = 1.0 / (f64::from(self.drawn) * f64::from(self.pixels()));
        for (mean, &layer) in self.means.iter_mut().zip(&self.held) {
            *mean = factor * self.all[layer..].iter().step_by(self.layers).sum::<DVec3>();
        }
        self.fresh = self.halves();
        let sum = |spread: &Option<Spread>| {
            spread.as_ref().map_or(0.0, |spread| spread.squares.weighted(&self.even()))
        };
        let (before, after) = (sum(&self.known), sum(&self.fresh));
        self.trend = (before > 0.0).then_some(Trend { before, after });
    }

    /// Joins what the last round says with what was known before, which has become less by a factor. Each counts half:
    /// so the last rounds count most, and no single one settles that all is well.
    pub fn join(&mut self, fall: f64) {
        let Some(mut fresh) = self.fresh.take() else { return };
        if let Some(before) = self.known.take() {
            let even = self.even();
            let parts = [fresh.squares.weighted(&even), fall * before.squares.weighted(&even)];
            let sum = parts[0] + parts[1];
            if sum > 0.0 {
                let part = |part: f64, variance: f64| part * part * variance / (sum * sum);
                fresh.variance = part(parts[0], fresh.variance) + part(parts[1], before.variance);
            }
            fresh.squares.mean(&before.squares, fall);
        }
        self.known = Some(fresh);
    }

    /// The squared error with these weights.
    pub fn square(&self, weights: &[Rgb]) -> Square {
        let Some(known) = &self.known else { return Square::default() };
        let square = known.squares.weighted(weights);
        let unit = square * square;
        Square { square, variance: known.variance * unit, truth: known.truth * unit }
    }

    /// Mean over pixels and colours.
    pub fn mean(&self, weights: &[Rgb]) -> f64 {
        let sum: DVec3 = self.means.iter().zip(weights).map(|(mean, weight)| *mean * weight.as_dvec3()).sum();
        sum.element_sum() / 3.0
    }

    /// A layer's mean over all samples of a pixel.
    pub fn value(&self, pixel: usize, layer: usize) -> DVec3 {
        self.all[pixel * self.layers + layer] / f64::from(self.drawn.max(1))
    }

    fn even(&self) -> Vec<Rgb> {
        vec![Rgb::ONE; self.held.len()]
    }

    fn halves(&self) -> Option<Spread> {
        if self.before == 0 || self.drawn == self.before {
            return None;
        }
        let (a, b) = (f64::from(self.before), f64::from(self.drawn - self.before));
        let factor = a * b / ((a + b) * (a + b)) / f64::from(self.pixels());
        let mut squares = Squares::new(self.held.len());
        let mut apart = vec![DVec3::ZERO; self.held.len()];
        let (mut sum, mut fourth) = (0.0, 0.0);
        for (all, first) in self.all.chunks_exact(self.layers).zip(self.first.chunks_exact(self.layers)) {
            for (apart, &layer) in apart.iter_mut().zip(&self.held) {
                *apart = first[layer] / a - (all[layer] - first[layer]) / b;
            }
            squares.add(&apart, factor);
            let square = apart.iter().sum::<DVec3>().length_squared();
            sum += square;
            fourth += square * square;
        }
        // Of independent numbers, the variance of the mean is that of each over their count, and that of each at most the
        // mean of its square: a bound, however unlike the pixels are, and however few are far off.
        let variance = if sum > 0.0 { fourth / (sum * sum) } else { 0.0 };
        Some(Spread { squares, variance, truth: variance })
    }
}
