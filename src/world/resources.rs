//! What there is one of.

use crate::appearance::light_groups::glow::Glow;
use crate::base::time::Clock;
use crate::track::Animated;
use bevy_ecs::entity::Entity;
use bevy_ecs::resource::Resource;

/// The moment that the world shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Resource)]
pub struct Now(pub Clock);

/// The latest value of something that frames are made of: the packed geometry, the tree over it, the camera.
/// Marked as changed only when it is.
#[derive(Clone, Debug, PartialEq, Resource)]
pub struct Current<T: Send + Sync + 'static>(pub T);

/// The objects whose placement may change, parents before children, each with its parent.
#[derive(Clone, Debug, Default, Resource)]
pub struct Hierarchy(pub Vec<(Entity, Option<Entity>)>);

/// The objects in the file's order.
#[derive(Clone, Debug, Default, Resource)]
pub struct Objects(pub Vec<Entity>);

/// The cameras in the file's order, and which of them is looked through.
#[derive(Clone, Debug, Resource)]
pub struct ActiveCamera {
    pub cameras: Vec<Entity>,
    pub index: Animated<usize>,
}

/// The ambient light, and how many layers of the film all light takes.
#[derive(Clone, Copy, Debug, Resource)]
pub struct Glows {
    pub ambient: Glow,
    pub layers: usize,
}
