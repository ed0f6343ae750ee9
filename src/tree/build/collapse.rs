//! From a binary tree to one with eight children per node.

use super::binary::{Binary, Subtree};
use super::split::TOGETHER;
use crate::math::DVec3;
use crate::tree::{Child, Contents, Node, Space, Tree};
use rayon::prelude::*;

/// The tree that a binary one becomes by its plans, with what is in its leaves. What is below a node stands behind it,
/// its children side by side.
pub fn collapse(binary: &Binary, space: Space) -> (Tree, Contents) {
    let all = binary.root();
    let bounds = all.corners(binary).map(|corner| DVec3::from_array(corner.map(f64::from)));
    // What is small is made in parallel and put into the whole, in the order in which it is met there.
    let mut small = Vec::new();
    Wide::of(binary, all, |_, subtree, _| {
        let is_small = subtree.count < TOGETHER;
        small.extend(is_small.then_some(subtree));
        is_small
    });
    let part = |subtree| Wide::of(binary, subtree, |_, _, _| false);
    let parts: Vec<_> = small.into_par_iter().map(part).collect();
    let mut parts = parts.into_iter();
    let mut wide = Wide::of(binary, all, |whole, subtree, node| {
        let part = if subtree.count < TOGETHER { parts.next() } else { None };
        part.map(|part| whole.append(node, part)).is_some()
    });
    wide.nodes.shrink_to_fit();
    wide.contents.shrink_to_fit();
    let root = if wide.nodes.is_empty() { Child::leaf(0) } else { Child(0) };
    (Tree { space, bounds, nodes: wide.nodes, root }, wide.contents)
}

/// Boxes for a node of most trees over triangles.
const LIKELY: usize = 24;

/// A part of a tree.
#[derive(Default)]
struct Wide {
    nodes: Vec<Node>,
    contents: Contents,
}

/// Nodes that have no children yet, and what goes below them.
type Waiting = Vec<(Subtree, usize)>;

impl Wide {
    /// What a subtree becomes, its root first, but for what is put `aside`.
    fn of(
        binary: &Binary,
        subtree: Subtree,
        mut aside: impl FnMut(&mut Self, Subtree, usize) -> bool,
    ) -> Self {
        let contents = Contents::with_capacity(subtree.count);
        let mut wide = Self { nodes: Vec::with_capacity(subtree.count / LIKELY), contents };
        let mut waiting = Vec::new();
        wide.child(binary, subtree, &mut waiting);
        while let Some((subtree, node)) = waiting.pop() {
            if !aside(&mut wide, subtree, node) {
                wide.fill(binary, subtree, node, &mut waiting);
            }
        }
        wide
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

    fn fill(&mut self, binary: &Binary, subtree: Subtree, node: usize, waiting: &mut Waiting) {
        let (mut roots, mut count) = ([subtree; 8], 0);
        subtree.roots(binary, 8, &mut roots, &mut count);
        for (slot, root) in roots.into_iter().enumerate().take(count) {
            let child = self.child(binary, root, waiting);
            let [low, high] = root.corners(binary);
            let node = &mut self.nodes[node];
            node.children[slot] = child;
            for (axis, planes) in node.planes.iter_mut().enumerate() {
                (planes[0][slot], planes[1][slot]) = (low[axis], high[axis]);
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
        let mut below = part.nodes.drain(..);
        if let Some(root) = below.next() {
            self.nodes[node] = root;
        }
        self.nodes.extend(below);
        self.contents.append(part.contents);
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
