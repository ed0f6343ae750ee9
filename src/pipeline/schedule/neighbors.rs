//! Frames that are denoised with the samples of the frames before and after them.
//!
//! Samples are kept from frame to frame, so a run over all frames traces none of them twice. A frame by itself takes the
//! samples of its neighbours, too, and so has the same bytes as in a run over all.

use super::frame_loop::FrameLoop;
use super::frame_state::{FrameState, SampledState};
use super::sample_sets::{FilmSet, drawn};
use super::shared_paths::weights_of;
use super::stages::{FilmInProgress, FilmSink, FrameError, RunProgress, Stats, TraceRequest};
use crate::base::digest::Digest;
use crate::camera::path::NoCamera;
use crate::film::denoise::{Halves, Neighbor, SampleFilms, denoise};
use crate::film::{Film, LayerId};
use crate::trace::PrimaryHits;
use std::collections::BTreeSet;
use std::sync::atomic::Ordering::Relaxed;

/// The samples of a frame, for it and its neighbours.
pub struct SampledFrame {
    digest: Digest,
    lit: Vec<LayerId>,
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
        let is_needed = |known: &SampledFrame| sampled.iter().any(|one| one.digest() == known.digest);
        self.sampled.retain(is_needed);
        // Two films of each frame, and the audits.
        let missing = sampled.iter().filter(|one| self.known(one, lit).is_none()).count() as u32;
        let all = 2 * missing + 2;
        let (mut places, mut traced) = (Vec::with_capacity(sampled.len()), 0);
        for one in sampled {
            let known = self.known(one, lit);
            traced += if known.is_none() { 2 } else { 0 };
            places.push(match known {
                Some(place) => place,
                None => self.sample(one, lit, [traced - 2, all])?,
            });
        }
        let held = places.first().map_or(&[][..], |own| &self.sampled[*own].lit).to_vec();
        let audits = self.trace_films(state, &held, FilmSet::Audits, [traced, all])?;
        let (Ok([a, b]), [own, others @ ..]) = (<[Film; 2]>::try_from(audits), &places[..]) else {
            return Err(no_film(state));
        };
        let own = &self.sampled[*own];
        let neighbor = |place: &usize| {
            let SampledFrame { halves, hits, .. } = &self.sampled[*place];
            let found = own.hits.seen_by(hits);
            // Where nothing moves, they have the same random numbers otherwise, and nothing to add.
            let found = if self.quality.vary_noise { found } else { found.without_still() };
            Neighbor::new(halves, found)
        };
        let film = tracing::debug_span!("denoise").in_scope(|| {
            let neighbors: Vec<Neighbor> = others.iter().map(neighbor).collect();
            let films = SampleFilms { halves: &own.halves, neighbors: &neighbors, audits: [&a, &b] };
            denoise(&films, f64::from(drawn(self.quality.samples.next_multiple_of(2))))
        });
        self.world.resource_mut::<Stats>().traced += 1;
        let meter = &self.world.resource::<RunProgress>().0;
        meter.frames.fetch_add(1, Relaxed);
        meter.thousandths.store(0, Relaxed);
        Ok(film)
    }

    /// The place of a frame's samples in the list, if they are known with all layers that are needed.
    fn known(&self, frame: &SampledState, lit: &[LayerId]) -> Option<usize> {
        let has_all =
            |known: &SampledFrame| frame.lit.iter().chain(lit).all(|layer| known.lit.contains(layer));
        self.sampled.iter().position(|known| known.digest == frame.digest() && has_all(known))
    }

    /// Traces the samples of a frame. Returns their place in the list.
    fn sample(
        &mut self,
        frame: &SampledState,
        lit: &[LayerId],
        parts: [u32; 2],
    ) -> Result<usize, FrameError> {
        let wanted: BTreeSet<LayerId> = frame.lit.iter().chain(lit).copied().collect();
        let lit: Vec<LayerId> = wanted.into_iter().collect();
        let films = self.trace_films(&frame.state, &lit, FilmSet::Halves, parts)?;
        let hits = self.world.resource_mut::<FilmInProgress>().hits.take();
        let (Ok(films), Some(hits)) = (<[Film; 2]>::try_from(films), hits) else {
            return Err(no_film(&frame.state));
        };
        let traced = SampledFrame { digest: frame.digest(), lit, halves: Halves::new(films), hits };
        let before = self.sampled.iter().position(|known| known.digest == traced.digest);
        match before {
            Some(place) => self.sampled[place] = traced,
            None => self.sampled.push(traced),
        }
        Ok(before.unwrap_or(self.sampled.len() - 1))
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
