//! Settings that are left out because they missed their noise target.

use super::experiment::{Experiment, FINER, LeftOut};

impl Experiment {
    /// Whether a setting stopped before it reached its noise target; `took_all` is set if it hit the limit of samples.
    pub fn is_unfinished(&self, index: usize, took_all: bool) -> bool {
        index > 0 && took_all && self.all[index].quality.noise.is_some()
    }

    /// Removes settings that missed their noise target, from the experiment and from the results `came`. `capped`
    /// gives the fraction of pixels that hit the limit of samples.
    pub fn without_unfinished<T>(&mut self, came: Vec<T>, capped: impl Fn(&T) -> f64) -> Vec<T> {
        let unfinished: Vec<bool> = came
            .iter()
            .enumerate()
            .map(|(index, came)| self.is_unfinished(index, capped(came) > 0.0))
            .collect();
        for (index, came) in came.iter().enumerate().filter(|(index, _)| unfinished[*index]) {
            let setting = &self.all[index];
            let most = setting.quality.noise.map_or(0, |target| target.most);
            let why = format!(
                "{} missed: {:.0} % of the pixels hit the limit of {most} samples. The limit is this low because the \
                 reference must have {FINER} times as many",
                setting.value,
                100.0 * capped(came),
            );
            self.left_out.push(LeftOut { what: "noise target", why });
        }
        let mut kept = unfinished.iter();
        self.all.retain(|_| kept.next().is_none_or(|unfinished| !unfinished));
        came.into_iter().zip(unfinished).filter(|(_, unfinished)| !unfinished).map(|(came, _)| came).collect()
    }
}
