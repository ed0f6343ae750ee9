//! Refits trees: moves the boxes of leaves, and widens or narrows those above them. The tree keeps its shape.

use super::bounds::{self, Bounds};
use super::pieces;
use crate::base::math::{Aabb, DVec3};
use crate::geometry::bvh::tree::{Child, Node};
use crate::geometry::bvh::{Tree, TreeSpace};
use glam::Vec4;

/// The box around the content of a leaf, in the space of its tree.
#[derive(Clone, Copy, Debug)]
pub struct LeafBox([[f32; 3]; 2]);

impl LeafBox {
    /// The box around triangles that lie in `space`.
    #[inline(always)]
    pub fn of_triangles(
        space: &TreeSpace,
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        leaf: impl Iterator<Item = u32>,
    ) -> Self {
        let boxes = leaf.map(|triangle| pieces::whole(space, positions, triangles[triangle as usize]));
        Self(boxes.fold(Bounds::EMPTY, Bounds::union).corners())
    }

    /// A box of the world, rounded outwards.
    #[inline(always)]
    pub fn of_box(space: &TreeSpace, bounds: Aabb) -> Self {
        Self(Bounds::new(space.outward(bounds)).corners())
    }
}

/// A refitted tree is kept up to this multiple of the cost of the built one, and for so many refits: a box that flies away
/// makes the cost of all others small beside that of the root, and what lay in one place is sorted badly when it parts.
const WORST_GROWTH: f64 = 1.25;
const MOST_REFITS: u32 = 32;

impl Tree {
    /// Whether the tree may be refitted once more.
    pub fn can_be_refitted(&self) -> bool {
        self.refits < MOST_REFITS
    }

    /// The tree with other content of its leaves, which lies in `space`: one box for each leaf. None if a new tree is
    /// likely to be better.
    pub fn refitted(&self, space: TreeSpace, leaves: &[LeafBox]) -> Option<Self> {
        let (mut nodes, mut area) = (self.nodes.clone(), 0.0);
        // Children follow their parents.
        for index in (0..nodes.len()).rev() {
            for slot in 0..8 {
                let child = nodes[index].children[slot];
                if child != Child::NONE {
                    let corners = match child.as_leaf() {
                        Some(leaf) => leaves[leaf as usize].0,
                        None => nodes[child.0 as usize].corners(),
                    };
                    nodes[index].set_box(slot, corners);
                    area += half_area(corners);
                }
            }
        }
        let all = match (nodes.first(), leaves.first()) {
            (Some(root), _) => root.corners(),
            (None, Some(only)) => only.0,
            (None, None) => EMPTY,
        };
        let bounds = all.map(|corner| DVec3::from_array(corner.map(f64::from)));
        let tree = Self { space, bounds, nodes, refits: self.refits + 1, ..*self };
        // A comparison with NaN is false.
        (tree.cost_of(area) <= WORST_GROWTH * self.built_cost).then_some(tree)
    }

    /// The expected number of nodes and leaves that a ray visits if it hits the box around all (surface area
    /// heuristic).
    pub fn cost(&self) -> f64 {
        self.cost_of(self.nodes.iter().map(Node::half_area).sum())
    }

    /// How often the tree was refitted since it was built.
    #[cfg(test)]
    pub fn refits(&self) -> u32 {
        self.refits
    }

    /// The cost for a sum of the half areas of all boxes below the root.
    fn cost_of(&self, area: f64) -> f64 {
        1.0 + area / self.nodes.first().map_or(1.0, |root| half_area(root.corners()))
    }
}

/// Where the boxes of a tree are, and what they cost.
#[derive(Clone, Debug, Default)]
pub struct Refitter {
    /// For each node, and for each leaf, the place of its box.
    nodes: Vec<BoxPlace>,
    leaves: Vec<BoxPlace>,
    /// A bit for each node that holds a box that has changed.
    dirty: Vec<u64>,
    /// For each node, the sum of the half areas of its boxes when it was last updated, and the sum of these.
    areas: Vec<f64>,
    area: f64,
}

/// The place of a box: the index of a node, times 8, plus the number of the child.
#[derive(Clone, Copy, Debug)]
struct BoxPlace(u32);

impl BoxPlace {
    /// The root has no box.
    const NONE: Self = Self(u32::MAX);

    fn node(self) -> usize {
        self.0 as usize / 8
    }

    fn child(self) -> usize {
        self.0 as usize % 8
    }
}

/// The corners of a box without content. No ray hits it.
const EMPTY: [[f32; 3]; 2] = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

impl Refitter {
    /// For a tree whose nodes and leaves have been built.
    pub fn new(tree: &Tree, leaves: usize) -> Self {
        let mut refitter = Self {
            nodes: vec![BoxPlace::NONE; tree.nodes.len()],
            leaves: vec![BoxPlace::NONE; leaves],
            dirty: vec![0; tree.nodes.len().div_ceil(64)],
            areas: tree.nodes.iter().map(Node::half_area).collect(),
            area: 0.0,
        };
        for (index, node) in (0..).zip(&tree.nodes) {
            for (slot, child) in (0..).zip(node.children).filter(|(_, child)| *child != Child::NONE) {
                let place = BoxPlace(8 * index + slot);
                match child.as_leaf() {
                    Some(leaf) => refitter.leaves[leaf as usize] = place,
                    None => refitter.nodes[child.0 as usize] = place,
                }
            }
        }
        refitter.area = refitter.areas.iter().sum();
        refitter
    }

    /// Sets the box around the content of a leaf; none if the leaf is empty now. Returns false if the box does not lie
    /// in the tree's space, so that the tree has to be built again. Call [`Refitter::finish`] after the last leaf.
    #[inline]
    pub fn set_leaf(&mut self, tree: &mut Tree, leaf: u32, bounds: Option<Aabb>) -> bool {
        let corners = bounds.map_or(EMPTY, |bounds| Bounds::new(tree.space.outward(bounds)).corners());
        let [low, high] = corners;
        let fits =
            bounds.is_none() || low.iter().all(|low| *low >= -1.0) & high.iter().all(|high| *high <= 1.0);
        if fits {
            self.set(tree, self.leaves[leaf as usize], corners);
        }
        fits
    }

    fn set(&mut self, tree: &mut Tree, place: BoxPlace, corners: [[f32; 3]; 2]) {
        tree.nodes[place.node()].set_box(place.child(), corners);
        self.dirty[place.node() / 64] |= 1 << (place.node() % 64);
    }

    /// Updates the boxes above the leaves that were set, from the bottom up: children follow their parents.
    pub fn finish(&mut self, tree: &mut Tree) {
        for word in (0..self.dirty.len()).rev() {
            while let Some(bit) = self.dirty[word].checked_ilog2() {
                self.dirty[word] ^= 1 << bit;
                let index = 64 * word + bit as usize;
                let node = &tree.nodes[index];
                let (corners, area) = (node.corners(), node.half_area());
                self.area += area - std::mem::replace(&mut self.areas[index], area);
                let place = self.nodes[index];
                if index == 0 {
                    tree.bounds = corners.map(|corner| DVec3::from_array(corner.map(f64::from)));
                } else if tree.nodes[place.node()].box_of(place.child()) != corners {
                    self.set(tree, place, corners);
                }
            }
        }
    }

    /// The cost of the tree for a ray, as a multiple of its cost when it was built (surface area heuristic).
    pub fn growth(&self, tree: &Tree) -> f64 {
        self.cost(tree) / tree.built_cost
    }

    /// [`Tree::cost`], without looking at every node.
    pub fn cost(&self, tree: &Tree) -> f64 {
        tree.cost_of(self.area)
    }
}

/// Half the surface area of a box; 0 for an empty one.
fn half_area(corners: [[f32; 3]; 2]) -> f64 {
    if corners == EMPTY { 0.0 } else { f64::from(Bounds::new(corners).half_area()) }
}

impl Node {
    /// The sum of the half areas of the boxes. Empty ones have none.
    fn half_area(&self) -> f64 {
        let mut sum = 0.0;
        for first in [0, 4] {
            let row = |[low, high]: &[[f32; 8]; 2]| {
                [low, high].map(|planes| Vec4::from_slice(&planes[first..first + 4]))
            };
            let [x, y, z] = self.planes.each_ref().map(row);
            let areas = bounds::half_area([x, y, z].map(|[low, high]| high - low));
            let areas = Vec4::select(x[0].cmple(x[1]), areas, Vec4::ZERO);
            sum += areas.to_array().map(f64::from).iter().sum::<f64>();
        }
        sum
    }

    /// The corners of a child's box.
    fn box_of(&self, slot: usize) -> [[f32; 3]; 2] {
        let [[x, to_x], [y, to_y], [z, to_z]] = &self.planes;
        [[x[slot], y[slot], z[slot]], [to_x[slot], to_y[slot], to_z[slot]]]
    }
}
