//! World → Scene: packs what has changed, in the order of the file.

use super::{Finish, Geometry, Shading, Weights};
use crate::appearance::environment::Environment;
use crate::appearance::fog::Fog;
use crate::appearance::light::{Light, Source};
use crate::appearance::material::{Material, MaterialBinding};
use crate::base::math::{DAffine3, DVec3};
use crate::geometry::shape::Shape;
use crate::world::{AreaLight, Current, FileOrder, Transform, Visible, Weight};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::component::Component;
use bevy_ecs::query::{Changed, Or, With};
use bevy_ecs::system::{Query, ResMut};

/// Whether any visible geometry has moved, appeared or vanished.
pub fn geometry_changed(objects: Query<(), ObjectChange>, lights: Query<(), LightChange>) -> bool {
    !objects.is_empty() || !lights.is_empty()
}

type ObjectChange = (With<Shape>, Or<(Changed<Transform>, Changed<Visible>)>);
type LightChange = (With<AreaLight>, Changed<Light>);

/// Whether a material, a light's position, the sky or the fog has changed. Weights do not count.
pub fn shading_changed(changed: Query<(), ShadingChange>) -> bool {
    !changed.is_empty()
}

type ShadingChange = Or<(Changed<Material>, Changed<Light>, Changed<Environment>, Changed<Fog>)>;

/// Whether a light was switched or faded.
pub fn weights_changed(changed: Query<(), Changed<Weight>>) -> bool {
    !changed.is_empty()
}

pub fn geometry(
    objects: Query<(&FileOrder, &Shape, &Transform, &Visible, &MaterialBinding)>,
    lights: Query<(&FileOrder, &Light), With<AreaLight>>,
    mut geometry: ResMut<Current<Geometry>>,
) {
    let mut shown: Vec<_> =
        objects.iter().filter(|(_, shape, _, v, _)| v.0 && **shape != Shape::Group).collect();
    shown.sort_unstable_by_key(|(order, ..)| **order);
    let mut packed = Geometry::default();
    for (_, shape, at, _, of) in shown {
        packed.push(shape, at.0, Finish::Material(*of));
    }
    let mut lights: Vec<_> = lights.iter().collect();
    lights.sort_unstable_by_key(|(order, _)| **order);
    for (order, light) in lights {
        if let Some(shape) = shape_of(light) {
            packed.push(&shape, DAffine3::IDENTITY, Finish::Light(order.0));
        }
    }
    // Unchanged if only invisible objects move, or if a shape is mapped onto itself: then the tree is kept.
    geometry.set_if_neq(Current(packed));
}

/// The shape of a visible light; none if keys flatten it at this moment.
fn shape_of(light: &Light) -> Option<Shape> {
    match light.source {
        Source::Sphere(sphere) => Some(Shape::Sphere(sphere)),
        Source::Rectangle { rectangle, .. } => {
            (rectangle.u.cross(rectangle.v) != DVec3::ZERO).then_some(Shape::Rectangle(rectangle))
        }
        Source::Point { .. } | Source::Spot { .. } | Source::Directional { .. } => None,
    }
}

pub fn shading(
    materials: Query<(&FileOrder, &Material)>,
    lights: Query<(&FileOrder, &Light)>,
    skies: Query<&Environment>,
    fogs: Query<&Fog>,
    mut shading: ResMut<Current<Shading>>,
) {
    shading.0.materials = in_file_order(materials);
    shading.0.lights = in_file_order(lights);
    shading.0.environment = skies.iter().next().cloned().unwrap_or_default();
    // A density of 0 means no fog.
    shading.0.fog = fogs.iter().next().copied().filter(|fog| fog.density > 0.0);
}

pub fn weights(weighted: Query<&Weight>, mut weights: ResMut<Current<Weights>>) {
    for weight in &weighted {
        weights.0.0[weight.layer.index()] = weight.value;
    }
}

fn in_file_order<T: Component + Clone>(entities: Query<(&FileOrder, &T)>) -> Vec<T> {
    let mut entries: Vec<_> = entities.iter().collect();
    entries.sort_unstable_by_key(|(order, _)| **order);
    entries.into_iter().map(|(_, value)| value.clone()).collect()
}
