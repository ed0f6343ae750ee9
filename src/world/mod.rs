//! The ECS world of a sequence: entities, resources, and the systems that animate them.
//!
//! In: a `Sequence` and a clock.
//! Out: components and resources with their values at that time.
//! Uses `sequence` only to spawn, and the parts of a scene.

pub mod animate;
mod components;
mod resources;
mod spawn;

pub use components::{
    AreaLight, ClipPlanes, ClippedBy, FileOrder, PreparedVisibility, ShapeDeformed, ShapeParticles,
    ShapeSeries, ShownWith, Slot, Transform, Visible, VisibleTracks, Weight,
};
pub use resources::{ActiveCamera, Current, Hierarchy, LightSetup, Now, Objects, ShapeUse, SlotCount};
pub use spawn::{sky_table, spawn};
