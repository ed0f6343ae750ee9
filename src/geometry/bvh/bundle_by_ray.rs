//! Traversal along a bundle of rays that go different ways: each ray is tested with all children of a node at once.

use super::bundle::{BundleStack, BundleVisitor, Place, STACK, Waiting, put};
use super::bundle_rows::Rows;
use super::bundle_slabs::BundleSlabs;
use super::tree::{Child, Tree};
use crate::base::lanes::Level;

impl Tree {
    /// The walk of rays that go different ways, from a child on.
    #[inline(always)]
    pub(super) fn walk_by_ray<L: Level>(
        &self,
        from: Child,
        (slabs, rows): (&BundleSlabs<L>, &Rows),
        mut rays: u32,
        leaves: &mut impl BundleVisitor<L>,
        BundleStack { waiting: stack, work, .. }: &mut BundleStack,
    ) {
        let (mut top, mut at) = (0, from);
        loop {
            if let Some(leaf) = at.as_leaf() {
                leaves.visit(leaf, rays);
            } else {
                work.add(rays);
                let (node, bottom) = (&self.nodes[at.0 as usize], top);
                let mut met = rows.test(node, rays, leaves.limit());
                while met.children != 0 {
                    let slot = met.children.trailing_zeros() as usize & 7;
                    met.children &= met.children - 1;
                    let (enter, rays) = (met.enter[slot], met.rays(slot));
                    if top == STACK {
                        self.walk_below_bundle(node.children[slot], slabs, rays, leaves);
                        continue;
                    }
                    let place = Place::new(at, slot);
                    put(stack, bottom, top, Waiting { enter, least: 0.0, place, rays });
                    top += 1;
                }
                if top > bottom {
                    top -= 1;
                    let (node, slot) = stack[top % STACK].place.of(self);
                    (at, rays) = (node.children[slot], stack[top % STACK].rays);
                    continue;
                }
            }
            // Since a child was postponed, searches of its rays may have ended before it.
            loop {
                let Some(next) = top.checked_sub(1) else { return };
                top = next;
                let Waiting { place, rays: met, .. } = stack[top % STACK];
                let (node, slot) = place.of(self);
                rays = met & slabs.test(node, slot, leaves.limit()).0;
                if rays != 0 {
                    at = node.children[slot];
                    break;
                }
            }
        }
    }
}
