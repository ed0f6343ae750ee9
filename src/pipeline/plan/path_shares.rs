//! Estimates how many paths of films are traced, if films share paths.
//!
//! Films of a small picture are traced together. The share of paths that are traced again hardly depends on the size.

use super::camera_rays::{camera_rays, camera_rays_in_order};
use super::ray_estimate::{NullSink, downscaled};
use super::render_plan::Plan;
use super::tries::Tries;
use crate::base::stats::{ProgressMeter, SharedPaths};
use crate::film::LayerId;
use crate::pipeline::schedule::{FrameLoop, FrameState};
use crate::sequence::Sequence;
use crate::trace::{MAX_FRAMES, PathObstacle, sharing_would_pay};
use std::sync::Arc;

/// Limits of what is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShareTrials {
    /// Maximum number of groups of films, and of the films of each: scenes take long to prepare.
    pub groups: usize,
    pub films: usize,
    /// Samples of a small picture. With 0, nothing is traced.
    pub samples: u64,
}

impl ShareTrials {
    /// Limits with this number of samples.
    pub fn of_samples(samples: u64) -> Self {
        Self { groups: 4, films: 8, samples }
    }

    /// Limits for about `count` films, but at least the two films of one group that can share paths. Where these cannot,
    /// others of the group are tried.
    pub fn of_films(count: usize, samples: u64) -> Self {
        let all = Self::of_samples(samples);
        let films = count.clamp(2, all.films);
        Self { groups: (count / films).clamp(1, all.groups), films, samples }
    }
}

/// How many paths of films are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct PathShares {
    /// For each film, the expected share of its paths that are traced for it: 1 if it shares none, and more if it takes
    /// samples of other frames.
    pub films: Vec<f64>,
    /// For each film that shares paths, the expected rays that are traced for it, per path.
    pub rays: Vec<Option<f64>>,
    /// Why films that may share paths do not, if any of those that were tried does not.
    pub obstacle: Option<PathObstacle>,
}

/// The paths that films share. If nothing is traced, no film shares paths.
pub fn path_shares(sequence: &Sequence, plan: &Plan, trials: ShareTrials) -> PathShares {
    let mut found =
        PathShares { films: vec![1.0; plan.films.len()], rays: vec![None; plan.films.len()], obstacle: None };
    for group in &plan.view_groups {
        let alone: u64 = group.films.clone().map(|film| camera_rays(sequence, plan.state_of(film))).sum();
        found.films[group.films.clone()].fill(group.camera_rays as f64 / alone.max(1) as f64);
    }
    if sequence.quality.uses_neighbors() {
        // Samples of frames beside those of the run are traced, too.
        let films = (0..plan.films.len()).map(|film| (plan.state_of(film), &plan.films[film].lit));
        for (film, rays) in camera_rays_in_order(sequence, films).into_iter().enumerate() {
            found.films[film] = rays as f64 / camera_rays(sequence, plan.state_of(film)).max(1) as f64;
        }
    }
    let groups = groups(plan);
    if trials.samples == 0 || groups.is_empty() {
        return found;
    }
    let count = groups.len().min(trials.groups);
    let chosen = |index: usize| (2 * index + 1) * groups.len() / (2 * count);
    let known: Vec<GroupShare> =
        (0..count).map(|index| share(sequence, plan, groups[chosen(index)], trials)).collect();
    for (index, (first, films)) in groups.iter().enumerate() {
        let GroupShare { paths, rays, .. } = known[index * count / groups.len()];
        found.films[*first..first + films].fill(paths);
        found.rays[*first..first + films].fill(rays);
    }
    found.obstacle = known.iter().find_map(|known| known.obstacle);
    found
}

/// What films of a group share.
#[derive(Clone, Copy)]
struct GroupShare {
    /// The share of their paths that are traced.
    paths: f64,
    /// The rays that are traced, per path, if all films share paths.
    rays: Option<f64>,
    /// Why films share none, if some do not.
    obstacle: Option<PathObstacle>,
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

/// The share of a group's paths that are traced, and why films of the group share none, if some do not. As a run does,
/// this goes on until films are traced together. Those behind them are taken to be like them.
fn share(
    sequence: &Sequence,
    plan: &Plan,
    (first, films): (usize, usize),
    trials: ShareTrials,
) -> GroupShare {
    let shared = &plan.films[first..first + films];
    let states: Vec<&FrameState> = shared.iter().map(|film| &plan.states.frames[film.frames[0]]).collect();
    let small = downscaled(sequence, states[0], trials.samples);
    let mut frames = FrameLoop::new(&small, NullSink, Arc::new(ProgressMeter::default()));
    let (mut alone, mut obstacle, mut tries) = (0, None, Tries::default());
    while alone + 1 < films {
        let lit: Vec<LayerId> = Plan::lit(&shared[alone..]);
        let few = &states[alone..films.min(alone + trials.films)];
        let Ok(group) = frames.trace_together(few, &lit, plan.scenes_budget(), &mut |_, _| Ok(())) else {
            break;
        };
        obstacle = obstacle.or(group.end);
        if group.films > 0 {
            // The films that were tried stand for more, unless something ended them.
            let (counts, traced) = (frames.stats().counts, group.films);
            let more = if traced < few.len() { traced } else { (films - alone).min(MAX_FRAMES) };
            let times = more as f64 / traced as f64;
            let pays = sharing_would_pay(&counts, times);
            let share = match pays {
                // Every path once for all, and the same share of each film again.
                true => {
                    let once = 1.0 - counts.paths.whole as f64 / counts.paths.all.max(1) as f64;
                    again(&counts.paths) + once / more as f64
                }
                false => 1.0,
            };
            let all = (alone as f64 + share * (films - alone) as f64) / films as f64;
            let changes = (share >= 1.0).then_some(PathObstacle::Changes);
            // Paths that meet movers, and those in tiles that are traced whole, may have more rays than others.
            let SharedPaths { once_rays, all: paths, .. } = counts.paths;
            let often = (counts.rays.total() - once_rays) as f64;
            let rays = (often + once_rays as f64 / times) / paths.max(1) as f64;
            let rays = (pays && alone == 0).then_some(rays);
            return GroupShare { paths: all.min(1.0), rays, obstacle: changes.or(obstacle) };
        }
        alone += tries.next(films - alone, 0, false);
    }
    GroupShare { paths: 1.0, rays: None, obstacle }
}

/// The share of the paths of a film that are traced for it alone.
fn again(paths: &SharedPaths) -> f64 {
    (paths.retraced + paths.whole) as f64 / paths.all.max(1) as f64
}
