//! Every frame evaluated, and none traced.

use crate::base::cancel::Stop;
use crate::base::digest::Digest;
use crate::pipeline::schedule::{Look, looks};
use crate::sequence::Sequence;
use std::collections::{BTreeSet, HashSet};

/// What the frames of a run evaluate to, in the order in which they were asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    pub frames: Vec<Look>,
}

impl Survey {
    /// That of these frames, which are in the same order.
    pub fn only(mut self, frames: &[u32]) -> Self {
        let mut wanted = frames.iter().peekable();
        self.frames.retain(|look| wanted.next_if(|frame| **frame == look.frame).is_some());
        self
    }
}

/// These frames, and those of `among` that are made of the same films as one of them, in rising order.
pub fn with_shared(sequence: &Sequence, frames: &[u32], among: &[u32]) -> Vec<u32> {
    let transports: HashSet<Digest> =
        survey(sequence, frames).frames.iter().map(|look| look.transport).collect();
    let looks = survey(sequence, among).frames;
    let shared = looks.iter().filter(|look| transports.contains(&look.transport)).map(|look| look.frame);
    let all: BTreeSet<u32> = shared.chain(frames.iter().copied()).collect();
    all.into_iter().collect()
}

/// Evaluates frames, in parallel. What one evaluates to does not depend on the others.
pub fn survey(sequence: &Sequence, frames: &[u32]) -> Survey {
    survey_until(sequence, frames, &Stop::default())
}

/// The same; where `stop` asks for it, the rest is left out.
pub fn survey_until(sequence: &Sequence, frames: &[u32], stop: &Stop) -> Survey {
    Survey { frames: looks(sequence, frames, stop) }
}
