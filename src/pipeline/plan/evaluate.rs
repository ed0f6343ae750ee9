//! Evaluates frames without tracing them.

use super::work_groups::work_groups;
use crate::base::cancel::Stop;
use crate::base::digest::Digest;
use crate::base::units::counted;
use crate::pipeline::schedule::{FrameState, SampledState, frame_states};
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

    /// The number of scenes beside those of these frames whose samples help to denoise them.
    pub fn neighbors_besides(&self) -> usize {
        let sampled = || self.frames.iter().filter_map(|state| state.neighbors.as_deref());
        let own: HashSet<Digest> =
            sampled().filter_map(|all| all.first()).map(SampledState::digest).collect();
        let all: HashSet<Digest> = sampled().flatten().map(SampledState::digest).collect();
        all.difference(&own).count()
    }

    /// What is said of neighbours, if they are many for so few frames.
    pub fn neighbors_note(&self) -> Option<String> {
        let (own, others) = (self.frames.len(), self.neighbors_besides());
        (2 * others > own).then(|| {
            format!(
                "the samples of {} were traced besides, to denoise {own} with their neighbours; `denoise: Alone` \
                 (--denoise=alone) takes none",
                counted(others as u64, "frame"),
            )
        })
    }
}

/// These frames, plus those of `among` that one process should render with them, because they share a film or samples: in
/// ascending order.
pub fn with_shared(sequence: &Sequence, frames: &[u32], among: &[u32]) -> Vec<u32> {
    let wanted: BTreeSet<u32> = frames.iter().copied().collect();
    let all: BTreeSet<u32> = wanted.iter().chain(among).copied().collect();
    let all: Vec<u32> = all.into_iter().collect();
    let groups = work_groups(&evaluate(sequence, &all).frames);
    let numbers = groups.into_iter().map(|group| group.frames.into_iter().map(|index| all[index]).collect());
    let groups = numbers.filter(|group: &Vec<u32>| group.iter().any(|frame| wanted.contains(frame)));
    groups.flatten().collect::<BTreeSet<u32>>().into_iter().collect()
}

/// Evaluates frames in parallel. The state of a frame does not depend on the other frames of the list.
pub fn evaluate(sequence: &Sequence, frames: &[u32]) -> FrameStates {
    evaluate_until(sequence, frames, &Stop::default())
}

/// [`evaluate`], which skips the remaining frames once `stop` is set.
pub fn evaluate_until(sequence: &Sequence, frames: &[u32], stop: &Stop) -> FrameStates {
    FrameStates { frames: frame_states(sequence, frames, stop) }
}
