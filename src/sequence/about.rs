//! What a sequence tells about itself in the files that come of it.

use super::Sequence;
use super::layers::Shining;
use crate::appearance::light_groups::layers::Layers;
use crate::encode::{ALBEDO, About, NORMAL};
use std::collections::HashSet;

impl Sequence {
    /// Its name, length and settings, and the names of its layers of light.
    pub fn about(&self) -> About {
        About {
            name: self.name.clone(),
            frames: self.timeline.frames,
            seed: self.quality.seed,
            samples: self.quality.samples,
            antialias: self.quality.antialias,
            noise: self.quality.noise.map(|target| target.error),
            time_limit: None,
            layers: self.layer_names(),
        }
    }

    /// What the film's layers of light are called: that without keys `constant`, the others after whatever shines
    /// in them. Different layers have different names, of letters, digits and signs that no program minds.
    fn layer_names(&self) -> Vec<String> {
        let mut layers = Layers::new();
        let mut members: Vec<Vec<&str>> = vec![Vec::new()];
        for (what, dimmer) in self.dimmers() {
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

    fn name_of(&self, what: Shining) -> &str {
        match what {
            Shining::Background => "background",
            Shining::Ambient => "ambient",
            Shining::Light(index) => &self.lights[index].name,
            Shining::Material(index) => &self.materials[index].name,
            Shining::Fog => "fog",
        }
    }
}

/// The layer of light without keys.
const CONSTANT: &str = "constant";

/// Names that no keyed layer may have, as files have other channels under them, whether these are asked for or not.
const TAKEN: [&str; 3] = [CONSTANT, NORMAL, ALBEDO];

/// The name, or if it is taken already, with as many numbers behind it as make it another.
fn unlike(mut name: String, index: usize, taken: &HashSet<String>) -> String {
    while taken.contains(&name) {
        name += &format!("_{index}");
    }
    name
}

/// A name without dots, which separate layers from channels, and without anything unusual. Long ones are cut.
fn plain(name: &str) -> String {
    let letter = |c: char| if c.is_alphanumeric() || "+-_".contains(c) { c } else { '_' };
    name.chars().map(letter).take(60).collect()
}

#[cfg(test)]
mod tests {
    use crate::sequence::parse;

    #[test]
    fn layers_are_called_after_what_shines_in_them() {
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
    fn no_layer_is_called_like_another_channel() {
        let named = |lights: &[&str]| {
            let light = |(index, name): (usize, &&str)| {
                format!("{name:?}: Point(position: (1, 2, 3), intensity: [(0, 1), ({}, 0)]),", index + 1)
            };
            let lights: String = lights.iter().enumerate().map(light).collect();
            let sequence = parse("a.ron", &format!("(lights: {{ {lights} }})")).expect("a sequence");
            sequence.about().layers
        };
        assert_eq!(named(&["albedo", "N", "Z"]), ["constant", "albedo_1", "N_2", "Z"]);
        // A name with a number may be there already.
        assert_eq!(named(&["x y", "x_y_3", "x.y"]), ["constant", "x_y", "x_y_3", "x_y_3_3"]);
        assert_eq!(named(&["a_2", "a 2", "a_2_2"]), ["constant", "a_2", "a_2_2", "a_2_2_3"]);
    }
}
