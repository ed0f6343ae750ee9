//! Traces the samples of views and adds them to films.

use super::SharedViews;
use super::blocks::{TracedBlock, traced_blocks};
use super::coverage::Coverage;
use super::film_sums::{AddSamples, FilmSums, SampleBatch};
use super::raster::Raster;
use super::samples::{SampleGrid, SamplePlan};
use crate::base::color::Rgb;
use crate::base::lanes::dispatch;
use crate::base::math::DVec3;
use crate::base::stats::{Counts, ProgressMeter, SharedSamples};
use crate::camera::Camera;
use crate::film::Film;
use crate::film::filter::FilterWeights;
use crate::sampling::PixelSampler;
use crate::scene::Scene;
use crate::scene::top_level::Bvh;
use crate::trace::ONE_EACH;
use crate::trace::camera_rays::{PixelSamples, Placement};
use crate::trace::pixels::PixelTracer;
use crate::trace::settings::{Moment, TraceSettings};
use crate::trace::sums::valid;
use crate::trace::wavefront::WAVE;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

/// Values that are traced before films take them: of each sample, its place and its layers.
const AT_ONCE: u64 = 1 << 20;

/// A pixel may have this many samples less than asked for. Where pixels cut the lattices of several views, numbers vary by
/// about one, which is no reason to trace other samples for one film only.
const MAY_LACK: u32 = 1;

/// If one sample is asked for, it may stand for this share of its pixel.
const LEAST_SHARE: f64 = 0.5;

/// Traces films of views, which are places in `shared`, with the layers that the scene's weights light. The scene's
/// camera may have any view. None if the run is stopped.
pub fn trace_views(
    shared: &SharedViews,
    requested: &[usize],
    (scene, bvh): (&Scene, &Bvh),
    settings: &TraceSettings,
    meter: &ProgressMeter,
) -> Option<(Vec<Film>, Counts)> {
    let camera = |place: &usize| shared.views[*place].camera(scene.camera.position);
    let cameras: Vec<Camera> = (0..shared.len()).map(|place| camera(&place)).collect();
    let scenes: Vec<Scene> = cameras.iter().map(|camera| Scene { camera, ..*scene }).collect();
    let first = PixelTracer::new(scenes.first()?, bvh, settings, Moment::ONLY);
    let plan = SamplePlan::new(settings.size, &settings.quality, first.random);
    let grid = SampleGrid::new(&plan);
    let raster = grid.raster(&plan);
    let mut run = ViewRun {
        coverage: Coverage::new(&shared.views, raster, &grid),
        filter: FilterWeights::new(plan.filter),
        films: Vec::new(),
        counts: Counts::default(),
        raster,
        grid,
    };
    let held = first.held();
    let depth_layer = first.context.aovs.and_then(|layer| held.iter().position(|held| *held == layer));
    run.films.extend(requested.iter().map(|_| FilmSums::new(&raster, held.len(), depth_layer)));
    let blocks = |own| traced_blocks(&run.coverage, &run.grid, own, requested);
    let blocks: Vec<Vec<TracedBlock>> = (0..scenes.len()).into_par_iter().map(blocks).collect();
    let all = blocks.iter().flatten().map(|block| block.most_samples(&run.grid)).sum();
    let mut progress = ViewProgress { meter, done: 0, all, films: requested.len() as u64 };
    for (own, (scene, blocks)) in scenes.iter().zip(&blocks).enumerate() {
        if !blocks.is_empty() {
            let tracer = PixelTracer::new(scene, bvh, settings, Moment::ONLY);
            run.trace_view((own, blocks), requested, &tracer, &mut progress)?;
        }
    }
    let sums = std::mem::take(&mut run.films);
    let films = sums.into_iter().zip(requested).map(|(sums, &place)| {
        let tracer = PixelTracer::new(&scenes[place], bvh, settings, Moment::ONLY);
        run.film(&sums, place, &tracer)
    });
    let films = films.collect();
    run.counts.samples.traced = run.counts.rays.camera - run.counts.samples.own;
    Some((films, run.counts))
}

/// The state while views are traced.
struct ViewRun {
    raster: Raster,
    grid: SampleGrid,
    coverage: Coverage,
    filter: FilterWeights,
    /// Of the requested views.
    films: Vec<FilmSums>,
    counts: Counts,
}

impl ViewRun {
    /// Traces the blocks of a view, and adds their samples to the films. None if the run is stopped.
    fn trace_view(
        &mut self,
        (own, blocks): (usize, &[TracedBlock]),
        requested: &[usize],
        tracer: &PixelTracer,
        progress: &mut ViewProgress,
    ) -> Option<()> {
        let _span = tracing::debug_span!("view", own).entered();
        let parts = || self.grid.parts();
        let jobs: Vec<_> =
            blocks.iter().flat_map(|block| parts().map(move |numbers| (block, numbers))).collect();
        let side = self.grid.block_side() as u64;
        let samples = side * side * parts().map(|numbers| numbers.len() as u64).max().unwrap_or(1);
        let values = samples * (1 + tracer.held().len() as u64);
        let at_once = (AT_ONCE / values.max(1)).max(1) as usize;
        for jobs in jobs.chunks(at_once.max(rayon::current_num_threads())) {
            let meter = progress.meter;
            if meter.is_stopped() {
                return None;
            }
            let traced = jobs.par_iter().with_max_len(ONE_EACH).map(|(block, numbers)| {
                let (batch, counts) = self.trace_block((own, block), numbers.clone(), tracer);
                meter.rays.fetch_add(counts.rays.total(), Relaxed);
                (batch, counts)
            });
            let traced: Vec<(SampleBatch, Counts)> = traced.collect();
            let (coverage, filter) = (&self.coverage, &self.filter);
            self.films.par_iter_mut().zip(requested).enumerate().for_each(|(index, (film, view))| {
                let map = coverage.map(own, *view);
                for ((block, _), (batch, _)) in jobs.iter().zip(&traced) {
                    if block.is_in(index) {
                        dispatch(AddSamples { batch, map, filter, film });
                    }
                }
            });
            traced.into_iter().for_each(|(_, counts)| self.counts += counts);
            progress.add(jobs.iter().map(|(block, numbers)| block.cells() * numbers.len() as u64).sum());
        }
        Some(())
    }

    /// Traces the samples of a block that have these numbers in their cells.
    fn trace_block(
        &self,
        (own, block): (usize, &TracedBlock),
        numbers: Range<u32>,
        tracer: &PixelTracer,
    ) -> (SampleBatch, Counts) {
        let (mut batch, mut counts) = (SampleBatch::default(), Counts::default());
        let (held, seed) = (tracer.held(), self.grid.seed(own));
        let mut scratch = tracer.take_scratch();
        let (mut wave, places) = scratch.take_samples();
        let mut finish = |wave: &mut PixelSamples, batch: &mut SampleBatch| {
            scratch.follow(&tracer.context, wave, Placement::Given);
            let limit = tracer.context.quality.clamp.map(f64::from);
            for slot in 0..wave.len() as u32 {
                for &layer in &held {
                    let sample = scratch.sums.get(layer, slot);
                    let light = match layer < tracer.context.lit_layers {
                        true => valid(sample, limit, &mut scratch.counts.dropped),
                        false => sample,
                    };
                    batch.light.extend(light.to_array());
                }
            }
            wave.clear();
        };
        block.each(&self.coverage, &self.grid, (own, numbers), |(column, row), sample| {
            let sampler = PixelSampler::new((column as u32, row as u32), seed).sample(sample.number);
            wave.push_at(sample.position, sampler);
            batch.push(sample.position, sample.weight);
            if wave.len() == WAVE {
                finish(&mut wave, &mut batch);
            }
        });
        if wave.len() > 0 {
            finish(&mut wave, &mut batch);
        }
        batch.pad();
        scratch.give_back(wave, places);
        counts += std::mem::take(&mut scratch.counts);
        tracer.give_back(scratch);
        (batch, counts)
    }

    /// The film of a view. Pixels get samples of their own if they have too few, or if those that they have stand for a
    /// smaller part of their solid angle than as many samples of their own would.
    fn film(&mut self, sums: &FilmSums, view: usize, tracer: &PixelTracer) -> Film {
        let (width, height) = tracer.context.settings.size;
        let weights = tracer.context.scene.weights.0.clone();
        let mut film = Film::with_aovs(width, height, weights, tracer.context.settings.aovs);
        let asked = self.grid.asked();
        let layers = film.layers();
        let least = f64::from(asked.saturating_sub(MAY_LACK)).max(LEAST_SHARE);
        // Samples of the view itself weigh at least `asked / least` times as much, so that rounding does not decide. Where
        // it does for samples of other views, it costs a few samples and no accuracy.
        let least_weight = self.filter.integral() * least / self.coverage.view(view).density();
        let mut lacking = Vec::new();
        for (index, pixel) in film.data_mut().chunks_exact_mut(layers).enumerate() {
            let (count, weight, means) = sums.pixel(index);
            pixel.iter_mut().zip(means).for_each(|(layer, mean)| *layer = mean.as_vec3());
            if count < least || weight < least_weight {
                lacking.push((index as u32 % width, index as u32 / width));
            }
        }
        let all = self.raster.pixels() * u64::from(self.grid.asked());
        let own = lacking.len() as u64 * u64::from(self.grid.asked());
        self.counts.samples += SharedSamples { films: 1, alone: all, own, traced: 0 };
        self.fill(&lacking, tracer, film.data_mut());
        film
    }

    /// Traces samples for pixels that lack some. They take the place of those that these have, which may be in one part of
    /// a pixel only.
    fn fill(&mut self, lacking: &[(u32, u32)], tracer: &PixelTracer, data: &mut [Rgb]) {
        let (held, layers) = (tracer.held(), tracer.layers());
        let width = tracer.context.settings.size.0;
        let traced = lacking.par_chunks(WAVE).with_max_len(ONE_EACH).map(|pixels| {
            let mut own = vec![DVec3::ZERO; pixels.len() * layers];
            (tracer.trace(pixels, &mut own), own)
        });
        let traced: Vec<(Counts, Vec<DVec3>)> = traced.collect();
        for (pixels, (counts, own)) in lacking.chunks(WAVE).zip(traced) {
            self.counts += counts;
            for (&(x, y), own) in pixels.iter().zip(own.chunks_exact(layers)) {
                let index = (y * width + x) as usize;
                let pixel = &mut data[index * held.len()..][..held.len()];
                pixel.iter_mut().zip(&held).for_each(|(layer, &place)| *layer = own[place].as_vec3());
            }
        }
    }
}

/// How many of the samples of all views are done.
struct ViewProgress<'m> {
    meter: &'m ProgressMeter,
    done: u64,
    all: u64,
    films: u64,
}

impl ViewProgress<'_> {
    fn add(&mut self, samples: u64) {
        let before = self.done;
        self.done += samples;
        self.meter.advance(before, self.done, self.all, self.films);
    }
}
