//! The pilot: some films, a few blocks of each, as long as there is time.

use super::Outlook;
use super::film::{FilmNoise, PilotFilm};
use super::passes::Passes;
use crate::base::clock::{Clock, Took};
use crate::base::color::Rgb;
use crate::film::Extras;
use crate::pipeline::plan::{Plan, Take};
use crate::pipeline::schedule::{Probed, Prober};
use crate::sequence::Sequence;
use crate::trace::Probe;
use std::ops::Range;

/// How long a pilot may take, beyond a first look of a few milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patience {
    pub seconds: f64,
    /// And what share of the time that the run is expected to take.
    pub share: f64,
}

impl Patience {
    /// For whoever only wants to know.
    pub const PLAN: Self = Self { seconds: 1.5, share: f64::INFINITY };
    /// Before a run that is expected to be long.
    pub const RUN: Self = Self { seconds: 2.0, share: 0.03 };
}

/// Films of each kind, random or not, that are looked at.
const FILMS: usize = 6;

/// Weightings of a film that are compared, at most.
const WEIGHTINGS: usize = 32;

/// Blocks for each thread at least, so that all have work until the end.
const BLOCKS: usize = 8;

/// Samples of a pixel in the first pass.
const FIRST: u32 = 8;

/// Samples of a pixel that a pilot takes where it may choose between more samples and more blocks.
const ENOUGH: u32 = 64;

/// And at most.
const MOST: u32 = 1 << 20;

/// Looks at some films of the plan.
pub fn look_ahead(
    sequence: &Sequence,
    plan: &Plan,
    extras: Extras,
    patience: Patience,
    clock: Clock,
) -> Outlook {
    let looks = &plan.survey.frames;
    let random: Vec<bool> = plan.takes.iter().map(|take| looks[take.frames[0]].random).collect();
    let mut places = spread(&random, true);
    places.extend(spread(&random, false));
    let prober = Prober::new(sequence, extras, clock);
    let mut stage = Stage { sequence, plan, prober, spent: Took::ZERO };
    let few = Effort { blocks: BLOCKS * rayon::current_num_threads(), seconds: 0.0 };
    let mut pilots: Vec<PilotFilm> = places.iter().filter_map(|&place| stage.film(place, few)).collect();
    let outlook = |mut pilots: Vec<PilotFilm>, spent: Took| {
        pilots.sort_by_key(|pilot| pilot.place);
        same_power(&mut pilots);
        Outlook { pilots, random: random.clone(), spent }
    };
    let expected = outlook(pilots.clone(), stage.spent).forecast(&sequence.quality).wall.mid;
    let left = patience.seconds.min(patience.share * expected) - stage.spent.wall;
    // Less than what the first look took would tell no more than that.
    if left > stage.spent.wall {
        let seconds = left / pilots.len().max(1) as f64;
        let deeper = |film: PilotFilm| {
            let effort = few.deeper(&film, seconds, sequence.quality.antialias);
            stage.film(film.place, effort).unwrap_or(film)
        };
        pilots = pilots.into_iter().map(deeper).collect();
    }
    outlook(pilots, stage.spent)
}

/// What is done for one film.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Effort {
    blocks: usize,
    /// As long as there is time, samples are doubled after the first two passes.
    seconds: f64,
}

impl Effort {
    /// As many blocks as can have enough samples in so many seconds, by what a first look has said.
    fn deeper(self, film: &PilotFilm, seconds: f64, antialias: u32) -> Self {
        // Passes over the samples of a grid come twice.
        let (samples, passes) = match film.is_random() {
            true => (ENOUGH, (ENOUGH / FIRST).ilog2() + 1),
            false => (2 * antialias * antialias, 2),
        };
        let again = if film.moments > 1 { f64::from(passes) } else { 1.0 };
        let fits = (seconds - again * film.prepare.wall) / film.sample.wall.max(1e-12);
        let blocks = (fits / Probe::BLOCK / f64::from(samples)) as usize;
        Self { blocks: blocks.max(self.blocks), seconds }
    }
}

/// Some films of one kind, from the first to the last.
fn spread(random: &[bool], wanted: bool) -> Vec<usize> {
    let all: Vec<usize> = (0..random.len()).filter(|&place| random[place] == wanted).collect();
    let count = FILMS.min(all.len());
    // In the middle of as many parts, as they stand for what is around them.
    (0..count).map(|index| all[(2 * index + 1) * all.len() / (2 * count)]).collect()
}

/// What one film says of the power of its samples is vague: all have that which they say together.
fn same_power(pilots: &mut [PilotFilm]) {
    let noises: Vec<&FilmNoise> = pilots.iter().filter_map(|pilot| pilot.noise.as_ref()).collect();
    let mean = noises.iter().map(|noise| noise.power).sum::<f64>() / noises.len().max(1) as f64;
    pilots.iter_mut().filter_map(|pilot| pilot.noise.as_mut()).for_each(|noise| {
        noise.power = mean.clamp(1.0, 1.5);
    });
}

/// What pilots look at.
struct Stage<'a> {
    sequence: &'a Sequence,
    plan: &'a Plan,
    prober: Prober,
    spent: Took,
}

impl Stage<'_> {
    /// What a film says; nothing if its frame has no camera.
    fn film(&mut self, place: usize, effort: Effort) -> Option<PilotFilm> {
        let take = &self.plan.takes[place];
        let look = &self.plan.survey.frames[take.frames[0]];
        let mut probe = self.prober.probe(look, effort.blocks);
        let (width, height) = self.sequence.output.size;
        let mut pilot = PilotFilm {
            place,
            pixels: f64::from(width) * f64::from(height),
            moments: look.moments,
            prepare: Took::ZERO,
            sample: Took::ZERO,
            rays: 1.0,
            noise: None,
        };
        let pixels = probe.pixels() as f64;
        if look.random {
            self.random(&mut pilot, take, &mut probe, effort.seconds)?;
        } else {
            let grid = self.sequence.quality.antialias.pow(2);
            // The first time, nothing is warm.
            let cold = self.pass(take, &mut probe, 0..grid)?;
            let warm = self.pass(take, &mut probe, 0..grid)?;
            pilot.prepare = cold.prepare;
            pilot.sample = warm.trace * (1.0 / (pixels * f64::from(grid)));
            pilot.rays = warm.rays as f64 / (pixels * f64::from(grid));
        }
        Some(pilot)
    }

    /// Looks at random samples: twice as many in every pass.
    fn random(&mut self, pilot: &mut PilotFilm, take: &Take, probe: &mut Probe, seconds: f64) -> Option<()> {
        let start = self.spent.wall;
        let (mut traced, mut rays, mut passes) = (Took::ZERO, 0, Passes::default());
        let weightings = weightings(self.plan, take);
        pilot.prepare = self.pass(take, probe, 0..FIRST)?.prepare;
        let mut drawn = FIRST;
        loop {
            let done = self.pass(take, probe, drawn..2 * drawn)?;
            traced = traced + done.trace;
            rays += done.rays;
            passes.add(probe, &weightings, (drawn, 2 * drawn));
            drawn *= 2;
            let next = done.prepare.wall + 2.0 * done.trace.wall;
            if self.spent.wall - start + next > seconds || drawn >= MOST {
                break;
            }
        }
        let samples = probe.pixels() as f64 * f64::from(drawn - FIRST);
        pilot.sample = traced * (1.0 / samples);
        pilot.rays = rays as f64 / samples;
        pilot.noise = Some(passes.noise(pilot.pixels));
        Some(())
    }

    fn pass(&mut self, take: &Take, probe: &mut Probe, samples: Range<u32>) -> Option<Probed> {
        let look = &self.plan.survey.frames[take.frames[0]];
        let done = self.prober.pass(look, &take.lit, probe, &samples)?;
        self.spent = self.spent + done.prepare + done.trace;
        Some(done)
    }
}

/// The different weights with which a film is shown: some of them if they are many.
fn weightings(plan: &Plan, take: &Take) -> Vec<Vec<Rgb>> {
    let looks = || take.frames.iter().map(|&frame| &plan.survey.frames[frame]);
    let mut all: Vec<&Vec<Rgb>> = Vec::new();
    // What is sampled until it is good is so for frames that are not rendered, too.
    let shown = looks().next().into_iter().flat_map(|look| look.shown.iter());
    for weights in shown.chain(looks().map(|look| &look.weights)) {
        if !all.contains(&weights) {
            all.push(weights);
        }
    }
    let step = all.len().div_ceil(WEIGHTINGS).max(1);
    all.into_iter().step_by(step).cloned().collect()
}
