//! Searches for anything that blocks the rays of a bundle.

use super::bvh::Bvh;
use super::occlusion::{Occlusion, TransmissiveFlags, is_transmissive};
use super::single::AnyHit;
use crate::base::lanes::{LaneKernel, Level, Mask, Row, Select};
use crate::geometry::bvh::{BundleSlabs, BundleStack, BundleVisitor, Stack, TraversalRay};
use crate::geometry::shape::{PreparedRay, RayInterval, store_lanes};
use crate::scene::{Geometry, Primitive};

/// The search for anything that blocks eight shadow rays.
pub struct LaneAnyHit<'a, L: Level> {
    ray: &'a PreparedRay<L::F64>,
    within: RayInterval<L::F64>,
    transmissive: Option<TransmissiveFlags<'a>>,
    /// Rays whose search has not ended.
    open: L::Mask,
    blocked: L::Mask,
    dimmed: L::Mask,
}

impl<'a, L: Level> LaneAnyHit<'a, L> {
    #[inline(always)]
    pub fn new(
        ray: &'a PreparedRay<L::F64>,
        within: RayInterval<L::F64>,
        wanted: L::Mask,
        transmissive: Option<TransmissiveFlags<'a>>,
    ) -> Self {
        let none = L::Mask::splat(false);
        Self { ray, within, transmissive, open: wanted, blocked: none, dimmed: none }
    }

    #[inline(always)]
    pub fn open(&self) -> L::Mask {
        self.open
    }

    /// Tests the primitives of these indices for some of the rays. Rays that go different ways come with a stack.
    #[inline(always)]
    pub fn test(&mut self, geometry: &Geometry, indices: &[u32], rays: L::Mask, apart: Option<&mut Stack>) {
        if !indices.is_empty() {
            L::call_with(Test { shadow: self, geometry, indices, rays, apart });
        }
    }

    #[inline(always)]
    fn test_one(&mut self, rays: L::Mask, index: u32, primitive: &Primitive, apart: Option<&mut Stack>) {
        let passes = is_transmissive(self.transmissive, index);
        let rays = if passes { rays & !self.dimmed } else { rays };
        if !rays.any() {
            return;
        }
        let max = L::F64::select(rays, self.within.max, L::F64::splat(-1.0));
        let within = RayInterval { min: self.within.min, max };
        let met = primitive.occludes_with(self.ray, within, apart);
        if passes {
            self.dimmed = self.dimmed | met;
        } else {
            self.blocked = self.blocked | met;
            self.open = self.open & !met;
        }
    }

    #[inline(always)]
    pub fn occlusion(&self) -> Occlusion<L::Mask> {
        Occlusion { blocked: self.blocked, dimmed: self.dimmed & !self.blocked }
    }

    #[inline(always)]
    pub fn bounds(&self) -> [[f64; 8]; 2] {
        [store_lanes(self.within.min), store_lanes(self.within.max)]
    }

    /// A bit for each ray that is blocked, and for each that is dimmed.
    #[inline(always)]
    pub fn bits(&self) -> [u32; 2] {
        [self.blocked.bits(), self.dimmed.bits()]
    }
}

struct Test<'a, 'r, L: Level> {
    shadow: &'a mut LaneAnyHit<'r, L>,
    geometry: &'a Geometry,
    indices: &'a [u32],
    rays: L::Mask,
    apart: Option<&'a mut Stack>,
}

impl<L: Level> LaneKernel<L> for Test<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { shadow, geometry, indices, rays, mut apart } = self;
        for &index in indices {
            let primitive = &geometry.primitives[index as usize];
            shadow.test_one(rays & shadow.open, index, primitive, apart.as_deref_mut());
        }
    }
}

impl Bvh {
    /// Searches the tree for primitives that block eight rays. Those that go different ways come with a stack.
    #[inline(always)]
    pub(super) fn occlusion_in_bundle<L: Level>(
        &self,
        geometry: &Geometry,
        shadow: &mut LaneAnyHit<L>,
        (stack, apart): (&mut BundleStack, Option<&mut Stack>),
    ) {
        L::call_with(Occluded::<L> { bvh: self, geometry, shadow, stack, apart });
    }
}

/// The search for occlusion.
struct Occluded<'a, 'r, L: Level> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    shadow: &'a mut LaneAnyHit<'r, L>,
    stack: &'a mut BundleStack,
    apart: Option<&'a mut Stack>,
}

impl<L: Level> LaneKernel<L> for Occluded<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { bvh, geometry, shadow, stack, apart } = self;
        let ray = &shadow.ray.ray;
        let wanted = shadow.open.bits();
        let (slabs, near, afar) = BundleSlabs::<L>::new(&bvh.tree, ray, shadow.within.min, wanted);
        let limit = slabs.limit(L::F64::select(shadow.open, shadow.within.max, L::F64::splat(-1.0)));
        let mut walk = AnyHitWalk { bvh, geometry, shadow, limit, apart };
        if near != 0 {
            bvh.tree.walk_bundle(&slabs, near, &mut walk, stack);
        }
        for lane in crate::base::lanes::lanes(afar) {
            walk.alone(lane);
        }
    }
}

struct AnyHitWalk<'a, 'r, L: Level> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    shadow: &'a mut LaneAnyHit<'r, L>,
    limit: L::F32,
    apart: Option<&'a mut Stack>,
}

impl<L: Level> AnyHitWalk<'_, '_, L> {
    /// Searches along one ray.
    #[inline(always)]
    fn alone(&mut self, ray: usize) {
        let Self { bvh, geometry, .. } = *self;
        let single = &TraversalRay::new(self.shadow.ray.ray.lane(ray));
        let [min, max] = self.shadow.bounds();
        let within = RayInterval { min: min[ray], max: max[ray] };
        let dimmed = self.shadow.dimmed.bits() >> ray & 1 == 1;
        let transmissive = self.shadow.transmissive;
        let parts = self.apart.as_deref_mut();
        let mut any =
            AnyHit { bvh, geometry, ray: single, within, transmissive, blocked: false, dimmed, parts };
        bvh.tree.walk(single, [any.within.min, any.within.max], &mut any);
        let bit = 1 << ray;
        if any.dimmed {
            self.shadow.dimmed = self.shadow.dimmed | L::Mask::from_bits(bit);
        }
        if any.blocked {
            self.shadow.blocked = self.shadow.blocked | L::Mask::from_bits(bit);
            self.close();
        }
    }

    /// Ends the search of blocked rays.
    #[inline(always)]
    fn close(&mut self) {
        self.shadow.open = self.shadow.open & !self.shadow.blocked;
        self.limit = L::F32::select(self.shadow.blocked, L::F32::splat(-1.0), self.limit);
    }
}

impl<L: Level> BundleVisitor<L> for AnyHitWalk<'_, '_, L> {
    const IN_ORDER: bool = false;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        let (primitives, rays) = (self.bvh.leaves.leaf(leaf), L::Mask::from_bits(rays));
        self.shadow.test(self.geometry, primitives, rays, self.apart.as_deref_mut());
        self.close();
    }

    #[inline(always)]
    fn limit(&self) -> L::F32 {
        self.limit
    }
}
