//! The top level of the acceleration structure: a tree over a scene's primitives.
//!
//! Rays are searched eight at a time. Primitives outside the tree are tested with all eight. In the tree, they are
//! searched as a bundle, or one by one where few of them visit the same nodes. The tree only decides what to skip. The
//! hits are those of the primitives, and among equally near ones the first in the file wins.

mod bundle;
mod bundle_any_hit;
mod bvh;
mod closest;
mod extent;
mod gain;
mod grouping;
mod occlusion;
mod query;
mod single;
#[cfg(test)]
mod tests;

pub use super::Hit;
pub use bvh::{Bvh, BvhUpdate};
pub use closest::{LaneHits, NOTHING};
pub use occlusion::{Occlusion, TransmissiveFlags};
pub use query::{Coherence, Stacks};
