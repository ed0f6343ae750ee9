//! In how many ways light is keyed: each of them takes a picture of its own in memory.

use super::Sequence;
use super::fault::Fault;
use super::node::File;
use crate::glow::{Dimmer, Glow};
use crate::layers::Layers;
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
}

impl Sequence {
    /// How many layers its films have.
    pub fn layers(&self) -> u64 {
        let mut layers = Layers::new();
        self.dimmers().for_each(|dimmer| _ = layers.of(&dimmer));
        layers.count() as u64
    }

    /// How each light is keyed: background, ambient light and fog, then lights, then emission.
    fn dimmers(&self) -> impl Iterator<Item = Dimmer> {
        let air = [self.background.dimmer(), Glow::split(&self.ambient).1];
        let fog = self.fog.as_ref().map(|fog| fog.split().1);
        let lights = self.lights.iter().map(|light| light.value.dimmer());
        let emission = self.materials.iter().map(|material| material.value.emission_split().1);
        air.into_iter().chain(fog).chain(lights).chain(emission)
    }
}

/// Reports the first light, or material that shines, which is keyed in one more way than there may be.
pub fn report_too_many_layers(file: &File<'_>, sequence: &Sequence, places: &Places) {
    let mut layers = Layers::new();
    let too_many = |dimmer: Dimmer| {
        layers.of(&dimmer);
        // One layer is for light without keys.
        layers.count() > MOST_WAYS + 1
    };
    let Some(index) = sequence.dimmers().position(too_many) else { return };
    // Background, ambient light and fog come first, and are never too many alone.
    let index = index - 2 - usize::from(sequence.fog.is_some());
    let mut named = places.lights.iter().chain(&places.materials);
    let (place, label) = match named.nth(index) {
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
    }
}
