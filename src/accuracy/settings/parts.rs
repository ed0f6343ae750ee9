//! Settings that switch off one part of the scene, and remedies for fireflies.

use super::axis::SettingAxis;
use super::experiment::{Experiment, Setting};
use crate::accuracy::change::SceneChange;
use crate::sequence::quality::{Integrator, PathSettings, Quality};

impl Experiment {
    /// Adds a setting for each effect, light or object that is switched off, with its name.
    pub fn parts(&mut self, own: &Quality, parts: Vec<(SceneChange, String)>) {
        for (change, name) in parts {
            self.push(SettingAxis::Parts, self.few_samples(own), name, String::new(), self.paired_runs());
            self.change_last(change);
        }
    }

    /// Adds remedies for fireflies; `refracts` and `area` are set if the scene has refraction and area lights.
    pub fn remedies(&mut self, own: &Quality, refracts: bool, area: bool) {
        let Integrator::Path(path) = own.integrator else { return };
        if !self.random {
            return;
        }
        let samples = (self.facts.samples.ceil() as u32).min(16);
        let short = Quality { samples, noise: None, ..*own };
        self.remedy(short, "as it is".to_owned());
        let clamps = [16.0, 4.0].map(|times| rounded(times * self.facts.bright) as f32);
        for clamp in clamps.into_iter().filter(|clamp| own.clamp.is_none_or(|own| *clamp < own)) {
            self.remedy(Quality { clamp: Some(clamp), ..short }, format!("clamp: {clamp}"));
        }
        if refracts && !path.refractive_shadows {
            let integrator = Integrator::Path(PathSettings { refractive_shadows: true, ..path });
            self.remedy(Quality { integrator, ..short }, "refractive_shadows: true".to_owned());
        }
        if area {
            self.remedy(short, "area lights of twice the size, the same power".to_owned());
            self.change_last(SceneChange::LargerLights);
        }
    }

    fn remedy(&mut self, quality: Quality, value: String) {
        let runs = if self.scope.quick { 8 } else { 16 };
        self.push(SettingAxis::Remedies, quality, value, String::new(), runs);
    }

    fn change_last(&mut self, change: SceneChange) {
        if let Some(Setting { change: last, .. }) = self.all.last_mut() {
            *last = change;
        }
    }
}

/// Rounds to 1, 2 or 5 times a power of ten.
fn rounded(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return 1.0;
    }
    let exponent = libm::floor(libm::log10(value));
    let power = libm::pow(10.0, exponent);
    let far = |digit: &f64| libm::fabs(libm::log(value / (power * digit)));
    let digit = [1.0, 2.0, 5.0, 10.0].into_iter().min_by(|a, b| far(a).total_cmp(&far(b)));
    power * digit.unwrap_or(1.0)
}
