//! Resources of the world.

use crate::appearance::light_groups::GroupRadiance;
use crate::base::time::Clock;
use crate::camera::CameraCuts;
use bevy_ecs::entity::Entity;
use bevy_ecs::resource::Resource;

/// The current moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Resource)]
pub struct Now(pub Clock);

/// The current value of something that frames are made from: the packed geometry, its tree, the camera. Marked as
/// changed only if the value changes.
#[derive(Clone, Debug, PartialEq, Resource)]
pub struct Current<T: Send + Sync + 'static>(pub T);

/// Whether rays are traced, for which shapes need their trees. Digests do not need them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Resource)]
pub enum ShapeUse {
    /// Particles have no tree. The first mesh of a series takes the place of all, with the digest of the mesh that would
    /// be there.
    #[default]
    Digests,
    Rays,
}

/// Objects that may move and depend on others, each after these: its parent and the object that it is shown with.
#[derive(Clone, Debug, Default, Resource)]
pub struct Hierarchy(pub Vec<Entity>);

/// The objects in the file's order.
#[derive(Clone, Debug, Default, Resource)]
pub struct Objects(pub Vec<Entity>);

/// The number of primitives, including those of hidden objects.
#[derive(Clone, Copy, Debug, Resource)]
pub struct SlotCount(pub u32);

/// The cameras in the file's order, and which of them is active over time.
#[derive(Clone, Debug, Resource)]
pub struct ActiveCamera {
    pub cameras: Vec<Entity>,
    pub cuts: CameraCuts,
    /// The camera to use at all times instead: one of two that show a frame together.
    pub only: Option<usize>,
}

/// The ambient light, and the number of light layers of the film.
#[derive(Clone, Copy, Debug, Resource)]
pub struct LightSetup {
    pub ambient: GroupRadiance,
    pub layers: usize,
}
