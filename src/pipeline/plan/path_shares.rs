//! Estimates how many paths of films are traced, if films share paths.
//!
//! Films of a small picture are traced together. The share of paths that are traced again hardly depends on the size.

use super::camera_rays::camera_rays;
use super::ray_estimate::{NullSink, downscaled};
use super::render_plan::Plan;
use crate::base::stats::{ProgressMeter, SharedPaths};
use crate::film::LayerId;
use crate::pipeline::schedule::{FrameLoop, FrameState};
use crate::sequence::Sequence;
use std::sync::Arc;

/// Maximum number of groups of films that are measured.
const GROUPS: usize = 4;

/// For each film, the expected share of its paths that are traced for it: 1 if it shares none. `samples` is the number
/// of samples of a small picture; with 0, nothing is traced and no film shares paths.
pub fn path_shares(sequence: &Sequence, plan: &Plan, samples: u64) -> Vec<f64> {
    let mut shares = vec![1.0; plan.films.len()];
    for group in &plan.view_groups {
        let alone: u64 = group.films.clone().map(|film| camera_rays(sequence, plan.state_of(film))).sum();
        shares[group.films.clone()].fill(group.camera_rays as f64 / alone.max(1) as f64);
    }
    let groups = groups(plan);
    if samples == 0 || groups.is_empty() {
        return shares;
    }
    let count = groups.len().min(GROUPS);
    let chosen = |index: usize| (2 * index + 1) * groups.len() / (2 * count);
    let known: Vec<f64> =
        (0..count).map(|index| share(sequence, plan, groups[chosen(index)], samples)).collect();
    for (index, (first, films)) in groups.iter().enumerate() {
        shares[*first..first + films].fill(known[index * count / groups.len()]);
    }
    shares
}

/// Groups of films that may share paths: the first film of each, and the number of its films.
fn groups(plan: &Plan) -> Vec<(usize, usize)> {
    let (mut groups, mut first) = (Vec::new(), 0);
    while first < plan.films.len() {
        let count = plan.together(first).max(1);
        if count > 1 {
            groups.push((first, count));
        }
        first += count;
    }
    groups
}

/// The share of a group's paths that are traced.
fn share(sequence: &Sequence, plan: &Plan, (first, films): (usize, usize), samples: u64) -> f64 {
    let films = &plan.films[first..first + films];
    let states: Vec<&FrameState> = films.iter().map(|film| &plan.states.frames[film.frames[0]]).collect();
    let lit: Vec<LayerId> = Plan::lit(films);
    let small = downscaled(sequence, states[0], samples);
    let mut frames = FrameLoop::new(&small, NullSink, Arc::new(ProgressMeter::default()));
    let traced = frames.trace_together(&states, &lit, plan.scenes_budget()).unwrap_or_default();
    let SharedPaths { retraced, .. } = frames.stats().counts.paths;
    let all = frames.stats().counts.paths.total();
    match traced.len() {
        count if count > 1 && all > 0 => (1.0 / count as f64 + retraced as f64 / all as f64).min(1.0),
        _ => 1.0,
    }
}
