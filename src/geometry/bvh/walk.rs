//! Walking a tree along a ray.

use super::slabs::Wide;
use super::{Child, Node, Probe, Slabs, Tree};
use crate::base::lanes::{Level, SimdKernel, dispatch_narrow};

/// What a tree's leaves hold, while a ray walks the tree.
pub trait Leaves {
    /// Tests what is in a leaf and before `limit`; gives the limit beyond which nothing is of interest any more, or none to end the walk.
    /// Implementations are `#[inline(always)]`.
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32>;

    /// Asks for what is in a leaf that will be visited soon.
    fn prefetch<L: Level>(&self, leaf: u32);
}

impl Tree {
    /// Visits every leaf that the ray may meet before `t_max`, of a node's children the nearest first.
    #[inline(always)]
    pub fn walk(&self, probe: &Probe, t_max: f64, leaves: &mut impl Leaves) {
        if self.root != Child::NONE {
            dispatch_narrow(Begin { tree: self, probe, t_max, leaves });
        }
    }

    /// [`Tree::walk`] on lanes that are at work already.
    #[inline(always)]
    pub fn walk_on<L: Level>(&self, probe: &Probe, t_max: f64, leaves: &mut impl Leaves, stack: &mut Stack) {
        if self.root != Child::NONE
            && let Some(slabs) = Slabs::new::<L>(self, probe, t_max)
        {
            let limit = slabs.limit(t_max);
            Walk { tree: self, slabs: &slabs, leaves, limit, from: self.root, stack }.run::<L>();
        }
    }
}

/// A walk from the root on.
struct Begin<'a, V> {
    tree: &'a Tree,
    probe: &'a Probe,
    t_max: f64,
    leaves: &'a mut V,
}

impl<V: Leaves> SimdKernel for Begin<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { tree, probe, t_max, leaves } = self;
        tree.walk_on::<L>(probe, t_max, leaves, &mut Stack::default());
    }
}

/// A walk from a child on.
pub(super) struct Walk<'a, V> {
    pub tree: &'a Tree,
    pub slabs: &'a Slabs,
    pub leaves: &'a mut V,
    pub limit: f32,
    pub from: Child,
    pub stack: &'a mut Stack,
}

impl<V: Leaves> SimdKernel for Walk<'_, V> {
    /// The limit at the end of the walk; none if a leaf has ended it.
    type Output = Option<f32>;

    #[inline(always)]
    fn run<L: Level>(self) -> Option<f32> {
        let Self { tree, slabs, leaves, mut limit, from, stack: Stack(entries) } = self;
        let wide = Wide::<L::F32>::new(slabs);
        let (mut top, mut at) = (0, from);
        loop {
            if let Some(leaf) = at.as_leaf() {
                limit = leaves.visit::<L>(leaf, slabs, limit)?;
            } else if top > STACK - 8 {
                let stack = &mut Stack::default();
                limit = walk_apart(Walk { tree, slabs, leaves, limit, from: at, stack })?;
            } else {
                let node = &tree.nodes[at.0 as usize];
                let (met, enter) = wide.test(node, limit);
                if met != 0 {
                    let first = met.trailing_zeros() as usize & 7;
                    let mut others = met & (met - 1);
                    if others == 0 {
                        at = node.children[first];
                        continue;
                    }
                    let mut nearest = Entered::new(node, &enter, first);
                    let bottom = top;
                    while others != 0 {
                        let mut other = Entered::new(node, &enter, others.trailing_zeros() as usize & 7);
                        others &= others - 1;
                        (nearest, other) = nearest.sorted(other);
                        match other.child().as_leaf() {
                            Some(leaf) => leaves.prefetch::<L>(leaf),
                            None => L::prefetch(&tree.nodes, other.child().0 as usize),
                        }
                        put(entries, bottom, top, other);
                        top += 1;
                    }
                    at = nearest.child();
                    continue;
                }
            }
            at = loop {
                top = match top.checked_sub(1) {
                    Some(top) => top,
                    None => return Some(limit),
                };
                let next = entries[top % STACK];
                // A box entered exactly at the limit may hold an equally near thing of a lower index.
                if next.enter() <= limit {
                    break next.child();
                }
            };
        }
    }
}

/// A child with where the ray enters it, in the upper half, so that numbers compare like distances: those are never
/// below zero, and then their bits are in order. A zero with a sign counts as far; that changes the order of visits alone.
#[derive(Clone, Copy)]
struct Entered(u64);

impl Entered {
    #[inline(always)]
    fn new(node: &Node, enter: &[f32; 8], slot: usize) -> Self {
        Self(u64::from(enter[slot].to_bits()) << 32 | u64::from(node.children[slot].0))
    }

    #[inline(always)]
    fn child(self) -> Child {
        Child(self.0 as u32)
    }

    #[inline(always)]
    fn enter(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    /// The nearer and the farther of two, without a branch, which could not be predicted.
    #[inline(always)]
    fn sorted(self, other: Self) -> (Self, Self) {
        (Self(self.0.min(other.0)), Self(self.0.max(other.0)))
    }
}

/// Children put off at once. Where a deeper tree needs more, what is below a node is walked by recursion.
const STACK: usize = 64;

/// Room for the children that a walk puts off. What is in it before and after means nothing.
pub struct Stack([Entered; STACK]);

impl Default for Stack {
    fn default() -> Self {
        Self([Entered(0); STACK])
    }
}

/// Puts a child among those between `bottom` and `top`, of which the nearest is on top.
#[inline(always)]
fn put(entries: &mut [Entered; STACK], bottom: usize, top: usize, child: Entered) {
    let mut place = top;
    while place > bottom && entries[(place - 1) % STACK].0 < child.0 {
        entries[place % STACK] = entries[(place - 1) % STACK];
        place -= 1;
    }
    entries[place % STACK] = child;
}

/// The same walk from another child on, out of line.
#[cold]
#[inline(never)]
fn walk_apart<V: Leaves>(walk: Walk<'_, V>) -> Option<f32> {
    dispatch_narrow(walk)
}
