//! Spawns the entities of a sequence, with their values at its first moment.

use super::{
    ActiveCamera, AreaLight, ClipPlanes, ClippedBy, FileOrder, Hierarchy, LightSetup, Now, Objects,
    PreparedVisibility, ShapeDeformed, ShapeParticles, ShapeSeries, ShownWith, Slot, SlotCount, Transform,
    Visible, VisibleTracks, Weight, animate,
};
use crate::appearance::environment::EnvironmentDistribution;
use crate::appearance::light::{Light, Source};
use crate::appearance::light_groups::{GroupRadiance, GroupWeight};
use crate::base::color::Rgb;
use crate::base::math::{DAffine3, UpAxis};
use crate::film::LayerId;
use crate::geometry::clip::ClipPlane;
use crate::geometry::prepared_transform::PreparedTransform;
use crate::geometry::ray_kinds::RayKinds;
use crate::geometry::shape::Shape;
use crate::sequence::{LightLayers, Named, Object, Sequence, ShapeTracks};
use crate::track::Animated;
use bevy_ecs::entity::Entity;
use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::world::{EntityWorldMut, World};
use std::sync::Arc;

/// A world of the sequence. All components count as changed until the first frame has been rendered.
pub fn spawn(sequence: &Sequence) -> World {
    let mut world = World::new();
    let layers = sequence.light_layers();
    world.insert_resource(Now(sequence.timeline.clock(0)));
    spawn_environment(&mut world, &layers, sequence);
    let ambient = spawn_ambient(&mut world, &layers, &sequence.ambient);
    spawn_materials(&mut world, &layers, sequence);
    spawn_fog(&mut world, &layers, sequence);
    spawn_cameras(&mut world, sequence);
    // Slots are in this order.
    spawn_objects(&mut world, sequence);
    spawn_lights(&mut world, &layers, sequence);
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
    let mut slots = FreeSlots::of(world);
    for ((order, light), &layer) in (0..).zip(&sequence.lights).zip(&layers.lights) {
        let (tracks, dimmer) = (&light.value, light.value.group_weight());
        let source = tracks.kind.at(start);
        let (radiance, shadows) = (tracks.constant_radiance(), tracks.shadows);
        let light = Light { source, radiance, shadows, layer };
        let mut entity = world.spawn((FileOrder(order), light));
        if tracks.kind.is_keyed() {
            entity.insert(tracks.clone());
        }
        if matches!(source, Source::Sphere(_) | Source::Rectangle { .. }) {
            entity.insert((AreaLight, slots.next()));
        }
        weigh(&mut entity, dimmer, layer);
    }
    world.insert_resource(SlotCount(slots.0));
}

/// The first slot that is not in use.
struct FreeSlots(u32);

impl FreeSlots {
    fn of(world: &World) -> Self {
        Self(world.get_resource().map_or(0, |SlotCount(count)| *count))
    }

    fn next(&mut self) -> Slot {
        self.0 += 1;
        Slot(self.0 - 1)
    }
}

fn spawn_materials(world: &mut World, layers: &LightLayers, sequence: &Sequence) {
    let start = sequence.timeline.clock(0).time;
    for ((order, material), &layer) in (0..).zip(&sequence.materials).zip(&layers.materials) {
        let (_, dimmer) = material.value.emission_split();
        let now = material.value.at(start, layer);
        let mut entity = world.spawn((FileOrder(order), now));
        if material.value.is_keyed() {
            entity.insert(material.value.clone());
        }
        weigh(&mut entity, dimmer, layer);
    }
}

fn spawn_cameras(world: &mut World, sequence: &Sequence) {
    let cameras =
        (0..sequence.cameras.len()).map(|index| world.spawn(sequence.fitted_camera(index)).id()).collect();
    world.insert_resource(ActiveCamera { cameras, cuts: sequence.active_camera.clone(), only: None });
}

/// Spawns the objects where they are at the first moment. Only objects that may move keep their tracks: those with keys
/// of their own, and those below them.
fn spawn_objects(world: &mut World, sequence: &Sequence) {
    let start = sequence.timeline.clock(0).time;
    let (objects, order) = (&sequence.objects, parents_first(sequence));
    let root = upright_root(sequence.up);
    let still = (Transform(DAffine3::IDENTITY), Visible(RayKinds::ALL));
    let (mut placed, mut moves) = (vec![still; objects.len()], vec![false; objects.len()]);
    for &index in &order {
        let Object { transform, parent, skin_of, .. } = &objects[index].value;
        let visible = visibility(&objects[index].value);
        let outer = parent.map(|parent| placed[parent]).or(root);
        let node = skin_of.map(|node| placed[node].1);
        placed[index] = animate::placed((transform.at(start), visible.at(start)), (outer, node));
        let keyed = transform.is_keyed() || visible.is_keyed();
        moves[index] = keyed || parent.iter().chain(skin_of).any(|&above| moves[above]);
    }
    let (mut entities, mut slots) = (Vec::with_capacity(objects.len()), FreeSlots::of(world));
    for (index, Named { name, value: object }) in objects.iter().enumerate() {
        let mut entity = world.spawn((object.shape.clone(), object.made_of, placed[index]));
        if object.shape != Shape::Group {
            entity.insert(slots.next());
        }
        match &object.tracks {
            Some(ShapeTracks::Series(series)) => {
                entity.insert(ShapeSeries(Arc::clone(series)));
            }
            Some(ShapeTracks::Deformed(mesh)) => {
                entity.insert(ShapeDeformed { mesh: Arc::clone(mesh), object: name.as_str().into() });
            }
            Some(ShapeTracks::Particles(particles)) => {
                entity.insert(ShapeParticles(Arc::clone(particles)));
            }
            None => {}
        }
        if let Some(track) = &object.row {
            entity.insert(track.at(start));
            if track.is_keyed() {
                entity.insert(track.clone());
            }
        }
        if moves[index] {
            entity.insert((
                PreparedTransform::from(&object.transform),
                PreparedVisibility::from(visibility(object)),
            ));
        }
        entities.push(entity.id());
    }
    spawn_cuts(world, objects, &entities);
    let root = root.map(|root| world.spawn(root).id());
    let mut hierarchy = Vec::new();
    for index in order.into_iter().filter(|&index| moves[index]) {
        let Object { parent, skin_of, .. } = &objects[index].value;
        let mut entity = world.entity_mut(entities[index]);
        let parent = parent.map(|parent| entities[parent]).or(root);
        if let Some(parent) = parent {
            entity.insert(ChildOf(parent));
        }
        if let Some(node) = *skin_of {
            entity.insert(ShownWith(entities[node]));
        }
        if parent.is_some() || skin_of.is_some() {
            hierarchy.push(entities[index]);
        }
    }
    world.insert_resource(Hierarchy(hierarchy));
    world.insert_resource(Objects(entities));
    world.insert_resource(SlotCount(slots.0));
}

/// Gives objects the planes that cut them open: their own, and those of the objects above.
fn spawn_cuts(world: &mut World, objects: &[Named<Object>], entities: &[Entity]) {
    let planes: Vec<Arc<[ClipPlane]>> =
        objects.iter().map(|object| object.value.clip.as_slice().into()).collect();
    if planes.iter().all(|planes| planes.is_empty()) {
        return;
    }
    for (index, object) in objects.iter().enumerate() {
        let above = std::iter::successors(Some(index), |&at| objects[at].value.parent);
        let cut: Vec<_> = above
            .filter(|&at| !planes[at].is_empty())
            .map(|at| (entities[at], Arc::clone(&planes[at])))
            .collect();
        if object.value.shape != Shape::Group && !cut.is_empty() {
            world.entity_mut(entities[index]).insert((ClippedBy(cut), ClipPlanes::default()));
        }
    }
}

/// The rays that see an object over time.
fn visibility(object: &Object) -> VisibleTracks {
    VisibleTracks { visible: object.visible.clone(), rays: object.rays.clone() }
}

/// Where the parent of all objects without one is, if their axes differ from those of the world.
fn upright_root(up: UpAxis) -> Option<(Transform, Visible)> {
    (up != UpAxis::Y).then(|| (Transform(DAffine3::from_mat3(up.matrix())), Visible(RayKinds::ALL)))
}

/// Indices of all objects, parents before children, and the nodes of skinned meshes before these.
fn parents_first(sequence: &Sequence) -> Vec<usize> {
    let count = sequence.objects.len();
    let (mut order, mut below, mut missing) = (Vec::new(), vec![Vec::new(); count], vec![0u8; count]);
    for (index, object) in sequence.objects.iter().enumerate() {
        let Object { parent, skin_of, .. } = &object.value;
        for &above in parent.iter().chain(skin_of) {
            below[above].push(index);
            missing[index] += 1;
        }
        if missing[index] == 0 {
            order.push(index);
        }
    }
    let mut next = 0;
    while let Some(&above) = order.get(next) {
        for &index in &below[above] {
            missing[index] -= 1;
            if missing[index] == 0 {
                order.push(index);
            }
        }
        next += 1;
    }
    order
}
