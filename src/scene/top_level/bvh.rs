//! The tree over a scene's primitives and its construction.

use crate::geometry::bvh::{LeafPrimitives, Tree};
use crate::geometry::shape::Shape;
use crate::scene::{Geometry, Primitive};

/// A tree over the bounded primitives, with lists of those that are tested without it.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    pub(super) tree: Tree,
    /// The indices of the primitives in each leaf.
    pub(super) leaves: LeafPrimitives,
    /// Indices of primitives that are tested directly: infinite ones, or all if testing them is cheap.
    pub(super) direct: Vec<u32>,
    /// Indices of meshes outside the tree, if there is none. Each has a tree of its own.
    pub(super) meshes: Vec<u32>,
    /// The largest coordinate of all bounded primitives and of the points of planes.
    pub(super) reach: f64,
    /// Whether the geometry is so small that incoherent rays are searched as bundles too.
    pub(super) is_small: bool,
}

/// Below this cost of testing all bounded primitives there is no tree: a search takes longer.
const CHEAP: usize = 12;

/// The cost of testing a primitive, in tests of a sphere or a rectangle, which most rays that miss leave early. Others
/// take at least the transforms of three corners or of the ray first.
fn cost(primitive: &Primitive) -> usize {
    match (&primitive.shape, &primitive.transform) {
        (Shape::Sphere(_) | Shape::Rectangle(_) | Shape::Disk(_) | Shape::Cuboid(_), None) => 1,
        _ => 2,
    }
}

impl Bvh {
    /// Builds the tree over `geometry`. The same geometry gives the same tree.
    pub fn build(geometry: &Geometry) -> Self {
        let (mut bounded, mut boxes, mut direct) = (Vec::new(), Vec::new(), Vec::new());
        for (index, primitive) in (0..).zip(&geometry.primitives) {
            match primitive.bounds() {
                Some(bounds) => {
                    bounded.push(index);
                    boxes.push(bounds);
                }
                None => direct.push(index),
            }
        }
        let (mut tree, mut leaves) = Tree::of_boxes(&boxes);
        let anchors = geometry.primitives.iter().filter_map(|primitive| match &primitive.shape {
            Shape::Plane(plane) => Some(plane.point.abs().max_element()),
            _ => None,
        });
        let reach = anchors.fold(tree.space().reach(), f64::max);
        let mut meshes = Vec::new();
        let costs = bounded.iter().map(|index| cost(&geometry.primitives[*index as usize]));
        if costs.sum::<usize>() < CHEAP {
            (tree, leaves) = Default::default();
            for index in bounded.drain(..) {
                let is_mesh = matches!(geometry.primitives[index as usize].shape, Shape::Mesh(_));
                if is_mesh { meshes.push(index) } else { direct.push(index) }
            }
            direct.sort_unstable();
        }
        leaves.renumber(|primitive| bounded[primitive as usize]);
        let mut shapes = geometry.primitives.iter().map(|primitive| &primitive.shape);
        let is_small = tree.is_small() && !shapes.any(|shape| matches!(shape, Shape::Mesh(_)));
        Self { tree, leaves, direct, meshes, reach, is_small }
    }

    /// The largest coordinate of all bounded primitives and of the points of planes.
    pub fn reach(&self) -> f64 {
        self.reach
    }
}
