//! What a scene is made of, switched off piece by piece, and what may remove its fireflies.

use super::{Axis, Setting, Settings};
use crate::accuracy::change::Change;
use crate::sequence::quality::{Integrator, PathSettings, Quality};

impl Settings {
    /// Adds effects, lights and objects, each switched off, under their names.
    pub fn parts(&mut self, own: &Quality, parts: Vec<(Change, String)>) {
        for (change, name) in parts {
            self.push(Axis::Parts, self.short(own), name, String::new(), self.short_runs());
            self.change_last(change);
        }
    }

    /// Adds what may remove fireflies; `refracts` and `area` tell whether the scene has refraction and area lights.
    pub fn remedies(&mut self, own: &Quality, refracts: bool, area: bool) {
        let Integrator::Path(path) = own.integrator else { return };
        if !self.random {
            return;
        }
        let samples = (self.known.samples.ceil() as u32).min(16);
        let short = Quality { samples, noise: None, ..*own };
        self.remedy(short, "as it is".to_owned());
        let clamps = [16.0, 4.0].map(|times| rounded(times * self.known.bright) as f32);
        for clamp in clamps.into_iter().filter(|clamp| own.clamp.is_none_or(|own| *clamp < own)) {
            self.remedy(Quality { clamp: Some(clamp), ..short }, format!("clamp: {clamp}"));
        }
        if refracts && !path.refractive_shadows {
            let integrator = Integrator::Path(PathSettings { refractive_shadows: true, ..path });
            self.remedy(Quality { integrator, ..short }, "refractive_shadows: true".to_owned());
        }
        if area {
            self.remedy(short, "area lights of twice the size, as much light".to_owned());
            self.change_last(Change::LargerLights);
        }
    }

    fn remedy(&mut self, quality: Quality, value: String) {
        let runs = if self.scope.quick { 8 } else { 16 };
        self.push(Axis::Remedies, quality, value, String::new(), runs);
    }

    fn change_last(&mut self, change: Change) {
        if let Some(Setting { change: last, .. }) = self.all.last_mut() {
            *last = change;
        }
    }
}

/// A number of one digit: 1, 2 or 5 times a power of ten.
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
