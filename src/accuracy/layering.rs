//! The same light in more or fewer layers, to see what keeping it apart costs.

use crate::appearance::light::LightTracks;
use crate::base::time::Time;
use crate::sequence::Sequence;
use crate::track::{Animated, Ease, Key, Repeat, Track};

/// How the light of lights is kept apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layering {
    /// As the sequence's keys have it.
    #[default]
    Own,
    /// Keys of lights hold what they are worth at the moment, so that all of them share a layer.
    Together,
    /// Every light by itself.
    Apart,
}

impl Layering {
    /// A sequence that looks the same at `time`, in these layers.
    pub fn of(self, sequence: &Sequence, time: Time) -> Sequence {
        let mut sequence = sequence.clone();
        let lights = sequence.lights.iter_mut().map(|light| &mut light.value);
        match self {
            Self::Own => {}
            Self::Together => lights.for_each(|light| hold(light, time)),
            Self::Apart => lights.zip(1..).for_each(|(light, number)| set_apart(light, time, number)),
        }
        sequence
    }
}

fn hold(light: &mut LightTracks, time: Time) {
    light.on = light.on.at(time).into();
    light.intensity = light.intensity.at(time).into();
    light.color = light.color.at(time).into();
}

/// Gives a light keys that no other one has, and that change nothing.
fn set_apart(light: &mut LightTracks, time: Time, number: i128) {
    let on = light.on.at(time);
    let key = |second| Key { time: Time::from_integer(second), value: on, ease: Ease::Step };
    if let Ok(track) = Track::new(vec![key(0), key(number)], Repeat::Hold, false) {
        light.on = Animated::Keyed(track);
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
        assert_eq!([Layering::Together, Layering::Own, Layering::Apart].map(layers), [1, 3, 4]);
        let apart = Layering::Apart.of(&sequence, time);
        for (light, own) in apart.lights.iter().zip(&sequence.lights) {
            assert_eq!(light.value.on.at(time), own.value.on.at(time));
        }
        assert_eq!(Layering::Own.of(&sequence, time), sequence);
    }
}
