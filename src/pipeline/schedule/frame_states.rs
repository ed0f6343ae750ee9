//! Evaluates frames together, because frames that share a film may affect how it is sampled.

use super::frame_state::{FrameState, SampledState};
use super::preview::Preview;
use super::view_spans::share_views;
use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::film::LayerId;
use crate::sequence::Sequence;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Evaluates frames in parallel, and skips the rest once `stop` is set. The state of a frame depends only on the
/// sequence and its number.
pub fn frame_states(sequence: &Sequence, frames: &[u32], stop: &Stop) -> Vec<FrameState> {
    let mut states = independent_states(sequence, frames, stop);
    let shares_views =
        sequence.quality.shares_views() && states.iter().any(|state| state.viewpoint.is_some());
    let sampled = |state: &FrameState| state.random && state.weights.len() > 1;
    if sequence.quality.uses_neighbors() {
        sample_with_neighbors(sequence, &mut states, stop);
        return states;
    }
    let shares_samples = sequence.quality.noise.is_some() && states.iter().any(sampled);
    if !shares_views && !shares_samples {
        return states;
    }
    let requested: BTreeSet<u32> = frames.iter().copied().collect();
    let others: Vec<u32> = (0..sequence.timeline.frames).filter(|frame| !requested.contains(frame)).collect();
    let mut all: BTreeMap<u32, FrameState> =
        states.iter().cloned().map(|state| (state.frame, state)).collect();
    all.extend(independent_states(sequence, &others, stop).into_iter().map(|state| (state.frame, state)));
    match shares_views {
        true => share_views(sequence, &all, &mut states),
        false => share_sampled_films(&all, &mut states),
    }
    states
}

/// How many frames before and after a frame it is denoised with.
pub const REACH: u32 = 2;

/// Makes frames use the samples of the frames around them: of those that the same camera shows, and that differ.
fn sample_with_neighbors(sequence: &Sequence, states: &mut [FrameState], stop: &Stop) {
    let last = sequence.timeline.frames.saturating_sub(1);
    let around = |frame: u32, reach: u32| frame.saturating_sub(reach)..=frame.saturating_add(reach).min(last);
    let is_sampled = |state: &FrameState| state.random && state.faded.is_none() && state.fault.is_none();
    let mut all: BTreeMap<u32, FrameState> =
        states.iter().cloned().map(|state| (state.frame, state)).collect();
    let sampled = states.iter().filter(|state| is_sampled(state));
    // The frames that a neighbour is sampled for are as far away again.
    let needed: BTreeSet<u32> = sampled.flat_map(|state| around(state.frame, 2 * REACH)).collect();
    let others: Vec<u32> = needed.into_iter().filter(|frame| !all.contains_key(frame)).collect();
    all.extend(independent_states(sequence, &others, stop).into_iter().map(|state| (state.frame, state)));
    let of = |frame: u32| all.get(&frame).filter(|state| is_sampled(state));
    let sampled = |state: &FrameState| {
        let lit: BTreeSet<LayerId> =
            around(state.frame, REACH).filter_map(of).flat_map(FrameState::lit).collect();
        SampledState { state: state.clone(), lit: lit.into_iter().collect() }
    };
    for state in states.iter_mut().filter(|state| is_sampled(state)) {
        let mut found = vec![sampled(state)];
        for other in around(state.frame, REACH).filter_map(of) {
            let is_known = found.iter().any(|one| one.state.scene_hash == other.scene_hash);
            if other.camera == state.camera && !is_known {
                found.push(sampled(other));
            }
        }
        state.sample_with(found);
    }
}

/// Makes frames share films that are sampled for all frames of the sequence.
fn share_sampled_films(all: &BTreeMap<u32, FrameState>, states: &mut [FrameState]) {
    // For each film, the different appearances of its frames.
    let mut films: HashMap<Digest, FilmAppearances> = HashMap::new();
    for state in all.values().filter(|state| state.random) {
        let shown = films.entry(state.scene_hash).or_default();
        if !shown.image_hashes.contains(&state.image_hash) {
            shown.image_hashes.push(state.image_hash);
            shown.weightings.push(state.weights.clone());
        }
    }
    for state in states {
        if let Some(FilmAppearances { image_hashes, weightings }) = films.get(&state.scene_hash)
            && let Some(own) = image_hashes.iter().position(|hash| *hash == state.image_hash)
            && image_hashes.len() > 1
        {
            state.share(Digest::of(image_hashes), weightings.as_slice().into(), own);
        }
    }
}

/// Different appearances of a film's frames. Radiance identifies them, because weights of layers without light do not
/// matter.
#[derive(Default)]
struct FilmAppearances {
    image_hashes: Vec<Digest>,
    weightings: Vec<Vec<Rgb>>,
}

/// Minimum number of frames for a world of their own.
const FEW: usize = 64;

/// Evaluates frames without regard to other frames.
fn independent_states(sequence: &Sequence, frames: &[u32], stop: &Stop) -> Vec<FrameState> {
    let part = frames.len().div_ceil(rayon::current_num_threads()).max(FEW);
    let looked = frames.par_chunks(part).flat_map_iter(|frames| {
        let mut preview = Preview::new(sequence);
        let on = |_: &&u32| stop.signal().is_none();
        frames.iter().take_while(on).map(move |&frame| preview.state(frame)).collect::<Vec<_>>()
    });
    looked.collect()
}
