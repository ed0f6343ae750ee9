//! World → Scene: packs what has changed, in the order of the file.

use super::{Finish, Geometry, Shading, Weights};
use crate::appearance::environment::Environment;
use crate::appearance::fog::Fog;
use crate::appearance::light::{Light, Source};
use crate::appearance::material::{Material, MaterialBinding};
use crate::base::math::{DAffine3, DVec3};
use crate::geometry::prepared_transform::PreparedTransform;
use crate::geometry::shape::{Shape, Solid};
use crate::geometry::table_rows::TableRow;
use crate::world::{
    AreaLight, ClipPlanes, Current, FileOrder, ShapeDeformed, ShapeParticles, ShapeSeries, Slot, Transform,
    Visible, Weight,
};
use bevy_ecs::change_detection::{DetectChanges, DetectChangesMut, Ref};
use bevy_ecs::component::Component;
use bevy_ecs::query::{Changed, Or, With};
use bevy_ecs::system::{Query, Res, ResMut};

/// Whether geometry may have moved, appeared or vanished.
pub fn geometry_changed(
    objects: Query<(), ObjectChange>,
    lights: Query<(), LightChange>,
    geometry: Res<Current<Geometry>>,
) -> bool {
    geometry.is_added() || !objects.is_empty() || !lights.is_empty()
}

/// Only objects that may move, or whose shape may change, have tracks.
type ObjectChange = Or<(
    Changed<ClipPlanes>,
    Changed<TableRow>,
    (With<PreparedTransform>, Or<(Changed<Transform>, Changed<Visible>)>),
    (Or<(With<ShapeSeries>, With<ShapeDeformed>, With<ShapeParticles>)>, Changed<Shape>),
)>;
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

/// An object, as it is packed.
type Object<'w> = (
    &'w Slot,
    &'w Shape,
    &'w Transform,
    &'w Visible,
    &'w MaterialBinding,
    Option<&'w ClipPlanes>,
    Option<&'w TableRow>,
);

/// Packs the slots of objects and lights that have changed; the first time, of all.
pub fn geometry(
    all: Query<Object<'static>>,
    changed: Query<Object<'static>, ObjectChange>,
    lights: Query<(&FileOrder, &Slot, &Light), LightChange>,
    mut geometry: ResMut<Current<Geometry>>,
) {
    let first = geometry.is_added();
    let packed = &mut geometry.bypass_change_detection().0;
    packed.forget_old_changes();
    let before = packed.revision();
    let mut pack = |(slot, shape, at, visible, of, cut, row): Object<'_>| {
        // A deformed mesh without an area is a group for that moment.
        let shows = !visible.is_hidden() && !matches!(shape, Shape::Group);
        let cut = cut.filter(|_| shows).map(|cut| Shape::Solid(Solid::cut(shape, cut.0.iter().copied())));
        let content = (cut.as_ref().unwrap_or(shape), &at.0, Finish::Material(*of));
        packed.set_seen(slot.0 as usize, shows.then_some(content), visible.0);
        packed.set_row(slot.0 as usize, row.filter(|_| shows));
    };
    match first {
        true => all.iter().for_each(&mut pack),
        false => changed.iter().for_each(&mut pack),
    }
    for (order, slot, light) in &lights {
        let shape = shape_of(light);
        let content = shape.as_ref().map(|shape| (shape, DAffine3::IDENTITY, Finish::Light(order.0)));
        packed.set(slot.0 as usize, content);
    }
    // Unchanged if only invisible objects move, or if a shape is mapped onto itself.
    if packed.revision() != before {
        geometry.set_changed();
    }
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
    materials: Query<(&FileOrder, Ref<Material>)>,
    lights: Query<(&FileOrder, Ref<Light>)>,
    skies: Query<&Environment>,
    fogs: Query<&Fog>,
    mut shading: ResMut<Current<Shading>>,
) {
    update(&mut shading.0.materials, materials);
    update(&mut shading.0.lights, lights);
    shading.0.environment = skies.iter().next().cloned().unwrap_or_default();
    // A density of 0 means no fog.
    shading.0.fog = fogs.iter().next().copied().filter(|fog| fog.density > 0.0);
}

pub fn weights(weighted: Query<&Weight>, mut weights: ResMut<Current<Weights>>) {
    for weight in &weighted {
        weights.0.0[weight.layer.index()] = weight.value;
    }
}

/// Brings a list in the order of the file up to date.
fn update<T: Component + Clone>(list: &mut Vec<T>, entities: Query<(&FileOrder, Ref<T>)>) {
    if list.len() == entities.iter().len() {
        for (order, value) in entities.iter().filter(|(_, value)| value.is_changed()) {
            list[order.0 as usize] = T::clone(&value);
        }
        return;
    }
    let mut entries: Vec<_> = entities.iter().collect();
    entries.sort_unstable_by_key(|(order, _)| **order);
    *list = entries.into_iter().map(|(_, value)| T::clone(&value)).collect();
}
