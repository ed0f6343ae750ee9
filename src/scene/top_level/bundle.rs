//! Searches along bundles of eight rays. Each ray gets the hits that it would get on its own.

use super::bvh::Bvh;
use super::closest::LaneClosestHit;
use super::single::ClosestHit;
use crate::base::lanes::{LaneKernel, Level, Mask, Real, Row, Select};
use crate::geometry::bvh::{BundleSlabs, BundleStack, BundleVisitor, Stack, TraversalRay};
use crate::geometry::shape::{RayInterval, store_lanes};
use crate::scene::Geometry;

impl Bvh {
    /// Searches the tree for the closest hits of eight rays. Those that go different ways come with a stack.
    #[inline(always)]
    pub(super) fn intersect_in_bundle<L: Level>(
        &self,
        geometry: &Geometry,
        nearest: &mut LaneClosestHit<L::F64>,
        (stack, apart): (&mut BundleStack, Option<&mut Stack>),
    ) {
        L::call_with(Closest::<L> { bvh: self, geometry, nearest, stack, apart });
    }
}

/// The search for the closest hits.
struct Closest<'a, 'r, L: Level> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    nearest: &'a mut LaneClosestHit<'r, L::F64>,
    stack: &'a mut BundleStack,
    apart: Option<&'a mut Stack>,
}

impl<L: Level> LaneKernel<L> for Closest<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { bvh, geometry, nearest, stack, apart } = self;
        let ray = &nearest.ray.ray;
        let wanted = L::F64::splat(0.0).le(nearest.limit).bits();
        let (slabs, near, afar) = BundleSlabs::<L>::new(&bvh.tree, ray, nearest.within.min, wanted);
        let limit = slabs.limit(nearest.limit);
        let mut walk = ClosestHitWalk { bvh, geometry, slabs: &slabs, nearest, limit, apart };
        if near != 0 {
            bvh.tree.walk_bundle(&slabs, near, &mut walk, stack);
        }
        for lane in crate::base::lanes::lanes(afar) {
            walk.alone(lane);
        }
    }
}

struct ClosestHitWalk<'a, 'r, L: Level> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    slabs: &'a BundleSlabs<L>,
    nearest: &'a mut LaneClosestHit<'r, L::F64>,
    limit: L::F32,
    apart: Option<&'a mut Stack>,
}

impl<L: Level> ClosestHitWalk<'_, '_, L> {
    /// Searches along one ray.
    #[inline(always)]
    fn alone(&mut self, ray: usize) {
        let single = &TraversalRay::new(self.nearest.ray.ray.lane(ray));
        let [min, max] = self.nearest.bounds();
        let within = RayInterval { min: min[ray], max: max[ray] };
        let mut rows = self.nearest.hits.store();
        let mut one = ClosestHit::new(
            self.bvh,
            self.geometry,
            single,
            within,
            (rows.lane(ray), self.apart.as_deref_mut()),
        );
        self.bvh.tree.walk(single, [one.within.min, one.limit()], &mut one);
        let hit = one.found.hit;
        let mut limits = store_lanes(self.nearest.limit);
        limits[ray] = one.limit();
        rows.set_lane(ray, hit);
        self.nearest.hits = rows.load();
        self.nearest.limit = L::F64::load(&limits, 0);
        self.limit = self.slabs.limit(self.nearest.limit);
    }
}

impl<L: Level> BundleVisitor<L> for ClosestHitWalk<'_, '_, L> {
    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        let all = self.nearest.limit;
        // The other rays do not enter the leaf. Minima and maxima store all lanes: a load that follows the store of some
        // waits for it.
        let (rays, infinite) = (L::Mask::from_bits(rays), L::F64::splat(f64::INFINITY));
        self.nearest.limit = all.min(L::F64::select(rays, infinite, L::F64::splat(-1.0)));
        self.nearest.test(self.geometry, self.bvh.leaves.leaf(leaf), self.apart.as_deref_mut());
        self.nearest.limit = self.nearest.limit.max(L::F64::select(rays, -infinite, all));
        self.limit = self.slabs.limit(self.nearest.limit);
    }

    #[inline(always)]
    fn limit(&self) -> L::F32 {
        self.limit
    }
}
