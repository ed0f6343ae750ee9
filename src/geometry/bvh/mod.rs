//! Bounding volume hierarchies: which boxes a ray may hit, and in which order.
//!
//! A tree only decides what to skip, eight boxes at a time and in f32. The f64 tests of its primitives decide what is
//! hit. So a tree gives the same hits as a test of all primitives, to the last bit, on every processor.

mod build;
mod bundle;
mod bundle_by_ray;
mod bundle_rows;
mod bundle_slabs;
mod bundle_sweep;
mod leaf_primitives;
mod slabs;
mod traversal;
mod traversal_ray;
mod tree;
mod tree_space;

pub use build::{LeafBox, Refitter, fetch_ahead};
pub use bundle::{BundleStack, BundleVisitor, BundleWork, NodeRef};
pub use bundle_slabs::BundleSlabs;
pub use leaf_primitives::LeafPrimitives;
pub use slabs::{CLEARANCE, Slabs};
pub use traversal::{LeafVisitor, Stack};
pub use traversal_ray::TraversalRay;
pub use tree::Tree;
pub use tree_space::TreeSpace;
