//! Frames looked at together: what each of them evaluates to, and which others have a say in how it is sampled.

use super::{Look, Preview};
use crate::color::Rgb;
use crate::digest::Digest;
use crate::sequence::Sequence;
use crate::stop::Stop;
use crate::trace::Weightings;
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
    let mut films: HashMap<Digest, Vec<Vec<Rgb>>> = HashMap::new();
    for look in all.values().filter(|look| look.random) {
        let shown = films.entry(look.transport).or_default();
        if !shown.contains(&look.weights) {
            shown.push(look.weights.clone());
        }
    }
    let films: HashMap<Digest, Weightings> =
        films.into_iter().map(|(film, all)| (film, all.into())).collect();
    for look in &mut looks {
        if let Some(shown) = films.get(&look.transport) {
            look.share(shown);
        }
    }
    looks
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
