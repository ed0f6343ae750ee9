//! The settings to measure, and the facts about the scene that they are chosen by.

use super::axis::SettingAxis;
use crate::accuracy::change::SceneChange;
use crate::sequence::quality::Quality;

/// One setting on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    pub axis: SettingAxis,
    pub quality: Quality,
    /// How the sequence differs from the file's.
    pub change: SceneChange,
    /// The value on its axis: a number, or `off`.
    pub value: String,
    /// Options to paste after `kinora render FILE`; empty if only the file can express the setting.
    pub flags: String,
    /// Whether its pixels have random samples.
    pub random: bool,
    /// The expected number of samples per pixel.
    pub samples: f64,
    /// The number of renders.
    pub runs: u32,
}

/// Facts about a sequence from short renders, before settings are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneFacts {
    /// Whether pixels have random samples at the file's own setting.
    pub random: bool,
    /// Whether pixels have random samples with the other integrator.
    pub other_random: bool,
    /// Mean samples per pixel at the file's own setting.
    pub samples: f64,
    /// A rough error of the file's own setting, as a fraction of the mean brightness; 0 if unknown.
    pub error: f64,
    /// The 90th percentile of the radiance of film layers, before their weights.
    pub bright: f64,
}

/// The extent of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scope {
    /// Fewer settings and runs, for a first answer.
    pub quick: bool,
    /// The largest number of samples per pixel, unless the file's own setting has more.
    pub most: Option<u32>,
}

/// An axis or a setting that is not measured, and the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    pub what: &'static str,
    pub why: String,
}

/// All settings to measure of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The first is the file's own.
    pub all: Vec<Setting>,
    pub left_out: Vec<LeftOut>,
    /// Whether pixels have random samples.
    pub random: bool,
    /// Samples per pixel of each of both references.
    pub reference: u32,
    pub(super) scope: Scope,
    pub(super) facts: SceneFacts,
}

/// Both references together have at least this multiple of the samples of every setting that is compared with them.
pub const FINER: u32 = 16;
/// Runs if every picture is the same: they only measure the time.
const STILL_RUNS: u32 = 5;

impl Experiment {
    pub(super) fn push(
        &mut self,
        axis: SettingAxis,
        quality: Quality,
        value: String,
        flags: String,
        runs: u32,
    ) {
        let random = self.random;
        let samples = samples_of(&quality, random, self.facts.samples);
        let runs = if random { runs } else { STILL_RUNS };
        let change = SceneChange::None;
        self.all.push(Setting { axis, quality, change, value, flags, random, samples, runs });
    }

    pub(super) fn leave_out(&mut self, what: &'static str, why: &str) {
        self.left_out.push(LeftOut { what, why: why.to_owned() });
    }

    /// Runs of a setting that is compared with a baseline of the same random numbers.
    pub(super) fn paired_runs(&self) -> u32 {
        if self.scope.quick { 6 } else { 8 }
    }

    /// The file's quality with the few samples that a comparison with a baseline needs.
    pub(super) fn few_samples(&self, own: &Quality) -> Quality {
        let most = if self.scope.quick { (self.center() / 32).clamp(4, 16) } else { 16 };
        Quality { samples: most.min(self.facts.samples.ceil() as u32).max(1), noise: None, ..*own }
    }

    /// The index of the setting to compare with: the file's own setting with as many samples.
    pub fn baseline(&self, index: usize) -> usize {
        let own = &self.all[0];
        let axis = match self.all[index].axis {
            SettingAxis::Samples | SettingAxis::Independent | SettingAxis::Noise | SettingAxis::Antialias => {
                return 0;
            }
            SettingAxis::Remedies => SettingAxis::Remedies,
            _ => SettingAxis::Bounces,
        };
        let same = |other: &Setting| other.axis == axis && other.is_plain(own);
        self.all.iter().position(same).unwrap_or(0)
    }
}

impl Setting {
    /// Whether it differs from the file's own setting only in its number of samples.
    pub fn is_plain(&self, own: &Self) -> bool {
        let (a, b) = (&self.quality, &own.quality);
        self.change == own.change
            && a.bounces == b.bounces
            && a.integrator == b.integrator
            && a.clamp == b.clamp
            && a.points == b.points
    }
}

/// Samples per pixel of a quality. With a noise target, it is the expected number of the file's own setting.
pub fn samples_of(quality: &Quality, random: bool, expected: f64) -> f64 {
    match (random, quality.noise) {
        (false, _) => f64::from(quality.antialias * quality.antialias),
        (true, None) => f64::from(quality.samples),
        (true, Some(target)) => expected.clamp(1.0, f64::from(target.most)),
    }
}
