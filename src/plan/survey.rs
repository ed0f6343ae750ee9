//! Every frame evaluated, and none traced.

use crate::schedule::{Look, Preview};
use crate::sequence::Sequence;
use rayon::prelude::*;

/// What the frames of a run evaluate to, in the order in which they were asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    pub frames: Vec<Look>,
}

/// Frames that are not worth a world of their own.
const FEW: usize = 64;

/// Evaluates frames, in parallel. What one evaluates to does not depend on the others.
pub fn survey(sequence: &Sequence, frames: &[u32]) -> Survey {
    let part = frames.len().div_ceil(rayon::current_num_threads()).max(FEW);
    let looked = frames.par_chunks(part).flat_map_iter(|frames| {
        let mut preview = Preview::new(sequence);
        frames.iter().map(move |&frame| preview.look(frame)).collect::<Vec<_>>()
    });
    Survey { frames: looked.collect() }
}
