//! World → Scene: packs what has changed, in the order of the file.

use super::{Geometry, Primitive, Shading, Weights};
use crate::environment::Environment;
use crate::light::Light;
use crate::material::Material;
use crate::shape::Shape;
use crate::world::{Current, FileOrder, MadeOf, Transform, Visible, Weight};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::component::Component;
use bevy_ecs::query::{Changed, Or, With};
use bevy_ecs::system::{Query, ResMut, Single};

/// Whether anything that can be hit has moved, appeared or vanished.
pub fn geometry_changed(changed: Query<(), GeometryChange>) -> bool {
    !changed.is_empty()
}

type GeometryChange = (With<Shape>, Or<(Changed<Transform>, Changed<Visible>)>);

/// Whether a material, a light's place or the background has changed. Weights are not of this kind.
pub fn shading_changed(
    materials: Query<(), Changed<Material>>,
    lights: Query<(), Changed<Light>>,
    background: Query<(), Changed<Environment>>,
) -> bool {
    !materials.is_empty() || !lights.is_empty() || !background.is_empty()
}

/// Whether a light was switched or faded.
pub fn weights_changed(changed: Query<(), Changed<Weight>>) -> bool {
    !changed.is_empty()
}

pub fn geometry(
    objects: Query<(&FileOrder, &Shape, &Transform, &Visible, &MadeOf)>,
    mut geometry: ResMut<Current<Geometry>>,
) {
    let mut shown: Vec<_> =
        objects.iter().filter(|(_, shape, _, v, _)| v.0 && **shape != Shape::Group).collect();
    shown.sort_unstable_by_key(|(order, ..)| **order);
    let packed = shown.into_iter().filter_map(|(_, shape, at, _, of)| Primitive::new(*shape, at.0, of.0));
    // What moves unseen, or turns within its own shape, changes nothing that a tree is built over.
    geometry.set_if_neq(Current(Geometry { primitives: packed.collect() }));
}

pub fn shading(
    materials: Query<(&FileOrder, &Material)>,
    lights: Query<(&FileOrder, &Light)>,
    background: Single<&Environment>,
    mut shading: ResMut<Current<Shading>>,
) {
    shading.0.materials = in_file_order(materials);
    shading.0.lights = in_file_order(lights);
    shading.0.background = background.clone();
}

pub fn weights(weighted: Query<&Weight>, mut weights: ResMut<Current<Weights>>) {
    for weight in &weighted {
        weights.0.0[weight.layer.index()] = weight.value;
    }
}

fn in_file_order<T: Component + Copy>(entities: Query<(&FileOrder, &T)>) -> Vec<T> {
    let mut entries: Vec<_> = entities.iter().collect();
    entries.sort_unstable_by_key(|(order, _)| **order);
    entries.into_iter().map(|(_, value)| *value).collect()
}
