//! World at t: systems that sample tracks and write only what differs.
//!
//! A value that stays equal is not written, so that what depends on it is not made again: see the change
//! filters in [`crate::scene::extract`].

use crate::camera::Camera;
use crate::camera_path::{CameraPath, NoCamera};
use crate::environment::{Environment, EnvironmentTracks};
use crate::light::{Dimmer, Light, LightTracks};
use crate::material::{Material, MaterialTracks};
use crate::math::DAffine3;
use crate::time::Time;
use crate::transform::TransformTracks;
use crate::world::{ActiveCamera, Current, Hierarchy, Now, Transform, Visible, VisibleTrack, Weight};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::system::{Query, Res, ResMut};

/// Places every object, parents before children.
pub fn transforms(
    now: Res<Now>,
    hierarchy: Res<Hierarchy>,
    mut objects: Query<(&TransformTracks, &VisibleTrack, &mut Transform, &mut Visible)>,
) {
    for &(entity, parent) in &hierarchy.0 {
        let parent = parent.and_then(|parent| objects.get(parent).ok());
        let parent = parent.map(|(_, _, transform, visible)| (transform.0, visible.0));
        let Ok((tracks, visible_track, mut transform, mut visible)) = objects.get_mut(entity) else {
            continue;
        };
        let (affine, shown) = placed(tracks, visible_track, parent, now.0.time);
        transform.set_if_neq(Transform(affine));
        visible.set_if_neq(Visible(shown));
    }
}

/// Where an object is in the world and whether it is shown, given the same of its parent.
fn placed(
    tracks: &TransformTracks,
    visible: &VisibleTrack,
    parent: Option<(DAffine3, bool)>,
    time: Time,
) -> (DAffine3, bool) {
    let (affine, visible) = (tracks.at(time), visible.0.at(time));
    match parent {
        Some((outer, shown)) => (outer * affine, shown && visible),
        None => (affine, visible),
    }
}

pub fn materials(now: Res<Now>, mut materials: Query<(&MaterialTracks, &mut Material)>) {
    for (tracks, mut material) in &mut materials {
        material.set_if_neq(tracks.at(now.0.time));
    }
}

pub fn lights(now: Res<Now>, mut lights: Query<(&LightTracks, &mut Light)>) {
    for (tracks, mut light) in &mut lights {
        let position = tracks.kind.position(now.0.time);
        let moved = Light { position, ..*light };
        light.set_if_neq(moved);
    }
}

pub fn environment(now: Res<Now>, mut environments: Query<(&EnvironmentTracks, &mut Environment)>) {
    for (tracks, mut environment) in &mut environments {
        let turned = tracks.at(now.0.time, environment.layer);
        environment.set_if_neq(turned);
    }
}

/// Switches and fades lights.
pub fn weights(now: Res<Now>, mut dimmed: Query<(&Dimmer, &mut Weight)>) {
    for (dimmer, mut weight) in &mut dimmed {
        let value = Weight { value: dimmer.at(now.0.time), ..*weight };
        weight.set_if_neq(value);
    }
}

/// Moves the camera that is looked through. A moment without a camera is an error that ends the run.
pub fn camera(
    now: Res<Now>,
    active: Res<ActiveCamera>,
    paths: Query<&CameraPath>,
    mut camera: ResMut<Current<Option<Camera>>>,
) -> Result<(), NoCamera> {
    let index = active.index.at(now.0.time).min(active.cameras.len() - 1);
    let Ok(path) = paths.get(active.cameras[index]) else { return Ok(()) };
    camera.set_if_neq(Current(Some(path.at(&now.0)?)));
    Ok(())
}
