//! Sampling until an error is reached: blocks of pixels, in rounds of more and more samples.
//!
//! The samples of a pixel are a prefix of one scrambled sequence, the longer the more its block needs: a power of two of
//! them. So where all blocks have as many, the picture is that of a fixed number of samples. How far the picture of a
//! block's first half of samples is from that of its second half says how good it is ([`block`]). What that means for the
//! frame is estimated over all blocks ([`estimate`]), and more samples go to where they lower the error of the frame most
//! per ray ([`allocation`]).
//!
//! The error of a frame is the root of the mean square over its pixels and colours, as a share of the frame's mean. A film
//! that several frames are made of is sampled until the worst of them is good enough.

mod allocation;
mod block;
mod estimate;
mod squares;

use super::pixels::Pixels;
use super::{Moment, TraceSettings};
use crate::base::color::Rgb;
use crate::base::stats::{Counts, Meter};
use crate::film::{Extras, Film, Noise, lit};
use crate::scene::top_level::Bvh;
use crate::scene::{Scene, Weights};
use crate::sequence::quality::NoiseTarget;
use block::Block;
use estimate::Estimate;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

/// Side of a block. Blocks lie on a fixed lattice, so that no size of tiles shows.
const SIDE: u32 = 8;

/// Samples of a pixel that are taken in any case, unless fewer are allowed.
pub const LEAST_SAMPLES: u32 = 16;

/// Bytes that a pixel of so many layers takes while it is sampled: sums of all samples and of the first half, and its share of
/// what its block knows.
pub fn bytes_of_pixel(layers: u64) -> u64 {
    let pairs = layers * (layers + 1) / 2;
    (2 * layers + 2 * pairs / u64::from(SIDE * SIDE)) * size_of::<glam::DVec3>() as u64
}

/// The weights with which a film is shown, one for each layer: those of every frame of the sequence that is made of it, each
/// once. They decide how many samples the film has.
pub type Weightings = Arc<[Vec<Rgb>]>;

/// A frame that is sampled in rounds.
pub struct Rounds {
    size: (u32, u32),
    seed: u32,
    target: NoiseTarget,
    /// Which layers are traced.
    layers: Weights,
    /// Those of the layers that are traced, one after the other.
    weightings: Vec<Vec<Rgb>>,
    extras: Extras,
    /// Row by row.
    blocks: Vec<Block>,
    estimate: Estimate,
}

/// Traces a frame in which nothing moves while it is exposed.
pub fn trace(
    scene: &Scene,
    bvh: &Bvh,
    settings: &TraceSettings,
    (target, shown): (NoiseTarget, &Weightings),
    meter: &Meter,
) -> (Film, Counts) {
    let mut rounds = Rounds::new(scene, settings, target, shown);
    let mut counts = Counts::default();
    loop {
        counts += rounds.trace(scene, bvh, settings, Moment::ONLY, meter);
        if rounds.settle(meter) {
            return (rounds.film(), counts);
        }
    }
}

impl Rounds {
    /// Of a scene whose weights say which layers are traced, and of the weights with which the film is shown.
    pub fn new(scene: &Scene, settings: &TraceSettings, target: NoiseTarget, shown: &Weightings) -> Self {
        let (size, layers) = (settings.size, scene.weights.clone());
        let held: Vec<usize> = lit(&layers.0).map(|layer| layer.index()).collect();
        let weightings = shown.iter().map(|all| held.iter().map(|&layer| all[layer]).collect()).collect();
        let corners = (0..size.1).step_by(SIDE as usize);
        let corners = corners.flat_map(|top| (0..size.0).step_by(SIDE as usize).map(move |left| (left, top)));
        let first = LEAST_SAMPLES.min(target.most).div_ceil(2);
        let block = |(left, top): (u32, u32)| {
            let places = (SIDE.min(size.0 - left), SIDE.min(size.1 - top));
            Block::new((left, top), places, &held, layers.0.len() + settings.extras.layers(), first)
        };
        let (seed, extras) = (settings.quality.seed, settings.extras);
        let (blocks, estimate) = (corners.map(block).collect(), Estimate::default());
        Self { size, seed, target, layers, weightings, extras, blocks, estimate }
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
        let scene = Scene { weights: &self.layers, ..*scene };
        let pixels = Pixels::sampled(&scene, bvh, settings, moment);
        let seed = self.seed;
        let counts = self.blocks.par_iter_mut().filter(|block| block.is_open()).map(|block| {
            if meter.is_stopped() && block.give_up() {
                meter.unfinished.store(true, Relaxed);
                return Counts::default();
            }
            let counts = block.trace(&pixels, seed);
            meter.rays.fetch_add(counts.rays.total(), Relaxed);
            counts
        });
        counts.reduce(Counts::default, |mut a, b| {
            a += b;
            a
        })
    }

    /// Ends a round, and settles which blocks get more samples. True if none does.
    pub fn settle(&mut self, meter: &Meter) -> bool {
        self.blocks.par_iter_mut().filter(|block| block.is_open()).for_each(Block::end_round);
        self.estimate = Estimate::new(&mut self.blocks, &self.weightings);
        let most = self.target.most;
        let wanted = match self.blocks.iter().any(Block::has_halves) {
            true => allocation::wanted(
                &self.blocks,
                &self.estimate,
                &self.target,
                self.size.0.div_ceil(SIDE) as usize,
            ),
            // Only the first half of what is taken in any case.
            false => vec![true; self.blocks.len()],
        };
        if meter.is_stopped() && wanted.contains(&true) {
            meter.unfinished.store(true, Relaxed);
            return true;
        }
        let mut open = 0;
        for (block, wanted) in self.blocks.iter_mut().zip(wanted) {
            if wanted && block.drawn() < most {
                block.open((2 * block.drawn()).min(most));
                open += 1;
            }
        }
        let share = 1000 - 1000 * open / self.blocks.len().max(1);
        meter.thousandths.store(share as u32, Relaxed);
        open == 0
    }

    /// What all samples show.
    pub fn film(self) -> Film {
        let mut film = Film::with_extras(self.size.0, self.size.1, self.layers.0.clone(), self.extras);
        let layers = film.layers();
        let extras = self.layers.0.len()..self.layers.0.len() + self.extras.layers();
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
        film.noises = (0..self.weightings.len()).map(|weighting| self.noise(weighting)).collect();
        film.shown_as(0, &self.layers.0)
    }

    /// What error is left where the film is shown with one of the weightings.
    fn noise(&self, weighting: usize) -> Noise {
        let pixels = f64::from(self.size.0) * f64::from(self.size.1);
        let share = |block: &Block| f64::from(block.pixels()) / pixels;
        let most = self.target.most;
        let samples: f64 = self.blocks.iter().map(|block| f64::from(block.drawn()) * share(block)).sum();
        let capped = self.blocks.iter().filter(|block| block.drawn() >= most).map(share);
        let capped = capped.fold(0.0, |sum, share| sum + share);
        Noise { samples, capped, ..self.estimate.noise(weighting) }
    }
}
