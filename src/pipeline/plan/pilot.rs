//! How many rays a plan will trace: counted in a few small pictures.
//!
//! What a frame's rays meet hardly depends on how many they are. So some of the frames are traced with a small part of
//! their samples, and counted up. Rays of the camera need no trial where the number of samples is set: they are known
//! exactly, unless an error is to be reached: then there are at least so many. How many it takes is found by an
//! [`outlook`](super::outlook).

use super::Plan;
use crate::base::stats::Meter;
use crate::encode::EncodeError;
use crate::film::{Film, LayerId};
use crate::pipeline::schedule::{FilmSink, FrameLoop, Look};
use crate::sequence::Sequence;
use crate::trace::LEAST_SAMPLES;
use std::sync::Arc;

/// What a run is expected to trace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Expected {
    /// Rays of the camera: frame by frame, and with the films of the plan.
    pub camera_alone: u64,
    pub camera: u64,
    /// Whether those are exact. If an error is to be reached they are the least that there can be.
    pub exact: bool,
    /// Rays of all kinds, where pilots were traced.
    pub rays_alone: Option<u64>,
    pub rays: Option<u64>,
}

/// How much a pilot may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Frames that are traced, at most, in each of the two ways.
    pub frames: usize,
    /// Samples of one of them, at most.
    pub samples: u64,
}

impl Effort {
    /// For whoever asks for nothing else.
    pub const PLAN: Self = Self { frames: 24, samples: 1 << 14 };
    /// Nothing is traced: only rays of the camera are told, and the least that there can be where an error is asked for.
    pub const NONE: Self = Self { frames: 0, samples: 0 };
}

/// What the films of a plan are expected to take.
#[derive(Clone, Debug, PartialEq)]
pub struct Work {
    /// All of them together. Of frames one by one only rays of the camera are told.
    pub expected: Expected,
    /// Rays of each film, in the order in which they are traced.
    pub films: Vec<f64>,
}

/// Takes films that nobody wants.
pub struct Nowhere;

impl FilmSink for Nowhere {
    fn push(&mut self, _frame: u32, _film: Film) -> Result<(), EncodeError> {
        Ok(())
    }
}

impl Expected {
    /// Only what is known without tracing anything.
    pub fn of(sequence: &Sequence, plan: &Plan) -> Self {
        let looks = &plan.survey.frames;
        let camera = plan.takes.iter().map(|take| samples(sequence, &looks[take.frames[0]])).sum();
        let camera_alone = looks.iter().map(|look| samples(sequence, look)).sum();
        let exact = sequence.quality.noise.is_none() || !looks.iter().any(|look| look.random);
        Self { camera_alone, camera, exact, rays_alone: None, rays: None }
    }
}

/// What a plan of the sequence will trace, from pictures of some of its frames.
pub fn pilot(sequence: &Sequence, plan: &Plan, effort: Effort) -> Expected {
    let expected = work(sequence, plan, effort).expected;
    if plan.reused() == 0 {
        return Expected { camera_alone: expected.camera, rays_alone: expected.rays, ..expected };
    }
    let looks = &plan.survey.frames;
    let alone: Vec<Exposure> = looks.iter().map(|look| (look, look.lit())).collect();
    let trials = trials(sequence, &alone, effort).unwrap_or_default();
    Expected { rays_alone: counted_up(sequence, &alone, &trials), ..expected }
}

/// What the films of a plan will take: their samples are known, and each of them is taken to send as many rays as those
/// of the film nearest to it that is tried. Without a trial, only rays of the camera are told.
pub fn work(sequence: &Sequence, plan: &Plan, effort: Effort) -> Work {
    let looks = &plan.survey.frames;
    let films: Vec<Exposure> =
        plan.takes.iter().map(|take| (&looks[take.frames[0]], take.lit.clone())).collect();
    let trials = trials(sequence, &films, effort).unwrap_or_default();
    let known = Expected::of(sequence, plan);
    let rays = |(film, (look, _)): (usize, &Exposure)| {
        let nearest = trials.get(film * trials.len() / films.len());
        let each =
            nearest.filter(|trial| trial.samples > 0.0).map_or(1.0, |trial| trial.rays / trial.samples);
        samples(sequence, look) as f64 * each
    };
    Work {
        expected: Expected { rays: counted_up(sequence, &films, &trials), ..known },
        films: films.iter().enumerate().map(rays).collect(),
    }
}

/// A look, and the layers of light that it is traced with.
type Exposure<'a> = (&'a Look, Vec<LayerId>);

/// Camera rays of a film; the least that there are where an error is asked for.
pub fn samples(sequence: &Sequence, look: &Look) -> u64 {
    let (width, height) = sequence.output.size;
    let quality = &sequence.quality;
    let each = match quality.noise {
        _ if !look.random => quality.antialias * quality.antialias,
        Some(target) => target.most.min(LEAST_SAMPLES),
        None => quality.samples,
    };
    if look.fault.is_some() { 0 } else { u64::from(width) * u64::from(height) * u64::from(each) }
}

/// The rays of films, from those of some of them, spread evenly over their order. None without a trial.
fn counted_up(sequence: &Sequence, films: &[Exposure], trials: &[Trial]) -> Option<u64> {
    let sum = |part: fn(&Trial) -> f64| trials.iter().map(part).sum::<f64>();
    let (traced, rays) = (sum(|trial| trial.samples), sum(|trial| trial.rays));
    let all: f64 = films.iter().map(|(look, _)| samples(sequence, look) as f64).sum();
    (traced > 0.0).then(|| (all / traced * rays).round() as u64)
}

/// What a film took that was tried.
struct Trial {
    samples: f64,
    rays: f64,
}

/// Traces some of the films with a small part of their samples: each of them stands for as many that are its neighbours.
fn trials(sequence: &Sequence, films: &[Exposure], effort: Effort) -> Option<Vec<Trial>> {
    let chosen = films.len().min(effort.frames);
    let trial = |index: usize| {
        let (look, lit) = &films[(2 * index + 1) * films.len() / (2 * chosen)];
        let small = shrunk(sequence, look, effort.samples);
        let mut frames = FrameLoop::new(&small, Nowhere, Arc::new(Meter::default()));
        frames.trace(look, lit).ok()?;
        let counts = frames.tally().counts.rays;
        let samples = samples(&small, look) as f64;
        Some(Trial { samples, rays: counts.total() as f64 })
    };
    (0..chosen).map(trial).collect()
}

/// A sequence of which a frame has so many samples, spread over as many pixels as there are.
pub fn shrunk(sequence: &Sequence, look: &Look, samples: u64) -> Sequence {
    let mut small = sequence.clone();
    small.quality.antialias = 1;
    small.quality.samples = sequence.quality.samples.min(look.moments);
    if small.quality.noise.take().is_some() {
        small.quality.samples = LEAST_SAMPLES;
    }
    let (width, height) = sequence.output.size;
    let each = small.quality.samples.max(1);
    let pixels = samples / u64::from(each);
    let share = (pixels as f64 / (f64::from(width) * f64::from(height))).sqrt().min(1.0);
    let side = |whole: u32| ((f64::from(whole) * share).round() as u32).clamp(1, whole);
    small.output.size = (side(width), side(height));
    small
}
