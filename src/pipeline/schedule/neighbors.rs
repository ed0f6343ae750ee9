//! Frames that are denoised with the samples of the frames before and after them.
//!
//! Samples are kept while they are those of a neighbour of the next frame, so a run over all frames traces them once. A frame
//! by itself takes the samples of its neighbours, too, and so has the same bytes as in a run over all.

use super::frame_loop::FrameLoop;
use super::frame_state::{FrameState, SampledState};
use super::sample_sets::FilmSet;
use super::shared_paths::weights_of;
use super::stages::{FilmInProgress, FilmSink, FrameError, RunProgress, Stats, TraceRequest};
use crate::camera::path::NoCamera;
use crate::film::denoise::{Halves, Memory, Neighbor, SampleFilms, denoise};
use crate::film::{Film, LayerId};
use crate::trace::PrimaryHits;
use std::sync::atomic::Ordering::Relaxed;

/// The samples of a frame, for it and its neighbours, and what its pixels see.
pub struct SampledFrame {
    halves: Halves,
    hits: PrimaryHits,
}

impl<S: FilmSink> FrameLoop<S> {
    /// Renders a frame that is denoised with its neighbours, with the layers `lit`. The first of `sampled` is the frame
    /// itself. Returns its film, which is not pushed.
    pub(super) fn trace_among_neighbors(
        &mut self,
        state: &FrameState,
        sampled: &[SampledState],
        lit: &[LayerId],
    ) -> Result<Film, FrameError> {
        self.sampled.keep_for(sampled);
        let missing: Vec<&SampledState> =
            sampled.iter().filter(|one| self.sampled.find(one, lit).is_none()).collect();
        // Two films of each frame, and the audits.
        let all = 2 * missing.len() as u32 + 2;
        for (before, one) in (0..).step_by(2).zip(&missing) {
            self.sample(one, lit, [before, all])?;
        }
        let held = sampled.first().and_then(|own| self.sampled.find(own, lit));
        let held = held.map_or(&[][..], |(_, held)| held).to_vec();
        let audits = self.trace_films(state, &held, FilmSet::Audits, [all - 2, all])?;
        let known = sampled.iter().filter_map(|one| self.sampled.find(one, lit));
        let known: Vec<&SampledFrame> = known.map(|(samples, _)| samples).collect();
        let (Ok([a, b]), [own, others @ ..]) = (<[Film; 2]>::try_from(audits), &known[..]) else {
            return Err(no_film(state));
        };
        let memory = self.filter_memory();
        let film = tracing::debug_span!("denoise").in_scope(|| {
            let hits: Vec<&PrimaryHits> = others.iter().map(|other| &other.hits).collect();
            let found = others.iter().zip(own.hits.seen_by(&hits, &memory));
            let neighbors = found.map(|(SampledFrame { halves, .. }, found)| {
                // Where nothing moves, they have the same random numbers otherwise, and nothing to add.
                let reprojection = if self.quality.vary_noise { found } else { found.without_still() };
                Neighbor { halves, reprojection }
            });
            let neighbors: Vec<Neighbor> = neighbors.collect();
            let films = SampleFilms { halves: &own.halves, neighbors: &neighbors, audits: [&a, &b] };
            denoise(&films, f64::from(self.quality.traced_samples(self.quality.samples)))
        });
        self.world.resource_mut::<Stats>().traced += 1;
        let meter = &self.world.resource::<RunProgress>().0;
        meter.frames.fetch_add(1, Relaxed);
        meter.thousandths.store(0, Relaxed);
        Ok(film)
    }

    /// Traces the samples of a frame.
    fn sample(&mut self, frame: &SampledState, lit: &[LayerId], parts: [u32; 2]) -> Result<(), FrameError> {
        let lit = frame.layers_with(lit);
        let films = self.trace_films(&frame.state, &lit, FilmSet::Halves, parts)?;
        let hits = self.world.resource_mut::<FilmInProgress>().hits.take();
        let (Ok(films), Some(hits)) = (<[Film; 2]>::try_from(films), hits) else {
            return Err(no_film(&frame.state));
        };
        let halves = Halves::new(films, &self.filter_memory());
        self.sampled.insert(frame, lit, SampledFrame { halves, hits });
        Ok(())
    }

    /// The memory of the run's filters.
    fn filter_memory(&self) -> Memory {
        self.world.resource::<FilmInProgress>().memory.clone()
    }

    /// Traces some of the films of a frame.
    fn trace_films(
        &mut self,
        state: &FrameState,
        lit: &[LayerId],
        set: FilmSet,
        parts: [u32; 2],
    ) -> Result<Vec<Film>, FrameError> {
        self.world.insert_resource(TraceRequest {
            lit: Some(weights_of(state, lit)),
            films: Some(set),
            parts,
            ..TraceRequest::default()
        });
        let moments = self.moments(state.frame, state.moments == 1);
        let done = self.run(&moments);
        self.world.insert_resource(TraceRequest::default());
        done?;
        Ok(std::mem::take(&mut self.world.resource_mut::<FilmInProgress>().sampled))
    }
}

/// Frames without a camera have no films.
fn no_film(state: &FrameState) -> FrameError {
    FrameError::Camera { frame: state.frame, why: NoCamera::NotFinite }
}
