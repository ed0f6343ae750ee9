//! Which light goes into which layer of a film: what is keyed alike shares one, which is a picture of its own in memory.

use super::Sequence;
use super::fault::Fault;
use super::node::File;
use crate::appearance::light_groups::glow::{Dimmer, Glow};
use crate::appearance::light_groups::layers::Layers;
use crate::film::LayerId;
use std::ops::Range;

/// Different keys of light at most.
const MOST_WAYS: usize = 1024;

/// Where that which shines stands in the file.
pub struct Places {
    /// Of every light.
    pub lights: Vec<Range<usize>>,
    /// Of every material with a name.
    pub materials: Vec<Range<usize>>,
    /// Of those without one.
    pub objects: Range<usize>,
    pub fog: Range<usize>,
}

/// Whatever may shine in a sequence. Lights and materials are told by their indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shining {
    Background,
    Ambient,
    Light(usize),
    Material(usize),
    Fog,
}

/// The layer of everything that may shine.
#[derive(Debug)]
pub struct LightLayers {
    pub background: LayerId,
    pub ambient: LayerId,
    /// Of every light.
    pub lights: Vec<LayerId>,
    /// Of every material, which may glow.
    pub materials: Vec<LayerId>,
    pub fog: LayerId,
    /// How many there are, with that of light without keys.
    pub count: usize,
}

impl Sequence {
    /// How many layers its films have.
    pub fn layers(&self) -> u64 {
        self.light_layers().count as u64
    }

    /// Gives all light its layer.
    pub fn light_layers(&self) -> LightLayers {
        let mut layers = Layers::new();
        let constant = LayerId::CONSTANT;
        let mut of = LightLayers {
            background: constant,
            ambient: constant,
            lights: vec![constant; self.lights.len()],
            materials: vec![constant; self.materials.len()],
            fog: constant,
            count: 0,
        };
        for (what, dimmer) in self.dimmers() {
            let layer = match what {
                Shining::Background => &mut of.background,
                Shining::Ambient => &mut of.ambient,
                Shining::Light(index) => &mut of.lights[index],
                Shining::Material(index) => &mut of.materials[index],
                Shining::Fog => &mut of.fog,
            };
            *layer = layers.of(&dimmer);
        }
        of.count = layers.count();
        of
    }

    /// How each light is keyed, in the order in which layers are given. This is the one place that knows it.
    pub(super) fn dimmers(&self) -> impl Iterator<Item = (Shining, Dimmer)> {
        let air = [
            (Shining::Background, self.background.dimmer()),
            (Shining::Ambient, Glow::split(&self.ambient).1),
        ];
        let light = |index| (Shining::Light(index), self.lights[index].value.dimmer());
        let emission = |index| (Shining::Material(index), self.materials[index].value.emission_split().1);
        let fog = self.fog.iter().map(|fog| (Shining::Fog, fog.split().1));
        let lights = (0..self.lights.len()).map(light);
        air.into_iter().chain(lights).chain((0..self.materials.len()).map(emission)).chain(fog)
    }
}

/// Reports the first light, or material that shines, which is keyed in one more way than there may be.
pub fn report_too_many_layers(file: &File<'_>, sequence: &Sequence, places: &Places) {
    let mut layers = Layers::new();
    let too_many = |(_, dimmer): &(Shining, Dimmer)| {
        layers.of(dimmer);
        // One layer is for light without keys.
        layers.count() > MOST_WAYS + 1
    };
    let Some((what, _)) = sequence.dimmers().find(too_many) else { return };
    let named = match what {
        // Background and ambient light come first, and are never too many.
        Shining::Background | Shining::Ambient => None,
        Shining::Light(index) => places.lights.get(index),
        Shining::Material(index) => places.materials.get(index),
        Shining::Fog => Some(&places.fog),
    };
    let (place, label) = match named {
        Some(place) => (place, "this one is too many"),
        None => (&places.objects, "a material in here is too many"),
    };
    let title = format!("light is keyed in more than {MOST_WAYS} different ways");
    let help =
        "all light that is keyed alike, emission too, takes a picture of its own in memory; key some alike";
    file.push(Fault::new(place.clone(), title, label).help(help));
}

#[cfg(test)]
mod tests {
    use crate::sequence::parse;
    use std::fmt::Write;

    /// So many entries, each keyed in its own way from `first` on.
    fn entries(first: usize, count: usize, entry: impl Fn(usize) -> String) -> String {
        (first..first + count).fold(String::new(), |mut text, index| {
            _ = writeln!(text, "\"{index}\": {},", entry(index));
            text
        })
    }

    fn told(text: &str) -> Result<u64, String> {
        parse("a.ron", text).map(|sequence| sequence.layers()).map_err(|faults| faults.to_string())
    }

    #[test]
    fn everything_that_is_keyed_counts() {
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
        assert_eq!(told(&text(500, 500, 23)), Ok(1025));
        for (lights, materials, objects, place) in [
            (1023, 1, 0, "\"2000\": (emission"),
            (1024, 0, 0, "\"1024\": Point"),
            (1024, 1, 0, "\"1024\": Point"),
            (0, 1000, 24, "objects: {"),
        ] {
            let told = told(&text(lights, materials, objects)).expect_err("too many");
            assert!(told.contains("light is keyed in more than 1024 different ways"), "{told}");
            assert!(told.contains(place) && told.contains("too many"), "{told}");
        }
        let fog = "fog: (density: 0.1, color: [(0, 0), (1, 0.5)])";
        let faulty = text(1023, 0, 0).replacen('(', &format!("({fog}, "), 1);
        let told = told(&faulty).expect_err("too many");
        assert!(told.contains(fog) && told.contains("this one is too many"), "{told}");
    }
}
