//! Adaptive sampling: blocks of pixels get more samples, round by round, until a target error is reached.
//!
//! The samples of a pixel are a prefix of one scrambled sequence. Its length is a power of two, chosen per block. If
//! all blocks have the same length, the image equals one with a fixed number of samples. The difference between the
//! halves of a block's samples estimates the block's error ([`block`]). The errors of all blocks give the error of the
//! frame ([`estimate`]). New samples go where they reduce the error of the frame most per ray ([`allocation`]).
//!
//! The error of a frame is its root mean square error over pixels and colours, relative to the mean of the frame. If a
//! film serves several frames, it is sampled until the worst of them reaches the target.

pub mod allocation;
mod block;
mod block_group;
mod estimate;
pub mod halves;
mod layer_products;
mod round;

use super::ONE_EACH;
use super::pixels::PixelTracer;
use super::scratch_pool::ScratchPool;
use super::settings::{Moment, TraceSettings};
use crate::base::color::Rgb;
use crate::base::stats::{Counts, ProgressMeter};
use crate::film::{AovSet, Film, Noise, lit};
use crate::scene::top_level::Bvh;
use crate::scene::{Scene, Weights};
use crate::sequence::quality::NoiseTarget;
use block::{Block, PixelLayers, SHORT};
use block_group::BlockGroup;
use estimate::ErrorEstimate;
use rayon::prelude::*;
use round::Round;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

/// The side of a block in pixels. Blocks form a fixed lattice, so the result does not depend on the size of tiles.
/// Noise is often that of few pixels: the smaller a block, the fewer of its pixels get samples that others need.
pub const SIDE: u32 = 4;

/// The side of a patch of blocks that are traced together, so that rays of a wave stay close to each other.
pub const PATCH: u32 = 8;

/// The least number of samples of a pixel, unless the limit is lower.
pub const MIN_SAMPLES: u32 = 8;

/// The bytes per pixel with this number of layers: the sums of its samples, and its share of its block. A frame of several
/// moments also keeps the sums at the ends of its round, which are most in the first one.
pub fn bytes_of_pixel(layers: u64, has_moments: bool) -> u64 {
    let (pairs, light) = (layers * (layers + 1) / 2, size_of::<glam::DVec3>() as u64);
    // Short lists are part of their block.
    let elsewhere = |count: u64| if count > SHORT as u64 { count } else { 0 };
    let block = size_of::<Block>() as u64 + (elsewhere(layers) + 2 * elsewhere(pairs)) * light;
    let sums = if has_moments { 1 + Round::MOST_ENDS as u64 } else { 1 };
    sums * layers * light + block.div_ceil(u64::from(SIDE * SIDE))
}

/// The weightings of a film, with one weight per layer: one weighting for each different frame of the sequence that
/// uses the film. They decide the number of samples.
pub type Weightings = Arc<[Vec<Rgb>]>;

/// A frame that is sampled in rounds.
pub struct AdaptiveFrame {
    size: (u32, u32),
    seed: u32,
    target: NoiseTarget,
    /// The weights that decide which layers are traced.
    layers: Weights,
    /// The weightings, for the traced layers only.
    weightings: Vec<Vec<Rgb>>,
    aovs: AovSet,
    /// As in [`Noise`].
    denoised: Option<bool>,
    /// Row by row.
    blocks: Vec<Block>,
    estimate: ErrorEstimate,
    /// The buffers of all rounds and moments, and the number of these so far. New buffers each time would be new memory,
    /// whose first use takes time.
    pool: Arc<ScratchPool>,
    tracers: u32,
}

/// Traces a frame without motion.
pub fn trace(
    scene: &Scene,
    bvh: &Bvh,
    settings: &TraceSettings,
    (target, shown): (NoiseTarget, &Weightings),
    meter: &ProgressMeter,
) -> (Film, Counts) {
    let mut rounds = AdaptiveFrame::new(scene, settings, target, shown);
    let mut counts = Counts::default();
    loop {
        counts += rounds.trace(scene, bvh, settings, Moment::ONLY, meter);
        if rounds.settle(meter) {
            return (rounds.film(), counts);
        }
    }
}

impl AdaptiveFrame {
    /// A frame without samples. The weights of the scene decide which layers are traced; `shown` are the weightings of
    /// the film.
    pub fn new(scene: &Scene, settings: &TraceSettings, target: NoiseTarget, shown: &Weightings) -> Self {
        let of_samples = (settings.quality.seed, target);
        Self::of_layers(settings.size, scene.weights.clone(), of_samples, settings.aovs, shown)
    }

    fn of_layers(
        size: (u32, u32),
        layers: Weights,
        (seed, target): (u32, NoiseTarget),
        aovs: AovSet,
        shown: &Weightings,
    ) -> Self {
        let held: Vec<usize> = lit(&layers.0).map(|layer| layer.index()).collect();
        let weightings = shown.iter().map(|all| held.iter().map(|&layer| all[layer]).collect()).collect();
        let of_pixel = Arc::new(PixelLayers { count: layers.0.len() + aovs.layers(), held });
        let corners = (0..size.1).step_by(SIDE as usize);
        let corners = corners.flat_map(|top| (0..size.0).step_by(SIDE as usize).map(move |left| (left, top)));
        let first = Round::first(target.most);
        let block = |(left, top): (u32, u32)| {
            let places = (SIDE.min(size.0 - left), SIDE.min(size.1 - top));
            Block::new((left, top), places, Arc::clone(&of_pixel), first)
        };
        let (blocks, estimate) = (corners.map(block).collect(), ErrorEstimate::default());
        Self {
            size,
            seed,
            target,
            layers,
            weightings,
            aovs,
            denoised: None,
            blocks,
            estimate,
            pool: Arc::default(),
            tracers: 0,
        }
    }

    /// A frame whose pixels have `samples` samples, traced with `rays` rays as two films of one half each. It is ready to be
    /// settled. Its samples are those of a frame that began without any; its error is known from one round only. It
    /// might have been denoised, and states that it is not.
    pub fn of_halves(
        halves: [&Film; 2],
        (samples, rays): (u32, u64),
        seed: u32,
        target: NoiseTarget,
        shown: &Weightings,
    ) -> Self {
        let [film, _] = halves;
        let (size, layers) = ((film.width, film.height), Weights(film.weights.clone()));
        // Guides are the last layers, which frames without the denoiser do not have.
        let aovs = AovSet { guides: false, ..film.aovs };
        let mut frame = Self::of_layers(size, layers, (seed, target), aovs, shown);
        frame.denoised = Some(false);
        let all = frame.layers.0.len();
        let kept: Vec<usize> =
            film.held.iter().map(|layer| layer.index()).chain(all..all + aovs.layers()).collect();
        let pixels = f64::from(size.0) * f64::from(size.1);
        frame.blocks.par_iter_mut().for_each(|block| {
            let own = rays as f64 * f64::from(block.pixels()) / pixels;
            block.take_halves(samples, own as u64, |(x, y), half, pixel| {
                let light = halves[half].pixel(y as usize * size.0 as usize + x as usize);
                kept.iter().zip(light).for_each(|(&layer, light)| pixel[layer] = light.as_dvec3());
            });
        });
        frame
    }

    /// The samples per pixel that the frame will still take until it reaches its target, as a mean over the pixels, as far as
    /// its samples show; without regard to the limit of samples. Holds for a frame that is settled.
    pub fn samples_left(&self) -> f64 {
        allocation::samples_left(&self.blocks, &self.estimate, &self.target, self.columns())
    }

    /// The blocks of a row.
    fn columns(&self) -> usize {
        self.size.0.div_ceil(SIDE) as usize
    }

    /// Whether the samples so far reach the target.
    pub fn is_reached(&self) -> bool {
        self.estimate.worst().1 <= self.target.error * self.target.error
    }

    /// Traces the samples of this round that belong to this moment, in all open blocks.
    pub fn trace(
        &mut self,
        scene: &Scene,
        bvh: &Bvh,
        settings: &TraceSettings,
        moment: Moment,
        meter: &ProgressMeter,
    ) -> Counts {
        // Blocks are too small for spans of their own.
        let _span = tracing::debug_span!("round").entered();
        let scene = Scene { weights: &self.layers, ..*scene };
        self.tracers += 1;
        let pixels = PixelTracer::sampled(&scene, bvh, settings, moment).with_pool(&self.pool, self.tracers);
        let seed = self.seed;
        let columns = self.columns();
        let groups = BlockGroup::of_round(&mut self.blocks, columns, moment.of);
        let counts = groups.into_par_iter().with_max_len(ONE_EACH).map(|group| {
            let (group, is_cut) = if meter.is_stopped() { group.shortened() } else { (Some(group), false) };
            meter.unfinished.fetch_or(is_cut, Relaxed);
            let Some(group) = group else { return Counts::default() };
            let counts = group.trace(&pixels, seed);
            meter.rays.fetch_add(counts.rays.total(), Relaxed);
            counts
        });
        counts.reduce(Counts::default, |mut a, b| {
            a += b;
            a
        })
    }

    /// Ends a round and chooses the blocks that get more samples. Returns true if there are none.
    pub fn settle(&mut self, meter: &ProgressMeter) -> bool {
        self.blocks.par_iter_mut().filter(|block| block.is_open()).for_each(Block::end_round);
        self.estimate = ErrorEstimate::new(&mut self.blocks, &self.weightings);
        let most = self.target.most;
        let refined =
            allocation::blocks_to_refine(&self.blocks, &self.estimate, &self.target, self.columns());
        // Few samples converge faster and faster, so errors after the first round are stated too large. A frame that is
        // good enough then takes another round everywhere; in other frames, quiet blocks need no more.
        let is_first = self.blocks.iter().all(|block| block.drawn() <= MIN_SAMPLES && block.drawn() < most);
        let refined = if is_first && !refined.contains(&true) { vec![true; refined.len()] } else { refined };
        if meter.is_stopped() && refined.contains(&true) {
            meter.unfinished.store(true, Relaxed);
            return true;
        }
        let mut open = 0;
        for (block, is_refined) in self.blocks.iter_mut().zip(refined) {
            if is_refined && block.drawn() < most {
                block.start_round(Round::after(block.drawn(), most));
                open += 1;
            }
        }
        let share = 1000 - 1000 * open / self.blocks.len().max(1);
        meter.thousandths.store(share as u32, Relaxed);
        open == 0
    }

    /// The film of all samples, with its error estimates.
    pub fn film(self) -> Film {
        let mut film = Film::with_aovs(self.size.0, self.size.1, self.layers.0.clone(), self.aovs);
        let layers = film.layers();
        let aovs = self.layers.0.len()..self.layers.0.len() + self.aovs.layers();
        let held: Vec<usize> = film.held.iter().map(|layer| layer.index()).chain(aovs).collect();
        let width = self.size.0;
        let bands = film.data_mut().par_chunks_mut((width * SIDE) as usize * layers);
        bands.zip(self.blocks.par_chunks(self.columns())).for_each(|(band, blocks)| {
            for block in blocks {
                for (index, (x, y)) in block.places().enumerate() {
                    let at = (y % SIDE * width + x) as usize * layers;
                    for (layer, value) in held.iter().zip(&mut band[at..at + layers]) {
                        *value = block.value(index, *layer).as_vec3();
                    }
                }
            }
        });
        film.noises = self.noises().into();
        film.shown_as(0, &self.layers.0)
    }

    /// The remaining error of the film with each of the weightings.
    pub fn noises(&self) -> Vec<Noise> {
        (0..self.weightings.len()).map(|weighting| self.noise(weighting)).collect()
    }

    fn noise(&self, weighting: usize) -> Noise {
        let pixels = f64::from(self.size.0) * f64::from(self.size.1);
        let share = |block: &Block| f64::from(block.pixels()) / pixels;
        let most = self.target.most;
        let samples: f64 = self.blocks.iter().map(|block| f64::from(block.drawn()) * share(block)).sum();
        let capped = self.blocks.iter().filter(|block| block.drawn() >= most).map(share);
        let capped = capped.fold(0.0, |sum, share| sum + share);
        Noise { samples, capped, denoised: self.denoised, ..self.estimate.noise(weighting) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::cancel::Stop;
    use crate::base::math::DVec3;

    /// Two blocks, of which a stop has left the second one with its first two samples.
    #[test]
    fn frames_that_are_stopped_are_unfinished() {
        for most in [8, 9, 4096] {
            let target = NoiseTarget { error: 0.5, most };
            let weightings = [vec![Rgb::ONE]].into();
            let layers = Weights(vec![Rgb::ONE]);
            let mut frame =
                AdaptiveFrame::of_layers((8, 4), layers, (0, target), AovSet::default(), &weightings);
            let meter = ProgressMeter::default();
            meter.stop.get_or_init(Stop::default).flag().store(2, Relaxed);
            let [full, short] = &mut frame.blocks[..] else { panic!("two blocks") };
            let sums = [2.0, 4.0, 8.0].repeat(16);
            full.take_sums(&sums.into_iter().map(DVec3::splat).collect::<Vec<_>>(), 1, Moment::ONLY);
            assert!(short.shorten_round());
            short.take_sums(&[DVec3::splat(2.0); 16], 1, Moment::ONLY);
            assert!(frame.settle(&meter) && !frame.is_reached() && meter.unfinished.load(Relaxed), "{most}");
            let noise = frame.noise(0);
            assert!(noise.error.is_infinite() && noise.samples == 5.0, "{noise:?}");
        }
    }
}
