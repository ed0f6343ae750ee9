//! Fireflies: single bright pixels that contain most of the error.

use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::SettingAxis;
use crate::base::units::{factor, percent};

impl Measured {
    /// The measured remedies, without their baseline.
    pub fn remedies(&self) -> Vec<&Point> {
        let own = &self.own().setting;
        let on = self.points.iter().filter(|point| point.setting.axis == SettingAxis::Remedies);
        on.filter(|point| !point.setting.is_plain(own)).collect()
    }

    /// The standard deviation with a remedy, relative to that without it.
    pub fn noise_left(&self, point: &Point) -> f64 {
        (point.variance / self.baseline(point).variance).sqrt()
    }

    /// The concentration of the error in words.
    pub fn concentration(&self) -> String {
        let found = self.own().concentration;
        format!(
            "{} of the pixels contain nine tenths of the squared error, the worst 1 % contain {}",
            percent(found.nine_tenths),
            percent(found.worst_hundredth)
        )
    }

    /// A sentence about whether fireflies dominate the error, and which remedy helps most.
    pub(super) fn fireflies(&self) -> Option<String> {
        let own = self.own();
        if !self.random || own.error() <= 0.0 {
            return None;
        }
        if !own.concentration.is_heavy() {
            return Some(format!("No fireflies: {}", self.concentration()));
        }
        let chain = self.chains.first().map_or_else(String::new, |chain| {
            format!("; {} of the noise comes from the path {}", percent(chain.share), chain.path)
        });
        let remedy = self.best_remedy().map_or_else(
            || "; no measured remedy lowers the total error".to_owned(),
            |point| {
                let noise = factor(self.noise_left(point));
                let bias = self.bias_phrase(point.bias);
                format!("; {} leaves {noise} times the noise, with a bias of {bias}", point.setting.value)
            },
        );
        let kind = match self.chains.first() {
            Some(chain) if chain.direct => "Few pixels hold most of the error",
            _ => "Fireflies",
        };
        Some(format!("{kind}: {}{chain}{remedy}", self.concentration()))
    }

    /// The predicted error of the file's own setting with a remedy: noise and bias together.
    pub fn with_remedy(&self, point: &Point) -> f64 {
        let noise = self.own().error() * self.noise_left(point);
        let bias = point.bias.root().unwrap_or(0.0);
        (noise * noise + bias * bias).sqrt()
    }

    /// The remedy with the smallest total error, if it lowers the error by at least 5 %.
    fn best_remedy(&self) -> Option<&Point> {
        let remedies = self.remedies();
        let best = remedies.into_iter().min_by(|a, b| self.with_remedy(a).total_cmp(&self.with_remedy(b)))?;
        (self.with_remedy(best) < 0.95 * self.own().error()).then_some(best)
    }
}
