//! Spawns the entities of a sequence, with their values at its first moment.

use super::{
    ActiveCamera, AreaLight, FileOrder, Hierarchy, LightSetup, Now, Objects, Transform, Visible,
    VisibleTrack, Weight,
};
use crate::appearance::environment::EnvironmentDistribution;
use crate::appearance::light::{Light, Source};
use crate::appearance::light_groups::{GroupRadiance, GroupWeight};
use crate::base::color::Rgb;
use crate::base::math::{DAffine3, UpAxis};
use crate::film::LayerId;
use crate::geometry::transform::{Rotation, TransformTracks};
use crate::sequence::{LightLayers, Sequence};
use crate::track::Animated;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::{EntityWorldMut, World};
use std::sync::Arc;

/// A world of the sequence. All components count as changed until the first frame has been rendered.
pub fn spawn(sequence: &Sequence) -> World {
    let mut world = World::new();
    let layers = sequence.light_layers();
    world.insert_resource(Now(sequence.timeline.clock(0)));
    spawn_environment(&mut world, &layers, sequence);
    let ambient = spawn_ambient(&mut world, &layers, &sequence.ambient);
    spawn_lights(&mut world, &layers, sequence);
    spawn_materials(&mut world, &layers, sequence);
    spawn_fog(&mut world, &layers, sequence);
    spawn_cameras(&mut world, sequence);
    spawn_objects(&mut world, sequence);
    world.insert_resource(LightSetup { ambient, layers: layers.count });
    world
}

/// The environment distribution, if paths sample the environment. Keys do not change it.
pub fn sky_table(sequence: &Sequence) -> Option<Arc<EnvironmentDistribution>> {
    if !sequence.quality.integrator.samples_lights() {
        return None;
    }
    let environment = sequence.background.at(sequence.timeline.clock(0).time, LayerId::CONSTANT);
    EnvironmentDistribution::new(&environment.sky).map(Arc::new)
}

/// Gives an entity a weight if its light is keyed. Constant light needs none.
fn weigh(entity: &mut EntityWorldMut<'_>, group_weight: GroupWeight, layer: LayerId) {
    if !group_weight.is_constant() {
        entity.insert((group_weight, Weight { layer, value: Rgb::ONE }));
    }
}

fn spawn_ambient(world: &mut World, layers: &LightLayers, color: &Animated<Rgb>) -> GroupRadiance {
    let (radiance, dimmer) = GroupRadiance::split(color);
    let layer = layers.ambient;
    weigh(&mut world.spawn_empty(), dimmer, layer);
    GroupRadiance { radiance, layer }
}

fn spawn_environment(world: &mut World, layers: &LightLayers, sequence: &Sequence) {
    let (tracks, dimmer) = (&sequence.background, sequence.background.group_weight());
    let layer = layers.background;
    let environment = tracks.at(sequence.timeline.clock(0).time, layer);
    weigh(&mut world.spawn((environment, tracks.clone())), dimmer, layer);
}

fn spawn_fog(world: &mut World, layers: &LightLayers, sequence: &Sequence) {
    let Some(tracks) = &sequence.fog else { return };
    let (radiance, dimmer) = tracks.split();
    let layer = layers.fog;
    let fog = tracks.at(sequence.timeline.clock(0).time, GroupRadiance { radiance, layer });
    weigh(&mut world.spawn((fog, tracks.clone())), dimmer, layer);
}

fn spawn_lights(world: &mut World, layers: &LightLayers, sequence: &Sequence) {
    let start = sequence.timeline.clock(0).time;
    for ((order, light), &layer) in (0..).zip(&sequence.lights).zip(&layers.lights) {
        let (tracks, dimmer) = (&light.value, light.value.group_weight());
        let source = tracks.kind.at(start);
        let light = Light { source, radiance: tracks.constant_radiance(), layer };
        let mut entity = world.spawn((FileOrder(order), light, tracks.clone()));
        if matches!(source, Source::Sphere(_) | Source::Rectangle { .. }) {
            entity.insert(AreaLight);
        }
        weigh(&mut entity, dimmer, layer);
    }
}

fn spawn_materials(world: &mut World, layers: &LightLayers, sequence: &Sequence) {
    let start = sequence.timeline.clock(0).time;
    for ((order, material), &layer) in (0..).zip(&sequence.materials).zip(&layers.materials) {
        let (_, dimmer) = material.value.emission_split();
        let now = material.value.at(start, layer);
        weigh(&mut world.spawn((FileOrder(order), now, material.value.clone())), dimmer, layer);
    }
}

fn spawn_cameras(world: &mut World, sequence: &Sequence) {
    let cameras =
        (0..sequence.cameras.len()).map(|index| world.spawn(sequence.fitted_camera(index)).id()).collect();
    world.insert_resource(ActiveCamera { cameras, index: sequence.active_camera.clone() });
}

fn spawn_objects(world: &mut World, sequence: &Sequence) {
    let mut entities = Vec::new();
    for (order, object) in (0..).zip(&sequence.objects) {
        let object = &object.value;
        let placed = (Transform(DAffine3::IDENTITY), Visible(true));
        let tracks = (object.transform.clone(), VisibleTrack(object.visible.clone()));
        entities
            .push(world.spawn((FileOrder(order), object.shape.clone(), object.made_of, placed, tracks)).id());
    }
    world.insert_resource(Objects(entities.clone()));
    let root = upright_root(world, sequence.up);
    let parent = |i: usize| sequence.objects[i].value.parent.map(|parent| entities[parent]).or(root);
    let objects = parents_first(sequence).into_iter().map(|i| (entities[i], parent(i)));
    let hierarchy: Vec<(Entity, Option<Entity>)> =
        root.map(|root| (root, None)).into_iter().chain(objects).collect();
    world.insert_resource(Hierarchy(hierarchy));
}

/// The parent of all objects without one, if their axes differ from those of the world. It has no shape.
fn upright_root(world: &mut World, up: UpAxis) -> Option<Entity> {
    if up == UpAxis::Y {
        return None;
    }
    let rotation = Rotation::Fixed(up.matrix());
    let tracks = TransformTracks { rotation, ..TransformTracks::default() };
    let placed = (Transform(DAffine3::IDENTITY), Visible(true));
    Some(world.spawn((placed, tracks, VisibleTrack(true.into()))).id())
}

/// Indices of all objects, parents before children.
fn parents_first(sequence: &Sequence) -> Vec<usize> {
    let parent = |i: usize| sequence.objects[i].value.parent;
    let depth = |i: usize| std::iter::successors(parent(i), |&p| parent(p)).count();
    let mut order: Vec<_> = (0..sequence.objects.len()).collect();
    order.sort_by_cached_key(|&i| depth(i));
    order
}
