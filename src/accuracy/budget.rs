//! How many samples fit into a time: a pilot of a few frames tells what a sample costs, and what it gives.

use super::clock::Took;
use super::studio::Studio;
use crate::filmstrip::spread;
use crate::quality::{MOST_SAMPLES, NoiseTarget, Quality};
use crate::render::RenderError;
use crate::sampling::Points;
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::time::Duration;

/// Samples that fit, and what to expect of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// With as many samples as fit: random ones, or on a grid where nothing is random.
    pub quality: Quality,
    /// Seconds that tracing all frames should take.
    pub wall: f64,
    /// Of all processors together, where the system tells.
    pub cpu: Option<f64>,
    /// Expected of the worst frame, as a share of brightness; none where nothing is random.
    pub error: Option<f64>,
    /// Seconds that the pilot took.
    pub spent: f64,
}

/// Frames that are looked at.
const PILOTS: u32 = 5;
/// Share of the time that may be spent on finding out.
const SHARE: f64 = 0.08;
/// Samples of the pilot's second look: one of each set, or several.
const SETS: u32 = crate::trace::SETS as u32;

/// A frame's cost: seconds without any sample, and for each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Cost {
    base: f64,
    each: f64,
}

impl Cost {
    /// Of what so many and so many samples took.
    fn between((few, short): (f64, f64), (many, long): (f64, f64)) -> Self {
        let each = ((long - short) / (many - few)).max(0.0);
        Self { base: (short - each * few).max(0.0), each }
    }

    fn of(self, samples: f64) -> f64 {
        self.base + self.each * samples
    }
}

/// What a pilot frame told.
struct Pilot {
    frame: u32,
    wall: Cost,
    cpu: Option<Cost>,
    /// Its error with one sample, if it has any.
    error: Option<f64>,
}

/// Finds how many samples fit into `limit` seconds of tracing `frames`, the pilot included.
pub fn budget(
    sequence: &Sequence,
    frames: &[u32],
    limit: Duration,
    threads: Option<NonZeroUsize>,
) -> Result<Budget, RenderError> {
    let limit = limit.as_secs_f64();
    let own = Quality { noise: None, ..sequence.quality };
    let places = spread(frames.len() as u32, PILOTS);
    let mut pilots = Vec::new();
    let mut spent = 0.0;
    for (done, &place) in places.iter().enumerate() {
        let frame = frames[place as usize];
        let studio = Studio::new(sequence, &[frame], threads)?;
        let share = (SHARE * limit - spent) / (places.len() - done) as f64;
        let (pilot, took) = look(&studio, frame, &own, share)?;
        spent += took;
        pilots.push(pilot);
    }
    let total = |cost: &dyn Fn(&Pilot) -> Option<Cost>| summed(&pilots, frames, cost);
    let wall = total(&|pilot| Some(pilot.wall)).unwrap_or_default();
    let fitting = fitting(limit - spent, wall);
    let random = pilots.iter().any(|pilot| pilot.error.is_some());
    let (samples, quality) = if random {
        (fitting.floor(), Quality { samples: fitting as u32, ..own })
    } else {
        let antialias = (fitting.sqrt() as u32).clamp(1, 64);
        (f64::from(antialias * antialias), Quality { antialias, ..own })
    };
    let worst = pilots.iter().filter_map(|pilot| pilot.error).reduce(f64::max);
    Ok(Budget {
        quality,
        wall: wall.of(samples),
        cpu: total(&|pilot| pilot.cpu).map(|cost| cost.of(samples)),
        // As independent samples would; stratified ones are better.
        error: worst.map(|error| error / samples.sqrt()),
        spent,
    })
}

/// How many samples fit into so many seconds; one at least.
fn fitting(seconds: f64, cost: Cost) -> f64 {
    ((seconds - cost.base) / cost.each).clamp(1.0, f64::from(MOST_SAMPLES))
}

/// Looks at a frame twice, with few samples and with more, in about so many seconds.
fn look(studio: &Studio, frame: u32, own: &Quality, seconds: f64) -> Result<(Pilot, f64), RenderError> {
    let started = [studio.shoot(&sampled(own, SETS))?, studio.shoot(&sampled(own, SETS))?];
    let random = started[1].films.iter().find_map(|film| film.noise);
    let few = if random.is_some() { SETS } else { own.antialias * own.antialias };
    let (first, second) = (started[0].took, started[1].took);
    let spent = first.wall + second.wall;
    // Five to twenty times as many, as far as there is time.
    let rounds = ((seconds - spent) / second.wall).clamp(2.0, 16.0) as u32;
    let (many, quality) = match random {
        Some(_) => (SETS * rounds, sampled(own, SETS * rounds)),
        None => {
            let antialias = own.antialias + 1 + u32::from(rounds > 4);
            (antialias * antialias, Quality { antialias, ..*own })
        }
    };
    let long = studio.shoot(&quality)?;
    let cost = |of: &dyn Fn(&Took) -> Option<f64>| {
        Some(Cost::between((f64::from(few), of(&second)?), (f64::from(many), of(&long.took)?)))
    };
    let noise = long.films.iter().find_map(|film| film.noise);
    let pilot = Pilot {
        frame,
        wall: cost(&|took| Some(took.wall)).unwrap_or_default(),
        cpu: cost(&|took| took.cpu),
        error: noise.map(|noise| noise.high * f64::from(many).sqrt()),
    };
    Ok((pilot, spent + long.took.wall))
}

/// So many samples everywhere, with a look at their error.
fn sampled(own: &Quality, samples: u32) -> Quality {
    // Nothing compares with it, so that not even what has no noise is ever good enough.
    Quality { noise: Some(NoiseTarget { error: f64::NAN, most: samples }), points: Points::Sobol, ..*own }
}

/// The cost of all frames: between pilots it changes evenly.
fn summed(pilots: &[Pilot], frames: &[u32], cost: &dyn Fn(&Pilot) -> Option<Cost>) -> Option<Cost> {
    let mut sum = Cost::default();
    for &frame in frames {
        let after = pilots.iter().position(|pilot| pilot.frame >= frame).unwrap_or(pilots.len() - 1);
        let before = after.saturating_sub(usize::from(pilots[after].frame > frame));
        let (a, b) = (&pilots[before], &pilots[after]);
        let width = f64::from(b.frame.saturating_sub(a.frame)).max(1.0);
        let part = (f64::from(frame.saturating_sub(a.frame)) / width).min(1.0);
        let (a, b) = (cost(a)?, cost(b)?);
        sum.base += a.base * (1.0 - part) + b.base * part;
        sum.each += a.each * (1.0 - part) + b.each * part;
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pilot(frame: u32, base: f64, each: f64) -> Pilot {
        Pilot { frame, wall: Cost { base, each }, cpu: None, error: None }
    }

    #[test]
    fn costs_are_lines() {
        let cost = Cost::between((4.0, 1.0), (64.0, 13.0));
        assert!((cost.each - 0.2).abs() < 1e-12 && (cost.base - 0.2).abs() < 1e-12);
        assert_eq!(Cost::between((4.0, 1.0), (64.0, 0.5)), Cost { base: 1.0, each: 0.0 });
    }

    #[test]
    fn frames_between_pilots_cost_what_lies_between() {
        let pilots = [pilot(10, 1.0, 0.0), pilot(14, 5.0, 4.0)];
        let sum = summed(&pilots, &[10, 11, 12, 13, 14], &|pilot| Some(pilot.wall)).expect("a cost");
        assert!((sum.base - 15.0).abs() < 1e-12 && (sum.each - 10.0).abs() < 1e-12, "{sum:?}");
        assert_eq!(summed(&pilots, &[10], &|pilot| pilot.cpu), None);
        let one = summed(&pilots[..1], &[10, 10], &|pilot| Some(pilot.wall));
        assert_eq!(one, Some(Cost { base: 2.0, each: 0.0 }));
    }

    #[test]
    fn more_time_is_more_samples() {
        let cost = Cost { base: 0.5, each: 0.25 };
        assert_eq!([1.0, 2.0, 4.0].map(|seconds| fitting(seconds, cost)), [2.0, 6.0, 14.0]);
        assert_eq!(fitting(0.1, cost), 1.0, "one at least");
        assert_eq!(fitting(1.0, Cost::default()), f64::from(MOST_SAMPLES), "what costs nothing");
    }
}
