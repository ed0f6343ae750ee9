//! What changes from frame to frame, and whose keys or path make it.

use crate::appearance::light_groups::glow::Glow;
use crate::base::digest::{Content, Digest};
use crate::base::time::Clock;
use crate::camera::Camera;
use crate::film::LayerId;
use crate::sequence::Sequence;

/// Something that has keys or a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// By its index in the sequence, as all of these.
    Camera(usize),
    /// Which camera is looked through.
    Cut,
    Object(usize),
    Material(usize),
    /// Where a light is.
    Light(usize),
    /// Whether a light is on.
    Switch(usize),
    /// How bright a light is, and in which colour.
    Brightness(usize),
    /// How bright a material shines.
    Emission(usize),
    Background,
    BackgroundBrightness,
    Ambient,
    Fog,
    FogColor,
    Exposure,
}

/// What has changed since another frame.
pub type Change = Vec<Part>;

impl Part {
    /// Whether it weights light that is traced already, or what is shown.
    pub fn is_weight(self) -> bool {
        match self {
            Self::Switch(_) | Self::Brightness(_) | Self::Emission(_) | Self::BackgroundBrightness => true,
            Self::Ambient | Self::FogColor | Self::Exposure => true,
            Self::Camera(_) | Self::Cut | Self::Object(_) | Self::Material(_) => false,
            Self::Light(_) | Self::Background | Self::Fog => false,
        }
    }

    /// The light that is switched, if this is a switch.
    fn switched(self) -> Option<usize> {
        match self {
            Self::Switch(index) => Some(index),
            _ => None,
        }
    }
}

/// What every part's keys evaluate to at a moment. An object's are its own, not those of what moves it.
pub fn values(sequence: &Sequence, clock: &Clock) -> Vec<(Part, Digest)> {
    let time = clock.time;
    let mut values = Vec::new();
    let mut note = |part, value: &dyn Content| values.push((part, Digest::of(value)));
    let active = sequence.active_camera.at(clock.start);
    note(Part::Cut, &active);
    if let Some(camera) = sequence.cameras.get(active) {
        let camera: Option<Camera> = camera.value.at(clock, None).ok();
        note(Part::Camera(active), &camera);
    }
    for (index, object) in sequence.objects.iter().enumerate() {
        note(Part::Object(index), &(object.value.transform.at(time), object.value.visible.at(time)));
    }
    for (index, light) in sequence.lights.iter().enumerate() {
        note(Part::Light(index), &light.value.kind.at(time));
        let dimmer = light.value.dimmer();
        note(Part::Switch(index), &dimmer.on.as_ref().is_none_or(|on| on.at(clock.start)));
        note(Part::Brightness(index), &dimmer.at(clock.start));
    }
    for (index, material) in sequence.materials.iter().enumerate() {
        note(Part::Material(index), &material.value.at(time, LayerId::CONSTANT));
        note(Part::Emission(index), &material.value.emission_split().1.at(clock.start));
    }
    note(Part::Background, &sequence.background.at(time, LayerId::CONSTANT));
    note(Part::BackgroundBrightness, &sequence.background.dimmer().at(clock.start));
    note(Part::Ambient, &sequence.ambient.at(clock.start));
    if let Some(fog) = &sequence.fog {
        note(Part::Fog, &fog.at(time, Glow::default()));
        note(Part::FogColor, &fog.split().1.at(clock.start));
    }
    note(Part::Exposure, &sequence.output.exposure.at(clock.start));
    values
}

/// The parts whose values differ. Both list the same parts in the same order, but for the camera that is looked through.
pub fn between(before: &[(Part, Digest)], now: &[(Part, Digest)]) -> Change {
    let differs = |index: usize| before.get(index) != now.get(index);
    // A camera that was not looked through before has not moved: the cut has led to it.
    let cut = before.first() != now.first();
    let moved = |part: &Part| !(cut && matches!(part, Part::Camera(_)));
    let mut changes: Change =
        (0..now.len()).filter(|index| differs(*index)).map(|index| now[index].0).filter(moved).collect();
    // A light that is switched is brighter or darker only for that.
    let switched: Vec<usize> = changes.iter().filter_map(|part| part.switched()).collect();
    changes.retain(|part| !matches!(part, Part::Brightness(index) if switched.contains(index)));
    changes
}
