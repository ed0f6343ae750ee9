//! Summarises a plan by spans of frames: what changes in each, and which effects it needs.

use super::changes::{AnimatedPart, Changes, between, values};
use super::effects::{EffectSource, SceneEffect, scene_effects};
use super::render_plan::Plan;
use crate::base::digest::Digest;
use crate::pipeline::schedule::{FrameState, Preview};
use crate::sequence::Sequence;
use std::collections::{BTreeMap, HashSet};

/// Consecutive frames in which the same parts change. Which lights fade may differ within a span.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSpan {
    /// Indices of the first and the last frame among the requested frames.
    pub first: usize,
    pub last: usize,
    /// Parts that change from each frame to the next.
    pub changes: Changes,
    /// Number of films traced for the span.
    pub traced: usize,
}

/// A summary of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    pub spans: Vec<FrameSpan>,
    /// The effects of all films, each with the first part of the scene that needs it.
    pub effects: BTreeMap<SceneEffect, EffectSource>,
    /// The films that need each effect.
    pub calls: BTreeMap<SceneEffect, Vec<usize>>,
    /// Why films are traced: the number of films for each reason, in order of appearance.
    pub reasons: Vec<(Reason, usize)>,
}

/// Why a film is traced instead of reused.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// It is the first film.
    First,
    /// A change that is more than the strength of lights.
    Change(Changes),
    /// Samples became random or returned to a grid, because area lights were switched.
    Samples,
    /// Each frame has random numbers of its own.
    Noise,
    /// An equal film existed, but memory was too small for it or for all its layers.
    Memory,
}

/// Summarises the plan of a sequence.
pub fn outline(sequence: &Sequence, plan: &Plan) -> Outline {
    let calls = effects(sequence, plan);
    let first =
        |(effect, callers): (&SceneEffect, &Vec<(usize, EffectSource)>)| Some((*effect, callers.first()?.1));
    let films = |(effect, callers): (&SceneEffect, &Vec<(usize, EffectSource)>)| {
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
    let states = &plan.states.frames;
    let mut known: HashSet<Digest> = HashSet::new();
    let mut found: Vec<(Reason, usize)> = Vec::new();
    for shared in &plan.films {
        let (index, state) = (shared.frames[0], &states[shared.frames[0]]);
        let reason = match index.checked_sub(1) {
            _ if !known.insert(state.scene_hash) => Reason::Memory,
            None => Reason::First,
            Some(before) => {
                let values = |state: &FrameState| values(sequence, &sequence.timeline.clock(state.frame));
                let mut changes = between(&values(&states[before]), &values(state));
                changes.retain(|part| !part.is_weight());
                match changes.is_empty() {
                    true if state.random && sequence.quality.vary_noise => Reason::Noise,
                    true => Reason::Samples,
                    false => Reason::Change(changes),
                }
            }
        };
        match found.iter_mut().find(|(other, _)| *other == reason) {
            Some((_, count)) => *count += 1,
            None => found.push((reason, 1)),
        }
    }
    found
}

fn spans(sequence: &Sequence, plan: &Plan) -> Vec<FrameSpan> {
    let states = &plan.states.frames;
    let valued = |state: &FrameState| values(sequence, &sequence.timeline.clock(state.frame));
    let mut spans: Vec<FrameSpan> = Vec::new();
    let mut before: Option<(&FrameState, Vec<(AnimatedPart, Digest)>)> = None;
    for (index, state) in states.iter().enumerate() {
        let now = valued(state);
        let traced = usize::from(plan.films[plan.film_of[index]].frames.first() == Some(&index));
        if let Some((last, last_values)) = &before {
            let changes = seen(last, state, between(last_values, &now));
            match spans.last_mut() {
                Some(span) if span.first == span.last && span.first == 0 => {
                    *span = FrameSpan { last: index, traced: span.traced + traced, changes, ..*span };
                }
                Some(span) if alike(&span.changes, &changes) => {
                    (span.last, span.traced) = (index, span.traced + traced);
                    span.changes.extend(changes);
                    span.changes.sort_unstable();
                    span.changes.dedup();
                }
                _ => spans.push(FrameSpan { first: index, last: index, changes, traced }),
            }
        } else {
            spans.push(FrameSpan { first: index, last: index, changes: Vec::new(), traced });
        }
        before = Some((state, now));
    }
    spans
}

/// Whether the same parts change. All changes of light weights count as one.
fn alike(one: &Changes, other: &Changes) -> bool {
    let shape = |change: &Changes| {
        let moves: Changes = change.iter().copied().filter(|part| !part.is_weight()).collect();
        (change.len() > moves.len(), moves)
    };
    shape(one) == shape(other)
}

/// Keeps the changes that have a visible effect.
fn seen(before: &FrameState, now: &FrameState, mut changes: Changes) -> Changes {
    let moved = before.scene_hash != now.scene_hash;
    let weighted = before.weights != now.weights || before.exposure != now.exposure;
    changes.retain(|part| if part.is_weight() { weighted } else { moved });
    changes
}

/// The films that need each effect, with the part of the scene that needs it.
fn effects(sequence: &Sequence, plan: &Plan) -> BTreeMap<SceneEffect, Vec<(usize, EffectSource)>> {
    let mut preview = Preview::new(sequence);
    let mut effects: BTreeMap<SceneEffect, Vec<(usize, EffectSource)>> = BTreeMap::new();
    for (film, shared) in plan.films.iter().enumerate() {
        let state = &plan.states.frames[shared.frames[0]];
        let found = preview.scene_of(state.frame, |scene| scene_effects(scene, state, &shared.lit));
        for (effect, caller) in found.into_iter().flatten() {
            let calls = effects.entry(effect).or_default();
            if calls.last().is_none_or(|(last, _)| *last != film) {
                calls.push((film, caller));
            }
        }
    }
    effects
}
