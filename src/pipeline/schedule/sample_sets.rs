//! Films of separate samples, which make one denoised film.

use crate::base::stats::ProgressMeter;
use crate::film::denoise::{SampleFilms, denoise, samples_of_audit};
use crate::film::{AovSet, Film, Noise};
use crate::sampling::hash;
use crate::sequence::quality::Quality;
use crate::trace::{MIN_SAMPLES, TraceSettings, Weightings};
use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

/// The films of a frame that is being traced: both halves of the picture's samples, and two audits. Without a target error,
/// each is traced once. With one, the number of samples is doubled, round by round: all samples so far become the first
/// half. The last round is the one whose error is below the target with its whole interval: estimates of small frames
/// scatter, and the first one below the target would be below it by chance.
#[derive(Debug)]
pub struct SampleSets {
    /// The films so far, in the order of [`PARTS`].
    films: Vec<Film>,
    /// Samples per pixel of the picture, once this round is traced.
    picture: u32,
    /// Those before this round, or none.
    before: u32,
    /// What is traced now, as an index of `PARTS`.
    part: usize,
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
    pub fn new(quality: &Quality) -> Self {
        let picture = quality.noise.map_or(quality.samples, |target| target.most.min(MIN_SAMPLES));
        Self { films: Vec::new(), picture: picture.next_multiple_of(2), before: 0, part: 0 }
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

    /// The parts of this round.
    fn parts(&self) -> Range<usize> {
        if self.before == 0 { 0..PARTS.len() } else { LATER }
    }

    /// Sets the meter to the part of the round that is traced now.
    pub fn show(&self, meter: &ProgressMeter) {
        let parts = self.parts();
        meter.pass.store((self.part - parts.start) as u32, Relaxed);
        meter.passes.store(parts.len() as u32, Relaxed);
    }

    /// Adds the film that was traced. The last one completes the frame, unless the target error asks for more samples:
    /// the error holds for each of `weightings`.
    pub fn add(
        &mut self,
        film: Film,
        quality: &Quality,
        weightings: &Weightings,
        meter: &ProgressMeter,
    ) -> Option<Film> {
        match (self.films.get_mut(self.part), PARTS[self.part]) {
            (None, _) => self.films.push(film),
            (Some(before), Part::Half(_)) => *before = film,
            (Some(before), Part::Audit(_)) => *before = before.mixed_with(&film, 0.5),
        }
        self.part += 1;
        if self.part < PARTS.len() {
            return None;
        }
        meter.pass.store(0, Relaxed);
        meter.passes.store(0, Relaxed);
        let [first, second, a, b] = self.films.first_chunk()?;
        let films = SampleFilms { halves: [first, second], audits: [a, b] };
        let drawn = self.picture + 2 * samples_of_audit(self.picture);
        let mut film = denoise(&films, f64::from(drawn));
        let Some(target) = quality.noise else { return Some(film) };
        let remaining = film.remaining.as_ref()?;
        let noises: Vec<_> = weightings.iter().map(|weights| remaining.of(weights)).collect();
        let is_reached = noises.iter().all(|noise| noise.high <= target.error);
        let is_last = 2 * self.picture > target.most;
        if !is_reached && !is_last && !meter.is_stopped() {
            self.start_round();
            return None;
        }
        if !is_reached && !is_last {
            meter.unfinished.store(true, Relaxed);
        }
        let capped = if is_last && !is_reached { 1.0 } else { 0.0 };
        film.noises = noises.into_iter().map(|noise| Noise { capped, ..noise }).collect();
        Some(film)
    }

    /// Begins a round that doubles the number of samples. Those of a film and those that it adds are equally many.
    fn start_round(&mut self) {
        if let [first, second, ..] = &mut self.films[..] {
            *first = first.mixed_with(second, 0.5);
        }
        (self.before, self.picture, self.part) = (self.picture, 2 * self.picture, LATER.start);
    }
}

/// A word for seeds of audits: "audi" in ASCII.
const SEED: u32 = 0x6175_6469;
