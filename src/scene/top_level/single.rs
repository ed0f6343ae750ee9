//! Searches along single rays.

use super::bvh::Bvh;
use super::closest::BestHit;
use super::occlusion::{TransmissiveFlags, is_transmissive};
use crate::base::lanes::{Level, SimdKernel, dispatch_narrow};
use crate::geometry::bvh::{LeafVisitor, Slabs, Stack, TraversalRay};
use crate::geometry::shape::{CoincidenceRange, PreparedRay, RayInterval};
use crate::scene::{Geometry, Hit};

#[warn(missing_docs)]
impl Bvh {
    /// The closest hit along a ray. Among equally near ones, the first primitive in the file wins.
    pub fn intersect_one(&self, geometry: &Geometry, ray: &TraversalRay) -> Option<Hit> {
        self.intersect_within(geometry, ray, RayInterval::up_to(f64::INFINITY))
    }

    /// Whether a ray hits anything before `t_max`.
    pub fn occludes_one(&self, geometry: &Geometry, ray: &TraversalRay, t_max: f64) -> bool {
        dispatch_narrow(Occluded { bvh: self, geometry, ray, within: RayInterval::up_to(t_max) })
    }

    /// The closest hit along a ray within bounds.
    pub fn intersect_within(
        &self,
        geometry: &Geometry,
        ray: &TraversalRay,
        within: RayInterval<f64>,
    ) -> Option<Hit> {
        dispatch_narrow(Closest { bvh: self, geometry, ray, within })
    }

    /// The closest hit among `found` and the tree. The second stack is for the trees of shapes.
    #[inline(always)]
    pub(super) fn intersect_on<L: Level>(
        &self,
        geometry: &Geometry,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        found: Option<Hit>,
        (stack, parts): (&mut Stack, &mut Stack),
    ) -> Option<Hit> {
        L::call(ClosestOn { bvh: self, geometry, ray, within, found, stack, parts })
    }

    /// Whether a primitive in the tree blocks a ray, and whether a transmissive one dims it.
    #[inline(always)]
    pub(super) fn occlusion_on<L: Level>(
        &self,
        geometry: &Geometry,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        transmissive: Option<TransmissiveFlags>,
        (stack, parts): (&mut Stack, &mut Stack),
    ) -> [bool; 2] {
        L::call(OccludedOn { bvh: self, geometry, ray, within, transmissive, stack, parts })
    }

    /// The range of t within which hits along a ray may coincide.
    #[inline(always)]
    pub fn coincidence_range(&self, ray: &TraversalRay) -> CoincidenceRange<f64> {
        PreparedRay::<f64>::splat(ray).coincidence_range(self.reach)
    }

    /// Passes every hit of every primitive along a ray within bounds to `take`, in no particular order.
    pub fn each_hit(
        &self,
        geometry: &Geometry,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        take: &mut dyn FnMut(Hit),
    ) {
        dispatch_narrow(Each { bvh: self, geometry, ray, within, take });
    }
}

struct ClosestOn<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    ray: &'a TraversalRay,
    within: RayInterval<f64>,
    found: Option<Hit>,
    stack: &'a mut Stack,
    parts: &'a mut Stack,
}

impl SimdKernel for ClosestOn<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<L: Level>(self) -> Option<Hit> {
        let Self { bvh, geometry, ray, within, found, stack, parts } = self;
        let mut nearest = ClosestHit::new(bvh, geometry, ray, within, (found, Some(parts)));
        bvh.tree.walk_on::<L>(ray, [within.min, nearest.limit()], &mut nearest, stack);
        nearest.found.hit
    }
}

struct OccludedOn<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    ray: &'a TraversalRay,
    within: RayInterval<f64>,
    transmissive: Option<TransmissiveFlags<'a>>,
    stack: &'a mut Stack,
    parts: &'a mut Stack,
}

impl SimdKernel for OccludedOn<'_> {
    type Output = [bool; 2];

    #[inline(always)]
    fn run<L: Level>(self) -> [bool; 2] {
        let Self { bvh, geometry, ray, within, transmissive, stack, parts } = self;
        let (blocked, dimmed, parts) = (false, false, Some(parts));
        let mut any = AnyHit { bvh, geometry, ray, within, transmissive, blocked, dimmed, parts };
        bvh.tree.walk_on::<L>(ray, [within.min, within.max], &mut any, stack);
        [any.blocked, any.dimmed]
    }
}

struct Closest<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    ray: &'a TraversalRay,
    within: RayInterval<f64>,
}

impl SimdKernel for Closest<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<L: Level>(self) -> Option<Hit> {
        let Self { bvh, geometry, ray, within } = self;
        let (mut stack, mut parts) = (Stack::default(), Stack::default());
        let mut direct = ClosestHit::new(bvh, geometry, ray, within, (None, Some(&mut parts)));
        direct.test::<L>(&bvh.direct);
        direct.test::<L>(&bvh.meshes);
        let found = direct.found.hit;
        bvh.intersect_on::<L>(geometry, ray, within, found, (&mut stack, &mut parts))
    }
}

struct Occluded<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    ray: &'a TraversalRay,
    within: RayInterval<f64>,
}

impl SimdKernel for Occluded<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(self) -> bool {
        let Self { bvh, geometry, ray, within } = self;
        let (mut stack, mut parts) = (Stack::default(), Stack::default());
        let outside = bvh.direct.iter().chain(&bvh.meshes);
        for primitive in outside.map(|index| &geometry.primitives[*index as usize]) {
            if primitive.occludes_on::<L>(ray, within, Some(&mut parts)) {
                return true;
            }
        }
        let [blocked, _] = bvh.occlusion_on::<L>(geometry, ray, within, None, (&mut stack, &mut parts));
        blocked
    }
}

/// The search for the closest hit along a ray.
pub(super) struct ClosestHit<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    ray: &'a TraversalRay,
    pub within: RayInterval<f64>,
    pub found: BestHit,
    /// For the trees of shapes. Without it, each search creates its own.
    parts: Option<&'a mut Stack>,
}

impl<'a> ClosestHit<'a> {
    #[inline(always)]
    pub fn new(
        bvh: &'a Bvh,
        geometry: &'a Geometry,
        ray: &'a TraversalRay,
        within: RayInterval<f64>,
        (hit, parts): (Option<Hit>, Option<&'a mut Stack>),
    ) -> Self {
        Self {
            bvh,
            geometry,
            ray,
            within,
            found: BestHit { hit, coincidence_range: bvh.coincidence_range(ray) },
            parts,
        }
    }

    #[inline(always)]
    pub fn limit(&self) -> f64 {
        self.found.limit(self.within.max)
    }

    /// Tests the primitives of these indices.
    #[inline(always)]
    fn test<L: Level>(&mut self, indices: &[u32]) {
        L::call(Test { leaves: self, indices });
    }
}

impl LeafVisitor for ClosestHit<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, _: f32) -> Option<f32> {
        self.test::<L>(self.bvh.leaves.leaf(leaf));
        Some(slabs.limit(self.limit()))
    }
}

/// The search for anything that blocks or dims a ray within bounds.
pub(super) struct AnyHit<'a> {
    pub bvh: &'a Bvh,
    pub geometry: &'a Geometry,
    pub ray: &'a TraversalRay,
    pub within: RayInterval<f64>,
    pub transmissive: Option<TransmissiveFlags<'a>>,
    pub blocked: bool,
    pub dimmed: bool,
    /// For the trees of shapes. Without it, each search creates its own.
    pub parts: Option<&'a mut Stack>,
}

impl AnyHit<'_> {
    /// Tests the primitives of these indices until one blocks the ray.
    #[inline(always)]
    fn test<L: Level>(&mut self, indices: &[u32]) {
        L::call(Test { leaves: self, indices });
    }
}

/// Tests of primitives along a ray.
struct Test<'a, V> {
    leaves: &'a mut V,
    indices: &'a [u32],
}

impl SimdKernel for Test<'_, ClosestHit<'_>> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { leaves: nearest, indices } = self;
        for &index in indices {
            let within = RayInterval { min: nearest.within.min, max: nearest.limit() };
            let primitive = &nearest.geometry.primitives[index as usize];
            if let Some(at) = primitive.intersect_on::<L>(nearest.ray, within, nearest.parts.as_deref_mut()) {
                nearest.found.consider(at, index);
            }
        }
    }
}

impl SimdKernel for Test<'_, AnyHit<'_>> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { leaves: any, indices } = self;
        for &index in indices {
            let passes = is_transmissive(any.transmissive, index);
            if passes && any.dimmed {
                continue;
            }
            let primitive = &any.geometry.primitives[index as usize];
            if primitive.occludes_on::<L>(any.ray, any.within, any.parts.as_deref_mut()) {
                match passes {
                    true => any.dimmed = true,
                    false => return any.blocked = true,
                }
            }
        }
    }
}

impl LeafVisitor for AnyHit<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        self.test::<L>(self.bvh.leaves.leaf(leaf));
        (!self.blocked).then_some(limit)
    }
}

struct Each<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    ray: &'a TraversalRay,
    within: RayInterval<f64>,
    take: &'a mut dyn FnMut(Hit),
}

impl Each<'_> {
    #[inline(never)]
    fn test(&mut self, index: u32) {
        let Self { geometry, ray, within, take, .. } = self;
        geometry.primitives[index as usize].each_crossing(ray, *within, &mut |at| {
            take(Hit { at, primitive: index });
        });
    }
}

impl LeafVisitor for Each<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        for &index in self.bvh.leaves.leaf(leaf) {
            self.test(index);
        }
        Some(limit)
    }
}

impl SimdKernel for Each<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(mut self) {
        let (bvh, ray, within) = (self.bvh, self.ray, self.within);
        for &index in bvh.direct.iter().chain(&bvh.meshes) {
            self.test(index);
        }
        bvh.tree.walk_on::<L>(ray, [within.min, within.max], &mut self, &mut Stack::default());
    }
}
