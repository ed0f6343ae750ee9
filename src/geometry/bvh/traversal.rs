//! Traversal along a single ray.

use super::slabs::WideSlabs;
use super::tree::{Child, Node, Tree};
use super::{Slabs, TraversalRay};
use crate::base::lanes::{Level, SimdKernel, dispatch_narrow};

/// Visits the leaves of a tree that a ray may hit.
pub trait LeafVisitor {
    /// Tests the primitives of a leaf that may be hit before `limit`. Returns the new limit, or none to end the walk.
    /// Implementations are `#[inline(always)]`.
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32>;

    /// Prefetches the primitives of a leaf that will be visited soon.
    fn prefetch<L: Level>(&self, leaf: u32);
}

impl Tree {
    /// Visits every leaf that the ray may hit within a span of t, the nearest child of a node first.
    #[inline(always)]
    pub fn walk(&self, ray: &TraversalRay, span: [f64; 2], leaves: &mut impl LeafVisitor) {
        if self.root != Child::NONE {
            dispatch_narrow(Begin { tree: self, ray, span, leaves });
        }
    }

    /// [`Tree::walk`] within a kernel that already runs on a level.
    #[inline(always)]
    pub fn walk_on<L: Level>(
        &self,
        ray: &TraversalRay,
        span: [f64; 2],
        leaves: &mut impl LeafVisitor,
        stack: &mut Stack,
    ) {
        if self.root != Child::NONE
            && let Some(slabs) = Slabs::new::<L>(self, ray, span)
        {
            let limit = slabs.limit(span[1]);
            Traversal { tree: self, slabs: &slabs, leaves, limit, from: self.root, stack }.run::<L>();
        }
    }
}

/// A walk from the root.
struct Begin<'a, V> {
    tree: &'a Tree,
    ray: &'a TraversalRay,
    span: [f64; 2],
    leaves: &'a mut V,
}

impl<V: LeafVisitor> SimdKernel for Begin<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { tree, ray, span, leaves } = self;
        tree.walk_on::<L>(ray, span, leaves, &mut Stack::default());
    }
}

/// A walk from a child.
pub(super) struct Traversal<'a, V> {
    pub tree: &'a Tree,
    pub slabs: &'a Slabs,
    pub leaves: &'a mut V,
    pub limit: f32,
    pub from: Child,
    pub stack: &'a mut Stack,
}

impl<V: LeafVisitor> SimdKernel for Traversal<'_, V> {
    /// The limit at the end of the walk; none if a leaf ended it.
    type Output = Option<f32>;

    #[inline(always)]
    fn run<L: Level>(self) -> Option<f32> {
        let Self { tree, slabs, leaves, mut limit, from, stack: Stack { entries, .. } } = self;
        let wide = WideSlabs::<L::F32>::new(slabs);
        let (mut top, mut at) = (0, from);
        loop {
            if let Some(leaf) = at.as_leaf() {
                limit = leaves.visit::<L>(leaf, slabs, limit)?;
            } else if top > STACK - 8 {
                let stack = &mut Stack::default();
                limit = traverse_out_of_line(Traversal { tree, slabs, leaves, limit, from: at, stack })?;
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
                // A box entered exactly at the limit may hold an equally near primitive of a lower index.
                if next.enter() <= limit {
                    break next.child();
                }
            };
        }
    }
}

/// A child in the lower half and its entry distance in the upper half, so that comparing integers compares distances.
/// Distances are never negative, so their bits are ordered. Only -0 counts as far, which changes the order of visits
/// and nothing else.
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

    /// The nearer and the farther of two, without a branch, which the processor could not predict.
    #[inline(always)]
    fn sorted(self, other: Self) -> (Self, Self) {
        (Self(self.0.min(other.0)), Self(self.0.max(other.0)))
    }
}

/// Capacity of the stack. Where a deeper tree needs more, the subtree is traversed by recursion.
const STACK: usize = 64;

/// Memory for the postponed children of a walk, whose content before and after a walk has no meaning, and what searches
/// with it shall find out.
pub struct Stack {
    entries: [Entered; STACK],
    /// Whether they shall show which hits of meshes are isolated. Only refraction needs to know.
    pub isolates: bool,
}

impl Default for Stack {
    fn default() -> Self {
        Self { entries: [Entered(0); STACK], isolates: false }
    }
}

/// Inserts a child among those between `bottom` and `top`. The nearest is on top.
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
fn traverse_out_of_line<V: LeafVisitor>(walk: Traversal<'_, V>) -> Option<f32> {
    dispatch_narrow(walk)
}
