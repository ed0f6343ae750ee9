//! Gives lights without keys layers of their own, so that switching, dimming and colouring them traces nothing.
//!
//! A film has a layer for each different set of keys. Here each constant becomes a key of its own, before the time 0 and
//! different for each light. So the weight of a light holds its switch, its intensity and its colour, and the scene hash
//! holds none of them.

use crate::base::color::Rgb;
use crate::base::time::Time;
use crate::sequence::Sequence;
use crate::sequence::quality::Integrator;
use crate::track::{Animate, Animated, Ease, Key, Repeat, Track};

/// Most lights that get layers of their own. Whitted's integrator asks every light anyway; paths take samples for each
/// layer.
const MOST_WHITTED: usize = 16;
const MOST_PATHS: usize = 4;

/// The sequence with a layer for each light, if there are few. `is_wanted` names lights that get one anyway.
pub fn isolated(mut sequence: Sequence, is_wanted: impl Fn(&str) -> bool) -> Sequence {
    let most = match sequence.quality.integrator {
        Integrator::Whitted => MOST_WHITTED,
        Integrator::Path(_) => MOST_PATHS,
    };
    let all = sequence.lights.len() <= most;
    for (index, light) in sequence.lights.iter_mut().enumerate() {
        if !(all || is_wanted(&light.name)) {
            continue;
        }
        let light = &mut light.value;
        // The other value of each pair never shows. It keeps a light that is off apart from one that never shines.
        if let Some(on) = light.on.constant() {
            light.on = keyed(&on.into(), |on| !on, index).into();
        }
        light.intensity = keyed(&light.intensity, |intensity| intensity + 1.0, index);
        light.color = keyed(&light.color, |color| color + Rgb::ONE, index);
    }
    let ambient = sequence.lights.len();
    if all && sequence.ambient != Animated::Constant(Rgb::ZERO) {
        sequence.ambient = keyed(&sequence.ambient, |color| color + Rgb::ONE, ambient);
    }
    sequence
}

/// A constant as keys before the time 0: first another value, then the constant.
fn keyed<T: Animate + Clone>(value: &Animated<T>, other: impl Fn(T) -> T, index: usize) -> Animated<T> {
    let Animated::Constant(constant) = value else { return value.clone() };
    let key = |time: i128, value| Key { time: Time::from_integer(time), value, ease: Ease::Step };
    let last = -1 - 2 * index as i128;
    let keys = vec![key(last - 1, other(constant.clone())), key(last, constant.clone())];
    Track::new(keys, Repeat::Hold, false).map_or_else(|_| value.clone(), Animated::Keyed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::schedule::Preview;
    use crate::sequence::parse;

    fn state(light: &str) -> (crate::base::digest::Digest, Vec<Rgb>) {
        let text = format!(
            "(lights: {{ \"a\": Point(position: (1, 2, 3), {light}), \"b\": Point(position: (3, 2, 1)) }},
            objects: {{ \"ball\": (shape: Sphere()) }})"
        );
        let sequence = isolated(parse("a.ron", &text).expect("a sequence"), |_| false);
        let state = Preview::new(&sequence).state(3);
        (state.scene_hash, state.weights)
    }

    #[test]
    fn a_light_without_keys_is_a_weight() {
        let (hash, weights) = state("intensity: 1");
        // Light without keys, ambient light, and both lights.
        assert_eq!(weights, [Rgb::ONE; 4]);
        for (light, weight) in [
            ("intensity: 0.5", Rgb::splat(0.5)),
            ("intensity: 0", Rgb::ZERO),
            ("color: (0.5, 1, 0.25), intensity: 2", Rgb::new(1.0, 2.0, 0.5)),
            ("on: false", Rgb::ZERO),
            ("intensity: [(0, 3), (9, 3)]", Rgb::splat(3.0)),
        ] {
            assert_eq!(state(light), (hash, vec![Rgb::ONE, Rgb::ONE, weight, Rgb::ONE]), "{light}");
        }
    }
}
