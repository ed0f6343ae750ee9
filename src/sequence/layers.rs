//! Assigns emitters to layers of the film. Emitters with equal keys share a layer; each layer takes as much memory as
//! a picture.

use super::Sequence;
use super::fault::Fault;
use super::source_file::File;
use crate::appearance::light_groups::LightGroups;
use crate::appearance::light_groups::{GroupRadiance, GroupWeight};
use crate::film::LayerId;
use std::ops::Range;

/// Maximum number of different keys of light.
const MAX_LIGHT_GROUPS: usize = 1024;

/// Places of emitters in the file.
pub struct EmitterPlaces {
    /// One for each light.
    pub lights: Vec<Range<usize>>,
    /// One for each named material.
    pub materials: Vec<Range<usize>>,
    /// The place for materials without a name.
    pub objects: Range<usize>,
    pub fog: Range<usize>,
}

/// Anything that emits light. Lights and materials have the index in the sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmitterId {
    Background,
    Ambient,
    Light(usize),
    Material(usize),
    Fog,
}

/// The layer of each emitter.
#[derive(Debug)]
pub struct LightLayers {
    pub background: LayerId,
    pub ambient: LayerId,
    /// One for each light.
    pub lights: Vec<LayerId>,
    /// One for each material, because materials may emit light.
    pub materials: Vec<LayerId>,
    pub fog: LayerId,
    /// Number of layers, including the one for light without keys.
    pub count: usize,
}

#[warn(missing_docs)]
impl Sequence {
    /// Number of light layers of the films.
    pub fn layers(&self) -> u64 {
        self.light_layers().count as u64
    }

    /// Assigns each emitter to a layer.
    pub fn light_layers(&self) -> LightLayers {
        let mut layers = LightGroups::new();
        let constant = LayerId::CONSTANT;
        let mut of = LightLayers {
            background: constant,
            ambient: constant,
            lights: vec![constant; self.lights.len()],
            materials: vec![constant; self.materials.len()],
            fog: constant,
            count: 0,
        };
        for (what, dimmer) in self.keyed_weights() {
            let layer = match what {
                EmitterId::Background => &mut of.background,
                EmitterId::Ambient => &mut of.ambient,
                EmitterId::Light(index) => &mut of.lights[index],
                EmitterId::Material(index) => &mut of.materials[index],
                EmitterId::Fog => &mut of.fog,
            };
            *layer = layers.of(&dimmer);
        }
        of.count = layers.count();
        of
    }

    /// The keyed weight of each emitter. Only this function knows the order in which layers are assigned.
    pub(super) fn keyed_weights(&self) -> impl Iterator<Item = (EmitterId, GroupWeight)> {
        let air = [
            (EmitterId::Background, self.background.group_weight()),
            (EmitterId::Ambient, GroupRadiance::split(&self.ambient).1),
        ];
        let light = |index| (EmitterId::Light(index), self.lights[index].value.group_weight());
        let emission = |index| (EmitterId::Material(index), self.materials[index].value.emission_split().1);
        let fog = self.fog.iter().map(|fog| (EmitterId::Fog, fog.split().1));
        let lights = (0..self.lights.len()).map(light);
        air.into_iter().chain(lights).chain((0..self.materials.len()).map(emission)).chain(fog)
    }
}

/// Reports the first emitter whose keys need more layers than the limit.
pub fn report_too_many_layers(file: &File<'_>, sequence: &Sequence, places: &EmitterPlaces) {
    let mut layers = LightGroups::new();
    let too_many = |(_, group_weight): &(EmitterId, GroupWeight)| {
        layers.of(group_weight);
        // One layer is for light without keys.
        layers.count() > MAX_LIGHT_GROUPS + 1
    };
    let Some((what, _)) = sequence.keyed_weights().find(too_many) else { return };
    let named = match what {
        // Background and ambient light come first, so they never exceed the limit.
        EmitterId::Background | EmitterId::Ambient => None,
        EmitterId::Light(index) => places.lights.get(index),
        EmitterId::Material(index) => places.materials.get(index),
        EmitterId::Fog => Some(&places.fog),
    };
    let (place, label) = match named {
        Some(place) => (place, "this one is too many"),
        None => (&places.objects, "a material in here is too many"),
    };
    let title = format!("light is keyed in more than {MAX_LIGHT_GROUPS} different ways");
    let help = "each different set of keys, also of emission, takes a picture in memory; give some lights equal keys";
    file.push(Fault::new(place.clone(), title, label).help(help));
}

#[cfg(test)]
mod tests {
    use crate::sequence::parse;
    use std::fmt::Write;

    /// Entries that are each keyed differently, numbered from `first`.
    fn entries(first: usize, count: usize, entry: impl Fn(usize) -> String) -> String {
        (first..first + count).fold(String::new(), |mut text, index| {
            _ = writeln!(text, "\"{index}\": {},", entry(index));
            text
        })
    }

    fn layer_count(text: &str) -> Result<u64, String> {
        parse("a.ron", text).map(|sequence| sequence.layers()).map_err(|faults| faults.to_string())
    }

    #[test]
    fn all_keyed_light_counts() {
        let lamp = |index| format!("Point(position: (1, 2, 3), intensity: [(0, 0), (1, {index})])");
        let glow = |index| format!("(emission: [(0, 0), (1, {index})])");
        let shape = |index| format!("(shape: Sphere(), material: {})", glow(index));
        let text = |lights, materials, objects| {
            let lights = entries(1, lights, lamp);
            let (materials, objects) = (entries(2000, materials, glow), entries(4000, objects, shape));
            format!(
                "(ambient: [(0, 0), (1, 0.1)], lights: {{ {lights} }}, materials: {{ {materials} }},
                objects: {{ {objects} }})"
            )
        };
        assert_eq!(layer_count(&text(500, 500, 23)), Ok(1025));
        for (lights, materials, objects, place) in [
            (1023, 1, 0, "\"2000\": (emission"),
            (1024, 0, 0, "\"1024\": Point"),
            (1024, 1, 0, "\"1024\": Point"),
            (0, 1000, 24, "objects: {"),
        ] {
            let message = layer_count(&text(lights, materials, objects)).expect_err("too many");
            assert!(message.contains("light is keyed in more than 1024 different ways"), "{message}");
            assert!(message.contains(place) && message.contains("too many"), "{message}");
        }
        let fog = "fog: (density: 0.1, color: [(0, 0), (1, 0.5)])";
        let faulty = text(1023, 0, 0).replacen('(', &format!("({fog}, "), 1);
        let message = layer_count(&faulty).expect_err("too many");
        assert!(message.contains(fog) && message.contains("this one is too many"), "{message}");
    }
}
