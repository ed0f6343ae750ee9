//! A binary tree over boxes, from the top down.

use super::bounds::{Bounds, Boxed};
use super::plan::{self, Costs, Plan};
use super::split::{Halves, TOGETHER, split};
use rayon::iter::repeat_n;
use rayon::prelude::*;

/// A binary tree over boxes, which stand in its order: those of every subtree together.
pub struct Binary {
    pub boxes: Vec<Boxed>,
    /// Around all of them.
    pub bounds: Bounds,
    /// A parent, then everything below its left child, then everything below its right one. Single boxes have none.
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    /// Boxes below the left child.
    left: u32,
    plan: Plan,
}

/// Boxes from which on the two sides of a split are built in parallel.
const PARALLEL: usize = 2048;

/// Boxes that are split at once.
struct Range<'a> {
    boxes: &'a mut [Boxed],
    /// One less than boxes.
    nodes: &'a mut [Node],
    bounds: Bounds,
    /// Around twice their centres.
    centres: Bounds,
    /// Splits above.
    depth: u32,
}

impl Binary {
    /// Over one box at least, with leaves of at most `largest` of them.
    pub fn new(mut boxes: Vec<Boxed>, largest: usize) -> Self {
        let empty = Node { left: 0, plan: Plan::default() };
        let union = |[a, b]: [Bounds; 2], [c, d]: [Bounds; 2]| [a.union(c), b.union(d)];
        let around = || boxes.par_chunks(TOGETHER).map(Bounds::both).reduce(|| [Bounds::EMPTY; 2], union);
        let (mut nodes, [bounds, centres]) = match boxes.len() < 2 * TOGETHER {
            true => (vec![empty; boxes.len() - 1], Bounds::both(&boxes)),
            // Memory is had from the system when it is first written to, which takes its time as well.
            false => (repeat_n(empty, boxes.len() - 1).collect(), around()),
        };
        Range { boxes: &mut boxes, nodes: &mut nodes, bounds, centres, depth: 0 }.build(largest);
        Self { boxes, bounds, nodes }
    }

    pub fn root(&self) -> Subtree {
        Subtree { node: 0, begin: 0, count: self.boxes.len() }
    }
}

/// Everything below a node, or a single box.
#[derive(Clone, Copy, Debug)]
pub struct Subtree {
    node: usize,
    pub begin: usize,
    pub count: usize,
}

impl Subtree {
    pub fn plan(self, tree: &Binary) -> Plan {
        if self.count == 1 { Plan::LEAF } else { tree.nodes[self.node].plan }
    }

    pub fn children(self, tree: &Binary) -> [Self; 2] {
        let left = tree.nodes[self.node].left as usize;
        let Self { node, begin, count } = self;
        [
            Self { node: node + 1, begin, count: left },
            Self { node: node + left, begin: begin + left, count: count - left },
        ]
    }

    /// Its boxes.
    pub fn boxes(self, tree: &Binary) -> &[Boxed] {
        &tree.boxes[self.begin..self.begin + self.count]
    }
}

impl Range<'_> {
    fn build(self, largest: usize) -> Costs {
        let count = self.boxes.len();
        let measure = self.bounds.measure();
        let Some((node, nodes)) = self.nodes.split_first_mut() else { return plan::leaf(measure) };
        let Halves { left, bounds, centres } = split(self.boxes, &self.centres, self.depth);
        // Where halves come to no less than a leaf of all, parts of them hardly ever do.
        if count <= largest && bounds[0].measure() + bounds[1].measure() >= measure {
            *node = Node { left: left as u32, plan: Plan::LEAF };
            return plan::leaf(measure);
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
        let (costs, plan) = plan::join(&a, &b, measure, count, count <= largest);
        *node = Node { left: left as u32, plan };
        costs
    }
}
