//! A binary tree over boxes, from the top down.

use super::bounds::{Bounds, CHUNK, PrimRef};
use super::plan::{self, CollapsePlan, Costs};
use super::split::{SplitResult, split};
use rayon::iter::repeat_n;
use rayon::prelude::*;

/// A binary tree over boxes. The boxes are sorted so that those of every subtree are contiguous.
pub struct BinaryTree {
    pub boxes: Vec<PrimRef>,
    /// The bounds of all boxes.
    pub bounds: Bounds,
    /// In depth-first order: a parent, its left subtree, its right subtree. Single boxes have no node.
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    /// Number of boxes below the left child.
    left: u32,
    plan: CollapsePlan,
}

/// From this number of boxes on, the two sides of a split are built in parallel.
const PARALLEL: usize = 2048;

/// A contiguous range of boxes that becomes one subtree.
struct Range<'a> {
    boxes: &'a mut [PrimRef],
    /// One node fewer than boxes.
    nodes: &'a mut [Node],
    bounds: Bounds,
    /// Bounds of twice their centres.
    centres: Bounds,
    /// Number of splits above this range.
    depth: u32,
}

impl BinaryTree {
    /// Builds the tree over at least one box, with at most `largest` boxes in a leaf.
    pub fn new(mut boxes: Vec<PrimRef>, largest: usize) -> Self {
        let empty = Node { left: 0, plan: CollapsePlan::default() };
        let union = |[a, b]: [Bounds; 2], [c, d]: [Bounds; 2]| [a.union(c), b.union(d)];
        let around =
            || boxes.par_chunks(CHUNK).map(Bounds::of_boxes_and_centres).reduce(|| [Bounds::EMPTY; 2], union);
        let (mut nodes, [bounds, centres]) = match boxes.len() < 2 * CHUNK {
            true => (vec![empty; boxes.len() - 1], Bounds::of_boxes_and_centres(&boxes)),
            // In parallel, because the system hands out memory at the first write, which takes time too.
            false => (repeat_n(empty, boxes.len() - 1).collect(), around()),
        };
        Range { boxes: &mut boxes, nodes: &mut nodes, bounds, centres, depth: 0 }.build(largest);
        Self { boxes, bounds, nodes }
    }

    pub fn root(&self) -> Subtree {
        Subtree { node: 0, begin: 0, count: self.boxes.len() }
    }
}

/// A node with its descendants, or a single box.
#[derive(Clone, Copy, Debug)]
pub struct Subtree {
    node: usize,
    pub begin: usize,
    pub count: usize,
}

impl Subtree {
    pub fn plan(self, tree: &BinaryTree) -> CollapsePlan {
        if self.count == 1 { CollapsePlan::LEAF } else { tree.nodes[self.node].plan }
    }

    pub fn children(self, tree: &BinaryTree) -> [Self; 2] {
        let left = tree.nodes[self.node].left as usize;
        let Self { node, begin, count } = self;
        [
            Self { node: node + 1, begin, count: left },
            Self { node: node + left, begin: begin + left, count: count - left },
        ]
    }

    /// The boxes of the subtree.
    pub fn boxes(self, tree: &BinaryTree) -> &[PrimRef] {
        &tree.boxes[self.begin..self.begin + self.count]
    }
}

impl Range<'_> {
    fn build(self, largest: usize) -> Costs {
        let count = self.boxes.len();
        let half_area = self.bounds.half_area();
        let Some((node, nodes)) = self.nodes.split_first_mut() else { return plan::leaf(half_area) };
        let SplitResult { left, bounds, centres } = split(self.boxes, &self.centres, self.depth);
        // If the two sides together cost as much as one leaf, their parts rarely cost less.
        if count <= largest && bounds[0].half_area() + bounds[1].half_area() >= half_area {
            *node = Node { left: left as u32, plan: CollapsePlan::LEAF };
            return plan::leaf(half_area);
        }
        let (boxes, rest) = self.boxes.split_at_mut(left);
        let (nodes, others) = nodes.split_at_mut(left - 1);
        let depth = self.depth + 1;
        let a = Range { boxes, nodes, bounds: bounds[0], centres: centres[0], depth };
        let b = Range { boxes: rest, nodes: others, bounds: bounds[1], centres: centres[1], depth };
        let (a, b) = match count < PARALLEL {
            true => (a.build(largest), b.build(largest)),
            false => rayon::join(|| a.build(largest), || b.build(largest)),
        };
        let (costs, plan) = plan::join(&a, &b, half_area, count, count <= largest);
        *node = Node { left: left as u32, plan };
        costs
    }
}
