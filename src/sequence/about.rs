//! Metadata of a sequence for the files that it renders.

use super::Sequence;
use super::layers::EmitterId;
use super::quality::Denoise;
use crate::appearance::light_groups::LightGroups;
use crate::encode::{ALBEDO, ANNOTATIONS, NORMAL, SAMPLES, SequenceInfo};
use std::collections::HashSet;

#[warn(missing_docs)]
impl Sequence {
    /// Name, length, settings and layer names of the sequence.
    pub fn about(&self) -> SequenceInfo {
        SequenceInfo {
            name: self.name.clone(),
            frames: self.timeline.frames,
            seed: self.quality.seed,
            vary_noise: self.quality.vary_noise,
            samples: self.quality.samples,
            antialias: self.quality.antialias,
            noise: self.quality.noise.map(|target| target.error),
            denoised: self.quality.denoise != Denoise::Off,
            time_limit: None,
            layers: self.layer_names(),
        }
    }

    /// Names of the film's light layers. The layer without keys is `constant`; others are named after their emitters.
    /// Names are unique and contain only letters, digits and signs that all programs accept.
    fn layer_names(&self) -> Vec<String> {
        let mut layers = LightGroups::new();
        let mut members: Vec<Vec<&str>> = vec![Vec::new()];
        for (what, dimmer) in self.keyed_weights() {
            let index = layers.of(&dimmer).index();
            members.resize(layers.count().max(members.len()), Vec::new());
            members[index].push(self.name_of(what));
        }
        let mut taken: HashSet<String> = TAKEN.map(str::to_owned).into();
        let mut names = vec![CONSTANT.to_owned()];
        for (index, members) in members.iter().enumerate().skip(1) {
            let name = unlike(plain(&members.join("+")), index, &taken);
            taken.insert(name.clone());
            names.push(name);
        }
        names
    }

    fn name_of(&self, what: EmitterId) -> &str {
        match what {
            EmitterId::Background => "background",
            EmitterId::Ambient => "ambient",
            EmitterId::Light(index) => &self.lights[index].name,
            EmitterId::Material(index) => &self.materials[index].name,
            EmitterId::Fog => "fog",
        }
    }
}

/// Name of the layer for light without keys.
const CONSTANT: &str = "constant";

/// Names that keyed layers must not have, because files may have other channels under them.
const TAKEN: [&str; 5] = [CONSTANT, NORMAL, ALBEDO, ANNOTATIONS, SAMPLES];

/// Appends `index` until the name is unique.
fn unlike(mut name: String, index: usize, taken: &HashSet<String>) -> String {
    while taken.contains(&name) {
        name += &format!("_{index}");
    }
    name
}

/// Replaces unusual characters, and dots, which separate layers from channels. Cuts long names.
fn plain(name: &str) -> String {
    let letter = |c: char| if c.is_alphanumeric() || "+-_".contains(c) { c } else { '_' };
    name.chars().map(letter).take(60).collect()
}

#[cfg(test)]
mod tests {
    use crate::sequence::parse;

    #[test]
    fn layers_are_named_after_their_emitters() {
        let text = r#"(
            background: [(0, 0), (1, 1)],
            lights: {
                "key.1": Point(position: (1, 2, 3), on: [(0, true), (1, false)]),
                "sun": Point(position: (1, 2, 3)),
                "fill": Point(position: (1, 2, 3), intensity: [(0, 1), (1, 0)]),
                "rim": Point(position: (3, 2, 3), on: [(0, true), (1, false)]),
                "constant": Point(position: (3, 2, 3), on: [(0, true), (2, false)]),
            },
        )"#;
        let sequence = parse("a.ron", text).expect("a sequence");
        let names = sequence.about().layers;
        assert_eq!(names, ["constant", "background", "key_1+rim", "fill", "constant_4"]);
        assert_eq!(names.len() as u64, sequence.layers());
    }

    #[test]
    fn layer_names_differ_from_other_channels() {
        let named = |lights: &[&str]| {
            let light = |(index, name): (usize, &&str)| {
                format!("{name:?}: Point(position: (1, 2, 3), intensity: [(0, 1), ({}, 0)]),", index + 1)
            };
            let lights: String = lights.iter().enumerate().map(light).collect();
            let sequence = parse("a.ron", &format!("(lights: {{ {lights} }})")).expect("a sequence");
            sequence.about().layers
        };
        assert_eq!(named(&["albedo", "N", "Z"]), ["constant", "albedo_1", "N_2", "Z"]);
        // The name with a number may exist already.
        assert_eq!(named(&["x y", "x_y_3", "x.y"]), ["constant", "x_y", "x_y_3", "x_y_3_3"]);
        assert_eq!(named(&["a_2", "a 2", "a_2_2"]), ["constant", "a_2", "a_2_2", "a_2_2_3"]);
    }
}
