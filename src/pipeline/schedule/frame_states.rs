//! Evaluates frames together, because frames that share a film may affect how it is sampled.

use super::frame_state::FrameState;
use super::preview::Preview;
use super::view_spans::share_views;
use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::digest::Digest;
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
