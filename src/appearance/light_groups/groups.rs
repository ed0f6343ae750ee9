//! Assigns lights to layers of the film: lights with equal keyed weights share a layer.

use crate::appearance::light_groups::weight::GroupWeight;
use crate::film::LayerId;

/// The layers of the film: one for all light without keys, and one for each different [`GroupWeight`].
#[derive(Debug)]
pub struct LightGroups {
    weights: Vec<GroupWeight>,
}

impl LightGroups {
    pub fn new() -> Self {
        Self { weights: vec![GroupWeight::default()] }
    }

    /// The layer of light with this weight. Equal weights share a layer. New layers are numbered in the order of the
    /// calls.
    pub fn of(&mut self, weight: &GroupWeight) -> LayerId {
        let known = self.weights.iter().position(|other| other == weight);
        let index = known.unwrap_or_else(|| {
            self.weights.push(weight.clone());
            self.weights.len() - 1
        });
        LayerId(index as u32)
    }

    pub fn count(&self) -> usize {
        self.weights.len()
    }
}

impl Default for LightGroups {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Time;
    use crate::track::{Animated, Ease, Key, Repeat, Track};

    fn switched_at(second: i128) -> GroupWeight {
        let key = |time: i128, value| Key { time: Time::from_integer(time), value, ease: Ease::Step };
        let track = Track::new(vec![key(0, false), key(second, true)], Repeat::Hold, false).expect("a track");
        GroupWeight { on: Some(Animated::Keyed(track).into()), ..GroupWeight::default() }
    }

    #[test]
    fn lights_keyed_alike_share_a_layer() {
        let mut layers = LightGroups::new();
        let of =
            [GroupWeight::default(), switched_at(1), switched_at(2), switched_at(1)].map(|d| layers.of(&d).0);
        assert_eq!(of, [0, 1, 2, 1]);
        assert_eq!(layers.count(), 3);
    }
}
