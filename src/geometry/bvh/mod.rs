//! Trees of boxes: what a ray may meet, and in which order.
//!
//! A tree only decides what may be skipped, eight boxes at a time and in f32. What is hit is decided by the f64 tests of
//! what it holds: a tree gives the same hits as asking everything, to the last bit, on every processor.

mod build;
mod bundle;
mod contents;
mod probe;
mod slabs;
mod space;
mod walk;

pub use build::fetch_ahead;
pub use bundle::{Branch, BundleLeaves, BundleSlabs, BundleStack};
pub use contents::Contents;
pub use probe::Probe;
pub use slabs::Slabs;
pub use space::Space;
pub use walk::{Leaves, Stack};

use crate::base::math::DVec3;

/// A tree of nodes with eight children each.
#[derive(Clone, Debug)]
pub struct Tree {
    space: Space,
    /// A box around all, in the tree's space.
    bounds: [DVec3; 2],
    /// Children stand behind their parents.
    nodes: Vec<Node>,
    root: Child,
}

/// Eight boxes in the tree's space, rounded outwards, one row of numbers after the other.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct Node {
    /// Along each axis the lower planes, then the upper ones. No ray meets a box whose planes are the wrong way round.
    planes: [[[f32; 8]; 2]; 3],
    children: [Child; 8],
}

/// A node or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const NONE: Self = Self(u32::MAX);

    fn leaf(number: u32) -> Self {
        Self(number | Self::LEAF)
    }

    /// The number of the leaf.
    #[inline(always)]
    fn as_leaf(self) -> Option<u32> {
        (self.0 & Self::LEAF != 0).then_some(self.0 & !Self::LEAF)
    }
}

impl Default for Tree {
    /// A tree of nothing.
    fn default() -> Self {
        Self {
            space: Space::default(),
            bounds: [DVec3::INFINITY, DVec3::NEG_INFINITY],
            nodes: Vec::new(),
            root: Child::NONE,
        }
    }
}

impl Tree {
    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.root == Child::NONE
    }

    /// The space in which the tree's filters compute.
    pub fn space(&self) -> &Space {
        &self.space
    }
}
