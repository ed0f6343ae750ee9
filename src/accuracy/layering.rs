//! The same light in more or fewer film layers, to measure what separate layers cost.

use crate::appearance::light::LightTracks;
use crate::base::time::Time;
use crate::sequence::Sequence;
use crate::track::{Animated, Ease, Key, Repeat, Track};

/// Which lights share a film layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layering {
    /// As the keys of the sequence require.
    #[default]
    AsKeyed,
    /// All lights share one layer: their keys are replaced by their values at the moment.
    Merged,
    /// Each light has a layer of its own.
    Separate,
}

impl Layering {
    /// The sequence with this layering; it looks the same at `time`.
    pub fn of(self, sequence: &Sequence, time: Time) -> Sequence {
        let mut sequence = sequence.clone();
        let lights = sequence.lights.iter_mut().map(|light| &mut light.value);
        match self {
            Self::AsKeyed => {}
            Self::Merged => lights.for_each(|light| hold(light, time)),
            Self::Separate => lights.zip(1..).for_each(|(light, number)| set_apart(light, time, number)),
        }
        sequence
    }
}

fn hold(light: &mut LightTracks, time: Time) {
    light.on = light.on.at(time).into();
    light.intensity = light.intensity.at(time).into();
    light.color = light.color.at(time).into();
}

/// Gives a light keys that no other light has and that do not change the picture.
fn set_apart(light: &mut LightTracks, time: Time, number: i128) {
    let on = light.on.at(time);
    let key = |second| Key { time: Time::from_integer(second), value: on, ease: Ease::Step };
    if let Ok(track) = Track::new(vec![key(0), key(number)], Repeat::Hold, false) {
        light.on = Animated::Keyed(track).into();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::parse;

    #[test]
    fn lights_share_a_layer_or_have_their_own() {
        let text = r#"(
            lights: { "a": Point(position: (0, 9, 0), on: [(0, true), (1, false)]), "b": Point(position: (1, 9, 0)),
                "c": Point(position: (2, 9, 0), intensity: [(0, 1), (2, 3)]), "d": Point(position: (3, 9, 0)) },
            objects: { "ball": (shape: Sphere()) },
        )"#;
        let sequence = parse("test.ron", text).expect("a sequence");
        let time = Time::from_integer(1);
        let layers = |layering: Layering| layering.of(&sequence, time).layers();
        assert_eq!([Layering::Merged, Layering::AsKeyed, Layering::Separate].map(layers), [1, 3, 4]);
        let apart = Layering::Separate.of(&sequence, time);
        for (light, own) in apart.lights.iter().zip(&sequence.lights) {
            assert_eq!(light.value.on.at(time), own.value.on.at(time));
        }
        assert_eq!(Layering::AsKeyed.of(&sequence, time), sequence);
    }
}
