//! Names of the parts of a sequence that change between frames, and of those that call for an effect.

use crate::pipeline::plan::{AnimatedPart, EffectSource};
use crate::sequence::Sequence;

/// `light "a" and light "b" fade; the fog changes`: parts that change in the same way come together.
pub fn sentence(sequence: &Sequence, changes: &[AnimatedPart]) -> String {
    let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
    for part in changes {
        let (subject, verb) = subject_and_verb(sequence, *part);
        match groups.iter_mut().find(|(same, _)| *same == verb) {
            Some((_, subjects)) => subjects.push(subject),
            None => groups.push((verb, vec![subject])),
        }
    }
    let clause = |(verb, subjects): &(&str, Vec<String>)| match &subjects[..] {
        [rest @ .., last] if !rest.is_empty() => {
            // The plural of the verb.
            format!("{} and {last} {}", rest.join(", "), verb.trim_end_matches('s'))
        }
        subjects => format!("{} {verb}", subjects.concat()),
    };
    groups.iter().map(clause).collect::<Vec<_>>().join("; ")
}

/// `light "a" fades`, for each part.
pub fn list(sequence: &Sequence, changes: &[AnimatedPart]) -> Vec<String> {
    let clause = |part: &AnimatedPart| {
        let (subject, verb) = subject_and_verb(sequence, *part);
        format!("{subject} {verb}")
    };
    changes.iter().map(clause).collect()
}

fn subject_and_verb(sequence: &Sequence, part: AnimatedPart) -> (String, &'static str) {
    let Sequence { cameras, objects, materials, lights, .. } = sequence;
    let named = |kind: &str, name: &str| format!("{kind} \"{name}\"");
    match part {
        AnimatedPart::Camera(index) => (named("camera", &cameras[index].name), "moves"),
        AnimatedPart::Cut => ("the active camera".to_owned(), "is another"),
        AnimatedPart::CrossFade => ("the cross-fade of cameras".to_owned(), "goes on"),
        AnimatedPart::Object(index) => (named("object", &objects[index].name), "moves"),
        AnimatedPart::Material(index) => (material(&materials[index].name), "changes"),
        AnimatedPart::Light(index) => (named("light", &lights[index].name), "moves"),
        AnimatedPart::Switch(index) => (named("light", &lights[index].name), "toggles"),
        AnimatedPart::Brightness(index) => (named("light", &lights[index].name), "fades"),
        AnimatedPart::Emission(index) => {
            (format!("emission of {}", material(&materials[index].name)), "fades")
        }
        AnimatedPart::Background => ("the background".to_owned(), "changes"),
        AnimatedPart::BackgroundBrightness => ("the background".to_owned(), "fades"),
        AnimatedPart::Ambient => ("ambient light".to_owned(), "fades"),
        AnimatedPart::Fog => ("the fog".to_owned(), "changes"),
        AnimatedPart::FogColor => ("the fog's colour".to_owned(), "fades"),
        AnimatedPart::Exposure => ("the exposure".to_owned(), "changes"),
    }
}

/// The part of the sequence that calls for an effect.
pub fn caller(sequence: &Sequence, caller: EffectSource) -> String {
    match caller {
        EffectSource::Camera => "the camera".to_owned(),
        EffectSource::Integrator => "the integrator".to_owned(),
        EffectSource::Background => "the background".to_owned(),
        EffectSource::Ambient => "the ambient light".to_owned(),
        EffectSource::Fog => "the fog".to_owned(),
        EffectSource::Light(index) => format!("light \"{}\"", sequence.lights[index as usize].name),
        EffectSource::Material(index) => material(&sequence.materials[index as usize].name),
    }
}

/// A material by its name. A material that is written inside an object is named after its place in the file.
fn material(name: &str) -> String {
    if name.starts_with("objects.") { name.to_owned() } else { format!("material \"{name}\"") }
}
