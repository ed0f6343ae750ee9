//! The cost of parts of the scene, and the effect of bounces.

use super::base::CODES;
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::SettingAxis;
use crate::base::units::{factor, percent};

impl Measured {
    /// The fraction of the time that switching off a part of the scene saves.
    pub fn saves(&self, point: &Point) -> f64 {
        1.0 - point.time() / self.baseline(point).time()
    }

    /// The points of switched-off parts of the scene, in ascending order of time: the most expensive part first.
    pub fn parts(&self) -> Vec<&Point> {
        self.on(SettingAxis::Parts)
    }

    /// A sentence about the most expensive parts of the scene.
    pub(super) fn dearest(&self) -> Option<String> {
        let parts = self.parts();
        let dear = parts.iter().filter(|point| self.saves(point) > 0.03).take(3);
        let named: Vec<String> =
            dear.map(|point| format!("{} {}", point.setting.value, percent(self.saves(point)))).collect();
        (!named.is_empty()).then(|| {
            format!(
                "Most expensive parts of this scene, by the time saved without them: {}",
                named.join(", ")
            )
        })
    }

    fn bounces(&self) -> Vec<&Point> {
        let mut on = self.on(SettingAxis::Bounces);
        on.sort_by_key(|point| point.setting.quality.bounces);
        on
    }

    /// The points of the fewest bounces that display the same picture, and of the file's own number, if that is larger.
    pub(super) fn enough_bounces(&self) -> Option<(&Point, &Point)> {
        let on = self.bounces();
        let own = self.own().setting.quality.bounces;
        let own = on.iter().find(|point| point.setting.quality.bounces == own)?;
        let enough = on.iter().find(|point| CODES * point.largest_change <= 1.0)?;
        (enough.setting.quality.bounces < own.setting.quality.bounces).then_some((*enough, *own))
    }

    /// A sentence about whether the file's number of bounces is too small, too large, or right.
    pub(super) fn depth(&self) -> Option<String> {
        let on = self.bounces();
        let own_bounces = self.own().setting.quality.bounces;
        let own = on.iter().find(|point| point.setting.quality.bounces == own_bounces)?;
        let deepest = on.last()?;
        if CODES * deepest.largest_change > 1.0 {
            return Some(format!(
                "Bounces: {} instead of {own_bounces} change the light by {} of the mean, and take {} times the time",
                deepest.setting.value,
                self.bias_phrase(deepest.bias),
                factor(deepest.time() / own.time())
            ));
        }
        Some(match self.enough_bounces() {
            Some((least, own)) => format!(
                "Bounces: {} instead of {own_bounces} change no pixel by more than 1/255 and save {} of the time",
                least.setting.value,
                percent((1.0 - least.time() / own.time()).max(0.0))
            ),
            None => format!("Bounces: {own_bounces} is the smallest number that omits no light above 1/255"),
        })
    }
}
