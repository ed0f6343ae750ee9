//! From a binary tree to one with eight children per node.

use super::binary::{Binary, Subtree};
use super::bounds::Bounds;
use super::split::TOGETHER;
use crate::base::math::DVec3;
use crate::geometry::bvh::{Child, Contents, Node, Space, Tree};
use rayon::prelude::*;

/// The tree that a binary one becomes by its plans, with what is in its leaves. What is below a node stands behind it,
/// its children side by side.
pub fn collapse(binary: &Binary, space: Space) -> (Tree, Contents) {
    let all = binary.root();
    // What is small is made in parallel and put into the whole, in the order in which it is met there.
    let (mut top, mut small) = (Wide::default(), Vec::new());
    top.add(binary, all, |_, subtree, _| {
        let is_small = subtree.count < TOGETHER;
        small.extend(is_small.then_some(subtree));
        is_small
    });
    let part = |subtree: Subtree| {
        let mut part = Wide::with_capacity(subtree.count / LIKELY, subtree.count);
        part.add(binary, subtree, |_, _, _| false);
        part.enclose(0..part.nodes.len());
        part
    };
    let parts: Vec<_> = small.into_par_iter().map(part).collect();
    let sum = |size: fn(&Wide) -> usize| size(&top) + parts.iter().map(size).sum::<usize>();
    let mut wide = Wide::with_capacity(sum(|part| part.nodes.len()) - parts.len(), all.count);
    let (mut parts, mut upper) = (parts.into_iter(), Vec::new());
    wide.add(binary, all, |whole, subtree, node| {
        let part = if subtree.count < TOGETHER { parts.next() } else { None };
        if part.is_none() {
            upper.push(node);
        }
        part.map(|part| whole.append(node, part)).is_some()
    });
    wide.enclose(upper.into_iter());
    wide.contents.shrink_to_fit();
    let root = if wide.nodes.is_empty() { Child::leaf(0) } else { Child(0) };
    let bounds = binary.bounds.corners().map(|corner| DVec3::from_array(corner.map(f64::from)));
    (Tree { space, bounds, nodes: wide.nodes, root }, wide.contents)
}

/// Boxes for a node of most trees over triangles, at least.
const LIKELY: usize = 16;

/// A part of a tree.
#[derive(Default)]
struct Wide {
    nodes: Vec<Node>,
    contents: Contents,
}

/// Nodes that have no children yet, and what goes below them.
type Waiting = Vec<(Subtree, usize)>;

impl Wide {
    fn with_capacity(nodes: usize, things: usize) -> Self {
        Self { nodes: Vec::with_capacity(nodes), contents: Contents::with_capacity(things) }
    }

    /// Adds what a subtree becomes, its root first, but for what is put `aside`.
    fn add(
        &mut self,
        binary: &Binary,
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

    /// A leaf, or a node that waits for its children.
    fn child(&mut self, binary: &Binary, subtree: Subtree, waiting: &mut Waiting) -> Child {
        if subtree.plan(binary).is_leaf() {
            let things = subtree.boxes(binary).iter().map(|boxed| boxed.thing());
            return Child::leaf(self.contents.push(things));
        }
        let planes = [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3];
        waiting.push((subtree, self.nodes.len()));
        self.nodes.push(Node { planes, children: [Child::NONE; 8] });
        Child(self.nodes.len() as u32 - 1)
    }

    /// Gives a node its children, with the boxes of those that are leaves.
    fn fill(&mut self, binary: &Binary, subtree: Subtree, node: usize, waiting: &mut Waiting) {
        let (mut roots, mut count) = ([subtree; 8], 0);
        subtree.roots(binary, 8, &mut roots, &mut count);
        for (slot, root) in roots.into_iter().enumerate().take(count) {
            let child = self.child(binary, root, waiting);
            self.nodes[node].children[slot] = child;
            if child.as_leaf().is_some() {
                let boxes = root.boxes(binary).iter().map(|boxed| boxed.bounds());
                self.nodes[node].set_box(slot, boxes.fold(Bounds::EMPTY, Bounds::union).corners());
            }
        }
    }

    /// The boxes of nodes that are children of others, in whose order they stand.
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

    /// Puts the root of a part in the place of a node, and what is below behind all the rest.
    fn append(&mut self, node: usize, mut part: Self) {
        let (nodes, leaves) = (self.nodes.len() as u32, self.contents.len() as u32);
        let moved = |child: Child| match child.as_leaf() {
            _ if child == Child::NONE => child,
            Some(leaf) => Child::leaf(leaf + leaves),
            // The part's root stands elsewhere.
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
    fn set_box(&mut self, slot: usize, [low, high]: [[f32; 3]; 2]) {
        for (axis, planes) in self.planes.iter_mut().enumerate() {
            (planes[0][slot], planes[1][slot]) = (low[axis], high[axis]);
        }
    }

    /// Of a box around those of all its children.
    pub(super) fn corners(&self) -> [[f32; 3]; 2] {
        [
            self.planes.map(|[low, _]| low.into_iter().fold(f32::INFINITY, f32::min)),
            self.planes.map(|[_, high]| high.into_iter().fold(f32::NEG_INFINITY, f32::max)),
        ]
    }
}

impl Subtree {
    /// The subtrees, at most `most`, that become the children of a node.
    fn roots(self, binary: &Binary, most: usize, roots: &mut [Self; 8], count: &mut usize) {
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
