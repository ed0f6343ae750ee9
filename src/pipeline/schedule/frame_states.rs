//! Evaluates frames together, because frames that share a film may affect how it is sampled.

use super::frame_state::FrameState;
use super::preview::Preview;
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
    let sampled = |state: &FrameState| state.random && state.weights.len() > 1;
    if sequence.quality.noise.is_none() || !states.iter().any(sampled) {
        return states;
    }
    let requested: BTreeSet<u32> = frames.iter().copied().collect();
    let others: Vec<u32> = (0..sequence.timeline.frames).filter(|frame| !requested.contains(frame)).collect();
    let others = independent_states(sequence, &others, stop);
    let all: BTreeMap<u32, &FrameState> =
        states.iter().chain(&others).map(|state| (state.frame, state)).collect();
    // For each film, the different appearances of its frames.
    let mut films: HashMap<Digest, FilmAppearances> = HashMap::new();
    for state in all.values().filter(|state| state.random) {
        let shown = films.entry(state.scene_hash).or_default();
        if !shown.image_hashes.contains(&state.image_hash) {
            shown.image_hashes.push(state.image_hash);
            shown.weightings.push(state.weights.clone());
        }
    }
    for state in &mut states {
        if let Some(FilmAppearances { image_hashes, weightings }) = films.get(&state.scene_hash)
            && let Some(own) = image_hashes.iter().position(|hash| *hash == state.image_hash)
            && image_hashes.len() > 1
        {
            state.share(Digest::of(image_hashes), weightings.as_slice().into(), own);
        }
    }
    states
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
