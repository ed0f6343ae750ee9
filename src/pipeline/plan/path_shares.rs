//! Estimates how many paths of films are traced, if films share paths.
//!
//! Films of a small picture are traced together. The share of paths that are traced again hardly depends on the size.

use super::camera_rays::{camera_rays, camera_rays_in_order};
use super::ray_estimate::{NullSink, PilotBudget, downscaled};
use super::render_plan::Plan;
use super::shared_films::SharedFilm;
use super::tries::Tries;
use crate::base::clock::{ElapsedTime, TimeSource};
use crate::base::math::min;
use crate::base::stats::{Counts, ProgressMeter, SharedPaths};
use crate::film::LayerId;
use crate::pipeline::schedule::{FrameError, FrameLoop, FrameState, SharingTrial};
use crate::sequence::Sequence;
use crate::trace::{MAX_FRAMES, PathObstacle, sharing_would_pay};
use std::sync::Arc;

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
    /// Seconds for all trials, as far as pictures have at least these samples and at most [`LARGEST`]: small pictures take
    /// more time per sample. And how they are timed. With 0, nothing is.
    pub seconds: f64,
    pub clock: TimeSource,
}

/// The most samples of a picture. Larger ones show no more.
const LARGEST: f64 = 262_144.0;

/// The most samples of a pixel of a picture whose tracing is timed. The time that a pixel takes is divided among them.
const MOST_OF_PIXEL: u32 = 9;

/// Maximum bytes of the copies of scenes that are made to compare films, if all are as large as those of the first two.
const MAX_COPIES: u64 = 1 << 27;

impl ShareTrials {
    /// Limits with this number of samples.
    pub fn of_samples(samples: u64) -> Self {
        let (seconds, clock) = (0.0, TimeSource::Machine);
        Self { groups: 4, films: 8, compared: MAX_FRAMES, samples, seconds, clock }
    }

    /// Timed trials of about so many films, each a scene to prepare, but at least the two films of one group that can share
    /// paths. Where these cannot, others of the group are tried.
    pub fn of_films(scenes: usize, seconds: f64, clock: TimeSource) -> Self {
        let all = Self { seconds, clock, ..Self::of_samples(PilotBudget::PLAN.samples) };
        let films = scenes.clamp(2, all.films);
        let groups = (scenes / films).clamp(1, all.groups);
        Self { groups, films, compared: (scenes / groups).clamp(films, all.compared), ..all }
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

/// What films of a group share.
#[derive(Clone, Copy)]
struct GroupShare {
    /// The mean of its films.
    mean: FilmShare,
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

/// A trial of a group.
struct GroupTrial<'a> {
    sequence: &'a Sequence,
    plan: &'a Plan,
    films: &'a [SharedFilm],
    states: Vec<&'a FrameState>,
    /// A world of small pictures.
    frames: FrameLoop<NullSink>,
    trials: ShareTrials,
}

/// A world whose pictures have so many samples, a pixel at most so many of them.
fn small_pictures(
    sequence: &Sequence,
    state: &FrameState,
    (samples, of_pixel): (u64, u32),
) -> FrameLoop<NullSink> {
    let small = downscaled(sequence, state, samples, of_pixel);
    FrameLoop::new(&small, NullSink, Arc::new(ProgressMeter::default()))
}

/// A trial, and the times of a ray of films that are traced together and alone, if it was timed.
struct TimedTrial {
    trial: SharingTrial,
    per_ray: Option<[ElapsedTime; 2]>,
}

/// The time of a ray, from the times of few and of many of them. What takes the same time for all pictures does not count, as
/// it is nothing beside a run. It can only have made rays look slower.
fn per_ray((few_took, few): (ElapsedTime, &Counts), (took, many): (ElapsedTime, &Counts)) -> ElapsedTime {
    let [few, many] = [few, many].map(|counts| counts.rays.total());
    let (whole, more) = (took * (1.0 / many.max(1) as f64), took - few_took);
    let more = more * (1.0 / many.saturating_sub(few).max(1) as f64);
    let less = |more: f64, whole: f64| if many > few && more > 0.0 { min(more, whole) } else { whole };
    let cpu = more.cpu.zip(whole.cpu).map(|(more, whole)| less(more, whole));
    ElapsedTime { wall: less(more.wall, whole.wall), cpu }
}

/// How the films of a group are divided into those that are traced together. Films behind them are taken to be like them.
struct Division {
    /// The first film of each part, and the number of its films.
    parts: Vec<(usize, usize)>,
    /// All films of the parts and between them.
    films: usize,
    /// Why films could not be added to those before them, if some could not.
    obstacle: Option<PathObstacle>,
}

impl<'a> GroupTrial<'a> {
    fn new(
        sequence: &'a Sequence,
        plan: &'a Plan,
        (first, films): (usize, usize),
        trials: ShareTrials,
    ) -> Self {
        let films = &plan.films[first..first + films];
        let states: Vec<&FrameState> = films.iter().map(|film| &plan.states.frames[film.frames[0]]).collect();
        let frames = small_pictures(sequence, states[0], (trials.samples, 1));
        Self { sequence, plan, films, states, frames, trials }
    }

    /// Divides the group as a run does, by scenes alone.
    fn divide(&mut self) -> Result<Division, FrameError> {
        let Self { plan, films, states, frames, trials, .. } = self;
        let mut found = Division { parts: Vec::new(), films: 0, obstacle: None };
        let memory = plan.scenes_budget();
        let two = frames.fitting(&states[..states.len().min(2)], &Plan::lit(films), memory)?;
        let most = trials.compared.min((2 * MAX_COPIES / two.bytes.max(1)) as usize).max(2);
        let (mut tries, mut compared) = (Tries::default(), 0);
        while found.films + 1 < films.len() && compared < most {
            let first = found.films;
            let end = films.len().min(first + (most - compared).max(2));
            let fitting = frames.fitting(&states[first..end], &Plan::lit(&films[first..]), memory)?;
            compared += fitting.frames.max(1);
            found.obstacle = found.obstacle.or(fitting.end);
            // The limit of comparisons is no reason to end a part.
            let is_cut = fitting.frames > 0 && fitting.end.is_none();
            let part = if is_cut { films.len() - first } else { fitting.frames };
            if part > 0 {
                found.parts.push((first, part));
            }
            found.films += tries.next(films.len() - first, part, true);
        }
        Ok(found)
    }

    /// Traces films, each of which stands for so many of the group, together and alone, with one sample of each pixel. If there
    /// is a limit of time, also gives the times of a ray of those that are traced together and alone.
    fn trace(
        &mut self,
        (few, times): (&[&FrameState], f64),
        lit: &[LayerId],
    ) -> Result<Option<TimedTrial>, FrameError> {
        let ShareTrials { samples, groups, seconds, clock, .. } = self.trials;
        let memory = self.plan.scenes_budget();
        let trial = |size: (u64, u32)| {
            let mut frames = small_pictures(self.sequence, few[0], size);
            frames.try_together((few, times), lit, memory, clock)
        };
        let Some(counted) = trial((samples, 1))? else { return Ok(None) };
        if seconds == 0.0 {
            return Ok(Some(TimedTrial { trial: counted, per_ray: None }));
        }
        let took = (counted.took + counted.took_alone).wall.max(1e-9);
        let left = seconds / groups as f64 - took;
        let fitting = (0.8 * left / took * samples as f64).clamp(samples as f64, LARGEST) as u64;
        let small = trial((fitting / 4, MOST_OF_PIXEL))?;
        let Some((small, large)) = small.zip(trial((fitting, MOST_OF_PIXEL))?) else { return Ok(None) };
        let together = per_ray((small.took, &small.counts), (large.took, &large.counts));
        let alone = per_ray((small.took_alone, &small.counts_alone), (large.took_alone, &large.counts_alone));
        Ok(Some(TimedTrial { trial: counted, per_ray: Some([together, alone]) }))
    }

    /// What its films share, by tracing some of them together and alone.
    fn share(mut self) -> GroupShare {
        let whole = GroupShare { mean: FilmShare::WHOLE, obstacle: None };
        let Ok(Division { parts, films, obstacle }) = self.divide() else { return whole };
        let whole = GroupShare { obstacle, ..whole };
        // The largest part stands for the others.
        let Some(&(first, count)) = parts.iter().max_by_key(|(_, count)| count) else { return whole };
        // Evenly spaced, because objects move faster at some times than at others.
        let chosen = count.min(self.trials.films);
        let few: Vec<&FrameState> =
            (0..chosen).map(|index| self.states[first + (2 * index + 1) * count / (2 * chosen)]).collect();
        let (lit, times) = (Plan::lit(&self.films[first..]), count as f64 / chosen as f64);
        let Ok(Some(TimedTrial { trial, per_ray })) = self.trace((&few, times), &lit) else { return whole };
        let (counts, traced) = (&trial.counts, chosen as f64);
        if !sharing_would_pay(counts, times) {
            return GroupShare { obstacle: Some(PathObstacle::Changes).or(obstacle), ..whole };
        }
        let SharedPaths { all: paths, whole, retraced, once, once_rays, .. } = counts.paths;
        let (each, each_alone) =
            (1.0 / paths.max(1) as f64, 1.0 / trial.counts_alone.paths.all.max(1) as f64);
        // Per path of all films: what is traced once for the films of the trial is traced once for each part.
        let shared: usize = parts.iter().map(|(_, count)| count).sum();
        let once_factor = parts.len() as f64 * traced / films as f64;
        let share = shared as f64 / films as f64;
        let mean = |once: f64, again: f64, alone: f64| {
            once_factor * each * once + share * each * again + (1.0 - share) * each_alone * alone
        };
        let rays = counts.rays.total();
        let alone = trial.counts_alone;
        let of_shared = mean(once_rays as f64, (rays - once_rays) as f64, 0.0);
        let of_others = mean(0.0, 0.0, alone.rays.total() as f64);
        let mean = FilmShare {
            paths: mean(once as f64, (retraced + whole) as f64, alone.paths.all as f64).min(1.0),
            rays: Some(of_shared + of_others),
            time: per_ray.map(|[together, alone]| together * of_shared + alone * of_others),
        };
        GroupShare { mean, obstacle }
    }
}
