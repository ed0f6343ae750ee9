//! How many samples fit into a time: a pilot of a few frames tells what a sample costs, and what it gives.

use super::clock::{Clock, Took};
use super::studio::Studio;
use crate::film::{Extras, Noise};
use crate::filmstrip::spread;
use crate::plan::Plan;
use crate::quality::{MOST_SAMPLES, NoiseTarget, Quality};
use crate::render::{RenderError, Request, extras};
use crate::sampling::Points;
use crate::sequence::Sequence;
use std::time::Duration;

/// Samples that fit, and what to expect of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// With as many samples as fit: random ones, or on a grid where nothing is random.
    pub quality: Quality,
    /// Seconds that tracing all films should take.
    pub wall: f64,
    /// Of all processors together, where the system tells.
    pub cpu: Option<f64>,
    /// Expected of the worst frame, as a share of brightness; none where nothing is random.
    pub error: Option<f64>,
    /// Seconds that the pilot took.
    pub spent: f64,
}

/// Films that are looked at in any case; and at most, as far as there is time.
const PILOTS: u32 = 5;
const MORE: u32 = 33;
/// Share of the time that may be spent on finding out.
const SHARE: f64 = 0.08;
/// Samples of the first look, and what others are a multiple of.
const SETS: u32 = 4;

/// A film's cost: seconds without any sample, and for each.
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

    /// Of so many samples, however many others take.
    fn kept(self, samples: f64) -> Self {
        Self { base: self.of(samples), each: 0.0 }
    }

    fn of(self, samples: f64) -> f64 {
        self.base + self.each * samples
    }
}

/// What a film that was looked at told.
struct Pilot {
    /// Its place among the films of the run.
    place: usize,
    wall: Cost,
    cpu: Option<Cost>,
    /// Its error with one sample, if it has any.
    error: Option<f64>,
}

impl Pilot {
    /// Where some films are random, it is their samples that are chosen: the grid of one that is not stays.
    fn keep_grid(&mut self, antialias: u32) {
        if self.error.is_none() {
            let samples = f64::from(antialias * antialias);
            self.wall = self.wall.kept(samples);
            self.cpu = self.cpu.map(|cost| cost.kept(samples));
        }
    }
}

/// Finds how many samples fit into `limit` of tracing the frames of `request`, the pilot included.
pub fn budget(
    sequence: &Sequence,
    request: &Request,
    limit: Duration,
    clock: Clock,
) -> Result<Budget, RenderError> {
    let limit = limit.as_secs_f64();
    let own = Quality { noise: None, ..sequence.quality };
    let sequence = Sequence { quality: own, ..sequence.clone() };
    let extras = extras(&sequence, &request.outputs);
    let studio = Studio::new(&sequence, &request.frames, request.threads)?;
    let room = request.reuse.budget(&sequence, extras);
    let plan = studio.install(|| Plan::new(&sequence, &request.frames, extras, room));
    let films = plan.takes.len();
    let mut places = spread(films as u32, PILOTS);
    let least = places.len();
    let mut more: Vec<u32> = spread(films as u32, MORE).into_iter().filter(|k| !places.contains(k)).collect();
    // In the order of van der Corput, so that wherever time runs out they lie all over the list.
    more.sort_unstable_by_key(|place| place.reverse_bits());
    places.extend(more);
    let stage = Stage { studio, plan, extras, own, clock };
    let mut pilots = Vec::new();
    let mut spent = 0.0;
    for (done, &place) in places.iter().enumerate() {
        let left = SHARE * limit - spent;
        if done >= least && left <= 0.0 {
            break;
        }
        let (pilot, took) = stage.look(place as usize, left / (places.len() - done) as f64)?;
        spent += took;
        pilots.push(pilot);
    }
    pilots.sort_unstable_by_key(|pilot| pilot.place);
    let random = pilots.iter().any(|pilot| pilot.error.is_some());
    if random {
        pilots.iter_mut().for_each(|pilot| pilot.keep_grid(own.antialias));
    }
    let wall = summed(&pilots, films, &|pilot| Some(pilot.wall)).unwrap_or_default();
    let fitting = fitting(limit - spent, wall);
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
        cpu: summed(&pilots, films, &|pilot| pilot.cpu).map(|cost| cost.of(samples)),
        // As independent samples would; stratified ones are better.
        error: worst.map(|error| error / samples.sqrt()),
        spent,
    })
}

/// How many samples fit into so many seconds; one at least.
fn fitting(seconds: f64, cost: Cost) -> f64 {
    ((seconds - cost.base) / cost.each).clamp(1.0, f64::from(MOST_SAMPLES))
}

/// What pilots look at, and how.
struct Stage {
    studio: Studio,
    plan: Plan,
    extras: Extras,
    own: Quality,
    clock: Clock,
}

impl Stage {
    fn shoot(&self, place: usize, quality: &Quality) -> Result<(Took, Option<Noise>), RenderError> {
        let take = &self.plan.takes[place];
        let look = &self.plan.survey.frames[take.frames[0]];
        let shot = self.studio.take(quality, self.extras, look, &take.lit)?;
        let noise = shot.films.iter().find_map(|film| film.noise);
        Ok((self.clock.told(shot.took, shot.rays), noise))
    }

    /// Looks at a film with few samples and with more, in about so many seconds. What is looked at first warms up what
    /// the others find warm, and tells the error.
    fn look(&self, place: usize, seconds: f64) -> Result<(Pilot, f64), RenderError> {
        let (first, random) = self.shoot(place, &sampled(&self.own, SETS))?;
        let each = first.wall / f64::from(if random.is_some() { SETS } else { self.grid(0).1 });
        // Samples that there is time for, half of them for the second cost.
        let room = ((seconds - first.wall) / each / 2.0).clamp(0.0, 1e9);
        let mut spent = first.wall;
        let mut error = random.map(|noise| noise.high * f64::from(SETS).sqrt());
        let costs = match random {
            Some(_) => {
                let rounds = (room as u32 / 2 / SETS).clamp(1, 16);
                let (took, noise) = self.shoot(place, &sampled(&self.own, SETS * rounds))?;
                spent += took.wall;
                error = noise.map(|noise| noise.high * f64::from(SETS * rounds).sqrt()).or(error);
                let many = (room as u32).clamp(4, 64);
                [(1, Quality { samples: 1, ..self.own }), (many, Quality { samples: many, ..self.own })]
            }
            None => [self.grid(0), self.grid(1 + u32::from(room > 8.0 * f64::from(self.grid(0).1)))]
                .map(|(quality, samples)| (samples, quality)),
        };
        let [(few, short), (many, long)] = costs;
        let (short, long) = (self.shoot(place, &short)?.0, self.shoot(place, &long)?.0);
        spent += short.wall + long.wall;
        let cost = |of: &dyn Fn(&Took) -> Option<f64>| {
            Some(Cost::between((f64::from(few), of(&short)?), (f64::from(many), of(&long)?)))
        };
        let wall = cost(&|took| Some(took.wall)).unwrap_or_default();
        Ok((Pilot { place, wall, cpu: cost(&|took| took.cpu), error }, spent))
    }

    /// A grid so many steps finer than the sequence's own, and its samples.
    fn grid(&self, finer: u32) -> (Quality, u32) {
        let antialias = self.own.antialias + finer;
        (Quality { antialias, ..self.own }, antialias * antialias)
    }
}

/// So many samples everywhere, with a look at their error.
fn sampled(own: &Quality, samples: u32) -> Quality {
    // Nothing compares with it, so that not even what has no noise is ever good enough.
    Quality { noise: Some(NoiseTarget { error: f64::NAN, most: samples }), points: Points::Sobol, ..*own }
}

/// The cost of so many films: between pilots it changes evenly.
fn summed(pilots: &[Pilot], films: usize, cost: &dyn Fn(&Pilot) -> Option<Cost>) -> Option<Cost> {
    let mut sum = Cost::default();
    for film in 0..films {
        let after = pilots.iter().position(|pilot| pilot.place >= film).unwrap_or(pilots.len() - 1);
        let before = after.saturating_sub(usize::from(pilots[after].place > film));
        let (a, b) = (&pilots[before], &pilots[after]);
        let width = b.place.saturating_sub(a.place).max(1) as f64;
        let part = (film.saturating_sub(a.place) as f64 / width).min(1.0);
        let (a, b) = (cost(a)?, cost(b)?);
        sum.base += a.base * (1.0 - part) + b.base * part;
        sum.each += a.each * (1.0 - part) + b.each * part;
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pilot(place: usize, base: f64, each: f64) -> Pilot {
        Pilot { place, wall: Cost { base, each }, cpu: None, error: None }
    }

    #[test]
    fn costs_are_lines() {
        let cost = Cost::between((4.0, 1.0), (64.0, 13.0));
        assert!((cost.each - 0.2).abs() < 1e-12 && (cost.base - 0.2).abs() < 1e-12);
        assert_eq!(Cost::between((4.0, 1.0), (64.0, 0.5)), Cost { base: 1.0, each: 0.0 });
    }

    #[test]
    fn films_between_pilots_cost_what_lies_between() {
        let pilots = [pilot(0, 1.0, 0.0), pilot(4, 5.0, 4.0)];
        let sum = summed(&pilots, 5, &|pilot| Some(pilot.wall)).expect("a cost");
        assert!((sum.base - 15.0).abs() < 1e-12 && (sum.each - 10.0).abs() < 1e-12, "{sum:?}");
        assert_eq!(summed(&pilots, 1, &|pilot| pilot.cpu), None);
        let one = summed(&pilots[..1], 2, &|pilot| Some(pilot.wall));
        assert_eq!(one, Some(Cost { base: 2.0, each: 0.0 }));
    }

    #[test]
    fn grids_stay_where_samples_are_chosen() {
        let mut still = pilot(0, 1.0, 0.5);
        still.keep_grid(4);
        assert_eq!(still.wall, Cost { base: 9.0, each: 0.0 });
        let mut noisy = Pilot { error: Some(1.0), ..pilot(0, 1.0, 0.5) };
        noisy.keep_grid(4);
        assert_eq!(noisy.wall, Cost { base: 1.0, each: 0.5 });
    }

    #[test]
    fn more_time_is_more_samples() {
        let cost = Cost { base: 0.5, each: 0.25 };
        assert_eq!([1.0, 2.0, 4.0].map(|seconds| fitting(seconds, cost)), [2.0, 6.0, 14.0]);
        assert_eq!(fitting(0.1, cost), 1.0, "one at least");
        assert_eq!(fitting(1.0, Cost::default()), f64::from(MOST_SAMPLES), "what costs nothing");
    }
}
