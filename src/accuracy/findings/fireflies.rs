//! Fireflies: single bright pixels that hold most of the error.

use super::{factor, percent};
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::Axis;

impl Measured {
    /// The remedies that were tried, without what they are compared with.
    pub fn remedies(&self) -> Vec<&Point> {
        let own = &self.own().setting;
        let on = self.points.iter().filter(|point| point.setting.axis == Axis::Remedies);
        on.filter(|point| !point.setting.is_plain(own)).collect()
    }

    /// The noise that a remedy leaves, as a share of that without it: a root of mean squares.
    pub fn noise_left(&self, point: &Point) -> f64 {
        (point.variance / self.twin(point).variance).sqrt()
    }

    /// How few pixels hold how much of the error.
    pub fn concentration(&self) -> String {
        let found = self.own().concentration;
        format!(
            "nine tenths of the squared error lie in {} of the pixels, {} in the worst 1 %",
            percent(found.nine_tenths),
            percent(found.worst_hundredth)
        )
    }

    /// Whether the error is fireflies, and what would remove them.
    pub(super) fn fireflies(&self) -> Option<String> {
        let own = self.own();
        if !self.random || own.error() <= 0.0 {
            return None;
        }
        if !own.concentration.is_heavy() {
            return Some(format!("No fireflies: {}", self.concentration()));
        }
        let chain = self.chains.first().map_or_else(String::new, |chain| {
            format!("; {} of it comes by {}", percent(chain.share), chain.path)
        });
        let remedy = self.best_remedy().map_or_else(
            || "; nothing that was tried lowers the whole error".to_owned(),
            |point| {
                let noise = factor(self.noise_left(point));
                let bias = self.amount(point.bias);
                format!("; {} leaves {noise} times the noise, with a bias of {bias}", point.setting.value)
            },
        );
        let kind = match self.chains.first() {
            Some(chain) if chain.direct => "Few pixels hold most of the error",
            _ => "Fireflies",
        };
        Some(format!("{kind}: {}{chain}{remedy}", self.concentration()))
    }

    /// The error that the file's own setting would have with a remedy: noise and bias together.
    pub fn with_remedy(&self, point: &Point) -> f64 {
        let noise = self.own().error() * self.noise_left(point);
        let bias = point.bias.root().unwrap_or(0.0);
        (noise * noise + bias * bias).sqrt()
    }

    /// The remedy that leaves the least error, if it lowers it.
    fn best_remedy(&self) -> Option<&Point> {
        let remedies = self.remedies();
        let best = remedies.into_iter().min_by(|a, b| self.with_remedy(a).total_cmp(&self.with_remedy(b)))?;
        (self.with_remedy(best) < 0.95 * self.own().error()).then_some(best)
    }
}
