//! Light groups: lights with the same keys share one layer of the film, and each frame weights the layers.

mod groups;
mod weight;

pub use groups::LightGroups;
pub use weight::{GroupRadiance, GroupWeight};
