//! Systems that sample tracks at the current time.
//!
//! A component is written only if its value differs, so that nothing that depends on it is rebuilt: see the change
//! filters in [`crate::scene::extract`].

use crate::appearance::environment::{Environment, EnvironmentTracks};
use crate::appearance::fog::{Fog, FogTracks};
use crate::appearance::light::{Light, LightTracks};
use crate::appearance::light_groups::GroupWeight;
use crate::appearance::material::{Material, MaterialTracks};
use crate::base::math::{Aabb, DAffine3, DVec3, is_flat};
use crate::camera::Camera;
use crate::camera::path::{CameraPath, NoCamera};
use crate::geometry::clip::moved_into;
use crate::geometry::mesh::MeshError;
use crate::geometry::prepared_transform::PreparedTransform;
use crate::geometry::ray_kinds::RayKinds;
use crate::geometry::shape::{Particles, Plane, Shape};
use crate::geometry::table_rows::{RowTrack, TableRow};
use crate::import::series::StepError;
use crate::track::SegmentCache;
use crate::world::{
    ActiveCamera, ClipPlanes, ClippedBy, Current, Hierarchy, Now, Objects, PreparedVisibility, ShapeDeformed,
    ShapeParticles, ShapeSeries, ShapeUse, ShownWith, Transform, Visible, Weight,
};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::entity::Entity;
use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::query::Without;
use bevy_ecs::system::{ParamSet, Query, Res, ResMut};
use std::sync::Arc;

/// Objects that cannot move have none.
type Tracks = (&'static PreparedTransform, &'static PreparedVisibility);

/// What follows tracks.
type Placed = (&'static mut Transform, &'static mut Visible);

/// Objects that may move and depend on no others.
type IndependentMovers<'w, 's> = Query<'w, 's, (Placed, Tracks), (Without<ChildOf>, Without<ShownWith>)>;

type AllObjects<'w, 's> = Query<'w, 's, (Placed, Option<Tracks>)>;

/// What an object inherits from: its parent, and the object that it is shown with.
type Above = (Option<&'static ChildOf>, Option<&'static ShownWith>);

/// Computes the world transform and visibility of every object that may move, parents before children.
pub fn transforms(
    now: Res<Now>,
    hierarchy: Res<Hierarchy>,
    mut objects: ParamSet<(IndependentMovers, AllObjects)>,
    above: Query<Above>,
) {
    let (time, mut cache) = (now.0.time, SegmentCache::default());
    // In the order of memory.
    for ((mut transform, mut visible), (tracks, own)) in &mut objects.p0() {
        transform.set_if_neq(Transform(tracks.at(time, &mut cache)));
        visible.set_if_neq(Visible(own.at(time)));
    }
    let mut objects = objects.p1();
    for &object in &hierarchy.0 {
        let (parent, shown_with) = above.get(object).unwrap_or_default();
        let parent = parent.and_then(|&ChildOf(parent)| objects.get(parent).ok());
        let parent = parent.map(|((transform, visible), _)| (*transform, *visible));
        let other = shown_with.and_then(|&ShownWith(other)| objects.get(other).ok());
        let other = other.map(|((_, visible), _)| *visible);
        let Ok(((mut transform, mut visible), Some((tracks, own)))) = objects.get_mut(object) else {
            continue;
        };
        let (affine, shown) = placed((tracks.at(time, &mut cache), own.at(time)), (parent, other));
        transform.set_if_neq(affine);
        visible.set_if_neq(shown);
    }
}

/// World transform and visibility of an object, from its own, those of its parent, and the visibility of the object
/// with which alone it is visible.
#[inline]
pub(super) fn placed(
    (affine, visible): (DAffine3, RayKinds),
    (parent, other): (Option<(Transform, Visible)>, Option<Visible>),
) -> (Transform, Visible) {
    let visible = other.map_or(visible, |other| visible.and(other.0));
    match parent {
        Some((outer, shown)) => {
            // All in a flat object is hidden; the product may have lost that by rounding.
            let shown = if is_flat(&outer.0) { RayKinds::NONE } else { shown.0 };
            (Transform(outer.0 * affine), Visible(shown.and(visible)))
        }
        None => (Transform(affine), Visible(visible)),
    }
}

/// Moves the planes that cut objects open into the spaces of these. A plane of the object itself stays as it is.
pub fn cuts(now: Res<Now>, mut cut: Query<(Entity, &ClippedBy, &mut ClipPlanes)>, placed: Query<&Transform>) {
    for (object, by, mut planes) in &mut cut {
        let mut all = Vec::new();
        for (owner, tracks) in &by.0 {
            let own: Vec<Plane> = tracks.iter().filter_map(|plane| plane.at(now.0.time)).collect();
            if *owner == object {
                all.extend(own);
            } else if let (Ok(above), Ok(below)) = (placed.get(*owner), placed.get(object)) {
                all.extend(moved_into(&own, &above.0, &below.0).unwrap_or_default());
            }
        }
        planes.set_if_neq(ClipPlanes(all));
    }
}

/// Updates the meshes of visible series.
pub fn series(
    now: Res<Now>,
    shapes: Res<ShapeUse>,
    mut objects: Query<(&ShapeSeries, &Visible, &mut Shape)>,
) -> Result<(), StepError> {
    for (series, visible, mut shape) in &mut objects {
        if !visible.is_hidden() {
            let mesh = match *shapes {
                ShapeUse::Digests => series.0.named(now.0.time),
                ShapeUse::Rays => series.0.loaded(now.0.time)?,
            };
            shape.set_if_neq(Shape::Mesh(mesh));
        }
    }
    Ok(())
}

/// Updates visible meshes that morph targets and joints deform. Those without an area become groups, which show nothing.
pub fn deformed(
    now: Res<Now>,
    shapes: Res<ShapeUse>,
    mut objects: Query<(&ShapeDeformed, &Visible, &mut Shape)>,
) -> Result<(), StepError> {
    for (deformed, visible, mut shape) in &mut objects {
        if !visible.is_hidden() {
            let mesh = match *shapes {
                ShapeUse::Digests => deformed.mesh.named(now.0.time),
                ShapeUse::Rays => deformed
                    .mesh
                    .loaded(now.0.time)
                    .map_err(|error| out_of_range(&deformed.object, &error))?,
            };
            shape.set_if_neq(mesh.map_or(Shape::Group, Shape::Mesh));
        }
    }
    Ok(())
}

/// The error of a mesh that is out of range at this moment.
fn out_of_range(object: &str, error: &MeshError) -> StepError {
    let mesh = format!("of the object {object:?}, as it is deformed");
    StepError { path: mesh.into(), why: error.to_string() }
}

/// Updates visible particles.
pub fn particles(
    now: Res<Now>,
    shapes: Res<ShapeUse>,
    mut objects: Query<(&ShapeParticles, &Visible, &mut Shape)>,
) {
    for (tracks, visible, mut shape) in &mut objects {
        let wants_tree = *shapes == ShapeUse::Rays;
        let before = match &*shape {
            Shape::Particles(Particles(before)) => Some(&**before),
            _ => None,
        };
        let known = before.filter(|before| before.has_tree() || !wants_tree);
        if visible.is_hidden() || known.is_some() && !tracks.0.is_keyed() {
            continue;
        }
        let set = tracks.0.at(now.0.time);
        if known.is_none_or(|known| !known.is_same(&set)) {
            let set = if wants_tree { set.with_tree(before) } else { set };
            *shape = Shape::Particles(Particles(Arc::new(set)));
        }
    }
}

/// Updates the numbers of tables that objects have.
pub fn table_rows(now: Res<Now>, mut objects: Query<(&RowTrack, &mut TableRow)>) {
    for (track, mut row) in &mut objects {
        row.set_if_neq(track.at(now.0.time));
    }
}

/// Materials without keys have no tracks.
pub fn materials(now: Res<Now>, mut materials: Query<(&MaterialTracks, &mut Material)>) {
    for (tracks, mut material) in &mut materials {
        let layer = material.emission_layer;
        material.set_if_neq(tracks.at(now.0.time, layer));
    }
}

/// Lights that cannot move have no tracks. Switches and colours are weights.
pub fn lights(now: Res<Now>, mut lights: Query<(&LightTracks, &mut Light)>) {
    for (tracks, mut light) in &mut lights {
        let moved = Light { source: tracks.kind.at(now.0.time), ..*light };
        light.set_if_neq(moved);
    }
}

/// Updates the environment and the fog.
pub fn sky_and_fog(
    now: Res<Now>,
    mut skies: Query<(&EnvironmentTracks, &mut Environment)>,
    mut fogs: Query<(&FogTracks, &mut Fog)>,
) {
    for (tracks, mut environment) in &mut skies {
        let layer = environment.layer;
        environment.set_if_neq(tracks.at(now.0.time, layer));
    }
    for (tracks, mut fog) in &mut fogs {
        let glow = fog.in_scattering;
        fog.set_if_neq(tracks.at(now.0.time, glow));
    }
}

/// Updates the weights of lights. They change from frame to frame, not while a shutter is open.
pub fn weights(now: Res<Now>, mut dimmed: Query<(&GroupWeight, &mut Weight)>) {
    for (dimmer, mut weight) in &mut dimmed {
        let value = Weight { value: dimmer.at(now.0.start), ..*weight };
        weight.set_if_neq(value);
    }
}

/// Updates the active camera. A moment without a valid camera is an error that ends the run.
pub fn camera(
    now: Res<Now>,
    active: Res<ActiveCamera>,
    paths: Query<&CameraPath>,
    objects: Res<Objects>,
    placed: Query<(&Shape, &Transform)>,
    mut camera: ResMut<Current<Option<Camera>>>,
) -> Result<(), NoCamera> {
    let index = active.only.unwrap_or_else(|| active.cuts.at(now.0.start)).min(active.cameras.len() - 1);
    let Ok(path) = paths.get(active.cameras[index]) else { return Ok(()) };
    let sharp = path.focus_object().and_then(|index| placed.get(*objects.0.get(index)?).ok());
    let sharp = sharp.map(|(shape, transform)| center(shape, transform));
    camera.set_if_neq(Current(Some(path.at(&now.0, sharp)?)));
    Ok(())
}

/// The centre of an object's bounding box or, for shapes without bounds, its origin.
fn center(shape: &Shape, transform: &Transform) -> DVec3 {
    transform.0.transform_point3(shape.bounds().map_or(DVec3::ZERO, Aabb::center))
}
