//! Estimates how many paths of films are traced, if films share paths.
//!
//! Films of a small picture are traced together. The share of paths that are traced again hardly depends on the size.

use super::camera_rays::{camera_rays, camera_rays_in_order};
use super::group_trial::{GroupShare, GroupTrial};
use super::ray_estimate::PilotBudget;
use super::render_plan::Plan;
use crate::base::clock::{ElapsedTime, TimeSource};
use crate::sequence::Sequence;
use crate::trace::{MAX_FRAMES, PathObstacle};

/// Limits of what is tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShareTrials {
    /// Maximum number of groups of films, and of the films of each that are traced: scenes take long to prepare.
    pub groups: usize,
    pub films: usize,
    /// Maximum number of films of a group whose scenes are compared.
    pub compared: usize,
    /// Samples of a small picture. With 0, nothing is traced.
    pub samples: u64,
    /// Seconds for all trials, as far as pictures have at least these samples and at most 2^18: small pictures take
    /// more time per sample. And how they are timed. With 0, nothing is.
    pub seconds: f64,
    pub clock: TimeSource,
}

impl ShareTrials {
    /// Limits with this number of samples.
    pub fn of_samples(samples: u64) -> Self {
        let (seconds, clock) = (0.0, TimeSource::Machine);
        Self { groups: 4, films: 8, compared: MAX_FRAMES, samples, seconds, clock }
    }

    /// Timed trials that prepare about so many scenes, but at least those of two films of one group: each group has
    /// scenes to compare and scenes to trace. Where two films cannot share paths, others of the group are tried.
    pub fn of_scenes(scenes: usize, seconds: f64, clock: TimeSource) -> Self {
        let all = Self { seconds, clock, ..Self::of_samples(PilotBudget::PLAN.samples) };
        let films = (scenes / 2).clamp(2, all.films);
        let groups = (scenes / (2 * films)).clamp(1, all.groups);
        let compared = (scenes / groups).saturating_sub(films).clamp(films, all.compared);
        Self { groups, films, compared, ..all }
    }
}

/// How many paths of films are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct PathShares {
    pub films: Vec<FilmShare>,
    /// Why films that may share paths do not, if any of those that were tried does not.
    pub obstacle: Option<PathObstacle>,
}

/// How much of a film is expected to be traced for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmShare {
    /// The share of its paths: 1 if it shares none, and more if it takes samples of other frames.
    pub paths: f64,
    /// If it shares paths: the rays that are traced for it, and the time that this takes, per path of the whole film.
    pub rays: Option<f64>,
    pub time: Option<ElapsedTime>,
}

impl FilmShare {
    /// All of them.
    pub const WHOLE: Self = Self::of_paths(1.0);

    /// A share of the paths, which are like the others.
    pub const fn of_paths(paths: f64) -> Self {
        Self { paths, rays: None, time: None }
    }
}

/// The paths that films share. If nothing is traced, no film shares paths.
pub fn path_shares(sequence: &Sequence, plan: &Plan, trials: ShareTrials) -> PathShares {
    let mut found = PathShares { films: vec![FilmShare::WHOLE; plan.films.len()], obstacle: None };
    for group in &plan.view_groups {
        let alone: u64 = group.films.clone().map(|film| camera_rays(sequence, plan.state_of(film))).sum();
        let share = FilmShare::of_paths(group.camera_rays as f64 / alone.max(1) as f64);
        found.films[group.films.clone()].fill(share);
    }
    if sequence.quality.uses_neighbors() {
        // Samples of frames beside those of the run are traced, too.
        let films = (0..plan.films.len()).map(|film| (plan.state_of(film), &plan.films[film].lit));
        for (film, rays) in camera_rays_in_order(sequence, films).into_iter().enumerate() {
            let alone = camera_rays(sequence, plan.state_of(film)).max(1);
            found.films[film] = FilmShare::of_paths(rays as f64 / alone as f64);
        }
    }
    let groups = groups(plan);
    if trials.samples == 0 || groups.is_empty() {
        return found;
    }
    let count = groups.len().min(trials.groups);
    let trials = ShareTrials { groups: count, ..trials };
    let chosen = |index: usize| (2 * index + 1) * groups.len() / (2 * count);
    let known: Vec<GroupShare> = (0..count)
        .map(|index| GroupTrial::new(sequence, plan, groups[chosen(index)], trials).share())
        .collect();
    for (index, (first, films)) in groups.iter().enumerate() {
        found.films[*first..first + films].fill(known[index * count / groups.len()].mean);
    }
    found.obstacle = known.iter().find_map(|known| known.obstacle);
    found
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
