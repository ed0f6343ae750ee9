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

use super::{Contents, Space, Tree};
use crate::math::{Aabb, DVec3};
use binary::Binary;
use bounds::{Bounds, Boxed};

/// Things in a leaf at most: as many as a filter tests at once.
const TOGETHER: usize = 8;

impl Tree {
    /// A tree over boxes, with what is in its leaves: single things, or several that are each of a kind of which a filter
    /// tests some at once.
    pub fn of_boxes(boxes: &[Aabb], is_of_kind: impl Fn(u32) -> bool) -> (Self, Contents) {
        let bounds = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        if bounds.is_empty() {
            return (Self::default(), Contents::default());
        }
        let space = Space::around(bounds);
        let boxed = |(thing, bounds): (u32, &Aabb)| {
            Boxed::new(thing, Bounds::new(space.outward(*bounds))).marked(is_of_kind(thing))
        };
        let boxes = (0..).zip(boxes).map(boxed).collect();
        Self::over(space, boxes, |boxes| boxes.iter().all(Boxed::is_marked))
    }

    /// A tree over triangles that lie within `bounds`, with what is in its leaves. Long triangles may be in several.
    pub fn of_triangles(
        bounds: Aabb,
        corners: impl Fn(u32) -> [DVec3; 3] + Sync,
        count: u32,
    ) -> (Self, Contents) {
        if count == 0 {
            return (Self::default(), Contents::default());
        }
        let space = Space::around(bounds);
        let placed = |triangle| {
            let [a, b, c] = corners(triangle);
            [space.point(a), space.point(b), space.point(c)]
        };
        let boxes = pieces::boxes(placed, count);
        Self::over(space, boxes, |_| true)
    }

    /// A tree over boxes in `space`, with leaves of single things, or of several that fit into one.
    fn over(space: Space, boxes: Vec<Boxed>, fit: impl Fn(&[Boxed]) -> bool + Sync) -> (Self, Contents) {
        let fit = |boxes: &[Boxed]| boxes.len() <= TOGETHER && fit(boxes);
        collapse::collapse(&Binary::new(boxes, &fit), space)
    }
}
