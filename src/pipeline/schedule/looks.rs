//! Frames looked at together: what each of them evaluates to, and which others have a say in how it is sampled.

use super::{Look, Preview};
use crate::base::cancel::Stop;
use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::sequence::Sequence;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Looks at frames, in parallel; where `stop` asks for it, the rest is left out. What a frame evaluates to depends on the
/// sequence and the frame alone.
pub fn looks(sequence: &Sequence, frames: &[u32], stop: &Stop) -> Vec<Look> {
    let mut looks = looks_alone(sequence, frames, stop);
    let sampled = |look: &Look| look.random && look.weights.len() > 1;
    if sequence.quality.noise.is_none() || !looks.iter().any(sampled) {
        return looks;
    }
    let asked: BTreeSet<u32> = frames.iter().copied().collect();
    let others: Vec<u32> = (0..sequence.timeline.frames).filter(|frame| !asked.contains(frame)).collect();
    let others = looks_alone(sequence, &others, stop);
    let all: BTreeMap<u32, &Look> = looks.iter().chain(&others).map(|look| (look.frame, look)).collect();
    // Of each film, what its frames look like, each once.
    let mut films: HashMap<Digest, Shown> = HashMap::new();
    for look in all.values().filter(|look| look.random) {
        let shown = films.entry(look.transport).or_default();
        if !shown.radiances.contains(&look.radiance) {
            shown.radiances.push(look.radiance);
            shown.weightings.push(look.weights.clone());
        }
    }
    for look in &mut looks {
        if let Some(Shown { radiances, weightings }) = films.get(&look.transport)
            && let Some(own) = radiances.iter().position(|radiance| *radiance == look.radiance)
            && radiances.len() > 1
        {
            look.share(Digest::of(radiances), weightings.as_slice().into(), own);
        }
    }
    looks
}

/// What the frames of a film look like: known by their radiance, as weights of what is dark do not count.
#[derive(Default)]
struct Shown {
    radiances: Vec<Digest>,
    weightings: Vec<Vec<Rgb>>,
}

/// Frames that are not worth a world of their own.
const FEW: usize = 64;

/// Looks that say nothing of other frames.
fn looks_alone(sequence: &Sequence, frames: &[u32], stop: &Stop) -> Vec<Look> {
    let part = frames.len().div_ceil(rayon::current_num_threads()).max(FEW);
    let looked = frames.par_chunks(part).flat_map_iter(|frames| {
        let mut preview = Preview::new(sequence);
        let on = |_: &&u32| stop.signal().is_none();
        frames.iter().take_while(on).map(move |&frame| preview.look(frame)).collect::<Vec<_>>()
    });
    looked.collect()
}
