//! What a sequence tells about itself in the files that come of it.

use super::Sequence;
use crate::encode::About;
use crate::glow::{Dimmer, Glow};
use crate::layers::Layers;

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
        for (name, dimmer) in self.named_dimmers() {
            let index = layers.of(&dimmer).index();
            members.resize(layers.count().max(members.len()), Vec::new());
            members[index].push(name);
        }
        let mut names: Vec<String> = Vec::new();
        for (index, members) in members.iter().enumerate() {
            let name = if index == 0 { "constant".to_owned() } else { plain(&members.join("+")) };
            let taken = names.contains(&name);
            names.push(if taken { format!("{name}_{index}") } else { name });
        }
        names
    }

    /// Whatever shines, with how it is keyed, in the order in which layers are given.
    fn named_dimmers(&self) -> impl Iterator<Item = (&str, Dimmer)> {
        let air = [("background", self.background.dimmer()), ("ambient", Glow::split(&self.ambient).1)];
        let lights = self.lights.iter().map(|light| (light.name.as_str(), light.value.dimmer()));
        let materials = self.materials.iter();
        let emission = materials.map(|material| (material.name.as_str(), material.value.emission_split().1));
        let fog = self.fog.iter().map(|fog| ("fog", fog.split().1));
        air.into_iter().chain(lights).chain(emission).chain(fog)
    }
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
}
