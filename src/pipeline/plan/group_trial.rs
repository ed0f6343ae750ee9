//! A trial of a group of films that may share paths: traces some of them together and alone, in small pictures.

use super::path_shares::{FilmShare, ShareTrials};
use super::ray_estimate::{NullSink, downscaled};
use super::render_plan::Plan;
use super::shared_films::SharedFilm;
use super::tries::Tries;
use crate::base::clock::ElapsedTime;
use crate::base::math::min;
use crate::base::stats::{ProgressMeter, SharedPaths};
use crate::film::LayerId;
use crate::pipeline::schedule::{FrameError, FrameLoop, FrameState, SharingTrial};
use crate::sequence::Sequence;
use crate::trace::{PathObstacle, sharing_would_pay};
use std::sync::Arc;

/// What films of a group share.
#[derive(Clone, Copy)]
pub struct GroupShare {
    /// The mean of its films.
    pub mean: FilmShare,
    /// Why films share none, if some do not.
    pub obstacle: Option<PathObstacle>,
}

/// A trial of a group.
pub struct GroupTrial<'a> {
    sequence: &'a Sequence,
    plan: &'a Plan,
    films: &'a [SharedFilm],
    states: Vec<&'a FrameState>,
    /// A world of small pictures.
    frames: FrameLoop<NullSink>,
    trials: ShareTrials,
}

/// How the films of a group are divided into those that are traced together. Films behind them are taken to be like them.
struct Division {
    parts: Vec<Part>,
    /// All films of the parts and between them.
    films: usize,
    /// Why films could not be added to those before them, if some could not.
    obstacle: Option<PathObstacle>,
}

/// Films that are traced together, of which the first ones were compared.
#[derive(Clone, Copy)]
struct Part {
    first: usize,
    films: usize,
    compared: usize,
}

/// The times of a ray of films that are traced together, and of films alone.
#[derive(Clone, Copy)]
struct RayTimes {
    together: ElapsedTime,
    alone: ElapsedTime,
}

/// The most samples of a picture. Larger ones show no more.
const LARGEST: f64 = 262_144.0;

/// The most samples of a pixel of a picture whose tracing is timed. The time that a pixel takes is divided among them.
const MOST_OF_PIXEL: u32 = 9;

/// Maximum bytes of the copies of scenes that are made to compare films, if all are as large as those of the first two.
const MAX_COPIES: u64 = 1 << 27;

impl<'a> GroupTrial<'a> {
    /// A trial of so many films from the first one on.
    pub fn new(
        sequence: &'a Sequence,
        plan: &'a Plan,
        (first, films): (usize, usize),
        trials: ShareTrials,
    ) -> Self {
        let films = &plan.films[first..first + films];
        let states: Vec<&FrameState> = films.iter().map(|film| &plan.states.frames[film.frames[0]]).collect();
        let small = downscaled(sequence, states[0], trials.samples, 1);
        let frames = FrameLoop::new(&small, NullSink, Arc::new(ProgressMeter::default()));
        Self { sequence, plan, films, states, frames, trials }
    }

    /// What its films share.
    pub fn share(mut self) -> GroupShare {
        let nothing = GroupShare { mean: FilmShare::WHOLE, obstacle: None };
        let Ok(division) = self.divide() else { return nothing };
        let nothing = GroupShare { obstacle: division.obstacle, ..nothing };
        // The largest part stands for the others.
        let Some(part) = division.parts.iter().max_by_key(|part| part.films) else { return nothing };
        let traced = part.compared.min(self.trials.films);
        let times = part.films as f64 / traced as f64;
        let Ok(Some((trial, per_ray))) = self.trace(part, (traced, times)) else { return nothing };
        match sharing_would_pay(&trial.counts, times) {
            true => GroupShare { mean: mean_share(&division, traced, &trial, per_ray), ..nothing },
            false => GroupShare { obstacle: Some(PathObstacle::Changes), ..nothing },
        }
    }

    /// Divides the group by scenes alone, as a run does if sharing pays.
    fn divide(&mut self) -> Result<Division, FrameError> {
        let Self { plan, films, states, frames, trials, .. } = self;
        let memory = plan.scenes_budget();
        let two = frames.fitting(&states[..states.len().min(2)], &Plan::lit(films), memory)?;
        let most = trials.compared.min((MAX_COPIES / two.bytes.max(1)) as usize).max(2);
        let mut found = Division { parts: Vec::new(), films: 0, obstacle: None };
        let (mut tries, mut compared) = (Tries::default(), 0);
        while found.films + 1 < films.len() && compared < most {
            let first = found.films;
            let end = films.len().min(first + (most - compared).max(2));
            let fitting = frames.fitting(&states[first..end], &Plan::lit(&films[first..]), memory)?;
            compared += fitting.frames.max(1);
            found.obstacle = found.obstacle.or(fitting.end);
            let mut part = Part { first, films: fitting.frames, compared: fitting.frames };
            if part.films > 0 {
                // The limit of comparisons is no reason to end a part, if nothing has ended one so far.
                if found.obstacle.is_none() {
                    part.films = films.len() - first;
                }
                found.parts.push(part);
            }
            found.films += tries.next(films.len() - first, part.films, true);
        }
        Ok(found)
    }

    /// Traces some films of a part, each of which stands for so many: with one sample of each pixel, to count rays, and if
    /// there is a limit of time, in two sizes with more samples of a pixel, to time them. None if they cannot share paths.
    fn trace(
        &mut self,
        part: &Part,
        (traced, times): (usize, f64),
    ) -> Result<Option<(SharingTrial, Option<RayTimes>)>, FrameError> {
        let Self { sequence, plan, films, states, frames, trials } = self;
        let ShareTrials { samples, groups, seconds, clock, .. } = *trials;
        // Evenly spaced, because objects move faster at some times than at others.
        let place = |index: usize| part.first + (2 * index + 1) * part.compared / (2 * traced);
        let few: Vec<&FrameState> = (0..traced).map(|index| states[place(index)]).collect();
        let lit: Vec<LayerId> = Plan::lit(&films[part.first..]);
        let picture = |samples: u64, of_pixel: u32| downscaled(sequence, few[0], samples, of_pixel);
        let mut fitting = samples;
        let mut next = |done: &[SharingTrial]| match done {
            [] => Some(picture(samples, 1)),
            [counted] if seconds > 0.0 => {
                let took = (counted.took + counted.took_alone).wall.max(1e-9);
                let left = 0.8 * (seconds / groups as f64 - took);
                fitting = (left / took * samples as f64).clamp(samples as f64, LARGEST) as u64;
                Some(picture(fitting, MOST_OF_PIXEL))
            }
            [_, _] => Some(picture(fitting / 4, MOST_OF_PIXEL)),
            _ => None,
        };
        let budget = (plan.scenes_budget(), clock);
        let found = frames.try_together((&few, times), &lit, budget, &mut next)?;
        let Some(counted) = found.first() else { return Ok(None) };
        let times = found.get(1).zip(found.get(2)).map(|(large, small)| RayTimes {
            together: time_per_ray([small, large].map(|of| (of.took, of.counts.rays.total()))),
            alone: time_per_ray([small, large].map(|of| (of.took_alone, of.counts_alone.rays.total()))),
        });
        Ok(Some((*counted, times)))
    }
}

/// The mean share of all films, by a trial of so many of them.
fn mean_share(
    Division { parts, films, .. }: &Division,
    traced: usize,
    trial: &SharingTrial,
    per_ray: Option<RayTimes>,
) -> FilmShare {
    let SharedPaths { all, whole, retraced, once, once_rays, .. } = trial.counts.paths;
    let (rays, alone) = (trial.counts.rays.total(), &trial.counts_alone);
    let (all, all_alone) = (all.max(1) as f64, alone.paths.all.max(1) as f64);
    let sharing: usize = parts.iter().map(|part| part.films).sum();
    let sharing = sharing as f64 / *films as f64;
    // What is traced once for the films of the trial is traced once for each part.
    let onces = (parts.len() * traced) as f64 / *films as f64;
    // Per path of all films: of those that share paths, and of the others.
    let shared = |once: u64, again: u64| (onces * once as f64 + sharing * again as f64) / all;
    let others = |alone: u64| (1.0 - sharing) * alone as f64 / all_alone;
    let (shared_rays, other_rays) = (shared(once_rays, rays - once_rays), others(alone.rays.total()));
    FilmShare {
        paths: min(shared(once, retraced + whole) + others(alone.paths.all), 1.0),
        rays: Some(shared_rays + other_rays),
        time: per_ray.map(|RayTimes { together, alone }| together * shared_rays + alone * other_rays),
    }
}

/// The time of a ray, from the times of few and of many rays. What takes the same time for all pictures is left out, as it is
/// nothing beside a run: it can only have made rays look slower.
fn time_per_ray([(few_took, few), (took, many)]: [(ElapsedTime, u64); 2]) -> ElapsedTime {
    let of_all = took * (1.0 / many.max(1) as f64);
    // Between pictures of nearly the same size, there would be little but noise.
    if many < 2 * few {
        return of_all;
    }
    let of_more = (took - few_took) * (1.0 / (many - few).max(1) as f64);
    let less = |more: f64, all: f64| if more > 0.0 { min(more, all) } else { all };
    let cpu = of_more.cpu.zip(of_all.cpu).map(|(more, all)| less(more, all));
    ElapsedTime { wall: less(of_more.wall, of_all.wall), cpu }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::stats::{Counts, RayCounts};

    #[test]
    fn what_all_pictures_take_is_no_part_of_a_ray() {
        let took = |wall: f64| ElapsedTime { wall, cpu: Some(2.0 * wall) };
        let time = |few: (f64, u64), many: (f64, u64)| {
            let found = time_per_ray([few, many].map(|(wall, rays)| (took(wall), rays)));
            assert_eq!(found.cpu, Some(2.0 * found.wall));
            found.wall
        };
        assert_eq!(time((3.0, 1), (6.0, 4)), 1.0, "two seconds for each picture");
        assert_eq!(time((1.0, 1), (8.0, 4)), 2.0, "more for later rays is not what pictures take");
        assert_eq!(time((5.0, 1), (4.0, 4)), 1.0, "noise");
        assert_eq!(time((3.0, 3), (8.0, 4)), 2.0, "nearly the same size");
        assert_eq!(time((0.0, 0), (0.0, 0)), 0.0);
    }

    /// Ten films: two parts of three and five of them, and two alone. Each has ten paths, half of which are traced again.
    #[test]
    fn every_part_traces_its_paths_once() {
        let part = |first, films| Part { first, films, compared: films };
        let division = Division { parts: vec![part(0, 3), part(4, 5)], films: 10, obstacle: None };
        let rays = |shadow| RayCounts { shadow, ..RayCounts::default() };
        let paths = SharedPaths { all: 40, once: 10, once_rays: 20, retraced: 20, ..SharedPaths::default() };
        let counts = Counts { paths, rays: rays(20 + 60), ..Counts::default() };
        let paths = SharedPaths { all: 20, whole: 20, ..SharedPaths::default() };
        let counts_alone = Counts { paths, rays: rays(50), ..Counts::default() };
        let (took, took_alone) = (ElapsedTime::ZERO, ElapsedTime::ZERO);
        let trial = SharingTrial { counts, counts_alone, took, took_alone };
        let second = |wall| ElapsedTime { wall, cpu: None };
        let times = RayTimes { together: second(1.0), alone: second(10.0) };
        let FilmShare { paths, rays, time } = mean_share(&division, 4, &trial, Some(times));
        // Of 100 paths, 20 once, 40 again and 20 alone. Of their rays, 40 once, 120 again and 50 alone.
        assert!((paths - 0.8).abs() < 1e-12, "{paths}");
        assert!(rays.is_some_and(|rays| (rays - 2.1).abs() < 1e-12), "{rays:?}");
        assert!(time.is_some_and(|time| (time.wall - (1.6 + 5.0)).abs() < 1e-12), "{time:?}");
    }
}
