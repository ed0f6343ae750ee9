//! Building trees: split from the top down by binned areas, in parallel, then eight children in a node as cost the least.
//! The same things give the same tree, by any number of threads.

mod binary;
mod bins;
mod bounds;
mod collapse;
mod partition;
mod pieces;
mod plan;
mod split;
#[cfg(test)]
mod tests;

pub use pieces::fetch_ahead;

use super::{Contents, Space, Tree};
use crate::base::math::{Aabb, DVec3};
use binary::Binary;
use bounds::{Bounds, Boxed};

/// Triangles in a leaf at most: as many as a filter tests at once. Other things are tested one by one.
const TOGETHER: usize = 8;

impl Tree {
    /// A tree over boxes, with what is in its leaves.
    pub fn of_boxes(boxes: &[Aabb]) -> (Self, Contents) {
        let bounds = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        if bounds.is_empty() {
            return (Self::default(), Contents::default());
        }
        let space = Space::around(bounds);
        let boxed = |(thing, bounds): (u32, &Aabb)| Boxed::new(thing, Bounds::new(space.outward(*bounds)));
        Self::over(space, (0..).zip(boxes).map(boxed).collect(), 1)
    }

    /// A tree over triangles, given as indices into positions, that lie within `bounds`, with what is in its leaves. Long
    /// triangles may be in several.
    pub fn of_triangles(bounds: Aabb, positions: &[DVec3], triangles: &[[u32; 3]]) -> (Self, Contents) {
        if triangles.is_empty() {
            return (Self::default(), Contents::default());
        }
        let space = Space::around(bounds);
        Self::over(space, pieces::boxes(&space, positions, triangles), TOGETHER)
    }

    /// A tree over boxes in `space`, with leaves of at most `largest` things.
    fn over(space: Space, boxes: Vec<Boxed>, largest: usize) -> (Self, Contents) {
        collapse::collapse(&Binary::new(boxes, largest), space)
    }
}
