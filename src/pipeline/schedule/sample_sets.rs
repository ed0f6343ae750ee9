//! Films of separate samples, which make one denoised film.

use crate::base::stats::ProgressMeter;
use crate::film::denoise::{Halves, Memory, SampleFilms, denoise, samples_of_audit};
use crate::film::{AovSet, Film, Noise};
use crate::sampling::hash;
use crate::sequence::quality::{NoiseTarget, Quality};
use crate::trace::{AdaptiveFrame, MIN_SAMPLES, TraceSettings, Weightings};
use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

/// The films of a frame that is being traced: both halves of the picture's samples, and two audits. Without a target error,
/// each is traced once. With one, the number of samples is doubled, round by round: all samples so far become the first
/// half. The last round is the one whose error is below the target with its whole interval: estimates of small frames
/// scatter, and the first one below the target would be below it by chance.
///
/// That interval is as wide as the audits are few, and all pixels get the same samples, so samples alone may reach the
/// target sooner, where they are needed. Every round compares what both ways would still take. If samples alone take less,
/// the frame goes on as one that is not denoised, from the samples that it has.
#[derive(Debug)]
pub struct SampleSets {
    /// The films so far, in the order of [`PARTS`].
    films: Vec<Film>,
    /// Samples per pixel of the picture, once this round is traced.
    picture: u32,
    /// Those before this round, or none.
    before: u32,
    /// The parts of the first round, as indices of `PARTS`, and the one that is traced now.
    all: Range<usize>,
    part: usize,
    /// The rays of the picture's samples.
    rays: u64,
    /// The memory of the filter.
    memory: Memory,
}

/// What follows when a part of a frame has been traced.
pub enum NextStep {
    /// Another part.
    Part(SampleSets),
    /// Samples alone, in rounds, without the denoiser.
    Samples(AdaptiveFrame),
    /// Nothing: this is the film.
    Done(Film),
    /// Nothing: these are the films that were asked for.
    Sampled(Vec<Film>),
}

/// Films of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmSet {
    /// All four, to be denoised.
    All,
    /// Both halves of the picture's samples.
    Halves,
    /// Both audits.
    Audits,
}

#[derive(Clone, Copy, Debug)]
enum Part {
    Half(u32),
    Audit(u32),
}

const PARTS: [Part; 4] = [Part::Half(0), Part::Half(1), Part::Audit(0), Part::Audit(1)];

/// The parts of later rounds.
const LATER: Range<usize> = 1..PARTS.len();

impl SampleSets {
    pub fn new(set: FilmSet, quality: &Quality, memory: &Memory) -> Self {
        let all = match set {
            FilmSet::All => 0..PARTS.len(),
            FilmSet::Halves => 0..2,
            FilmSet::Audits => 2..PARTS.len(),
        };
        let part = all.start;
        let picture = quality.noise.map_or(quality.samples, |target| target.most.min(MIN_SAMPLES));
        let (picture, memory) = (picture.next_multiple_of(2), memory.clone());
        Self { films: Vec::new(), picture, before: 0, all, part, rays: 0, memory }
    }

    /// The settings of the film that is traced now.
    pub fn settings(&self, frame: &TraceSettings) -> TraceSettings {
        let (samples, seed, guides) = match PARTS[self.part] {
            Part::Half(half) => (self.half(half), frame.quality.seed, true),
            // Another word than the samples of a pixel have, so that hardly any seed repeats the samples of another one.
            Part::Audit(audit) => (self.audit(), hash([frame.quality.seed, audit, SEED]), false),
        };
        let quality = Quality { samples: samples.len() as u32, seed, noise: None, ..frame.quality };
        let aovs = AovSet { guides, ..frame.aovs };
        TraceSettings { quality, aovs, first_sample: samples.start, ..frame.clone() }
    }

    fn half(&self, half: u32) -> Range<u32> {
        let count = self.picture / 2;
        half * count..(half + 1) * count
    }

    /// The samples of an audit that this round adds.
    fn audit(&self) -> Range<u32> {
        let before = if self.before == 0 { 0 } else { samples_of_audit(self.before) };
        before..samples_of_audit(self.picture)
    }

    /// The parts of this round. Audits that have as many samples as the picture needs take none.
    fn parts(&self) -> Range<usize> {
        match self.before {
            0 => self.all.clone(),
            _ if self.audit().is_empty() => LATER.start..LATER.start + 1,
            _ => LATER,
        }
    }

    /// Sets the meter to the part of the round that is traced now, after so many others and of all that are traced for a
    /// frame; 0 if these are the only ones.
    pub fn show(&self, meter: &ProgressMeter, [before, all]: [u32; 2]) {
        let parts = self.parts();
        meter.pass.store(before + (self.part - parts.start) as u32, Relaxed);
        meter.passes.store(all.max(parts.len() as u32), Relaxed);
    }

    /// Adds the film that was traced, with so many rays. The last one completes the frame, unless the target error asks for
    /// more samples: the error holds for each of `weightings`.
    pub fn add(
        mut self,
        (film, rays): (Film, u64),
        quality: &Quality,
        weightings: &Weightings,
        meter: &ProgressMeter,
    ) -> NextStep {
        if let Part::Half(_) = PARTS[self.part] {
            self.rays += rays;
        }
        match (self.films.get_mut(self.part - self.all.start), PARTS[self.part]) {
            (None, _) => self.films.push(film),
            (Some(before), Part::Half(_)) => *before = film,
            (Some(before), Part::Audit(_)) => *before = before.mixed_with(&film, 0.5),
        }
        self.part += 1;
        if self.part < self.parts().end {
            return NextStep::Part(self);
        }
        meter.pass.store(0, Relaxed);
        meter.passes.store(0, Relaxed);
        if self.all.len() < PARTS.len() {
            return NextStep::Sampled(self.films);
        }
        let samples = f64::from(drawn(self.picture));
        let film = tracing::debug_span!("denoise").in_scope(|| self.denoised(samples));
        match quality.noise {
            Some(target) => self.judge(film, target, quality.seed, weightings, meter),
            None => NextStep::Done(film),
        }
    }

    /// The denoised film of a complete round.
    fn denoised(&self, samples: f64) -> Film {
        let [first, second, a, b] = [0, 1, 2, 3].map(|part| &self.films[part]);
        let halves = Halves::new([first.clone(), second.clone()], &self.memory);
        denoise(&SampleFilms { halves: &halves, neighbors: &[], audits: [a, b] }, samples)
    }

    /// Ends a round of a frame with a target error: with the denoised film, another round, or samples alone.
    fn judge(
        mut self,
        mut film: Film,
        target: NoiseTarget,
        seed: u32,
        weightings: &Weightings,
        meter: &ProgressMeter,
    ) -> NextStep {
        let noises: Vec<Noise> = match &film.remaining {
            Some(remaining) => weightings.iter().map(|weights| remaining.of(weights)).collect(),
            None => Vec::new(),
        };
        let highest = |noises: &[Noise]| noises.iter().map(|noise| noise.high).fold(0.0, f64::max);
        let high = highest(&noises);
        let is_last = 2 * self.picture > target.most;
        let denoised = move |is_reached: bool| {
            let capped = if is_last && !is_reached { 1.0 } else { 0.0 };
            film.noises = noises.into_iter().map(|noise| Noise { capped, ..noise }).collect();
            NextStep::Done(film)
        };
        if high <= target.error {
            return denoised(true);
        }
        let alone = (!meter.is_stopped()).then(|| {
            let halves = [&self.films[0], &self.films[1]];
            let traced = (self.picture, self.rays);
            let mut samples = AdaptiveFrame::of_halves(halves, traced, seed, target, weightings);
            let is_complete = samples.settle(meter);
            (samples, is_complete)
        });
        let Some((samples, is_complete)) = alone.filter(|_| !meter.is_stopped()) else {
            meter.unfinished.fetch_or(!is_last, Relaxed);
            return denoised(false);
        };
        if samples.is_reached() || is_last && is_complete {
            // Samples alone have reached the target, or their limit. The better film counts.
            let (is_reached, sampled) = (samples.is_reached(), samples.film());
            return if highest(&sampled.noises) < high {
                NextStep::Done(sampled)
            } else {
                denoised(is_reached)
            };
        }
        if is_last {
            // The limit leaves room for samples alone, but not for another round of all films.
            let left = (f64::from(self.picture) / f64::from(target.most)).sqrt();
            let gains = highest(&samples.noises()) * left < high;
            return if gains { NextStep::Samples(samples) } else { denoised(false) };
        }
        if samples.samples_left() < self.samples_left(high / target.error) {
            return NextStep::Samples(samples);
        }
        self.start_round();
        NextStep::Part(self)
    }

    /// The samples per pixel that rounds of all films would still take, if the upper end of the error is so many times the
    /// target: it falls as the root of the samples. Without regard to the limit of samples: where it is in the way, the one
    /// that would need less comes nearer to the target.
    fn samples_left(&self, ratio: f64) -> f64 {
        let rounds = (2.0 * libm::log2(ratio)).ceil().max(1.0);
        f64::from(drawn(self.picture)) * (libm::exp2(rounds) - 1.0)
    }

    /// Begins a round that doubles the number of samples. Those of a film and those that it adds are equally many.
    fn start_round(&mut self) {
        if let [first, second, ..] = &mut self.films[..] {
            *first = first.mixed_with(second, 0.5);
        }
        (self.before, self.picture, self.part) = (self.picture, 2 * self.picture, LATER.start);
    }
}

/// The samples per pixel of all films of a picture with so many.
fn drawn(picture: u32) -> u32 {
    picture + 2 * samples_of_audit(picture)
}

/// A word for seeds of audits: "audi" in ASCII.
const SEED: u32 = 0x6175_6469;

#[cfg(test)]
mod tests {
    use super::*;

    /// A film of no samples would be black.
    #[test]
    fn no_part_of_a_round_is_without_samples() {
        let target = NoiseTarget { error: 0.01, most: 4096 };
        let quality = Quality { noise: Some(target), ..Quality::default() };
        let mut sets = SampleSets::new(FilmSet::All, &quality, &Memory::default());
        for (parts, audit) in [(0..4, 0..2), (1..2, 2..2), (1..4, 2..4), (1..4, 4..8)] {
            assert_eq!((sets.parts(), sets.audit()), (parts, audit));
            sets.start_round();
        }
    }
}
