//! A binary tree over boxes, from the top down.

use super::bins::{self, FEW, TOGETHER};
use super::bounds::{Bounds, Boxed};
use super::plan::{self, Costs, Plan};
use glam::{BVec4A, Vec4};
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

/// Splits above each other before boxes are halved as they come.
const DEEPEST: u32 = 64;

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
        let around = |boxes: &[Boxed]| {
            let start = [Bounds::EMPTY; 2];
            boxes.iter().fold(start, |[all, centres], b| [all.union(b.bounds()), centres.with(b.centre())])
        };
        let union = |[a, b]: [Bounds; 2], [c, d]: [Bounds; 2]| [a.union(c), b.union(d)];
        let [bounds, centres] = match boxes.len() < 2 * TOGETHER {
            true => around(&boxes),
            false => boxes.par_chunks(TOGETHER).map(around).reduce(|| [Bounds::EMPTY; 2], union),
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
        let (left, bounds, centres) = halves(self.boxes, &self.centres, self.depth);
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

/// Parts boxes in two; the number of those on the left side, and the bounds of boxes and of centres on both.
#[inline(never)]
fn halves(boxes: &mut [Boxed], centres: &Bounds, depth: u32) -> (usize, [Bounds; 2], [Bounds; 2]) {
    if boxes.len() <= FEW {
        return sweep(boxes, centres);
    }
    if depth < DEEPEST
        && let Some(split) = bins::split(boxes, centres)
    {
        let (left, centres) = partition(boxes, |boxed| split.is_left(boxed));
        return (left, split.bounds, centres);
    }
    let left = boxes.len() / 2;
    let (a, b) = boxes.split_at(left);
    let all = |boxes: &[Boxed]| boxes.iter().fold(Bounds::EMPTY, |all, boxed| all.union(boxed.bounds()));
    let centres = |boxes: &[Boxed]| boxes.iter().fold(Bounds::EMPTY, |all, boxed| all.with(boxed.centre()));
    (left, [all(a), all(b)], [centres(a), centres(b)])
}

/// [`halves`] of few boxes: in the order of their centres along the axis that these are farthest apart on.
#[inline(always)]
fn sweep(boxes: &mut [Boxed], centres: &Bounds) -> (usize, [Bounds; 2], [Bounds; 2]) {
    let count = boxes.len();
    let axis = centres.longest();
    for sorted in 1..count {
        let (boxed, mut place) = (boxes[sorted], sorted);
        while place > 0 && boxed.centre_along(axis) < boxes[place - 1].centre_along(axis) {
            boxes[place] = boxes[place - 1];
            place -= 1;
        }
        boxes[place] = boxed;
    }
    let mut right = [[Bounds::EMPTY; 2]; FEW];
    let mut all = [Bounds::EMPTY; 2];
    for place in (1..count).rev() {
        all = [all[0].union(boxes[place].bounds()), all[1].with(boxes[place].centre())];
        right[place] = all;
    }
    let mut best = (f32::INFINITY, 1, [Bounds::EMPTY; 2]);
    all = [Bounds::EMPTY; 2];
    for place in 1..count {
        all = [all[0].union(boxes[place - 1].bounds()), all[1].with(boxes[place - 1].centre())];
        let cost = all[0].measure() * place as f32 + right[place][0].measure() * (count - place) as f32;
        if cost < best.0 {
            best = (cost, place, all);
        }
    }
    let (_, place, all) = best;
    (place, [all[0], right[place][0]], [all[1], right[place][1]])
}

/// Puts the boxes of the left side first; their number, and the bounds of the centres on both sides.
fn partition(boxes: &mut [Boxed], is_left: impl Fn(&Boxed) -> bool + Sync) -> (usize, [Bounds; 2]) {
    if boxes.len() < 2 * TOGETHER {
        return partition_alone(boxes, &is_left);
    }
    let parts = boxes.par_chunks_mut(TOGETHER).map(|part| partition_alone(part, &is_left));
    let parts: Vec<_> = parts.collect();
    let left = parts.iter().map(|(left, _)| left).sum();
    let join = |[a, b]: [Bounds; 2], [c, d]: [Bounds; 2]| [a.union(c), b.union(d)];
    let centres = parts.iter().map(|(_, centres)| *centres).fold([Bounds::EMPTY; 2], join);
    // Each part is in order by itself: what stands on the wrong side of the whole changes places.
    let (front, back) = boxes.split_at_mut(left);
    let mut late = parts.iter().enumerate().map(|(i, (left, _))| (i * TOGETHER, *left));
    let (mut begin, mut waiting) = (0, 0);
    for (i, (here, _)) in parts.iter().enumerate() {
        // Right ones in front.
        let from = i * TOGETHER + here;
        let to = ((i + 1) * TOGETHER).min(left);
        let mut from = from;
        while from < to {
            while waiting == 0 {
                let Some((start, count)) = late.next() else { return (left, centres) };
                begin = start.max(left);
                waiting = (start + count).saturating_sub(begin);
            }
            let count = waiting.min(to - from);
            front[from..from + count].swap_with_slice(&mut back[begin - left..begin - left + count]);
            from += count;
            begin += count;
            waiting -= count;
        }
    }
    (left, centres)
}

fn partition_alone(boxes: &mut [Boxed], is_left: &impl Fn(&Boxed) -> bool) -> (usize, [Bounds; 2]) {
    let [mut of_left, mut of_right] = [Bounds::EMPTY; 2];
    let mut left = 0;
    // Without branches, which could not be predicted.
    for place in 0..boxes.len() {
        let (boxed, first) = (boxes[place], boxes[left]);
        (boxes[place], boxes[left]) = (first, boxed);
        let is_left = is_left(&boxed);
        left += usize::from(is_left);
        let centre = boxed.centre();
        let mask = BVec4A::splat(is_left);
        of_left = of_left.union(Bounds {
            low: Vec4::select(mask, centre, Vec4::INFINITY),
            high: Vec4::select(mask, centre, Vec4::NEG_INFINITY),
        });
        of_right = of_right.union(Bounds {
            low: Vec4::select(mask, Vec4::INFINITY, centre),
            high: Vec4::select(mask, Vec4::NEG_INFINITY, centre),
        });
    }
    (left, [of_left, of_right])
}
