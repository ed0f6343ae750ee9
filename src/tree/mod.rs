//! Trees of boxes: what a ray may meet, and in which order.
//!
//! A tree only decides what may be skipped. What is hit is decided by the f64 tests of what it holds.

mod build;
mod probe;
mod walk;

pub use probe::Probe;

use crate::math::DVec3;

/// A binary tree of boxes over things that have an index each.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// The root first; children are neighbours. Empty if there is nothing.
    nodes: Vec<Node>,
    /// The things' indices, in the order of the leaves.
    leaves: Vec<u32>,
}

/// A box in f32, rounded outwards, over two children or some things.
#[derive(Clone, Copy, Debug)]
struct Node {
    min: [f32; 3],
    max: [f32; 3],
    /// The first child, or the first of the leaf's things in `leaves`.
    first: u32,
    /// Number of things in a leaf; 0 for an inner node.
    count: u32,
}

impl Node {
    fn corners(&self) -> [DVec3; 2] {
        [self.min, self.max].map(|corner| DVec3::from_array(corner.map(f64::from)))
    }
}
