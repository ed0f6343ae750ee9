//! Sequence → World: entities and resources, spawned once and only here.

mod components;
mod resources;
mod spawn;

pub use components::{FileOrder, MadeOf, Transform, Visible, VisibleTrack, Weight};
pub use resources::{ActiveCamera, Current, Glows, Hierarchy, Now};
pub use spawn::spawn;
