//! Traversal along a bundle of eight rays, which pays if they go the same way.

use super::Slabs;
use super::bundle_slabs::BundleSlabs;
use super::traversal::{LeafVisitor, Stack, Traversal};
use super::tree::{Child, Tree};
use crate::base::lanes::{LaneKernel, Level, Row};

/// Visits the leaves of a tree that a bundle of rays may hit.
pub trait BundleVisitor<L: Level> {
    /// Whether single rays may leave the bundle. If not, their data need not be stored, and a bundle starts sooner.
    const ALONE: bool;

    /// Tests the primitives of a leaf for the rays whose bits are set. Implementations are `#[inline(always)]`.
    fn visit(&mut self, leaf: u32, rays: u32);

    /// The search limit of each ray, in the filter's units; below 0 for rays that have ended.
    fn limit(&self) -> L::F32;

    /// Continues the search of one ray on its own with [`Tree::walk_below`].
    fn continue_alone(&mut self, ray: usize, below: NodeRef);
}

/// A reference to a node of a tree, for [`Tree::walk_below`].
#[derive(Clone, Copy, Debug)]
pub struct NodeRef(Child);

/// Up to this number of rays, each continues on its own.
const FEW: u32 = 1;

/// A postponed child: where its first ray enters it, a lower bound of that for all rays, the child, and the bits of
/// its rays.
type Waiting = (f32, f32, Child, u32);

/// Capacity of the stack. Where a deeper tree needs more, the subtree is traversed by recursion.
const STACK: usize = 64;

/// Memory for the postponed children of a walk, whose content before and after a walk has no meaning, and the work of
/// the walks since it was last cleared.
pub struct BundleStack {
    waiting: [Waiting; STACK],
    pub work: BundleWork,
}

/// The nodes that bundles have visited, and the rays of the bundles there, summed over the nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct BundleWork {
    pub nodes: u32,
    pub rays: u32,
}

impl Default for BundleStack {
    fn default() -> Self {
        Self { waiting: [(0.0, 0.0, Child::NONE, 0); STACK], work: BundleWork::default() }
    }
}

impl Tree {
    /// Visits every leaf that the rays may hit.
    #[inline(always)]
    pub fn walk_bundle<L: Level>(
        &self,
        slabs: &BundleSlabs<L>,
        rays: u32,
        leaves: &mut impl BundleVisitor<L>,
        stack: &mut BundleStack,
    ) {
        if self.root != Child::NONE {
            self.walk_bundle_from(self.root, slabs, rays, leaves, stack);
        }
    }

    #[inline(always)]
    fn walk_bundle_from<L: Level, T: BundleVisitor<L>>(
        &self,
        from: Child,
        slabs: &BundleSlabs<L>,
        mut rays: u32,
        leaves: &mut T,
        BundleStack { waiting: stack, work }: &mut BundleStack,
    ) {
        let (mut top, mut at) = (0, from);
        let few = if T::ALONE { FEW } else { 0 };
        let mut farthest = slabs.farthest(leaves.limit());
        loop {
            if let Some(leaf) = at.as_leaf() {
                leaves.visit(leaf, rays);
                farthest = slabs.farthest(leaves.limit());
            } else if rays.count_ones() <= few {
                while rays != 0 {
                    leaves.continue_alone(rays.trailing_zeros() as usize & 7, NodeRef(at));
                    rays &= rays - 1;
                }
                farthest = slabs.farthest(leaves.limit());
            } else {
                work.nodes = work.nodes.wrapping_add(1);
                work.rays = work.rays.wrapping_add(rays.count_ones());
                let (node, limit, bottom) = (&self.nodes[at.0 as usize], leaves.limit(), top);
                let (mut candidates, mut least) = (0xff, [0.0; 8]);
                if let Some(hull) = &slabs.hull {
                    (candidates, least) = hull.test(node, farthest);
                }
                while candidates != 0 {
                    let slot = candidates.trailing_zeros() as usize & 7;
                    candidates &= candidates - 1;
                    let child = node.children[slot];
                    if child == Child::NONE {
                        continue;
                    }
                    let (met, enter) = slabs.test(node, slot, limit);
                    let met = met & rays;
                    if met == 0 {
                        continue;
                    }
                    if top == STACK {
                        L::call_with(Below { tree: self, from: child, slabs, rays: met, leaves });
                        continue;
                    }
                    let first = enter.to_array()[met.trailing_zeros() as usize & 7];
                    let waiting = (first, least[slot], child, met);
                    let mut place = top;
                    while place > bottom && stack[place - 1].0 < waiting.0 {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = waiting;
                    top += 1;
                }
            }
            // Skips children that the hull enters beyond all limits.
            loop {
                let Some(next) = top.checked_sub(1) else { return };
                top = next;
                let (_, least, child, met) = stack[top];
                if least <= farthest {
                    (at, rays) = (child, met);
                    break;
                }
            }
        }
    }

    /// Traverses the subtree below a node along a single ray up to `limit`. Returns the remaining limit, or none if a
    /// leaf ended the walk.
    #[inline(always)]
    pub fn walk_below<L: Level>(
        &self,
        below: NodeRef,
        slabs: &Slabs,
        limit: f32,
        leaves: &mut impl LeafVisitor,
    ) -> Option<f32> {
        L::Narrow::call(Traversal {
            tree: self,
            slabs,
            leaves,
            limit,
            from: below.0,
            stack: &mut Stack::default(),
        })
    }
}

/// A walk from another child on, out of line.
struct Below<'a, L: Level, T> {
    tree: &'a Tree,
    from: Child,
    slabs: &'a BundleSlabs<L>,
    rays: u32,
    leaves: &'a mut T,
}

impl<L: Level, T: BundleVisitor<L>> LaneKernel<L> for Below<'_, L, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { tree, from, slabs, rays, leaves } = self;
        tree.walk_bundle_from(from, slabs, rays, leaves, &mut BundleStack::default());
    }
}
