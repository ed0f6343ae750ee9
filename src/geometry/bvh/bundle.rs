//! Traversal along a bundle of eight rays.

use super::Slabs;
use super::bundle_slabs::BundleSlabs;
use super::bundle_sweep::SweepMemory;
use super::traversal::{LeafVisitor, Stack, Traversal};
use super::tree::{Child, Node, Tree};
use crate::base::lanes::{LaneKernel, Level, Row};

/// Visits the leaves of a tree that a bundle of rays may hit.
pub trait BundleVisitor<L: Level> {
    /// Whether a ray leaves the bundle where it is the only one, if all rays go the same way.
    const ALONE: bool = false;

    /// Whether a sweep (`Tree::sweep`) visits near leaves before far ones.
    const IN_ORDER: bool = true;

    /// Tests the primitives of a leaf for the rays whose bits are set. Implementations are `#[inline(always)]`.
    fn visit(&mut self, leaf: u32, rays: u32);

    /// The search limit of each ray, in the filter's units; below 0 for rays that have ended.
    fn limit(&self) -> L::F32;

    /// Continues the search of a ray that leaves the bundle with [`Tree::walk_below`].
    #[inline(always)]
    fn continue_alone(&mut self, _ray: usize, _below: NodeRef) {}
}

/// A reference to a node of a tree, for [`Tree::walk_below`].
#[derive(Clone, Copy, Debug)]
pub struct NodeRef(Child);

/// A postponed child.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    /// Where a ray enters it: the first of them, or that in the lowest lane.
    pub enter: f32,
    /// A lower bound of where any ray enters it, by the hull.
    pub least: f32,
    pub place: Place,
    /// The bits of its rays.
    pub rays: u32,
}

/// Eight times the index of a node, plus the slot of one of its children. The nodes that 32 bits cannot count take 137 GB.
#[derive(Clone, Copy)]
pub(super) struct Place(u32);

impl Place {
    #[inline(always)]
    pub fn new(node: Child, slot: usize) -> Self {
        Self(8 * node.0 + slot as u32)
    }

    #[inline(always)]
    pub fn of(self, tree: &Tree) -> (&Node, usize) {
        (&tree.nodes[self.0 as usize / 8], self.0 as usize & 7)
    }
}

/// Capacity of the stack. Where a deeper tree needs more, the subtree is traversed by recursion.
pub(super) const STACK: usize = 64;

/// Memory for the postponed children of a walk, whose content before and after a walk has no meaning, and the work of
/// the walks since it was last cleared.
pub struct BundleStack {
    pub(super) waiting: [Waiting; STACK],
    pub(super) met: SweepMemory,
    pub work: BundleWork,
}

/// The nodes that bundles have visited, and the rays of the bundles there, summed over the nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct BundleWork {
    pub nodes: u32,
    pub rays: u32,
}

impl BundleWork {
    /// Adds a node, and the number of these rays.
    #[inline(always)]
    pub(super) fn add(&mut self, rays: u32) {
        self.nodes = self.nodes.wrapping_add(1);
        self.rays = self.rays.wrapping_add(rays.count_ones());
    }
}

impl Default for BundleStack {
    fn default() -> Self {
        let none = Waiting { enter: 0.0, least: 0.0, place: Place(0), rays: 0 };
        Self { waiting: [none; STACK], met: SweepMemory::default(), work: BundleWork::default() }
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
        if self.root == Child::NONE {
            return;
        }
        if slabs.sweeps(self) && self.root.as_leaf().is_none() {
            return self.sweep(slabs, rays, leaves, stack);
        }
        self.walk_bundle_from(self.root, slabs, rays, leaves, stack);
    }

    #[inline(always)]
    fn walk_bundle_from<L: Level>(
        &self,
        from: Child,
        slabs: &BundleSlabs<L>,
        rays: u32,
        leaves: &mut impl BundleVisitor<L>,
        stack: &mut BundleStack,
    ) {
        match &slabs.rows {
            Some(rows) => self.walk_by_ray(from, (slabs, rows), rays, leaves, stack),
            None => self.walk_by_child(from, slabs, rays, leaves, stack),
        }
    }

    /// The walk of rays that go the same way: each child of a node is tested with all rays at once.
    #[inline(always)]
    fn walk_by_child<L: Level, T: BundleVisitor<L>>(
        &self,
        from: Child,
        slabs: &BundleSlabs<L>,
        mut rays: u32,
        leaves: &mut T,
        BundleStack { waiting: stack, work, .. }: &mut BundleStack,
    ) {
        let (mut top, mut at) = (0, from);
        let mut farthest = slabs.farthest(leaves.limit());
        loop {
            if let Some(leaf) = at.as_leaf() {
                leaves.visit(leaf, rays);
                farthest = slabs.farthest(leaves.limit());
            } else if T::ALONE && rays.is_power_of_two() {
                leaves.continue_alone(rays.trailing_zeros() as usize & 7, NodeRef(at));
                farthest = slabs.farthest(leaves.limit());
            } else {
                work.add(rays);
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
                    let rays = met & rays;
                    if rays == 0 {
                        continue;
                    }
                    if top == STACK {
                        self.walk_below_bundle(child, slabs, rays, leaves);
                        continue;
                    }
                    let enter = enter.to_array()[rays.trailing_zeros() as usize & 7];
                    let (place, least) = (Place::new(at, slot), least[slot]);
                    put(stack, bottom, top, Waiting { enter, least, place, rays });
                    top += 1;
                }
            }
            // Skips children that the hull enters beyond all limits.
            loop {
                let Some(next) = top.checked_sub(1) else { return };
                top = next;
                let Waiting { least, place, rays: met, .. } = stack[top];
                if least <= farthest {
                    let (node, slot) = place.of(self);
                    (at, rays) = (node.children[slot], met);
                    break;
                }
            }
        }
    }

    /// Walks a subtree out of line, with a stack of its own.
    #[inline(always)]
    pub(super) fn walk_below_bundle<L: Level>(
        &self,
        from: Child,
        slabs: &BundleSlabs<L>,
        rays: u32,
        leaves: &mut impl BundleVisitor<L>,
    ) {
        L::call_with(Below { tree: self, from, slabs, rays, leaves });
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

/// Inserts a child among those from `bottom` to `top`. The nearest is on top.
#[inline(always)]
pub(super) fn put(stack: &mut [Waiting; STACK], bottom: usize, top: usize, child: Waiting) {
    let mut place = top;
    while place > bottom && stack[(place - 1) % STACK].enter < child.enter {
        stack[place % STACK] = stack[(place - 1) % STACK];
        place -= 1;
    }
    stack[place % STACK] = child;
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
