//! From a sequence to entities, each with its values at the sequence's first moment.

use super::{
    ActiveCamera, FileOrder, Glows, Hierarchy, MadeOf, Now, Transform, Visible, VisibleTrack, Weight,
};
use crate::color::Rgb;
use crate::layers::Layers;
use crate::light::{Glow, Light};
use crate::math::DAffine3;
use crate::sequence::Sequence;
use crate::track::Animated;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

/// A world of the sequence. Everything counts as changed until the first frame has been made.
pub fn spawn(sequence: &Sequence) -> World {
    let mut world = World::new();
    let mut layers = Layers::new();
    world.insert_resource(Now(sequence.timeline.clock(0)));
    spawn_background(&mut world, &mut layers, sequence);
    let ambient = spawn_glow(&mut world, &mut layers, &sequence.ambient);
    spawn_lights(&mut world, &mut layers, sequence);
    spawn_materials(&mut world, sequence);
    spawn_cameras(&mut world, sequence);
    spawn_objects(&mut world, sequence);
    world.insert_resource(Glows { ambient, layers: layers.count() });
    world
}

/// The background is an entity, whose weight is keyed like a light's.
fn spawn_background(world: &mut World, layers: &mut Layers, sequence: &Sequence) {
    let (tracks, dimmer) = (&sequence.background, sequence.background.dimmer());
    let layer = layers.of(&dimmer);
    let mut entity = world.spawn((tracks.at(sequence.timeline.clock(0).time, layer), tracks.clone()));
    if !dimmer.is_constant() {
        entity.insert((dimmer, Weight { layer, value: Rgb::ONE }));
    }
}

/// A keyed glow gets an entity that holds its weight.
fn spawn_glow(world: &mut World, layers: &mut Layers, color: &Animated<Rgb>) -> Glow {
    let (radiance, dimmer) = Glow::split(color);
    let layer = layers.of(&dimmer);
    if !dimmer.is_constant() {
        world.spawn((dimmer, Weight { layer, value: Rgb::ONE }));
    }
    Glow { radiance, layer }
}

fn spawn_lights(world: &mut World, layers: &mut Layers, sequence: &Sequence) {
    let start = sequence.timeline.clock(0).time;
    for (order, light) in (0..).zip(&sequence.lights) {
        let (tracks, dimmer) = (&light.value, light.value.dimmer());
        let layer = layers.of(&dimmer);
        let light =
            Light { position: tracks.kind.position(start), radiance: tracks.constant_radiance(), layer };
        let mut entity = world.spawn((FileOrder(order), light, tracks.clone()));
        if !dimmer.is_constant() {
            entity.insert((dimmer, Weight { layer, value: Rgb::ONE }));
        }
    }
}

fn spawn_materials(world: &mut World, sequence: &Sequence) {
    let start = sequence.timeline.clock(0).time;
    for (order, material) in (0..).zip(&sequence.materials) {
        world.spawn((FileOrder(order), material.value.at(start), material.value.clone()));
    }
}

fn spawn_cameras(world: &mut World, sequence: &Sequence) {
    let cameras = sequence.cameras.iter().map(|camera| world.spawn(camera.value.clone()).id()).collect();
    world.insert_resource(ActiveCamera { cameras, index: sequence.active_camera.clone() });
}

fn spawn_objects(world: &mut World, sequence: &Sequence) {
    let mut entities = Vec::new();
    for (order, object) in (0..).zip(&sequence.objects) {
        let object = &object.value;
        let placed = (Transform(DAffine3::IDENTITY), Visible(true));
        let tracks = (object.transform.clone(), VisibleTrack(object.visible.clone()));
        let made_of = MadeOf(object.material as u32);
        entities.push(world.spawn((FileOrder(order), object.shape, made_of, placed, tracks)).id());
    }
    let hierarchy = parents_first(sequence);
    let pair = |i: usize| (entities[i], sequence.objects[i].value.parent.map(|parent| entities[parent]));
    let hierarchy: Vec<(Entity, Option<Entity>)> = hierarchy.into_iter().map(pair).collect();
    world.insert_resource(Hierarchy(hierarchy));
}

/// Indices of all objects, each after its parent.
fn parents_first(sequence: &Sequence) -> Vec<usize> {
    let parent = |i: usize| sequence.objects[i].value.parent;
    let depth = |i: usize| std::iter::successors(parent(i), |&p| parent(p)).count();
    let mut order: Vec<_> = (0..sequence.objects.len()).collect();
    order.sort_by_cached_key(|&i| depth(i));
    order
}
