//! What is not tried, and why.

use super::Settings;

/// An axis or a setting that is not tried, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    pub what: &'static str,
    pub why: String,
}

impl Settings {
    /// Leaves out settings that were stopped before they reached their target, with what came of them: the share of the
    /// pixels that hit the limit, if any did.
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
                "{} missed: {:.0} % of the pixels hit the limit of {most} samples that a reference of {FINER} times as \
                 many allows here",
                setting.value,
                100.0 * capped(came),
                FINER = super::FINER,
            );
            self.left_out.push(LeftOut { what: "noise target", why });
        }
        let mut kept = unfinished.iter();
        self.all.retain(|_| kept.next().is_none_or(|unfinished| !unfinished));
        came.into_iter().zip(unfinished).filter(|(_, unfinished)| !unfinished).map(|(came, _)| came).collect()
    }
}
