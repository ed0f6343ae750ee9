//! A tree of boxes with eight children per node.

use super::TreeSpace;
use crate::base::math::DVec3;

/// A tree of nodes with eight children each.
#[derive(Clone, Debug)]
pub struct Tree {
    pub(super) space: TreeSpace,
    /// A box around all primitives, in the tree's space.
    pub(super) bounds: [DVec3; 2],
    /// Children follow their parents.
    pub(super) nodes: Vec<Node>,
    pub(super) root: Child,
    /// The [cost](Tree::cost) when the tree was built, and how often it was refitted since.
    pub(super) built_cost: f64,
    pub(super) refits: u32,
}

/// Eight boxes in the tree's space, rounded outwards, as structure of arrays.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Along each axis the lower planes, then the upper ones. An empty box has its planes swapped, so no ray hits it.
    pub(super) planes: [[[f32; 8]; 2]; 3],
    pub(super) children: [Child; 8],
}

/// A node or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child(pub(super) u32);

impl Child {
    pub(super) const LEAF: u32 = 1 << 31;
    pub(super) const NONE: Self = Self(u32::MAX);

    pub(super) fn leaf(number: u32) -> Self {
        Self(number | Self::LEAF)
    }

    /// The number of the leaf.
    #[inline(always)]
    pub(super) fn as_leaf(self) -> Option<u32> {
        (self.0 & Self::LEAF != 0).then_some(self.0 & !Self::LEAF)
    }
}

impl Default for Tree {
    /// An empty tree.
    fn default() -> Self {
        Self {
            space: TreeSpace::default(),
            bounds: [DVec3::INFINITY, DVec3::NEG_INFINITY],
            nodes: Vec::new(),
            root: Child::NONE,
            built_cost: 1.0,
            refits: 0,
        }
    }
}

impl Tree {
    /// Whether the tree has no primitives.
    pub fn is_empty(&self) -> bool {
        self.root == Child::NONE
    }

    /// The space in which the tree's filters compute.
    pub fn space(&self) -> &TreeSpace {
        &self.space
    }
}
