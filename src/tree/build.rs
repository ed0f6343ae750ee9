//! Building trees: PLOC clustering and reinsertion by `obvhs` over boxes in f32, then leaves as large as pays, then
//! eight children in a node.

use super::{Child, Node, Space, Tree};
use crate::math::{Aabb, DVec3};
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::{build_bvh2, build_bvh2_from_tris};
use obvhs::triangle::Triangle;
use obvhs::{BvhBuildParams, aabb};
use std::time::Duration;

/// The things of one leaf, by the order in which they were given.
pub type Leaf = Vec<u32>;

/// Things in a leaf at most: as many as a filter tests at once.
const LARGEST_LEAF: u32 = 8;

/// What a step of a binary tree costs, next to the test of a leaf.
const STEP: f32 = 0.3;

/// How far triangles rounded to f32 in the tree's space may be from themselves, and how far their boxes are widened.
const WIDENED: f32 = 2.0 * f32::EPSILON;

impl Tree {
    /// A tree over boxes, with its leaves.
    pub fn of_boxes(boxes: &[Aabb]) -> (Self, Vec<Leaf>) {
        let Some(space) = space(boxes.iter().copied()) else { return (Self::default(), Vec::new()) };
        let rounded: Vec<_> = boxes
            .iter()
            .map(|bounds| {
                let [min, max] = space.outward(*bounds);
                aabb::Aabb { min: min.into(), max: max.into() }
            })
            .collect();
        let parameters = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        Self::collapsed(space, &build_bvh2(&rounded, parameters, &mut Duration::default()), 0.0)
    }

    /// A tree over triangles, with its leaves. Long ones may be in several.
    pub fn of_triangles(corners: impl Fn(u32) -> [DVec3; 3], count: u32) -> (Self, Vec<Leaf>) {
        let Some(space) = space((0..count).map(|i| Aabb::around(corners(i)))) else {
            return (Self::default(), Vec::new());
        };
        let rounded = (0..count).map(|i| {
            let [v0, v1, v2] = corners(i).map(|corner| space.point(corner).as_vec3().to_array().into());
            Triangle { v0, v1, v2 }
        });
        let rounded: Vec<_> = rounded.collect();
        let parameters = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::slow_build() };
        Self::collapsed(space, &build_bvh2_from_tris(&rounded, parameters, &mut Duration::default()), WIDENED)
    }

    fn collapsed(space: Space, binary: &Bvh2, widened: f32) -> (Self, Vec<Leaf>) {
        Collapse::new(binary, widened).tree(space)
    }
}

/// The space of things with these boxes; none if there is nothing.
fn space(boxes: impl Iterator<Item = Aabb>) -> Option<Space> {
    let bounds = boxes.fold(Aabb::EMPTY, Aabb::union);
    (!bounds.is_empty()).then(|| Space::around(bounds))
}

/// From a binary tree to a wide one.
struct Collapse<'a> {
    binary: &'a Bvh2,
    widened: f32,
    /// Of each binary node: whether everything below it makes one leaf.
    is_leaf: Vec<bool>,
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

impl<'a> Collapse<'a> {
    fn new(binary: &'a Bvh2, widened: f32) -> Self {
        let is_leaf = leaves_that_pay(binary);
        Self { binary, widened, is_leaf, nodes: Vec::new(), leaves: Vec::new() }
    }

    fn tree(mut self, space: Space) -> (Tree, Vec<Leaf>) {
        let [min, max] = self.planes(0).map(|corner| DVec3::from_array(corner.map(f64::from)));
        let root = self.child(0);
        let mut waiting = vec![(0, root)];
        while let Some((binary, child)) = waiting.pop() {
            if child.as_leaf().is_none() {
                self.fill(binary, child, &mut waiting);
            }
        }
        (Tree { space, bounds: [min, max], nodes: self.nodes, root }, self.leaves)
    }

    /// The lower and the upper corner of a binary node's box.
    fn planes(&self, binary: u32) -> [[f32; 3]; 2] {
        let bounds = self.binary.nodes[binary as usize].aabb();
        let widened = self.widened;
        [bounds.min.to_array().map(|v| v - widened), bounds.max.to_array().map(|v| v + widened)]
    }

    /// A new leaf, or a place for a new node, for a binary node.
    fn child(&mut self, binary: u32) -> Child {
        if self.is_leaf[binary as usize] {
            self.leaves.push(self.things(binary));
            return Child::leaf(self.leaves.len() as u32 - 1);
        }
        let planes = [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3];
        self.nodes.push(Node { planes, children: [Child::NONE; 8] });
        Child(self.nodes.len() as u32 - 1)
    }

    /// Fills a node with up to eight descendants of a binary node: the largest ones are opened first.
    fn fill(&mut self, binary: u32, child: Child, waiting: &mut Vec<(u32, Child)>) {
        let below = |binary: u32| {
            let first = self.binary.nodes[binary as usize].first_index;
            [first, first + 1]
        };
        let area = |binary: u32| self.binary.nodes[binary as usize].aabb().half_area();
        let mut slots = below(binary).to_vec();
        while slots.len() < 8 {
            let inner = (0..slots.len()).filter(|&slot| !self.is_leaf[slots[slot] as usize]);
            let Some(largest) = inner.max_by(|&a, &b| area(slots[a]).total_cmp(&area(slots[b]))) else {
                break;
            };
            let [left, right] = below(slots[largest]);
            slots[largest] = left;
            slots.push(right);
        }
        for (slot, binary) in slots.into_iter().enumerate() {
            let placed = self.child(binary);
            let corners = self.planes(binary);
            let node = &mut self.nodes[child.0 as usize];
            node.children[slot] = placed;
            for (axis, planes) in node.planes.iter_mut().enumerate() {
                (planes[0][slot], planes[1][slot]) = (corners[0][axis], corners[1][axis]);
            }
            waiting.push((binary, placed));
        }
    }

    /// Everything below a binary node, each thing once.
    fn things(&self, binary: u32) -> Leaf {
        let mut things = Vec::new();
        let mut waiting = vec![binary];
        while let Some(index) = waiting.pop() {
            let node = &self.binary.nodes[index as usize];
            let first = node.first_index as usize;
            if node.prim_count > 0 {
                let own = &self.binary.primitive_indices[first..first + node.prim_count as usize];
                things.extend_from_slice(own);
            } else {
                waiting.extend([first as u32, first as u32 + 1]);
            }
        }
        things.sort_unstable();
        things.dedup();
        things
    }
}

/// Which binary nodes become leaves, by the surface area heuristic: the test of a leaf costs the same however full it
/// is.
fn leaves_that_pay(binary: &Bvh2) -> Vec<bool> {
    let nodes = &binary.nodes;
    let mut order = vec![0u32];
    let mut at = 0;
    while let Some(&index) = order.get(at) {
        let node = &nodes[index as usize];
        if node.prim_count == 0 {
            order.extend([node.first_index, node.first_index + 1]);
        }
        at += 1;
    }
    let mut is_leaf = vec![true; nodes.len()];
    let mut things: Vec<u32> = nodes.iter().map(|node| node.prim_count).collect();
    let mut cost: Vec<f32> = nodes.iter().map(|node| node.aabb().half_area()).collect();
    // Children stand behind their parents.
    for &index in order.iter().rev() {
        let (index, node) = (index as usize, &nodes[index as usize]);
        if node.prim_count > 0 {
            continue;
        }
        let [left, right] = [0, 1].map(|side| node.first_index as usize + side);
        things[index] = things[left] + things[right];
        let apart = cost[left] + cost[right] + cost[index] * STEP;
        is_leaf[index] = things[index] <= LARGEST_LEAF && cost[index] <= apart;
        if !is_leaf[index] {
            cost[index] = apart;
        }
    }
    is_leaf
}
