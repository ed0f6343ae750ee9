//! Lights and cameras that objects carry.

use super::{Named, Object, Sequence};
use crate::appearance::light::{LightKind, LightTracks};
use crate::base::math::{Angle, DVec3, UpAxis};
use crate::base::time::Time;
use crate::camera::path::{CameraPath, CarriedPath, Step};
use crate::geometry::carrier::Carrier;
use crate::geometry::transform::{Rotation, TransformTracks};
use crate::track::{Animated, Ease, Key, Repeat, Track};
use std::ops::Range;

/// The most keys that the visibility of a light may have.
const MOST_KEYS: usize = 1_000_000;

/// The lights and cameras of a scene, each with the index of the object that carries it, and the place of the scene.
pub struct CarriedDraft {
    pub lights: Vec<(usize, LightTracks)>,
    pub cameras: Vec<(usize, CameraPath)>,
    pub place: Range<usize>,
}

/// Lights and cameras that objects carry, each with the place of its scene.
#[derive(Default)]
pub struct Carried {
    pub lights: Vec<(Named<LightTracks>, Range<usize>)>,
    pub cameras: Vec<(Named<CameraPath>, Range<usize>)>,
}

impl Carried {
    /// `up` is the upward axis of the objects, and `end` the time at which the sequence ends.
    pub fn of(objects: &[Named<Object>], drafts: Vec<CarriedDraft>, (up, end): (UpAxis, Time)) -> Self {
        let mut all = Self::default();
        let name = |object: usize| objects[object].name.clone();
        for CarriedDraft { lights, cameras, place } in drafts {
            for (object, light) in lights {
                let carrier = carrier(objects, object, up);
                let kind = LightKind::Carried { kind: Box::new(light.kind), carrier };
                let value = LightTracks { kind, on: visibility(objects, object, &light.on, end), ..light };
                all.lights.push((Named { name: name(object), value }, place.clone()));
            }
            for (object, camera) in cameras {
                let path = vec![carried_step(carrier(objects, object, up))];
                let value = CameraPath { path, ..camera };
                all.cameras.push((Named { name: name(object), value }, place.clone()));
            }
        }
        all
    }
}

/// The indices of an object and of those above it. Parents form no cycle.
pub fn chain(objects: &[Named<Object>], object: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(object), |&at| objects[at].value.parent)
}

/// What carries a light or a camera of an object. `up` is the upward axis of the objects.
fn carrier(objects: &[Named<Object>], object: usize, up: UpAxis) -> Carrier {
    let mut transforms: Vec<_> =
        chain(objects, object).map(|at| objects[at].value.transform.clone()).collect();
    if up == UpAxis::Z {
        let rotation = Rotation::AxisAngle { axis: DVec3::X.into(), angle: Angle(-90.0).into() };
        transforms.push(TransformTracks { rotation, ..TransformTracks::default() });
    }
    transforms.reverse();
    Carrier::new(object, transforms)
}

/// What carries a joint within the space of another object above it.
pub fn carrier_within(objects: &[Named<Object>], object: usize, above: usize) -> Carrier {
    let within = chain(objects, object).take_while(|at| *at != above);
    let mut transforms: Vec<_> = within.map(|at| objects[at].value.transform.clone()).collect();
    transforms.reverse();
    Carrier::new(object, transforms)
}

/// The step of a camera that an object carries.
fn carried_step(carrier: Carrier) -> Step {
    Step::Carried(CarriedPath::new(carrier.object, move |time| carrier.at(time)))
}

/// Whether an object and everything above it is visible, while `on` holds too. If several of these have keys, those that
/// repeat are written out until the time `end`.
fn visibility(objects: &[Named<Object>], object: usize, on: &Animated<bool>, end: Time) -> Animated<bool> {
    let visible = chain(objects, object).map(|at| &objects[at].value.visible);
    let all: Vec<&Animated<bool>> = visible.chain([on]).collect();
    if all.iter().any(|visible| **visible == Animated::Constant(false)) {
        return false.into();
    }
    let keyed: Vec<_> = all.into_iter().filter_map(track).collect();
    match keyed[..] {
        [] => true.into(),
        [one] => Animated::Keyed(one.clone()),
        _ => all_of(&keyed, end),
    }
}

fn track(visible: &Animated<bool>) -> Option<&Track<bool>> {
    if let Animated::Keyed(track) = visible { Some(track) } else { None }
}

/// Whether all tracks are true.
fn all_of(tracks: &[&Track<bool>], end: Time) -> Animated<bool> {
    let mut times: Vec<Time> = tracks.iter().flat_map(|track| track.times_until(end, MOST_KEYS)).collect();
    times.sort_unstable();
    times.dedup();
    times.truncate(MOST_KEYS);
    let mut keys: Vec<Key<bool>> = Vec::new();
    for time in times {
        let value = tracks.iter().all(|track| track.at(time));
        if keys.last().is_none_or(|last| last.value != value) {
            keys.push(Key { time, value, ease: Ease::Step });
        }
    }
    Track::new(keys, Repeat::Hold, false).map_or(true.into(), Animated::Keyed)
}

impl Sequence {
    /// Updates the lights and cameras that an object carries, and those of the objects below it.
    pub(super) fn refresh_carried(&mut self, object: usize) {
        let (objects, up) = (&self.objects, self.up);
        let is_below = |at: usize| chain(objects, at).any(|above| above == object);
        for light in &mut self.lights {
            if let LightKind::Carried { carrier: found, .. } = &mut light.value.kind
                && is_below(found.object)
            {
                *found = carrier(objects, found.object, up);
            }
        }
        for step in self.cameras.iter_mut().flat_map(|camera| &mut camera.value.path) {
            if let Step::Carried(found) = step
                && is_below(found.object)
            {
                *step = carried_step(carrier(objects, found.object, up));
            }
        }
    }
}
