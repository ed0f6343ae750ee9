//! Which light shares a layer of the film with which: light that is keyed alike.

use crate::appearance::light_groups::glow::Dimmer;
use crate::film::LayerId;

/// The film's layers: one for all light that no key weights, and one per different [`Dimmer`].
#[derive(Debug)]
pub struct Layers {
    dimmers: Vec<Dimmer>,
}

impl Layers {
    pub fn new() -> Self {
        Self { dimmers: vec![Dimmer::default()] }
    }

    /// The layer of light weighted by `dimmer`; equal dimmers share one. The order of the calls is that of
    /// the layers.
    pub fn of(&mut self, dimmer: &Dimmer) -> LayerId {
        let known = self.dimmers.iter().position(|other| other == dimmer);
        let index = known.unwrap_or_else(|| {
            self.dimmers.push(dimmer.clone());
            self.dimmers.len() - 1
        });
        LayerId(index as u32)
    }

    pub fn count(&self) -> usize {
        self.dimmers.len()
    }
}

impl Default for Layers {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Time;
    use crate::track::{Animated, Ease, Key, Repeat, Track};

    fn switched_at(second: i128) -> Dimmer {
        let key = |time: i128, value| Key { time: Time::from_integer(time), value, ease: Ease::Step };
        let track = Track::new(vec![key(0, false), key(second, true)], Repeat::Hold, false).expect("a track");
        Dimmer { on: Some(Animated::Keyed(track)), ..Dimmer::default() }
    }

    #[test]
    fn lights_keyed_alike_share_a_layer() {
        let mut layers = Layers::new();
        let of = [Dimmer::default(), switched_at(1), switched_at(2), switched_at(1)].map(|d| layers.of(&d).0);
        assert_eq!(of, [0, 1, 2, 1]);
        assert_eq!(layers.count(), 3);
    }
}
