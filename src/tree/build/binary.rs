//! A binary tree over boxes, from the top down.

use super::bounds::{Bounds, Boxed};
use super::plan::{self, Costs, Plan};
use super::split::{Halves, TOGETHER, split};
use rayon::prelude::*;

/// A binary tree over boxes, which stand in its order: those of every subtree together.
pub struct Binary {
    pub boxes: Vec<Boxed>,
    /// A parent, then everything below its left child, then everything below its right one. Single boxes have none.
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    corners: [[f32; 3]; 2],
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
        let empty = Node { corners: [[0.0; 3]; 2], left: 0, plan: Plan::default() };
        let mut nodes = vec![empty; boxes.len() - 1];
        let union = |[a, b]: [Bounds; 2], [c, d]: [Bounds; 2]| [a.union(c), b.union(d)];
        let [bounds, centres] = match boxes.len() < 2 * TOGETHER {
            true => Bounds::both(&boxes),
            false => boxes.par_chunks(TOGETHER).map(Bounds::both).reduce(|| [Bounds::EMPTY; 2], union),
        };
        Range { boxes: &mut boxes, nodes: &mut nodes, bounds, centres, depth: 0 }.build(largest);
        Self { boxes, nodes }
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
    /// The lower and the upper corner of its box.
    pub fn corners(self, tree: &Binary) -> [[f32; 3]; 2] {
        if self.count == 1 {
            tree.boxes[self.begin].bounds().corners()
        } else {
            tree.nodes[self.node].corners
        }
    }

    pub fn plan(self, tree: &Binary) -> Plan {
        if self.count == 1 { Plan::SINGLE } else { tree.nodes[self.node].plan }
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
        let Some((node, nodes)) = self.nodes.split_first_mut() else { return plan::single(measure) };
        let Halves { left, bounds, centres } = split(self.boxes, &self.centres, self.depth);
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
        *node = Node { corners: self.bounds.corners(), left: left as u32, plan };
        costs
    }
}
