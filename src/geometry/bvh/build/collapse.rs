//! Collapses a binary tree to one with eight children per node.

use super::binary::{BinaryTree, Subtree};
use super::bounds::{Bounds, CHUNK};
use crate::base::math::DVec3;
use crate::geometry::bvh::tree::{Child, Node, Tree};
use crate::geometry::bvh::{LeafPrimitives, TreeSpace};
use glam::Vec4;
use rayon::prelude::*;

/// Collapses a binary tree by its plans. Also returns the primitives of the leaves. Descendants follow their node, and
/// siblings are contiguous.
pub fn collapse(binary: &BinaryTree, space: TreeSpace) -> (Tree, LeafPrimitives) {
    let all = binary.root();
    // Small subtrees are collapsed in parallel and then appended in the order of a depth-first walk.
    let (mut top, mut small) = (WideTree::default(), Vec::new());
    top.add(binary, all, |_, subtree, _| {
        let is_small = subtree.count < CHUNK;
        small.extend(is_small.then_some(subtree));
        is_small
    });
    let part = |subtree: Subtree| {
        let mut part = WideTree::with_capacity(subtree.count / LIKELY, subtree.count);
        part.add(binary, subtree, |_, _, _| false);
        part.enclose(0..part.nodes.len());
        part
    };
    let parts: Vec<_> = small.into_par_iter().map(part).collect();
    let sum = |size: fn(&WideTree) -> usize| size(&top) + parts.iter().map(size).sum::<usize>();
    let mut wide = WideTree::with_capacity(sum(|part| part.nodes.len()) - parts.len(), all.count);
    let (mut parts, mut upper) = (parts.into_iter(), Vec::new());
    wide.add(binary, all, |whole, subtree, node| {
        let part = if subtree.count < CHUNK { parts.next() } else { None };
        if part.is_none() {
            upper.push(node);
        }
        part.map(|part| whole.append(node, part)).is_some()
    });
    wide.enclose(upper.into_iter());
    wide.contents.shrink_to_fit();
    let root = if wide.nodes.is_empty() { Child::leaf(0) } else { Child(0) };
    let bounds = binary.bounds.corners().map(|corner| DVec3::from_array(corner.map(f64::from)));
    let mut tree = Tree { space, bounds, nodes: wide.nodes, root, built_cost: 0.0, refits: 0 };
    tree.built_cost = tree.cost();
    (tree, wide.contents)
}

/// Fewest boxes per node in most trees over triangles: used to reserve memory.
const LIKELY: usize = 16;

/// A part of the wide tree.
#[derive(Default)]
struct WideTree {
    nodes: Vec<Node>,
    contents: LeafPrimitives,
}

/// Subtrees whose nodes have no children yet, with the index of the node.
type Waiting = Vec<(Subtree, usize)>;

impl WideTree {
    fn with_capacity(nodes: usize, primitives: usize) -> Self {
        Self { nodes: Vec::with_capacity(nodes), contents: LeafPrimitives::with_capacity(primitives) }
    }

    /// Adds the nodes of a subtree, the root first. Subtrees for which `aside` returns true are left out.
    fn add(
        &mut self,
        binary: &BinaryTree,
        subtree: Subtree,
        mut aside: impl FnMut(&mut Self, Subtree, usize) -> bool,
    ) {
        let mut waiting = Vec::new();
        self.child(binary, subtree, &mut waiting);
        while let Some((subtree, node)) = waiting.pop() {
            if !aside(self, subtree, node) {
                self.fill(binary, subtree, node, &mut waiting);
            }
        }
    }

    /// Adds a leaf, or a node whose children follow later.
    fn child(&mut self, binary: &BinaryTree, subtree: Subtree, waiting: &mut Waiting) -> Child {
        if subtree.plan(binary).is_leaf() {
            let primitives = subtree.boxes(binary).iter().map(|prim| prim.primitive());
            return Child::leaf(self.contents.push(primitives));
        }
        let planes = [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3];
        waiting.push((subtree, self.nodes.len()));
        self.nodes.push(Node { planes, children: [Child::NONE; 8] });
        Child(self.nodes.len() as u32 - 1)
    }

    /// Sets a node's children and the boxes of those that are leaves.
    fn fill(&mut self, binary: &BinaryTree, subtree: Subtree, node: usize, waiting: &mut Waiting) {
        let (mut roots, mut count) = ([subtree; 8], 0);
        subtree.roots(binary, 8, &mut roots, &mut count);
        for (slot, root) in roots.into_iter().enumerate().take(count) {
            let child = self.child(binary, root, waiting);
            self.nodes[node].children[slot] = child;
            if child.as_leaf().is_some() {
                let boxes = root.boxes(binary).iter().map(|prim| prim.bounds());
                self.nodes[node].set_box(slot, boxes.fold(Bounds::EMPTY, Bounds::union).corners());
            }
        }
    }

    /// Sets the boxes of inner children from the bottom up. Children follow their parents in the list.
    fn enclose(&mut self, nodes: impl DoubleEndedIterator<Item = usize>) {
        for node in nodes.rev() {
            for slot in 0..8 {
                let child = self.nodes[node].children[slot];
                if child != Child::NONE && child.as_leaf().is_none() {
                    let corners = self.nodes[child.0 as usize].corners();
                    self.nodes[node].set_box(slot, corners);
                }
            }
        }
    }

    /// Replaces a node by the root of `part` and appends the rest of `part` at the end.
    fn append(&mut self, node: usize, mut part: Self) {
        let (nodes, leaves) = (self.nodes.len() as u32, self.contents.len() as u32);
        let moved = |child: Child| match child.as_leaf() {
            _ if child == Child::NONE => child,
            Some(leaf) => Child::leaf(leaf + leaves),
            // The root of the part replaces `node`, so the others move down by one.
            None => Child(child.0 - 1 + nodes),
        };
        for node in &mut part.nodes {
            node.children = node.children.map(moved);
        }
        self.nodes[node] = part.nodes[0].clone();
        self.nodes.extend_from_slice(&part.nodes[1..]);
        self.contents.append(part.contents);
    }
}

impl Node {
    pub(super) fn set_box(&mut self, slot: usize, [low, high]: [[f32; 3]; 2]) {
        for (axis, planes) in self.planes.iter_mut().enumerate() {
            (planes[0][slot], planes[1][slot]) = (low[axis], high[axis]);
        }
    }

    /// The corners of the box around all children.
    pub(super) fn corners(&self) -> [[f32; 3]; 2] {
        let half = |planes: &[f32; 8], first: usize| Vec4::from_slice(&planes[first..first + 4]);
        let low = |[low, _]: &[[f32; 8]; 2]| half(low, 0).min(half(low, 4)).min_element();
        let high = |[_, high]: &[[f32; 8]; 2]| half(high, 0).max(half(high, 4)).max_element();
        [self.planes.each_ref().map(low), self.planes.each_ref().map(high)]
    }
}

impl Subtree {
    /// The subtrees, at most `most`, that become the children of a node.
    fn roots(self, binary: &BinaryTree, most: usize, roots: &mut [Self; 8], count: &mut usize) {
        let Some(of_left) = self.plan(binary).of_left(most) else {
            roots[*count] = self;
            *count += 1;
            return;
        };
        let [left, right] = self.children(binary);
        left.roots(binary, of_left, roots, count);
        right.roots(binary, most - of_left, roots, count);
    }
}
