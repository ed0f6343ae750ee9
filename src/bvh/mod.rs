//! The tree over a scene's geometry: finds the nearest primitive along a ray.
//!
//! The tree only decides what may be skipped. What is hit is decided by the primitives' own f64 tests, and a
//! tie goes to the lower index, so neither the tree's layout nor its builder shows in a picture.

mod build;
mod traverse;

use crate::math::DVec3;

/// A binary tree of boxes over the bounded primitives, and the list of those that no box holds.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    /// The root first; children are neighbours. Empty if no primitive is bounded.
    nodes: Vec<Node>,
    /// Indices of primitives, in the order of the leaves.
    leaves: Vec<u32>,
    /// Indices of infinite primitives.
    unbounded: Vec<u32>,
}

/// A box in f32, rounded outwards, over two children or some primitives.
#[derive(Clone, Copy, Debug)]
struct Node {
    min: [f32; 3],
    max: [f32; 3],
    /// The first child, or the first of the leaf's primitives in `leaves`.
    first: u32,
    /// Number of primitives in a leaf; 0 for an inner node.
    count: u32,
}

/// Where a ray meets a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub t: f64,
    /// Index into the geometry's primitives.
    pub primitive: u32,
}

impl Node {
    fn corners(&self) -> [DVec3; 2] {
        [self.min, self.max].map(|corner| DVec3::from_array(corner.map(f64::from)))
    }
}
