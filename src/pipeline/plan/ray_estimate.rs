//! Estimates the number of rays of a plan from a few small pictures.
//!
//! What rays hit hardly depends on their number. So this module traces some frames with few samples and
//! scales the counts. The number of camera rays is exact if the number of samples is set. With a target error it is a
//! lower bound; an [`outlook`](super::outlook) estimates the real number.

use super::camera_rays::{camera_rays, camera_rays_in_order};
use super::path_shares::{FilmShare, ShareTrials, path_shares};
use super::render_plan::Plan;
use crate::base::stats::ProgressMeter;
use crate::encode::EncodeError;
use crate::film::{Film, LayerId};
use crate::pipeline::schedule::{FilmSink, FrameLoop, FrameState};
use crate::sequence::Sequence;
use crate::sequence::quality::Denoise;
use crate::trace::{MIN_SAMPLES, PathObstacle};
use std::sync::Arc;

/// Expected numbers of rays of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayEstimate {
    /// Camera rays: without and with shared films.
    pub camera_alone: u64,
    pub camera: u64,
    /// Whether the number of camera rays with shared films is known. With a target error or shared views, it is a lower bound.
    pub exact: bool,
    /// Whether the number of camera rays without shared films is known. With a target error, it is a lower bound.
    pub exact_alone: bool,
    /// Whether films may share paths. Then the number of camera rays is an upper bound, or an estimate if pilots were
    /// traced.
    pub shares_paths: bool,
    /// Whether films share samples of views. Then the number of camera rays leaves out those of pixels that lack samples.
    pub shares_views: bool,
    /// Why some films that may share paths do not, if pilots were traced.
    pub path_obstacle: Option<PathObstacle>,
    /// Rays of all kinds, if pilots were traced.
    pub rays_alone: Option<u64>,
    pub rays: Option<u64>,
}

/// Limits of a pilot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PilotBudget {
    /// Maximum number of traced frames, each for runs with and without shared films.
    pub frames: usize,
    /// Maximum number of samples of a frame.
    pub samples: u64,
}

impl PilotBudget {
    /// The default.
    pub const PLAN: Self = Self { frames: 24, samples: 1 << 14 };
    /// Traces nothing, so that only camera rays are known.
    pub const NONE: Self = Self { frames: 0, samples: 0 };
}

/// Expected cost of the films of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct CostEstimate {
    /// Sum over all films. Without shared films, only camera rays are known.
    pub expected: RayEstimate,
    /// Rays of each film, in the order of tracing.
    pub films: Vec<f64>,
    /// Rays of all films if none of them share paths.
    unshared: Option<u64>,
}

/// A sink that drops all films.
pub struct NullSink;

impl FilmSink for NullSink {
    fn push(&mut self, _frame: u32, _film: Film) -> Result<(), EncodeError> {
        Ok(())
    }
}

impl RayEstimate {
    /// The estimate that needs no tracing.
    pub fn of(sequence: &Sequence, plan: &Plan) -> Self {
        let states = &plan.states.frames;
        let camera = camera_rays_of_films(sequence, plan);
        let alone = states.iter().map(|state| (state, state.lit()));
        let camera_alone = camera_rays_in_order(sequence, alone).iter().sum();
        let shares_views = !plan.view_groups.is_empty();
        let has_target = sequence.quality.noise.is_some() && states.iter().any(|state| state.random);
        let (exact, exact_alone) = (!has_target && !shares_views, !has_target);
        let shares_paths = (0..plan.films.len()).any(|film| plan.together(film) > 1);
        let (path_obstacle, rays_alone, rays) = (None, None, None);
        Self {
            camera_alone,
            camera,
            exact,
            exact_alone,
            shares_paths,
            shares_views,
            path_obstacle,
            rays_alone,
            rays,
        }
    }
}

/// The camera rays of all films, if none of them share paths.
fn camera_rays_of_films(sequence: &Sequence, plan: &Plan) -> u64 {
    let shares_views = |film: &usize| plan.view_groups.iter().any(|group| group.films.contains(film));
    let alone = (0..plan.films.len()).filter(|film| !shares_views(film));
    let alone = alone.map(|film| (plan.state_of(film), &plan.films[film].lit));
    camera_rays_in_order(sequence, alone).iter().sum::<u64>()
        + plan.view_groups.iter().map(|group| group.camera_rays).sum::<u64>()
}

/// Estimates the rays of a plan from small pictures of some frames.
pub fn estimate_rays(sequence: &Sequence, plan: &Plan, budget: PilotBudget) -> RayEstimate {
    let CostEstimate { expected, unshared, .. } = cost_estimate(sequence, plan, budget);
    if plan.reused() == 0 {
        return RayEstimate { rays_alone: unshared, ..expected };
    }
    let states = &plan.states.frames;
    let alone: Vec<LitFrame> = states.iter().map(|state| (state, state.lit())).collect();
    let trials = trials(sequence, &alone, budget).unwrap_or_default();
    RayEstimate { rays_alone: counted_up(sequence, &alone, &trials), ..expected }
}

/// Estimates the cost of the films of a plan. Each film sends as many rays per sample as the nearest traced film.
/// Without a pilot, only camera rays are known.
pub fn cost_estimate(sequence: &Sequence, plan: &Plan, budget: PilotBudget) -> CostEstimate {
    let states = &plan.states.frames;
    let films: Vec<LitFrame> =
        plan.films.iter().map(|shared| (&states[shared.frames[0]], shared.lit.clone())).collect();
    let trials = trials(sequence, &films, budget).unwrap_or_default();
    let known = RayEstimate::of(sequence, plan);
    let shares = path_shares(sequence, plan, ShareTrials::of_samples(budget.samples));
    let rays = |(film, (state, _)): (usize, &LitFrame)| {
        let nearest = trials.get(film * trials.len() / films.len());
        let each =
            nearest.filter(|trial| trial.samples > 0.0).map_or(1.0, |trial| trial.rays / trial.samples);
        let share = &shares.films[film];
        let each = share.rays.unwrap_or(each * share.paths);
        camera_rays(sequence, state) as f64 * each
    };
    let of_films: Vec<f64> = films.iter().enumerate().map(rays).collect();
    let unshared = counted_up(sequence, &films, &trials);
    let camera = |(film, share): (&LitFrame, &FilmShare)| camera_rays(sequence, film.0) as f64 * share.paths;
    let camera = films.iter().zip(&shares.films).map(camera).sum::<f64>().round();
    let alone = unshared_camera_rays(sequence, &films);
    let traced = if alone > 0 { camera / alone as f64 } else { 1.0 };
    let shares_rays = shares.films.iter().any(|film| film.rays.is_some());
    let all = unshared.map(|rays| match shares_rays {
        true => of_films.iter().sum::<f64>().round() as u64,
        false => (rays as f64 * traced).round() as u64,
    });
    let camera = if known.shares_paths { camera as u64 } else { known.camera };
    CostEstimate {
        expected: RayEstimate { camera, rays: all, path_obstacle: shares.obstacle, ..known },
        films: of_films,
        unshared,
    }
}

/// A frame state, and the layers that are traced.
type LitFrame<'a> = (&'a FrameState, Vec<LayerId>);

/// Extrapolates the rays of all films from some of them. None without a pilot.
fn counted_up(sequence: &Sequence, films: &[LitFrame], trials: &[Trial]) -> Option<u64> {
    let sum = |part: fn(&Trial) -> f64| trials.iter().map(part).sum::<f64>();
    let (traced, rays) = (sum(|trial| trial.samples), sum(|trial| trial.rays));
    let all = unshared_camera_rays(sequence, films) as f64;
    (traced > 0.0).then(|| (all / traced * rays).round() as u64)
}

/// The camera rays of films that share no paths, with those for neighbours.
fn unshared_camera_rays(sequence: &Sequence, films: &[LitFrame]) -> u64 {
    match sequence.quality.uses_neighbors() {
        true => camera_rays_in_order(sequence, films.iter().map(|(state, lit)| (*state, lit))).iter().sum(),
        false => films.iter().map(|(state, _)| camera_rays(sequence, state)).sum(),
    }
}

/// Counts of a traced film.
struct Trial {
    samples: f64,
    rays: f64,
}

/// Traces some films with few samples each. The chosen films are evenly spaced.
fn trials(sequence: &Sequence, films: &[LitFrame], budget: PilotBudget) -> Option<Vec<Trial>> {
    let chosen = films.len().min(budget.frames);
    let trial = |index: usize| {
        let (state, lit) = &films[(2 * index + 1) * films.len() / (2 * chosen)];
        // One in a pixel shows most of a picture.
        let small = downscaled(sequence, state, budget.samples, 1);
        let mut frames = FrameLoop::new(&small, NullSink, Arc::new(ProgressMeter::default()));
        frames.trace(&state.alone(), lit).ok()?;
        let counts = frames.stats().counts.rays;
        let samples = camera_rays(&small, state) as f64;
        Some(Trial { samples, rays: counts.total() as f64 })
    };
    (0..chosen).map(trial).collect()
}

/// A smaller copy of the sequence, in which a frame has about `samples` samples in total. A pixel has at most `most` of
/// them, unless several moments or a target error need more.
pub fn downscaled(sequence: &Sequence, state: &FrameState, samples: u64, most: u32) -> Sequence {
    let mut small = sequence.clone();
    small.quality.antialias = sequence.quality.antialias.min(most.isqrt()).max(1);
    small.quality.denoise = Denoise::Off;
    small.quality.samples = sequence.quality.samples.min(state.moments.max(most));
    if small.quality.noise.take().is_some() {
        small.quality.samples = MIN_SAMPLES;
    }
    let (width, height) = sequence.output.size;
    let share = (samples as f64 / camera_rays(&small, state).max(1) as f64).sqrt().min(1.0);
    let side = |whole: u32| ((f64::from(whole) * share).round() as u32).clamp(1, whole);
    small.output.size = (side(width), side(height));
    small
}
