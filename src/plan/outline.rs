//! A plan told by spans of frames: what changes in each, and which effects it calls for.

use super::Plan;
use super::changes::{Change, Part, between, values};
use super::effects::{Caller, Effect, called_for};
use crate::digest::Digest;
use crate::schedule::{Look, Preview};
use crate::sequence::Sequence;
use std::collections::BTreeMap;

/// Frames one after the other in which the same things change.
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
}

/// Tells what a plan of this sequence does.
pub fn outline(sequence: &Sequence, plan: &Plan) -> Outline {
    Outline { spans: spans(sequence, plan), effects: effects(sequence, plan) }
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
                Some(span) if span.changes == changes || span.first == span.last && span.first == 0 => {
                    *span = Span { last: index, traced: span.traced + traced, changes, ..*span };
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

/// Of what has changed, that which makes a difference.
fn seen(before: &Look, now: &Look, mut changes: Change) -> Change {
    let moved = before.transport != now.transport;
    let weighted = before.weights != now.weights || before.exposure != now.exposure;
    changes.retain(|part| if part.is_weight() { weighted } else { moved });
    changes
}

fn effects(sequence: &Sequence, plan: &Plan) -> BTreeMap<Effect, Caller> {
    let mut preview = Preview::new(sequence);
    let mut effects = BTreeMap::new();
    for take in &plan.takes {
        let look = &plan.survey.frames[take.frames[0]];
        let found = preview.scene_of(look.frame, |scene| called_for(scene, look, &take.lit));
        for (effect, caller) in found.into_iter().flatten() {
            effects.entry(effect).or_insert(caller);
        }
    }
    effects
}
