//! A plan told by spans of frames: what changes in each, and which effects it calls for.

use super::Plan;
use super::changes::{Change, Part, between, values};
use super::effects::{Caller, Effect, called_for};
use crate::base::digest::Digest;
use crate::pipeline::schedule::{Look, Preview};
use crate::sequence::Sequence;
use std::collections::{BTreeMap, HashSet};

/// Frames one after the other in which the same things change; which of the lights fade may differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    /// Where the first and the last of them are among the frames that were asked for.
    pub first: usize,
    pub last: usize,
    /// What changes from each to the next.
    pub changes: Change,
    /// Films that are traced for them.
    pub traced: usize,
}

/// A plan as people read it.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    pub spans: Vec<Span>,
    /// The effects that any film calls for, each with the first entity that does.
    pub effects: BTreeMap<Effect, Caller>,
    /// The films that call for each.
    pub calls: BTreeMap<Effect, Vec<usize>>,
    /// Why there are as many films as there are: how many for each reason, in the order in which these come up.
    pub reasons: Vec<(Reason, usize)>,
}

/// Why a film is traced and not made of another.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// It is the first.
    First,
    /// Something has changed that is more than the strength of lights.
    Change(Change),
    /// Samples have become random, or stand on a grid again, as lights with an area are switched.
    Samples,
    /// There was one, but no memory to keep it or all of its layers.
    Memory,
}

/// Tells what a plan of this sequence does.
pub fn outline(sequence: &Sequence, plan: &Plan) -> Outline {
    let calls = effects(sequence, plan);
    let first = |(effect, callers): (&Effect, &Vec<(usize, Caller)>)| Some((*effect, callers.first()?.1));
    let films = |(effect, callers): (&Effect, &Vec<(usize, Caller)>)| {
        (*effect, callers.iter().map(|call| call.0).collect())
    };
    Outline {
        spans: spans(sequence, plan),
        effects: calls.iter().filter_map(first).collect(),
        calls: calls.iter().map(films).collect(),
        reasons: reasons(sequence, plan),
    }
}

fn reasons(sequence: &Sequence, plan: &Plan) -> Vec<(Reason, usize)> {
    let looks = &plan.survey.frames;
    let mut known: HashSet<Digest> = HashSet::new();
    let mut found: Vec<(Reason, usize)> = Vec::new();
    for take in &plan.takes {
        let (index, look) = (take.frames[0], &looks[take.frames[0]]);
        let reason = match index.checked_sub(1) {
            _ if !known.insert(look.transport) => Reason::Memory,
            None => Reason::First,
            Some(before) => {
                let values = |look: &Look| values(sequence, &sequence.timeline.clock(look.frame));
                let mut changes = between(&values(&looks[before]), &values(look));
                changes.retain(|part| !part.is_weight());
                if changes.is_empty() { Reason::Samples } else { Reason::Change(changes) }
            }
        };
        match found.iter_mut().find(|(other, _)| *other == reason) {
            Some((_, count)) => *count += 1,
            None => found.push((reason, 1)),
        }
    }
    found
}

fn spans(sequence: &Sequence, plan: &Plan) -> Vec<Span> {
    let looks = &plan.survey.frames;
    let valued = |look: &Look| values(sequence, &sequence.timeline.clock(look.frame));
    let mut spans: Vec<Span> = Vec::new();
    let mut before: Option<(&Look, Vec<(Part, Digest)>)> = None;
    for (index, look) in looks.iter().enumerate() {
        let now = valued(look);
        let traced = usize::from(plan.takes[plan.of[index]].frames.first() == Some(&index));
        if let Some((last, last_values)) = &before {
            let changes = seen(last, look, between(last_values, &now));
            match spans.last_mut() {
                Some(span) if span.first == span.last && span.first == 0 => {
                    *span = Span { last: index, traced: span.traced + traced, changes, ..*span };
                }
                Some(span) if alike(&span.changes, &changes) => {
                    (span.last, span.traced) = (index, span.traced + traced);
                    span.changes.extend(changes);
                    span.changes.sort_unstable();
                    span.changes.dedup();
                }
                _ => spans.push(Span { first: index, last: index, changes, traced }),
            }
        } else {
            spans.push(Span { first: index, last: index, changes: Vec::new(), traced });
        }
        before = Some((look, now));
    }
    spans
}

/// Whether the same things change, where all that only weights light counts as one.
fn alike(one: &Change, other: &Change) -> bool {
    let shape = |change: &Change| {
        let moves: Change = change.iter().copied().filter(|part| !part.is_weight()).collect();
        (change.len() > moves.len(), moves)
    };
    shape(one) == shape(other)
}

/// Of what has changed, that which makes a difference.
fn seen(before: &Look, now: &Look, mut changes: Change) -> Change {
    let moved = before.transport != now.transport;
    let weighted = before.weights != now.weights || before.exposure != now.exposure;
    changes.retain(|part| if part.is_weight() { weighted } else { moved });
    changes
}

/// The films that call for each effect, with who does.
fn effects(sequence: &Sequence, plan: &Plan) -> BTreeMap<Effect, Vec<(usize, Caller)>> {
    let mut preview = Preview::new(sequence);
    let mut effects: BTreeMap<Effect, Vec<(usize, Caller)>> = BTreeMap::new();
    for (film, take) in plan.takes.iter().enumerate() {
        let look = &plan.survey.frames[take.frames[0]];
        let found = preview.scene_of(look.frame, |scene| called_for(scene, look, &take.lit));
        for (effect, caller) in found.into_iter().flatten() {
            let calls = effects.entry(effect).or_default();
            if calls.last().is_none_or(|(last, _)| *last != film) {
                calls.push((film, caller));
            }
        }
    }
    effects
}
