//! Evaluates frames without tracing them.

use crate::base::cancel::Stop;
use crate::base::digest::Digest;
use crate::pipeline::schedule::{FrameState, frame_states};
use crate::sequence::Sequence;
use std::collections::{BTreeSet, HashSet};

/// The frame states of a run, in the order of the requested frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameStates {
    pub frames: Vec<FrameState>,
}

impl FrameStates {
    /// Keeps the states of these frames, which must be in the same order.
    pub fn only(mut self, frames: &[u32]) -> Self {
        let mut wanted = frames.iter().peekable();
        self.frames.retain(|state| wanted.next_if(|frame| **frame == state.frame).is_some());
        self
    }
}

/// These frames, plus those of `among` that share a film or samples of views with one of them, in ascending order.
pub fn with_shared(sequence: &Sequence, frames: &[u32], among: &[u32]) -> Vec<u32> {
    let hashes: HashSet<Digest> =
        evaluate(sequence, frames).frames.iter().map(FrameState::shared_work).collect();
    let states = evaluate(sequence, among).frames;
    let shared = states.iter().filter(|state| hashes.contains(&state.shared_work())).map(|state| state.frame);
    let all: BTreeSet<u32> = shared.chain(frames.iter().copied()).collect();
    all.into_iter().collect()
}

/// Evaluates frames in parallel. The state of a frame does not depend on the other frames of the list.
pub fn evaluate(sequence: &Sequence, frames: &[u32]) -> FrameStates {
    evaluate_until(sequence, frames, &Stop::default())
}

/// [`evaluate`], which skips the remaining frames once `stop` is set.
pub fn evaluate_until(sequence: &Sequence, frames: &[u32], stop: &Stop) -> FrameStates {
    FrameStates { frames: frame_states(sequence, frames, stop) }
}
