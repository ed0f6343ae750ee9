//! What parts of the scene cost and add, and what bounces do.

use super::{CODES, factor, percent};
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::Axis;

impl Measured {
    /// The share of the time that goes into a part of the scene, by what is saved without it.
    pub fn saves(&self, point: &Point) -> f64 {
        1.0 - point.time() / self.twin(point).time()
    }

    /// The parts of the scene, each switched off, the dearest first.
    pub fn parts(&self) -> Vec<&Point> {
        self.on(Axis::Parts)
    }

    /// The dearest parts of the scene.
    pub(super) fn dearest(&self) -> Option<String> {
        let parts = self.parts();
        let dear = parts.iter().filter(|point| self.saves(point) > 0.03).take(3);
        let named: Vec<String> =
            dear.map(|point| format!("{} {}", point.setting.value, percent(self.saves(point)))).collect();
        (!named.is_empty())
            .then(|| format!("Dearest in this scene, by the time saved without: {}", named.join(", ")))
    }

    fn bounces(&self) -> Vec<&Point> {
        let mut on = self.on(Axis::Bounces);
        on.sort_by_key(|point| point.setting.quality.bounces);
        on
    }

    /// The fewest bounces that display the same as the file's own number, with that, if they are fewer.
    pub(super) fn enough_bounces(&self) -> Option<(&Point, &Point)> {
        let on = self.bounces();
        let own = self.own().setting.quality.bounces;
        let own = on.iter().find(|point| point.setting.quality.bounces == own)?;
        let enough = on.iter().find(|point| CODES * point.largest_change <= 1.0)?;
        (enough.setting.quality.bounces < own.setting.quality.bounces).then_some((*enough, *own))
    }

    /// Whether there are enough bounces, or too many.
    pub(super) fn depth(&self) -> Option<String> {
        let on = self.bounces();
        let own_bounces = self.own().setting.quality.bounces;
        let own = on.iter().find(|point| point.setting.quality.bounces == own_bounces)?;
        let deepest = on.last()?;
        if CODES * deepest.largest_change > 1.0 {
            return Some(format!(
                "Bounces: {} in place of {own_bounces} change the light by {} of the mean, and take {} times the time",
                deepest.setting.value,
                self.amount(deepest.bias),
                factor(deepest.time() / own.time())
            ));
        }
        Some(match self.enough_bounces() {
            Some((least, own)) => format!(
                "Bounces: {} in place of {own_bounces} change nothing above 1/255 and save {} of the time",
                least.setting.value,
                percent((1.0 - least.time() / own.time()).max(0.0))
            ),
            None => format!("Bounces: {own_bounces} are the fewest that leave nothing out above 1/255"),
        })
    }
}
