//! Notes about materials that reflect more light than they receive.

use crate::appearance::material::MaterialTracks;
use crate::appearance::texture::TextureTracks;
use crate::base::color::Rgb;
use crate::base::time::{Time, Timeline};
use crate::base::units::counted;
use crate::sequence::Sequence;
use crate::sequence::quality::Integrator;
use crate::sequence::suggest::shortened;
use crate::track::{Animate, Animated};

impl Sequence {
    /// Materials that reflect more light than they receive, if paths may hit them repeatedly.
    pub(super) fn energy_gains(&self) -> Vec<String> {
        if !matches!(self.quality.integrator, Integrator::Path(_)) {
            return Vec::new();
        }
        let gains = self
            .used_materials()
            .map(|material| (&material.name, most_light(&material.value, &self.timeline)));
        let mut gains = gains.filter(|(_, light)| *light > 1.0 + ROUNDING);
        let note = |(name, light): (&String, f64)| {
            let light = format!("{light:.2}");
            let light = light.trim_end_matches('0').trim_end_matches('.');
            format!(
                "material `{}` reflects and transmits up to {light} times the incoming light; with `Path`, the light \
                 adds up",
                shortened(name)
            )
        };
        let mut notes: Vec<_> = gains.by_ref().take(MAX_GAINS).map(note).collect();
        match gains.count() as u64 {
            0 => {}
            more => notes.push(format!("and {} more like this", counted(more, "material"))),
        }
        notes
    }
}

/// Maximum number of notes of this kind.
const MAX_GAINS: usize = 3;

/// Gains that would be displayed as 1.00 are ignored.
const ROUNDING: f64 = 0.005;

/// The largest share of light that a material reflects and transmits, over all channels and keys. Only plain colours
/// count, because paint may be darker at every point.
fn most_light(material: &MaterialTracks, timeline: &Timeline) -> f64 {
    let MaterialTracks { diffuse, mirror, transparency, refraction, microfacet, base, .. } = material;
    let lobes = [diffuse, mirror, transparency, refraction].map(|lobe| (&lobe.strength, &lobe.tint));
    let lobes = lobes.into_iter().chain([(microfacet, base)]);
    let colored = lobes.filter_map(|(strength, tint)| match tint {
        TextureTracks::Color(color) => Some((strength, color)),
        _ => None,
    });
    let colored: Vec<_> = colored.collect();
    let (start, end) = (timeline.clock(0).time, timeline.clock(timeline.frames.saturating_sub(1)).time);
    let keys = colored.iter().flat_map(|(strength, color)| key_times(strength).chain(key_times(color)));
    let times = keys.filter(|time| (start..end).contains(time)).chain([start, end]);
    let light = |time: Time| {
        let mut sum = [0.0; 3];
        for (strength, color) in &colored {
            let (strength, color) = (strength.at(time).max(0.0), color.at(time).max(Rgb::ZERO));
            sum.iter_mut().zip(color.to_array()).for_each(|(sum, part)| *sum += strength * f64::from(part));
        }
        sum.into_iter().fold(0.0, f64::max)
    };
    times.map(light).fold(0.0, f64::max)
}

fn key_times<T: Animate>(value: &Animated<T>) -> impl Iterator<Item = Time> {
    let keys = if let Animated::Keyed(track) = value { track.keys() } else { &[] };
    keys.iter().map(|key| key.time)
}

#[cfg(test)]
mod tests {
    use crate::sequence::parse;

    fn notes(text: &str) -> Vec<String> {
        parse("test.ron", &format!("({text})")).unwrap_or_else(|faults| panic!("{faults}")).notes()
    }

    fn of(material: &str) -> Vec<String> {
        notes(&format!(
            "quality: (integrator: Path()), materials: {{ \"x\": {material}, \"unused\": (diffuse: 9) }},
            objects: {{ \"ball\": (shape: Sphere(), material: \"x\") }}"
        ))
    }

    #[test]
    fn energy_gains_are_noted_for_paths() {
        let much = "(color: (0.5, 1, 0), diffuse: 0.75, mirror: 0.5, transparency: 0.5, refraction: 0)";
        let note = "material `x` reflects and transmits up to 1.75 times the incoming light; with `Path`, the light \
                    adds up";
        assert_eq!(of(much), [note]);
        for enough in [
            "(color: 1, diffuse: 0.7, mirror: 0.2, refraction: 0.1, specular: 3, emission: 5, ambient: 2)",
            "(color: (1, 0, 0), diffuse: 1, mirror: 1, mirror_color: (0, 1, 0), transparency_color: 2)",
            "(color: Checker(), diffuse: 1, mirror: 1)",
            "MetallicRoughness()",
            "Dielectric()",
            "Metal(color: 1)",
        ] {
            assert_eq!(of(enough), [""; 0], "{enough}");
        }
        assert!(of("MetallicRoughness(color: 2)")[0].contains(" 2 times the incoming light"));
        let whitted = "objects: { \"ball\": (shape: Sphere(), material: (diffuse: 5)) }";
        assert_eq!(notes(whitted), [""; 0]);
        let group =
            "quality: (integrator: Path), default_material: (diffuse: 5), objects: { \"g\": (shape: Group) }";
        assert_eq!(notes(group), [""; 0]);
    }

    #[test]
    fn keyed_materials_are_judged_at_their_brightest() {
        let still = "timeline: (frames: 48), quality: (integrator: Path)";
        let gains_of = |fields: &str| {
            notes(&format!(
                "{still}, objects: {{ \"a\": (shape: Sphere(), material: (color: 1, {fields})) }}"
            ))
        };
        assert_eq!(
            gains_of("diffuse: [(0, 1), (1, 0)], mirror: [(0, 0), (1, 1)]"),
            [""; 0],
            "one fades into the other"
        );
        assert_eq!(
            gains_of("diffuse: 0.5, mirror: [(0, 0), (10, 5)]").len(),
            1,
            "within the time that is shown"
        );
        assert_eq!(gains_of("diffuse: 0.5, mirror: [(3, 0.5), (4, 1)]"), [""; 0], "later");
        let note = gains_of("diffuse: 0.5, mirror: [(0, 0), (1, 1), (1.5, 0)]").remove(0);
        assert!(
            note.starts_with("material `objects.\"a\".material` reflects and transmits up to 1.5 times"),
            "{note}"
        );
    }

    #[test]
    fn many_materials_are_counted() {
        let balls: String =
            (0..8).map(|i| format!("\"{i}\": (shape: Sphere(), material: (diffuse: 2)),")).collect();
        let notes = notes(&format!("quality: (integrator: Path), objects: {{ {balls} }}"));
        assert_eq!((notes.len(), notes[3].as_str()), (4, "and 5 materials more like this"));
    }
}
