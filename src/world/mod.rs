//! Sequence → World: entities and resources, spawned once and only here.

pub mod animate;
mod components;
mod resources;
mod spawn;

pub use components::{AreaLight, FileOrder, Transform, Visible, VisibleTrack, Weight};
pub use resources::{ActiveCamera, Current, Glows, Hierarchy, Now, Objects};
pub use spawn::{sky_table, spawn};
