//! The pilot: probes a few patches of some films within a time limit.

use super::film::{FilmNoise, PilotFilm};
use super::passes::Passes;
use super::run_forecast::Outlook;
use crate::base::clock::{ElapsedTime, TimeSource, timed};
use crate::base::color::Rgb;
use crate::film::{AovSet, denoise};
use crate::pipeline::plan::path_shares::{PathShares, ShareTrials, path_shares};
use crate::pipeline::plan::render_plan::Plan;
use crate::pipeline::plan::shared_films::SharedFilm;
use crate::pipeline::schedule::{PassCost, Prober};
use crate::sequence::Sequence;
use crate::sequence::quality::{Denoise, Quality};
use crate::trace::PilotBlocks;
use std::cmp::Reverse;
use std::ops::Range;

/// Time limit of a pilot, in addition to a first probe of a few milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PilotTime {
    pub seconds: f64,
    /// Limit as a share of the expected time of the run.
    pub share: f64,
}

impl PilotTime {
    /// For `kinora plan`.
    pub const PLAN: Self = Self { seconds: 1.5, share: f64::INFINITY };
    /// Before a long run. Half of the share limits the number of probed films and of trials of shared paths.
    pub const RUN: Self = Self { seconds: 2.0, share: 0.01 };
    /// Before a run whose samples depend on its error, which takes more than a few patches to predict.
    pub const RUN_WITH_ERROR: Self = Self { share: 0.03, ..Self::RUN };

    /// Before a run of this quality.
    pub fn of_run(quality: &Quality) -> Self {
        if quality.noise.is_some() { Self::RUN_WITH_ERROR } else { Self::RUN }
    }
}

/// Maximum number of probed films of each kind, random or not.
const FILMS: usize = 6;

/// Maximum number of weightings of a film that are compared.
const WEIGHTINGS: usize = 256;

/// Minimum number of patches per thread, so that all threads stay busy.
const PATCHES: usize = 8;

/// Samples per pixel in the first pass.
const FIRST: u32 = 4;

/// Samples per pixel up to which a pilot prefers more samples to more patches. Then every patch is better than more
/// samples: where noise is uneven, a few of them hold most of it.
const ENOUGH: u32 = 16;

/// The number of blocks that get more samples than the others, to measure how their errors fall; up to how many samples
/// per pixel; and for which part of the time.
const DEEP: usize = 256;
const DEEPEST: u32 = 256;
const DEEP_TIME: f64 = 0.15;

/// How many times as long as all before a deeper pilot may take, and how many there may be.
const GROWTH: f64 = 8.0;
const ROUNDS: u32 = 6;

/// Maximum samples per pixel: more tell no more.
const MOST: u32 = 1 << 12;

impl FilmNoise {
    /// Whether more samples would tell more.
    fn is_open(&self) -> bool {
        self.samples < f64::from(MOST)
    }
}

/// Probes some films of the plan.
pub fn run_pilot(
    sequence: &Sequence,
    plan: &Plan,
    aovs: AovSet,
    limit: PilotTime,
    clock: TimeSource,
) -> Outlook {
    let states = &plan.states.frames;
    let random: Vec<bool> = plan.films.iter().map(|shared| states[shared.frames[0]].random).collect();
    let kinds = [spread(&random, true), spread(&random, false)];
    let mut run = PilotRun {
        sequence,
        plan,
        spent: ElapsedTime::ZERO,
        prober: Prober::new(sequence, aovs, clock),
        clock,
        filters: Vec::new(),
    };
    let few = ProbeBudget { patches: PATCHES * rayon::current_num_threads(), seconds: 0.0 };
    let outlook = |mut pilots: Vec<PilotFilm>, shares: &PathShares, spent: ElapsedTime| {
        pilots.sort_by_key(|pilot| pilot.place);
        same_power(&mut pilots);
        Outlook { pilots, random: random.clone(), shares: shares.clone(), spent }
    };
    // What shared views save is known without tracing.
    let known = path_shares(sequence, plan, ShareTrials::of_samples(0));
    let expected = |pilots: &[PilotFilm], shares: &PathShares, spent| {
        outlook(pilots.to_vec(), shares, spent).wall(&sequence.quality)
    };
    let mut pilots: Vec<PilotFilm> = Vec::new();
    // One film of each kind, then others. Where films take long to prepare, few of them must do: half of the time is
    // for these, half for the paths that they may share.
    let (firsts, others): (Vec<&[usize]>, Vec<&[usize]>) =
        kinds.iter().map(|kind| kind.split_at(kind.len().min(1))).unzip();
    pilots.extend(firsts.concat().into_iter().filter_map(|place| run.film(place, few)));
    for place in others.concat() {
        if run.spent.wall > 0.5 * limit.share * expected(&pilots, &known, run.spent) {
            break;
        }
        pilots.extend(run.film(place, few));
    }
    let seconds = 0.5 * limit.seconds.min(limit.share * expected(&pilots, &known, run.spent));
    let trials = affordable(&pilots, seconds, clock);
    let (shares, took) = timed(|| path_shares(sequence, plan, trials));
    run.spent = run.spent + clock.elapsed(took, 0);
    // The less a pilot has seen, the less it knows how long the run takes, and how long it may take itself. One that is
    // shorter than what was before would add no information, and grids have nothing to add after the first one.
    for round in 0..ROUNDS {
        let left = limit.seconds.min(limit.share * expected(&pilots, &shares, run.spent)) - run.spent.wall;
        let is_known =
            round > 0 && !pilots.iter().any(|film| film.noise.as_ref().is_some_and(FilmNoise::is_open));
        if left <= run.spent.wall || pilots.is_empty() || is_known {
            break;
        }
        let seconds = left.min(GROWTH * run.spent.wall) / pilots.len() as f64;
        let deeper = |film: PilotFilm| {
            let budget = few.deeper(&film, seconds, sequence.quality.antialias);
            run.film(film.place, budget).unwrap_or(film)
        };
        pilots = pilots.into_iter().map(deeper).collect();
    }
    outlook(pilots, &shares, run.spent)
}

/// The films that can be tried for sharing paths within `seconds`, by the time that they take to prepare.
fn affordable(pilots: &[PilotFilm], seconds: f64, clock: TimeSource) -> ShareTrials {
    let each = pilots.iter().map(|pilot| pilot.prepare.wall).sum::<f64>() / pilots.len().max(1) as f64;
    ShareTrials::of_scenes((seconds / each.max(1e-9)) as usize, seconds, clock)
}

/// The budget of one film.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ProbeBudget {
    patches: usize,
    /// Doubles the samples while time is left, once there are [`ENOUGH`].
    seconds: f64,
}

impl ProbeBudget {
    /// The number of patches that can have enough samples within `seconds`, by the costs of the first probe.
    fn deeper(self, film: &PilotFilm, seconds: f64, antialias: u32) -> Self {
        // A regular grid of samples is traced twice.
        let (samples, passes) = match film.is_random() {
            true => (ENOUGH, (ENOUGH / FIRST).ilog2() + 1),
            false => (2 * antialias * antialias, 2),
        };
        let again = if film.moments > 1 { f64::from(passes) } else { 1.0 };
        let fits = (seconds - again * film.prepare.wall) / film.sample.wall.max(1e-12);
        let patches = (fits / PilotBlocks::PATCH / f64::from(samples)) as usize;
        Self { patches: patches.max(self.patches), seconds }
    }
}

/// Selects films of one kind, evenly spaced: the middle one first, then from the ends.
fn spread(random: &[bool], wanted: bool) -> Vec<usize> {
    let all: Vec<usize> = (0..random.len()).filter(|&place| random[place] == wanted).collect();
    let count = FILMS.min(all.len());
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|index| Reverse(index.abs_diff(count / 2)));
    order.rotate_right(count.min(1));
    // Each selected film is the middle of an equal part of the list.
    order.into_iter().map(|index| all[(2 * index + 1) * all.len() / (2 * count)]).collect()
}

/// The exponent of a single film is uncertain, so all films get the mean.
fn same_power(pilots: &mut [PilotFilm]) {
    let noises: Vec<&FilmNoise> = pilots.iter().filter_map(|pilot| pilot.noise.as_ref()).collect();
    let mean = noises.iter().map(|noise| noise.power).sum::<f64>() / noises.len().max(1) as f64;
    pilots.iter_mut().filter_map(|pilot| pilot.noise.as_mut()).for_each(|noise| {
        noise.power = mean.clamp(1.0, 1.5);
    });
}

/// The state of a running pilot.
struct PilotRun<'a> {
    sequence: &'a Sequence,
    plan: &'a Plan,
    prober: Prober,
    spent: ElapsedTime,
    clock: TimeSource,
    /// Times to denoise a pixel, by the numbers of layers of light and of neighbours.
    filters: Vec<([usize; 2], ElapsedTime)>,
}

impl PilotRun<'_> {
    /// Measures a film. None if its frame has no camera.
    fn film(&mut self, place: usize, budget: ProbeBudget) -> Option<PilotFilm> {
        let shared = &self.plan.films[place];
        let state = &self.plan.states.frames[shared.frames[0]];
        let mut probe = self.prober.probe(state, budget.patches);
        let (width, height) = self.sequence.output.size;
        let mut pilot = PilotFilm {
            place,
            pixels: f64::from(width) * f64::from(height),
            moments: state.moments,
            prepare: ElapsedTime::ZERO,
            sample: ElapsedTime::ZERO,
            rays: 1.0,
            filter: ElapsedTime::ZERO,
            noise: None,
        };
        let pixels = probe.pixels() as f64;
        if state.random {
            self.random(&mut pilot, shared, &mut probe, budget.seconds)?;
            if self.sequence.quality.denoise != Denoise::Off {
                let neighbors = state.neighbors.as_ref().map_or(0, |frames| frames.len() - 1);
                pilot.filter = self.filter([shared.lit.len(), neighbors]);
            }
        } else {
            let grid = self.sequence.quality.antialias.pow(2);
            // The first run is slower, because caches are cold.
            let cold = self.pass(shared, &mut probe, 0..grid)?;
            let warm = self.pass(shared, &mut probe, 0..grid)?;
            pilot.prepare = cold.prepare;
            pilot.sample = warm.trace * (1.0 / (pixels * f64::from(grid)));
            pilot.rays = warm.rays as f64 / (pixels * f64::from(grid));
        }
        // In a cross-fade, another camera sees the same scene.
        let parts = f64::from(state.parts());
        (pilot.sample, pilot.rays) = (pilot.sample * parts, pilot.rays * parts);
        pilot.filter = pilot.filter * parts;
        Some(pilot)
    }

    /// The time to denoise a pixel of a film with so many layers of light and that many neighbours.
    fn filter(&mut self, kind: [usize; 2]) -> ElapsedTime {
        if let Some((_, time)) = self.filters.iter().find(|(known, _)| *known == kind) {
            return *time;
        }
        let [layers, neighbors] = kind;
        // Once for the memory that frames after the first one find.
        let memory = denoise::Memory::default();
        let [first, (pixels, took)] = [(); 2].map(|()| timed(|| denoise::trial(layers, neighbors, &memory)));
        let [first, took] = [first.1, took].map(|took| self.clock.elapsed(took, 0));
        self.spent = self.spent + first + took;
        let time = took * (1.0 / pixels as f64);
        self.filters.push((kind, time));
        time
    }

    /// Probes random samples. Each pass doubles their number.
    fn random(
        &mut self,
        pilot: &mut PilotFilm,
        shared: &SharedFilm,
        probe: &mut PilotBlocks,
        seconds: f64,
    ) -> Option<()> {
        let start = self.spent.wall;
        let (mut traced, mut rays, mut passes) = (ElapsedTime::ZERO, 0, Passes::default());
        let deep;
        let weightings = weightings(self.plan, shared);
        pilot.prepare = self.pass(shared, probe, 0..FIRST)?.prepare;
        let mut drawn = FIRST;
        loop {
            let done = self.pass(shared, probe, drawn..2 * drawn)?;
            traced = traced + done.trace;
            rays += done.rays;
            passes.add(probe, &weightings, (drawn, 2 * drawn));
            drawn *= 2;
            let next = done.prepare.wall + 2.0 * done.trace.wall;
            let is_over = self.spent.wall - start + next > (1.0 - DEEP_TIME) * seconds || drawn >= MOST;
            if drawn >= ENOUGH && is_over {
                // Two passes of the noisiest blocks: as many samples, then twice as many.
                let share = DEEP as f64 * PilotBlocks::BLOCK / probe.pixels() as f64;
                deep = 2.0 * done.prepare.wall + 6.0 * done.trace.wall * share.min(1.0);
                break;
            }
        }
        let samples = probe.pixels() as f64 * f64::from(drawn - FIRST);
        pilot.sample = traced * (1.0 / samples);
        pilot.rays = rays as f64 / samples;
        let near = probe.neighbourhoods();
        if deep < DEEP_TIME * seconds && 4 * drawn <= DEEPEST {
            let weights = &weightings[passes.worst()];
            probe.keep(&passes.noisiest(DEEP));
            let falls = self.falls(shared, probe, weights, (drawn, DEEP_TIME * seconds))?;
            passes.falls.extend(falls);
        }
        pilot.noise = Some(passes.noise(&near, pilot.pixels));
        Some(())
    }

    /// How the error of blocks falls beyond `drawn` samples. The pass that chose the blocks is left out, since blocks
    /// whose errors look largest are those of which too much has been measured. Its samples remain in their means.
    fn falls(
        &mut self,
        shared: &SharedFilm,
        probe: &mut PilotBlocks,
        weights: &[Rgb],
        (mut drawn, seconds): (u32, f64),
    ) -> Option<Vec<f64>> {
        let (start, mut squares) = (self.spent.wall, Vec::new());
        let mut next = 0.0;
        while self.spent.wall - start + next < seconds && drawn < DEEPEST {
            let done = self.pass(shared, probe, drawn..2 * drawn)?;
            next = done.prepare.wall + 2.0 * done.trace.wall;
            let blocks = probe.errors(weights, (drawn, 2 * drawn));
            squares.push(blocks.iter().map(|block| block.square * block.pixels).sum::<f64>());
            drawn *= 2;
        }
        let pairs = squares.windows(2).filter(|pair| pair.iter().all(|square| *square > 0.0));
        Some(pairs.map(|pair| libm::log2(pair[0] / pair[1])).collect())
    }

    fn pass(
        &mut self,
        shared: &SharedFilm,
        probe: &mut PilotBlocks,
        samples: Range<u32>,
    ) -> Option<PassCost> {
        let state = &self.plan.states.frames[shared.frames[0]];
        let done = self.prober.pass(state, &shared.lit, probe, &samples)?;
        self.spent = self.spent + done.prepare + done.trace;
        Some(done)
    }
}

/// The different weights with which frames show a film; a selection if there are many.
fn weightings(plan: &Plan, shared: &SharedFilm) -> Vec<Vec<Rgb>> {
    let states = || shared.frames.iter().map(|&frame| &plan.states.frames[frame]);
    let mut all: Vec<&Vec<Rgb>> = Vec::new();
    // Adaptive sampling also serves frames of the film that are not rendered.
    let shown = states().next().into_iter().flat_map(|state| state.weightings.iter());
    for weights in shown.chain(states().map(|state| &state.weights)) {
        if !all.contains(&weights) {
            all.push(weights);
        }
    }
    let step = all.len().div_ceil(WEIGHTINGS).max(1);
    all.into_iter().step_by(step).cloned().collect()
}
