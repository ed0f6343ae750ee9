//! The settings of the curve of error against time: every factor of two around the file's own setting.

use super::axis::SettingAxis;
use super::experiment::{Experiment, FINER, Scope};
use crate::sampling::SamplerKind;
use crate::sequence::quality::{NoiseTarget, Quality};

/// Runs of each setting of the curve. With `--quick`, only settings below the file's own have this number.
const RUNS: u32 = 16;

impl Scope {
    /// The numbers of steps of a factor of two below and above the file's own setting.
    fn steps(self) -> (u32, u32) {
        if self.quick { (3, 1) } else { (5, 2) }
    }

    fn runs(self, costly: bool) -> u32 {
        if self.quick && costly { RUNS / 2 } else { RUNS }
    }
}

impl Experiment {
    pub(super) fn samples(&mut self, own: &Quality) {
        let plain = |samples, points| Quality { samples, points, noise: None, ..*own };
        let flags = |samples| format!("--samples {samples}");
        // The file's own comes first.
        let runs = self.scope.runs(true);
        match own.noise {
            Some(target) => {
                let flags = format!("--noise {}", target.error);
                self.push(SettingAxis::Noise, *own, percent(target.error), flags, runs);
            }
            None => self.push(SettingAxis::Samples, *own, own.samples.to_string(), flags(own.samples), runs),
        }
        let ladder = self.ladder();
        let center = self.center();
        for &samples in ladder.iter().filter(|&&samples| own.noise.is_some() || samples != own.samples) {
            let runs = self.scope.runs(samples >= center);
            let quality = plain(samples, own.points);
            self.push(SettingAxis::Samples, quality, samples.to_string(), flags(samples), runs);
        }
        let most = if self.scope.quick { center.div_ceil(4) } else { center };
        for &samples in ladder.iter().filter(|&&samples| samples <= most) {
            let quality = plain(samples, SamplerKind::Independent);
            let runs = self.scope.runs(samples >= center);
            self.push(SettingAxis::Independent, quality, samples.to_string(), String::new(), runs);
        }
        let top = self.top();
        // In a long measurement, each of both references has that number of samples.
        let halves = if self.scope.quick { 2 } else { 1 };
        self.reference = FINER.saturating_mul(top).div_ceil(halves);
        self.leave_out(
            "anti-aliasing grid",
            "pixels of this frame have random samples, which smooth edges as well",
        );
    }

    /// The rounded number of samples of the file's own setting.
    pub(super) fn center(&self) -> u32 {
        (self.facts.samples.round() as u32).max(1)
    }

    /// Numbers of samples at every factor of two around the file's own setting.
    fn ladder(&self) -> Vec<u32> {
        let (below, above) = self.scope.steps();
        let center = self.center();
        let most = self.scope.most.unwrap_or(u32::MAX).max(center);
        let mut all: Vec<u32> = (0..=below).rev().map(|step| (center >> step).max(1)).collect();
        all.extend(
            (1..=above).map(|step| center.saturating_mul(1 << step)).filter(|&samples| samples <= most),
        );
        all.dedup();
        all
    }

    /// The largest number of samples of all settings that are compared with the references.
    fn top(&self) -> u32 {
        let curve = self.all.iter().filter(|setting| !setting.axis.has_baseline());
        curve.map(|setting| setting.samples.ceil() as u32).fold(1, u32::max)
    }

    /// Noise targets around the error of the file's own setting.
    pub(super) fn targets(&mut self, own: &Quality) {
        let error = own.noise.map_or(self.facts.error, |target| target.error);
        if error <= 0.0 {
            return;
        }
        let most = own.noise.map_or(NoiseTarget::MOST, |own| own.most).min(self.top());
        let factors = if self.scope.quick { &[1.0, 2.0][..] } else { &[0.5, 1.0, 2.0, 4.0] };
        for error in factors.iter().map(|factor| rounded(factor * error)).filter(|error| *error < 1.0) {
            if own.noise.is_some_and(|target| libm::fabs(target.error / error - 1.0) < 0.25) {
                continue;
            }
            let quality = Quality { noise: Some(NoiseTarget { error, most }), ..*own };
            let runs = self.scope.runs(true);
            self.push(SettingAxis::Noise, quality, percent(error), format!("--noise {error}"), runs);
        }
    }

    pub(super) fn grids(&mut self, own: &Quality) {
        let grid = |n| (Quality { antialias: n, ..*own }, format!("{n}x{n}"), format!("--antialias {n}"));
        let finest = (2 * own.antialias).clamp(own.antialias, 64).max(3);
        let mut others: Vec<u32> = vec![1, own.antialias / 2, own.antialias.saturating_sub(1)];
        others.extend([own.antialias + 1, 3 * own.antialias / 2, finest]);
        others.retain(|&n| (1..=64).contains(&n) && n != own.antialias);
        others.sort_unstable();
        others.dedup();
        for n in [own.antialias].into_iter().chain(others) {
            let (quality, value, flags) = grid(n);
            self.push(SettingAxis::Antialias, quality, value, flags, RUNS);
        }
        self.reference = FINER * finest * finest;
        for what in ["samples", "noise target"] {
            self.leave_out(what, "nothing in this frame is random, so pixels are sampled on a regular grid");
        }
    }
}

/// Rounds to 1, 1.5, 2, 3, 5 or 7 times a power of ten.
fn rounded(value: f64) -> f64 {
    let digits = [10.0, 15.0, 20.0, 30.0, 50.0, 70.0, 100.0];
    let exponent = libm::floor(libm::log10(value));
    let scale = libm::pow(10.0, 1.0 - exponent);
    let far = |digit: &f64| libm::fabs(libm::log(value * scale / digit));
    let digit = digits.into_iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(10.0);
    // A division, because 0.05 is not 50 times the f64 nearest to 0.001.
    digit / scale
}

fn percent(error: f64) -> String {
    format!("{} %", rounded_percent(error))
}

fn rounded_percent(error: f64) -> f64 {
    libm::round(error * 1e6) / 1e4
}
