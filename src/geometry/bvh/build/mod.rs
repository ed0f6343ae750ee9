//! Builds trees in parallel: splits from the top down by the binned surface area heuristic, then collapses to eight
//! children per node at the lowest cost. The same input gives the same tree for any number of threads.

mod binary;
mod bins;
mod bounds;
mod collapse;
mod partition;
mod pieces;
mod plan;
mod refit;
mod split;
#[cfg(test)]
mod tests;

pub use pieces::fetch_ahead;
pub use refit::{LeafBox, Refitter};

use super::{LeafPrimitives, Tree, TreeSpace};
use crate::base::math::{Aabb, DVec3};
use binary::BinaryTree;
use bounds::{Bounds, PrimRef};
use rayon::prelude::*;

/// Fewest boxes that are worth a task of their own.
const MIN_TASK: usize = 4096;

/// Most triangles or spheres in a leaf: this many are tested at once. Other primitives are tested one by one.
const LEAF_SIZE: usize = 8;

impl Tree {
    /// Builds a tree over boxes with one primitive in a leaf. Also returns the primitives of its leaves.
    pub fn of_boxes(boxes: &[Aabb]) -> (Self, LeafPrimitives) {
        Self::of_boxes_by(boxes, 1)
    }

    /// [`Tree::of_boxes`] with up to eight primitives in a leaf, which are tested at once.
    pub fn of_packed_boxes(boxes: &[Aabb]) -> (Self, LeafPrimitives) {
        Self::of_boxes_by(boxes, LEAF_SIZE)
    }

    fn of_boxes_by(boxes: &[Aabb], largest: usize) -> (Self, LeafPrimitives) {
        let bounds = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        if bounds.is_empty() {
            return (Self::default(), LeafPrimitives::default());
        }
        let space = TreeSpace::around(bounds);
        let prim =
            |(primitive, bounds): (u32, &Aabb)| PrimRef::new(primitive, Bounds::new(space.outward(*bounds)));
        let prims = (0..boxes.len() as u32).into_par_iter().zip(boxes).with_min_len(MIN_TASK).map(prim);
        Self::over(space, prims.collect(), largest)
    }

    /// Builds a tree over triangles, given as indices into positions, that lie within `bounds`. Also returns the
    /// primitives of its leaves. A long triangle may be in several leaves.
    pub fn of_triangles(bounds: Aabb, positions: &[DVec3], triangles: &[[u32; 3]]) -> (Self, LeafPrimitives) {
        if triangles.is_empty() {
            return (Self::default(), LeafPrimitives::default());
        }
        let space = TreeSpace::around(bounds);
        Self::over(space, pieces::boxes(&space, positions, triangles), LEAF_SIZE)
    }

    /// Builds a tree over boxes in `space`, with at most `largest` primitives in a leaf.
    fn over(space: TreeSpace, boxes: Vec<PrimRef>, largest: usize) -> (Self, LeafPrimitives) {
        collapse::collapse(&BinaryTree::new(boxes, largest), space)
    }
}
