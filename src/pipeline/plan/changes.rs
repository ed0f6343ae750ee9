//! Finds which keys or camera paths change from frame to frame.

use crate::appearance::light_groups::GroupRadiance;
use crate::base::digest::{Content, Digest};
use crate::base::time::Clock;
use crate::camera::Camera;
use crate::film::LayerId;
use crate::geometry::clip::ClipPlane;
use crate::geometry::shape::Plane;
use crate::sequence::{Object, Sequence};

/// A part of the sequence that has keys or a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AnimatedPart {
    /// Index in the sequence, as in all variants.
    Camera(usize),
    /// The choice of the active camera.
    Cut,
    /// The share of the camera before a cut, and its view.
    CrossFade,
    Object(usize),
    Material(usize),
    /// The place of a light.
    Light(usize),
    /// The switch of a light.
    Switch(usize),
    /// The intensity and colour of a light.
    Brightness(usize),
    /// The intensity of a material's emission.
    Emission(usize),
    Background,
    BackgroundBrightness,
    Ambient,
    Fog,
    FogColor,
    Exposure,
}

/// The parts that differ between two frames.
pub type Changes = Vec<AnimatedPart>;

impl AnimatedPart {
    /// Whether this part only weights light that is already traced, or only scales the displayed picture.
    pub fn is_weight(self) -> bool {
        match self {
            Self::Switch(_) | Self::Brightness(_) | Self::Emission(_) | Self::BackgroundBrightness => true,
            Self::Ambient | Self::FogColor | Self::Exposure => true,
            Self::Camera(_) | Self::Cut | Self::CrossFade | Self::Object(_) | Self::Material(_) => false,
            Self::Light(_) | Self::Background | Self::Fog => false,
        }
    }

    /// The light's index if this is a switch.
    fn switched(self) -> Option<usize> {
        match self {
            Self::Switch(index) => Some(index),
            _ => None,
        }
    }
}

/// The value of every part that may change, at a moment. An object's value leaves out the motion of its parents.
pub fn values(sequence: &Sequence, clock: &Clock) -> Vec<(AnimatedPart, Digest)> {
    let time = clock.time;
    let mut values = Vec::new();
    let mut note = |part, value: &dyn Content| values.push((part, Digest::of(value)));
    let active = sequence.active_camera.at(clock.start);
    note(AnimatedPart::Cut, &active);
    if let Some(camera) = sequence.cameras.get(active) {
        let camera: Option<Camera> = camera.value.at(clock, None).ok();
        note(AnimatedPart::Camera(active), &camera);
    }
    for (index, object) in sequence.objects.iter().enumerate() {
        let Object { transform, visible, rays, tracks, clip, .. } = &object.value;
        let tracks = tracks.as_ref().filter(|tracks| tracks.is_keyed());
        let cuts = clip.iter().any(ClipPlane::is_keyed);
        if transform.is_keyed() || visible.is_keyed() || rays.is_keyed() || tracks.is_some() || cuts {
            let shape = tracks.map(|tracks| tracks.digest(time));
            let clip: Vec<Option<Plane>> = clip.iter().map(|plane| plane.at(time)).collect();
            let shown = (visible.at(time), rays.at(time));
            note(AnimatedPart::Object(index), &((transform.at(time), shown), (shape, clip)));
        }
    }
    for (index, light) in sequence.lights.iter().enumerate() {
        if light.value.kind.is_keyed() {
            note(AnimatedPart::Light(index), &light.value.kind.at(time));
        }
        let group_weight = light.value.group_weight();
        if !group_weight.is_constant() {
            note(AnimatedPart::Switch(index), &group_weight.on.as_ref().is_none_or(|on| on.at(clock.start)));
            note(AnimatedPart::Brightness(index), &group_weight.at(clock.start));
        }
    }
    for (index, material) in sequence.materials.iter().enumerate() {
        if material.value.is_keyed() {
            note(AnimatedPart::Material(index), &material.value.at(time, LayerId::CONSTANT));
            note(AnimatedPart::Emission(index), &material.value.emission_split().1.at(clock.start));
        }
    }
    note(AnimatedPart::Background, &sequence.background.at(time, LayerId::CONSTANT));
    note(AnimatedPart::BackgroundBrightness, &sequence.background.group_weight().at(clock.start));
    note(AnimatedPart::Ambient, &sequence.ambient.at(clock.start));
    if let Some(fog) = &sequence.fog {
        note(AnimatedPart::Fog, &fog.at(time, GroupRadiance::default()));
        note(AnimatedPart::FogColor, &fog.split().1.at(clock.start));
    }
    note(AnimatedPart::Exposure, &sequence.output.exposure.at(clock.start));
    if sequence.active_camera.fades() {
        let fade = sequence.active_camera.cross_fade(clock.start);
        let before = fade.and_then(|fade| {
            let camera = sequence.cameras.get(fade.from)?.value.at(clock, None).ok();
            Some((fade.share, camera))
        });
        note(AnimatedPart::CrossFade, &before);
    }
    values
}

/// The parts whose values differ. Both lists hold the same parts in the same order, except for the active camera.
pub fn between(before: &[(AnimatedPart, Digest)], now: &[(AnimatedPart, Digest)]) -> Changes {
    let differs = |index: usize| before.get(index) != now.get(index);
    // After a cut, the new camera does not count as moved.
    let cut = before.first() != now.first();
    let moved = |part: &AnimatedPart| !(cut && matches!(part, AnimatedPart::Camera(_)));
    let mut changes: Changes =
        (0..now.len()).filter(|index| differs(*index)).map(|index| now[index].0).filter(moved).collect();
    // A switched light does not count as faded too.
    let switched: Vec<usize> = changes.iter().filter_map(|part| part.switched()).collect();
    changes.retain(|part| !matches!(part, AnimatedPart::Brightness(index) if switched.contains(index)));
    changes
}
