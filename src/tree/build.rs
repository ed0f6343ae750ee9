//! Building trees: PLOC clustering and reinsertion by `obvhs` over boxes in f32, then leaves as large as pays, then
//! eight children in a node.

use super::{Child, Node, Space, Tree};
use crate::math::{Aabb, DVec3};
use crate::sampling::hash;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb as Aabb32;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::splits::split_aabbs_preset;
use obvhs::triangle::Triangle;
use std::collections::HashMap;
use std::time::Duration;

/// The things of one leaf, by the order in which they were given.
pub type Leaf = Vec<u32>;

/// Triangles in a leaf at most: as many as a filter tests at once. Other things are tested one by one.
const TOGETHER: u32 = 8;

/// What a step of a binary tree costs, next to the test of a leaf.
const STEP: f32 = 0.3;

/// How far triangles rounded to f32 in the tree's space may be from themselves, and how far their boxes are widened.
const WIDENED: f32 = 2.0 * f32::EPSILON;

impl Tree {
    /// A tree over boxes, with its leaves.
    pub fn of_boxes(boxes: &[Aabb]) -> (Self, Vec<Leaf>) {
        let Some(space) = space(boxes.iter().copied()) else { return (Self::default(), Vec::new()) };
        let rounded = boxes.iter().map(|bounds| {
            let [min, max] = space.outward(*bounds);
            Aabb32 { min: min.into(), max: max.into() }
        });
        // Moving things are built anew every frame.
        Self::over(space, rounded.collect(), BvhBuildParams::medium_build(), 1, &|thing| thing)
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
        let mut boxes: Vec<_> = rounded.iter().map(Triangle::aabb).collect();
        let areas = || boxes.iter().map(Aabb32::half_area);
        let (mean, largest) = (areas().sum::<f32>() / count as f32, areas().fold(0.0, f32::max));
        let mut parts: Vec<u32> = (0..count).collect();
        split_aabbs_preset(&mut boxes, &mut parts, &rounded, mean, largest);
        for bounds in &mut boxes {
            *bounds = Aabb32 { min: bounds.min - WIDENED, max: bounds.max + WIDENED };
        }
        Self::over(space, boxes, BvhBuildParams::slow_build(), TOGETHER, &|index| parts[index as usize])
    }

    /// A tree over boxes in `space`, with leaves of at most `largest` things; `thing` says what is in each box.
    fn over(
        space: Space,
        boxes: Vec<Aabb32>,
        parameters: BvhBuildParams,
        largest: u32,
        thing: &dyn Fn(u32) -> u32,
    ) -> (Self, Vec<Leaf>) {
        let (mut boxes, groups) = grouped(boxes, thing);
        for (index, bounds) in (0..).zip(&mut boxes) {
            bounds.max += tie_break(index);
        }
        let parameters = BvhBuildParams { max_prims_per_leaf: 1, ..parameters };
        let binary = build_bvh2(&boxes, parameters, &mut Duration::default());
        Collapse::new(&binary, &groups, largest).tree(space)
    }
}

/// Different boxes, each with what is in it: clustering would find equal ones by pairs only.
fn grouped(boxes: Vec<Aabb32>, thing: &dyn Fn(u32) -> u32) -> (Vec<Aabb32>, Vec<Leaf>) {
    let mut known: HashMap<[u32; 6], usize> = HashMap::with_capacity(boxes.len());
    let (mut different, mut groups): (Vec<Aabb32>, Vec<Leaf>) = (Vec::new(), Vec::new());
    for (index, bounds) in (0..).zip(boxes) {
        let ([a, b, c], [d, e, f]) = (bounds.min.to_array(), bounds.max.to_array());
        let group = *known.entry([a, b, c, d, e, f].map(f32::to_bits)).or_insert_with(|| {
            different.push(bounds);
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[group].push(thing(index));
    }
    (different, groups)
}

/// How far a box is widened so that it is unlike others. Clustering pairs boxes that are each other's best partner; in
/// rows and stacks of equal ones it would find a single pair at a time. A step of the largest coordinates is enough to
/// be seen in areas.
fn tie_break(index: u32) -> f32 {
    (hash([index, 0, 0]) % 16) as f32 * f32::EPSILON
}

/// The space of things with these boxes; none if there is nothing.
fn space(boxes: impl Iterator<Item = Aabb>) -> Option<Space> {
    let bounds = boxes.fold(Aabb::EMPTY, Aabb::union);
    (!bounds.is_empty()).then(|| Space::around(bounds))
}

/// From a binary tree to a wide one.
struct Collapse<'a> {
    binary: &'a Bvh2,
    groups: &'a [Leaf],
    /// Things in a leaf at most.
    largest: u32,
    plans: Vec<Plan>,
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

impl<'a> Collapse<'a> {
    fn new(binary: &'a Bvh2, groups: &'a [Leaf], largest: u32) -> Self {
        let plans = plans(binary, groups, largest);
        Self { binary, groups, largest, plans, nodes: Vec::new(), leaves: Vec::new() }
    }

    fn is_leaf(&self, binary: u32) -> bool {
        self.plans[binary as usize].is_leaf
    }

    fn tree(mut self, space: Space) -> (Tree, Vec<Leaf>) {
        let [min, max] = self.planes(0).map(|corner| DVec3::from_array(corner.map(f64::from)));
        let root = self.child(0);
        let mut waiting = if self.is_leaf(0) { Vec::new() } else { vec![(0, root)] };
        while let Some((binary, child)) = waiting.pop() {
            self.fill(binary, child, &mut waiting);
        }
        (Tree { space, bounds: [min, max], nodes: self.nodes, root }, self.leaves)
    }

    /// The lower and the upper corner of a binary node's box.
    fn planes(&self, binary: u32) -> [[f32; 3]; 2] {
        let bounds = self.binary.nodes[binary as usize].aabb();
        [bounds.min.to_array(), bounds.max.to_array()]
    }

    /// A new leaf, or a place for a new node, for a binary node.
    fn child(&mut self, binary: u32) -> Child {
        if self.is_leaf(binary) {
            let corners = self.planes(binary);
            return self.leaf(self.things(binary), corners);
        }
        self.node()
    }

    /// A leaf of these things, or nodes over several leaves if they are many: then all are in the same place.
    fn leaf(&mut self, things: Leaf, corners: [[f32; 3]; 2]) -> Child {
        if things.len() <= self.largest as usize {
            self.leaves.push(things);
            return Child::leaf(self.leaves.len() as u32 - 1);
        }
        let parent = self.node();
        for (slot, part) in things.chunks(things.len().div_ceil(8)).enumerate() {
            let child = self.leaf(part.to_vec(), corners);
            self.place(parent, slot, child, corners);
        }
        parent
    }

    /// An empty node.
    fn node(&mut self) -> Child {
        let planes = [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3];
        self.nodes.push(Node { planes, children: [Child::NONE; 8] });
        Child(self.nodes.len() as u32 - 1)
    }

    /// Fills a node with up to eight descendants of a binary node: the largest ones are opened first.
    fn fill(&mut self, binary: u32, child: Child, waiting: &mut Vec<(u32, Child)>) {
        let mut slots = Vec::new();
        let node = &self.binary.nodes[binary as usize];
        let left = self.plans[binary as usize].split[8];
        self.roots(node.first_index, left, &mut slots);
        self.roots(node.first_index + 1, 8 - left, &mut slots);
        for (slot, binary) in slots.into_iter().enumerate() {
            let placed = self.child(binary);
            self.place(child, slot, placed, self.planes(binary));
            if !self.is_leaf(binary) {
                waiting.push((binary, placed));
            }
        }
    }

    /// The nodes and leaves, at most `count`, that a binary node becomes as a forest.
    fn roots(&self, binary: u32, count: u8, roots: &mut Vec<u32>) {
        let plan = &self.plans[binary as usize];
        let left = plan.split[count as usize];
        if left == 0 {
            roots.push(binary);
            return;
        }
        let count = plan.used[count as usize];
        let first = self.binary.nodes[binary as usize].first_index;
        self.roots(first, left, roots);
        self.roots(first + 1, count - left, roots);
    }

    fn place(&mut self, parent: Child, slot: usize, child: Child, corners: [[f32; 3]; 2]) {
        let node = &mut self.nodes[parent.0 as usize];
        node.children[slot] = child;
        for (axis, planes) in node.planes.iter_mut().enumerate() {
            (planes[0][slot], planes[1][slot]) = (corners[0][axis], corners[1][axis]);
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
                own.iter().for_each(|&index| things.extend_from_slice(&self.groups[index as usize]));
            } else {
                waiting.extend([first as u32, first as u32 + 1]);
            }
        }
        things.sort_unstable();
        things.dedup();
        things
    }
}

#[derive(Clone, Copy, Default)]
struct Plan {
    /// cost[i]: of the subtree as a forest of at most i roots
    cost: [f32; 8],
    /// roots of the left child if the forest of at most i roots is split; 0 if it is one root. [8]: as the children of a node
    split: [u8; 9],
    used: [u8; 9],
    is_leaf: bool,
    things: u32,
}

fn plans(binary: &Bvh2, groups: &[Leaf], largest: u32) -> Vec<Plan> {
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
    let leaf_cost: f32 = 1.0;
    let mut plans = vec![Plan::default(); nodes.len()];
    for &index in order.iter().rev() {
        let (index, node) = (index as usize, &nodes[index as usize]);
        let area = node.aabb().half_area();
        let mut plan = Plan::default();
        if node.prim_count > 0 {
            let first = node.first_index as usize;
            let own = &binary.primitive_indices[first..first + node.prim_count as usize];
            plan.things = own.iter().map(|&group| groups[group as usize].len() as u32).sum();
            plan.is_leaf = true;
            plan.cost = [area * leaf_cost; 8];
            plans[index] = plan;
            continue;
        }
        let (left, right) = (plans[node.first_index as usize], plans[node.first_index as usize + 1]);
        plan.things = left.things + right.things;
        let distribute = |roots: usize| {
            let mut best = (f32::INFINITY, 0u8);
            for k in 1..roots {
                let cost = left.cost[k.min(7)] + right.cost[(roots - k).min(7)];
                if cost < best.0 {
                    best = (cost, k as u8);
                }
            }
            best
        };
        let (inner, split) = distribute(8);
        plan.split[8] = split;
        let as_node = inner + area;
        let as_leaf = if plan.things <= largest { area * leaf_cost } else { f32::INFINITY };
        plan.is_leaf = as_leaf <= as_node;
        plan.cost[1] = as_leaf.min(as_node);
        for roots in 2..8 {
            let (cost, split) = distribute(roots);
            if cost < plan.cost[roots - 1] {
                plan.cost[roots] = cost;
                plan.split[roots] = split;
                plan.used[roots] = roots as u8;
            } else {
                plan.cost[roots] = plan.cost[roots - 1];
                plan.split[roots] = plan.split[roots - 1];
                plan.used[roots] = plan.used[roots - 1];
            }
        }
        plans[index] = plan;
    }
    plans
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes in a row, in a plane and in one place: the tree must not be deep, nor take long.
    #[test]
    fn equal_boxes_make_balanced_trees() {
        let cube = |at: DVec3| Aabb { min: at, max: at + DVec3::splat(0.5) };
        let row = |i: u32| cube(DVec3::X * f64::from(i));
        let plane = |i: u32| cube(DVec3::new(f64::from(i % 64), 0.0, f64::from(i / 64)));
        let stack = |_: u32| cube(DVec3::ONE);
        let all: [&dyn Fn(u32) -> Aabb; 3] = [&row, &plane, &stack];
        for boxes in all {
            let boxes: Vec<_> = (0..4096).map(boxes).collect();
            let (tree, leaves) = Tree::of_boxes(&boxes);
            let mut things: Vec<u32> = leaves.into_iter().flatten().collect();
            things.sort_unstable();
            assert!(things.into_iter().eq(0..4096));
            assert!(depth(&tree, tree.root) <= 12, "{}", depth(&tree, tree.root));
        }
    }

    fn depth(tree: &Tree, child: Child) -> u32 {
        if child == Child::NONE || child.as_leaf().is_some() {
            return 0;
        }
        let children = tree.nodes[child.0 as usize].children;
        1 + children.into_iter().map(|child| depth(tree, child)).max().unwrap_or(0)
    }
}
