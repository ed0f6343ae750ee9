//! Searches particles along a single ray, eight spheres at a time.

use super::Particles;
use crate::base::lanes::{Level, Mask, Row, SimdKernel, lanes};
use crate::geometry::bvh::{LeafVisitor, Slabs, Stack, TraversalRay, Tree};
use crate::geometry::shape::ParticleSet;
use crate::geometry::shape::nearest_part::NearestPart;
use crate::geometry::shape::part_search::PartSearch;
use crate::geometry::shape::{Geometric, PreparedRay, RayInterval, ShapeHit};

impl Particles {
    /// The closest sphere within bounds; of equally near ones, the one with the lowest index.
    #[inline(always)]
    pub fn intersect_on<L: Level>(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        stack: &mut Stack,
    ) -> Option<ShapeHit> {
        let set = &*self.0;
        let range = PreparedRay::splat(ray).coincidence_range(set.tree().space().reach());
        Closest { set, ray, nearest: NearestPart::new(within, range) }.search_on::<L>(stack)
    }

    /// Whether there is a sphere within bounds.
    #[inline(always)]
    pub fn occludes_on<L: Level>(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        stack: &mut Stack,
    ) -> bool {
        Any { set: &self.0, ray, within, found: false }.search_on::<L>(stack)
    }

    /// Passes all hits within bounds to `take`, in no particular order.
    pub fn each(&self, ray: &TraversalRay, within: RayInterval<f64>, take: &mut dyn FnMut(ShapeHit)) {
        let prepared = PreparedRay::splat(ray);
        self.0.tree().walk(ray, within.max, &mut Every { set: &self.0, ray: prepared, within, take });
    }
}

/// The search for the closest sphere.
struct Closest<'a> {
    set: &'a ParticleSet,
    ray: &'a TraversalRay,
    nearest: NearestPart,
}

/// The search for any sphere.
struct Any<'a> {
    set: &'a ParticleSet,
    ray: &'a TraversalRay,
    within: RayInterval<f64>,
    found: bool,
}

/// The search for all hits.
struct Every<'a> {
    set: &'a ParticleSet,
    ray: PreparedRay<f64>,
    within: RayInterval<f64>,
    take: &'a mut dyn FnMut(ShapeHit),
}

impl<'a> PartSearch<'a> for Closest<'a> {
    type Found = Option<ShapeHit>;

    #[inline(always)]
    fn tree(&self) -> &'a Tree {
        self.set.tree()
    }

    #[inline(always)]
    fn ray(&self) -> &'a TraversalRay {
        self.ray
    }

    #[inline(always)]
    fn t_max(&self) -> f64 {
        self.nearest.within.max
    }

    #[inline(always)]
    fn found(self) -> Option<ShapeHit> {
        self.nearest.hit
    }
}

impl<'a> PartSearch<'a> for Any<'a> {
    type Found = bool;

    #[inline(always)]
    fn tree(&self) -> &'a Tree {
        self.set.tree()
    }

    #[inline(always)]
    fn ray(&self) -> &'a TraversalRay {
        self.ray
    }

    #[inline(always)]
    fn t_max(&self) -> f64 {
        self.within.max
    }

    #[inline(always)]
    fn found(self) -> bool {
        self.found
    }
}

/// The visit of a leaf.
struct Visit<'a, S> {
    search: &'a mut S,
    leaf: u32,
}

impl LeafVisitor for Closest<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, leaf: u32) {
        L::prefetch(self.set.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, _: f32) -> Option<f32> {
        L::call(Visit { search: self, leaf });
        Some(slabs.limit(self.nearest.limit()))
    }
}

impl SimdKernel for Visit<'_, Closest<'_>> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { search: Closest { set, ray, nearest }, leaf } = self;
        let packet = &set.packets()[leaf as usize];
        let row = L::F64::splat;
        let within = RayInterval { min: row(nearest.within.min), max: row(nearest.limit()) };
        let at = packet.lanes::<L>().intersect(&PreparedRay::splat(ray), within);
        let (hit, t) = (at.is_hit().bits(), at.t.to_array());
        for lane in lanes(hit & ((1 << packet.count()) - 1)) {
            if t[lane] < nearest.limit() {
                nearest.consider(t[lane], packet.part(lane));
            }
        }
    }
}

impl LeafVisitor for Any<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, leaf: u32) {
        L::prefetch(self.set.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        self.found = L::call(Visit { search: self, leaf });
        (!self.found).then_some(limit)
    }
}

impl SimdKernel for Visit<'_, Any<'_>> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(self) -> bool {
        let Self { search: Any { set, ray, within, .. }, leaf } = self;
        let row = L::F64::splat;
        let within = RayInterval { min: row(within.min), max: row(within.max) };
        let spheres = set.packets()[leaf as usize].lanes::<L>();
        spheres.intersect(&PreparedRay::splat(ray), within).is_hit().any()
    }
}

impl LeafVisitor for Every<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        let packet = &self.set.packets()[leaf as usize];
        for lane in 0..packet.count() {
            let (sphere, mut within) = (packet.sphere(lane), self.within);
            while let Some(at) = sphere.intersect(&self.ray, within).one() {
                (self.take)(ShapeHit::of_part(at.t, packet.part(lane)));
                within.min = at.t;
            }
        }
        Some(limit)
    }
}
