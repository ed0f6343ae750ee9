//! What is tried: settings that differ from the file's own along one axis each.

mod axis;
mod curve;
mod left_out;
mod parts;
#[cfg(test)]
mod tests;

pub use axis::Axis;
pub use left_out::LeftOut;

use super::change::Change;
use super::layering::Layering;
use crate::sequence::quality::{Integrator, PathSettings, Quality};

/// One point on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub axis: Axis,
    pub quality: Quality,
    /// How the sequence differs from the file's.
    pub change: Change,
    /// What it is on its axis: a number, or `off`.
    pub value: String,
    /// What to paste behind `kinora render FILE`; empty if only the file can say it.
    pub flags: String,
    /// Whether its pixels have random samples.
    pub random: bool,
    /// Expected in a pixel.
    pub samples: f64,
    /// How often it is rendered.
    pub runs: u32,
}

/// What is known of a sequence before settings are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Whether pixels have random samples by the file's own setting.
    pub random: bool,
    /// The same by the other integrator.
    pub other_random: bool,
    /// Samples of a pixel by the file's own setting, on average.
    pub samples: f64,
    /// About the error of the file's own setting, as a share of the mean brightness; 0 if unknown.
    pub error: f64,
    /// A radiance that one of ten pixels of a layer exceeds, before its weight.
    pub bright: f64,
}

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scope {
    /// A first answer: fewer settings and runs.
    pub quick: bool,
    /// No more samples than these, unless the file's own setting takes more.
    pub most: Option<u32>,
}

/// What is tried of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The first is the file's own.
    pub all: Vec<Setting>,
    pub left_out: Vec<LeftOut>,
    /// Whether pixels have random samples.
    pub random: bool,
    /// Samples in each pixel of each of both references.
    pub reference: u32,
    scope: Scope,
    known: Known,
}

/// Both references together have at least this many times the samples of anything that they judge.
pub const FINER: u32 = 16;
/// Runs where every picture is the same, for the time alone.
const STILL_RUNS: u32 = 5;

impl Settings {
    /// Along all axes that mean something for the sequence.
    pub fn new(own: &Quality, known: Known, scope: Scope) -> Self {
        let (all, left_out) = (Vec::new(), Vec::new());
        let mut settings = Self { all, left_out, random: known.random, reference: 0, scope, known };
        if known.random {
            settings.samples(own);
            settings.targets(own);
        } else {
            settings.grids(own);
        }
        settings.bounces(own);
        settings.roulette(own);
        settings.integrators(own);
        settings
    }

    fn push(&mut self, axis: Axis, quality: Quality, value: String, flags: String, runs: u32) {
        let random = self.random;
        let samples = samples_of(&quality, random, self.known.samples);
        let runs = if random { runs } else { STILL_RUNS };
        let change = Change::None;
        self.all.push(Setting { axis, quality, change, value, flags, random, samples, runs });
    }

    fn leave_out(&mut self, what: &'static str, why: &str) {
        self.left_out.push(LeftOut { what, why: why.to_owned() });
    }

    /// Runs of a setting that is compared with one of the same random numbers.
    fn short_runs(&self) -> u32 {
        if self.scope.quick { 6 } else { 8 }
    }

    /// The file's quality with no more samples than it takes to compare.
    fn short(&self, own: &Quality) -> Quality {
        let most = if self.scope.quick { (self.center() / 32).clamp(4, 16) } else { 16 };
        Quality { samples: most.min(self.known.samples.ceil() as u32).max(1), noise: None, ..*own }
    }

    fn bounces(&mut self, own: &Quality) {
        let deeper = own.bounces.saturating_mul(2).max(1);
        let mut all: Vec<u32> = vec![0, 1, 2, own.bounces / 2, own.bounces, deeper];
        if !self.scope.quick {
            all.extend([3, 5, 8]);
        }
        all.sort_unstable();
        all.dedup();
        for bounces in all.into_iter().filter(|&bounces| bounces <= deeper) {
            let quality = Quality { bounces, ..self.short(own) };
            let flags = format!("--bounces {bounces}");
            self.push(Axis::Bounces, quality, bounces.to_string(), flags, self.short_runs());
        }
    }

    fn roulette(&mut self, own: &Quality) {
        let Integrator::Path(path) = own.integrator else {
            return self.leave_out("roulette", "the integrator is Whitted, which has none");
        };
        let others = [None, Some(0), Some(3), Some(8)].into_iter().filter(|other| *other != path.roulette);
        for roulette in [path.roulette].into_iter().chain(others) {
            let integrator = Integrator::Path(PathSettings { roulette, ..path });
            let value = roulette.map_or("off".to_owned(), |bounces| format!("after {bounces}"));
            let quality = Quality { integrator, ..self.short(own) };
            self.push(Axis::Roulette, quality, value, String::new(), self.short_runs());
        }
    }

    /// The integrator that the file does not name.
    fn integrators(&mut self, own: &Quality) {
        let (integrator, name) = match own.integrator {
            Integrator::Whitted => (Integrator::Path(PathSettings::default()), "path"),
            Integrator::Path(_) => (Integrator::Whitted, "whitted"),
        };
        let quality = Quality { integrator, ..self.short(own) };
        self.push(
            Axis::Integrator,
            quality,
            name.to_owned(),
            format!("--integrator {name}"),
            self.short_runs(),
        );
        let random = self.known.other_random;
        if let Some(last) = self.all.last_mut() {
            last.random = random;
            last.samples = samples_of(&last.quality, random, 0.0);
        }
    }

    /// Adds the axis of layers, of which there are so many with each layering; none if there is nothing to compare.
    pub fn layers(&mut self, own: &Quality, counts: &[(Layering, u64)]) {
        if counts.len() < 2 {
            return self.leave_out(
                "layers of light",
                "it takes one frame with several lights to show what they cost",
            );
        }
        for &(layering, count) in counts {
            let runs = self.short_runs();
            self.push(Axis::Layers, self.short(own), count.to_string(), String::new(), runs);
            if let Some(last) = self.all.last_mut() {
                last.change = Change::Layers(layering);
            }
        }
    }

    /// What a setting is compared with: the file's own with as many samples.
    pub fn twin(&self, index: usize) -> usize {
        let own = &self.all[0];
        let axis = match self.all[index].axis {
            Axis::Samples | Axis::Independent | Axis::Noise | Axis::Antialias => return 0,
            Axis::Remedies => Axis::Remedies,
            _ => Axis::Bounces,
        };
        let same = |other: &Setting| other.axis == axis && other.is_plain(own);
        self.all.iter().position(same).unwrap_or(0)
    }

    /// Whether a setting was stopped before it was as good as it should be, if it took all samples that it may.
    pub fn is_unfinished(&self, index: usize, took_all: bool) -> bool {
        index > 0 && took_all && self.all[index].quality.noise.is_some()
    }
}

impl Setting {
    /// Whether it differs from the file's own setting in its number of samples alone.
    pub fn is_plain(&self, own: &Self) -> bool {
        let (a, b) = (&self.quality, &own.quality);
        self.change == own.change
            && a.bounces == b.bounces
            && a.integrator == b.integrator
            && a.clamp == b.clamp
            && a.points == b.points
    }
}

/// How many samples a pixel gets by a quality: where it is settled on the way, what is expected of the file's own.
pub fn samples_of(quality: &Quality, random: bool, expected: f64) -> f64 {
    match (random, quality.noise) {
        (false, _) => f64::from(quality.antialias * quality.antialias),
        (true, None) => f64::from(quality.samples),
        (true, Some(target)) => expected.clamp(1.0, f64::from(target.most)),
    }
}
