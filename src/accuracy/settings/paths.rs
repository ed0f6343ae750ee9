//! Settings of light paths: bounces, roulette, the integrator, and layers of light.

use super::axis::SettingAxis;
use super::experiment::{Experiment, samples_of};
use crate::accuracy::change::SceneChange;
use crate::accuracy::layering::Layering;
use crate::sequence::quality::{Integrator, PathSettings, Quality};

impl Experiment {
    pub(super) fn bounces(&mut self, own: &Quality) {
        let deeper = own.bounces.saturating_mul(2).max(1);
        let mut all: Vec<u32> = vec![0, 1, 2, own.bounces / 2, own.bounces, deeper];
        if !self.scope.quick {
            all.extend([3, 5, 8]);
        }
        all.sort_unstable();
        all.dedup();
        for bounces in all.into_iter().filter(|&bounces| bounces <= deeper) {
            let quality = Quality { bounces, ..self.few_samples(own) };
            let flags = format!("--bounces {bounces}");
            self.push(SettingAxis::Bounces, quality, bounces.to_string(), flags, self.paired_runs());
        }
    }

    pub(super) fn roulette(&mut self, own: &Quality) {
        let Integrator::Path(path) = own.integrator else {
            return self.leave_out("roulette", "the integrator is Whitted, which has no roulette");
        };
        let others = [None, Some(0), Some(3), Some(8)].into_iter().filter(|other| *other != path.roulette);
        for roulette in [path.roulette].into_iter().chain(others) {
            let integrator = Integrator::Path(PathSettings { roulette, ..path });
            let value = roulette.map_or("off".to_owned(), |bounces| format!("after {bounces}"));
            let quality = Quality { integrator, ..self.few_samples(own) };
            self.push(SettingAxis::Roulette, quality, value, String::new(), self.paired_runs());
        }
    }

    /// Adds the integrator that the file does not use.
    pub(super) fn integrators(&mut self, own: &Quality) {
        let (integrator, name) = match own.integrator {
            Integrator::Whitted => (Integrator::Path(PathSettings::default()), "path"),
            Integrator::Path(_) => (Integrator::Whitted, "whitted"),
        };
        let quality = Quality { integrator, ..self.few_samples(own) };
        self.push(
            SettingAxis::Integrator,
            quality,
            name.to_owned(),
            format!("--integrator {name}"),
            self.paired_runs(),
        );
        let random = self.facts.other_random;
        if let Some(last) = self.all.last_mut() {
            last.random = random;
            last.samples = samples_of(&last.quality, random, 0.0);
        }
    }

    /// Adds the axis of layers, from each layering and its number of film layers; nothing if there is only one.
    pub fn layers(&mut self, own: &Quality, counts: &[(Layering, u64)]) {
        if counts.len() < 2 {
            return self.leave_out(
                "layers of light",
                "their cost can only be measured on a single frame with several lights",
            );
        }
        for &(layering, count) in counts {
            let runs = self.paired_runs();
            self.push(SettingAxis::Layers, self.few_samples(own), count.to_string(), String::new(), runs);
            if let Some(last) = self.all.last_mut() {
                last.change = SceneChange::Layers(layering);
            }
        }
    }
}
