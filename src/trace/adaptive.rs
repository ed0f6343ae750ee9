//! Sampling until an error is reached: blocks of pixels, in rounds of more and more samples.
//!
//! Every pixel is looked at by four sets of samples, scrambled independently. How far they are apart is the error of
//! their mean; the spread within one set is not, for its points are not independent. How far two of them are
//! apart decides when a block has enough. What error is left is told by the difference of the other two, and by that of the
//! two pairs' means, which have no part in it: of numbers that were stopped at because they were small, the mean would be
//! too small. What few samples show, and those much, is in one set or another, in the picture as well as in what is told.
//!
//! A layer of a block is closed on its own: whatever else is traced does not change it, so it is the same whichever
//! lights are on. Its error is the root of the mean square over the block's pixels, its scale their mean, to which it
//! is compared. Means add up where roots of squares at most do, so a sum of layers with weights of 0 or more is as
//! good as its parts.

use super::pixels::{Pixels, SampleSet};
use super::{Moment, TraceSettings};
use crate::bvh::Bvh;
use crate::color::Rgb;
use crate::counters::{Counts, Meter};
use crate::film::{Extras, Film, Noise};
use crate::math::DVec3;
use crate::quality::NoiseTarget;
use crate::sampling::hash;
use crate::scene::{Scene, Weights};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

/// Side of a block. Blocks lie on a fixed lattice, so that no size of tiles shows.
const SIDE: u32 = 8;
/// Sets of samples of each pixel.
pub const SETS: usize = 4;
/// Samples of each set in the first round.
const FIRST: u32 = 8;
/// Samples of a pixel that are taken in any case, unless fewer are allowed.
pub const LEAST_SAMPLES: u32 = SETS as u32 * FIRST;
/// What is darker than the mean of the frame by this factor counts as so bright: four stops, below which a display
/// shows few steps and an eye none beside the rest.
const DARKEST: f64 = 1.0 / 16.0;

/// A frame that is sampled in rounds.
pub struct Rounds {
    size: (u32, u32),
    seed: u32,
    target: NoiseTarget,
    /// What each layer is weighted with; what is left out is not there.
    weights: Vec<Rgb>,
    extras: Extras,
    blocks: Vec<Block>,
    /// Samples that every set of open layers has.
    taken: u32,
    /// Of each layer: below which mean a block counts as no darker.
    darkest: Vec<f64>,
}

/// A few pixels.
struct Block {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
    /// Of each set, each pixel's layers.
    sums: Vec<DVec3>,
    /// Of each layer, the samples in each set.
    drawn: Vec<u32>,
    open: Vec<bool>,
}

/// Traces a frame in which nothing moves while it is exposed.
pub fn trace(
    scene: &Scene,
    bvh: &Bvh,
    settings: &TraceSettings,
    target: NoiseTarget,
    meter: &Meter,
) -> (Film, Counts) {
    let mut rounds = Rounds::new(scene, settings, target);
    let mut counts = Counts::default();
    loop {
        counts += rounds.trace(scene, bvh, settings, Moment::ONLY, meter);
        if rounds.settle(meter) {
            return (rounds.film(), counts);
        }
    }
}

impl Rounds {
    pub fn new(scene: &Scene, settings: &TraceSettings, target: NoiseTarget) -> Self {
        let (size, weights) = (settings.size, scene.weights.0.clone());
        let layers = weights.len() + settings.extras.layers();
        let dark = |layer: usize| weights.get(layer).is_some_and(|weight| *weight == Rgb::ZERO);
        let corners = (0..size.1).step_by(SIDE as usize);
        let corners = corners.flat_map(|top| (0..size.0).step_by(SIDE as usize).map(move |left| (left, top)));
        let block = |(left, top): (u32, u32)| {
            let (width, height) = (SIDE.min(size.0 - left), SIDE.min(size.1 - top));
            let sums = vec![DVec3::ZERO; SETS * layers * (width * height) as usize];
            let open = (0..layers).map(|layer| !dark(layer)).collect();
            Block { left, top, width, height, sums, drawn: vec![0; layers], open }
        };
        Self {
            size,
            seed: settings.quality.seed,
            target,
            extras: settings.extras,
            blocks: corners.map(block).collect(),
            taken: 0,
            darkest: vec![0.0; layers],
            weights,
        }
    }

    /// Takes the samples of the round that fall on this moment, wherever they are wanted.
    pub fn trace(
        &mut self,
        scene: &Scene,
        bvh: &Bvh,
        settings: &TraceSettings,
        moment: Moment,
        meter: &Meter,
    ) -> Counts {
        let weights = Weights(self.wanted());
        let scene = Scene { weights: &weights, ..*scene };
        let pixels = Pixels::sampled(&scene, bvh, settings, moment);
        let samples = self.taken..self.next();
        let seeds = std::array::from_fn(|set| hash([self.seed, set as u32, 0]));
        let counts = self.blocks.par_iter_mut().filter(|block| block.is_open()).map(|block| {
            let counts = block.trace(&pixels, &samples, &seeds);
            meter.rays.fetch_add(counts.rays.total(), Relaxed);
            counts
        });
        counts.reduce(Counts::default, |mut a, b| {
            a += b;
            a
        })
    }

    /// The weights of the layers that are still open somewhere. Others are not traced any more.
    fn wanted(&self) -> Vec<Rgb> {
        let open = |layer: usize| self.blocks.iter().any(|block| block.open[layer]);
        let weights = self.weights.iter().enumerate();
        weights.map(|(layer, weight)| if open(layer) { *weight } else { Rgb::ZERO }).collect()
    }

    /// Samples of each set after the round in hand: powers of two and what lies halfway.
    fn next(&self) -> u32 {
        let next = match self.taken {
            0 => FIRST,
            taken if taken.is_power_of_two() => taken / 2 * 3,
            taken => taken / 3 * 4,
        };
        next.min(self.most())
    }

    fn most(&self) -> u32 {
        self.target.most.div_ceil(SETS as u32)
    }

    /// Ends a round: closes what is good enough, or has all the samples that it may. True if nothing is left open.
    pub fn settle(&mut self, meter: &Meter) -> bool {
        let first = self.taken == 0;
        self.taken = self.next();
        for block in &mut self.blocks {
            block.note(self.taken);
        }
        if first {
            self.darkest = (0..self.darkest.len()).map(|layer| DARKEST * self.mean(layer)).collect();
        }
        let last = self.taken >= self.most();
        let guides = self.extras.guides_layer(self.weights.len()).map_or(usize::MAX, |layer| layer.index());
        let (error, darkest) = (self.target.error, &self.darkest);
        self.blocks.par_iter_mut().filter(|block| block.is_open()).for_each(|block| {
            for (layer, darkest) in darkest.iter().enumerate() {
                // Guides are to be as good as the first round makes them.
                let enough = last || layer >= guides;
                block.open[layer] &= !enough && !block.error_at_most(error, layer, *darkest);
            }
        });
        let open = self.blocks.iter().filter(|block| block.is_open()).count();
        let share = 1000 - 1000 * open / self.blocks.len().max(1);
        meter.thousandths.store(share as u32, Relaxed);
        open == 0
    }

    /// Mean over the frame's pixels and channels.
    fn mean(&self, layer: usize) -> f64 {
        let sum: f64 = self.blocks.iter().map(|block| block.mean(layer) * f64::from(block.pixels())).sum();
        sum / (f64::from(self.size.0) * f64::from(self.size.1))
    }

    /// What all samples show.
    pub fn film(self) -> Film {
        let mut film = Film::with_extras(self.size.0, self.size.1, self.weights.clone(), self.extras);
        let layers = film.layers();
        let extras = self.weights.len()..self.weights.len() + self.extras.layers();
        let held: Vec<usize> = film.held.iter().map(|layer| layer.index()).chain(extras).collect();
        let data = film.data_mut();
        for block in &self.blocks {
            for (index, (x, y)) in block.places().enumerate() {
                let at = (y * self.size.0 + x) as usize * layers;
                for (layer, value) in held.iter().zip(&mut data[at..at + layers]) {
                    *value = block.value(index, *layer).as_vec3();
                }
            }
        }
        film.noise = Some(self.noise());
        film
    }

    /// What is left, by differences that had no part in deciding when to stop.
    fn noise(&self) -> Noise {
        let pixels = f64::from(self.size.0) * f64::from(self.size.1);
        let each: Vec<_> = self.blocks.iter().map(|block| block.weighted(&self.weights)).collect();
        let share = |block: &Block| f64::from(block.pixels()) / pixels;
        let mean: f64 = self.blocks.iter().zip(&each).map(|(block, part)| part.mean * share(block)).sum();
        let (mut square, mut variance) = (0.0, 0.0);
        for (block, part) in self.blocks.iter().zip(&each).filter(|(_, part)| part.square > 0.0) {
            let scale = part.mean.max(DARKEST * mean);
            let share = share(block) / (scale * scale);
            square += share * part.square;
            variance += share * share * part.variance;
        }
        let most = self.most();
        let drawn = |block: &Block| block.drawn.iter().copied().max().unwrap_or(0);
        let samples: f64 = self.blocks.iter().map(|block| f64::from(drawn(block)) * share(block)).sum();
        let capped = self
            .blocks
            .iter()
            .filter(|block| drawn(block) >= most)
            .map(share)
            .fold(0.0, |sum, share| sum + share);
        Noise { samples: samples * SETS as f64, capped, ..Noise::of_square(square, variance) }
    }
}

impl Block {
    fn pixels(&self) -> u32 {
        self.width * self.height
    }

    fn is_open(&self) -> bool {
        self.open.contains(&true)
    }

    /// The places of its pixels, row by row, as they are kept.
    fn places(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (left, top, width) = (self.left, self.top, self.width);
        (0..self.pixels()).map(move |index| (left + index % width, top + index / width))
    }

    fn trace(&mut self, pixels: &Pixels, samples: &Range<u32>, seeds: &[u32; SETS]) -> Counts {
        let layers = self.open.len();
        let mut counts = Counts::default();
        let places: Vec<_> = self.places().collect();
        let mut taken = vec![DVec3::ZERO; layers * places.len()];
        for (&seed, sums) in seeds.iter().zip(self.sums.chunks_exact_mut(taken.len())) {
            counts += pixels.add(&places, &SampleSet { samples: samples.clone(), seed }, &mut taken);
            for (index, (sum, taken)) in sums.iter_mut().zip(&mut taken).enumerate() {
                let taken = std::mem::take(taken);
                if self.open[index % layers] {
                    *sum += taken;
                }
            }
        }
        counts
    }

    /// Notes how many samples the sets of open layers have.
    fn note(&mut self, taken: u32) {
        self.drawn
            .iter_mut()
            .zip(&self.open)
            .filter(|(_, open)| **open)
            .for_each(|(drawn, _)| *drawn = taken);
    }

    /// A layer's mean over the samples of one set.
    fn value_of(&self, set: usize, pixel: usize, layer: usize) -> DVec3 {
        let drawn = self.drawn[layer];
        if drawn == 0 {
            return DVec3::ZERO;
        }
        let layers = self.open.len();
        self.sums[(set * self.pixels() as usize + pixel) * layers + layer] / f64::from(drawn)
    }

    fn value(&self, pixel: usize, layer: usize) -> DVec3 {
        (0..SETS).map(|set| self.value_of(set, pixel, layer)).sum::<DVec3>() / SETS as f64
    }

    /// Mean over pixels and channels.
    fn mean(&self, layer: usize) -> f64 {
        let count = self.pixels();
        (0..count as usize).map(|pixel| self.value(pixel, layer).element_sum()).sum::<f64>()
            / f64::from(3 * count)
    }

    /// Whether a layer's error is no larger than this share of its mean, by more than one standard deviation of what
    /// two sets tell of it: where few pixels are far off, others may be without having shown it yet.
    fn error_at_most(&self, error: f64, layer: usize, darkest: f64) -> bool {
        let between = |pixel: usize| self.value_of(0, pixel, layer) - self.value_of(1, pixel, layer);
        let (square, variance) = self.squared_error(between);
        let scale = error * self.mean(layer).max(darkest);
        square + variance.sqrt() <= scale * scale
    }

    /// The weighted picture, with its error by the last two sets and by both pairs.
    fn weighted(&self, weights: &[Rgb]) -> Part {
        let value = |set: usize, pixel: usize| {
            let layers = weights.iter().enumerate();
            layers.map(|(l, weight)| weight.as_dvec3() * self.value_of(set, pixel, l)).sum::<DVec3>()
        };
        let pixels = 0..self.pixels() as usize;
        let sets = pixels.flat_map(|pixel| (0..SETS).map(move |set| (set, pixel)));
        let sum: f64 = sets.map(|(set, pixel)| value(set, pixel).element_sum()).sum();
        let count = f64::from(self.pixels());
        let (mut square, mut variance) = (0.0, 0.0);
        for pixel in 0..self.pixels() as usize {
            let [a, b, c, d] = std::array::from_fn(|set| value(set, pixel));
            // The mean of two has half the variance of one: so their difference is as far off as one set.
            let others = squared(c - d);
            let pairs = squared(a + b - c - d) / 2.0;
            square += (others + pairs) / (2.0 * count);
            // Of independent numbers, the variance of the mean is a quarter of the sum of theirs, and that of each at most
            // the mean of its square: a bound, however unlike the pixels are, and however few of them are far off.
            variance += (others * others + pairs * pairs) / (4.0 * count * count);
        }
        Part { mean: sum / f64::from(3 * SETS as u32 * self.pixels()), square, variance }
    }

    /// The squared error of the mean over all sets, as mean over pixels and channels, by how far two sets are apart;
    /// and the variance of that, as if all pixels were alike.
    fn squared_error(&self, between: impl Fn(usize) -> DVec3) -> (f64, f64) {
        let count = f64::from(self.pixels());
        let (mut mean, mut squares) = (0.0, 0.0);
        for pixel in 0..self.pixels() as usize {
            let square = squared(between(pixel));
            mean += square / count;
            squares += square * square / count;
        }
        (mean, (squares - mean * mean).max(0.0) / count)
    }
}

/// The squared error of a pixel's mean over all sets, as mean over channels, by the difference of two sets: it has twice the
/// variance of one.
fn squared(between: DVec3) -> f64 {
    between.length_squared() / (3.0 * 2.0 * SETS as f64)
}

/// What a block says of the whole picture.
struct Part {
    mean: f64,
    square: f64,
    variance: f64,
}
