//! Searches a mesh along a single ray.

use super::Mesh;
use crate::base::lanes::{Level, Row, SimdKernel};
use crate::geometry::bvh::{LeafVisitor, Slabs, Stack, TraversalRay, Tree};
use crate::geometry::mesh::ShearedRay;
use crate::geometry::shape::nearest_part::NearestPart;
use crate::geometry::shape::part_search::PartSearch;
use crate::geometry::shape::triangle::{TriangleLanes, covers};
use crate::geometry::shape::{PreparedRay, RayInterval, ShapeHit};

impl Mesh {
    /// Passes all hits within bounds to `take`, in no particular order.
    pub fn each(&self, ray: &TraversalRay, within: RayInterval<f64>, take: &mut dyn FnMut(ShapeHit)) {
        let mut all = EveryTriangle { mesh: self, ray: PreparedRay::splat(ray), within, take };
        self.mesh.tree().walk(ray, within.max, &mut all);
    }

    /// [`Geometric::intersect_one`](crate::geometry::shape::Geometric::intersect_one) within a kernel that already runs on a level.
    #[inline(always)]
    pub fn intersect_on<L: Level>(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        stack: &mut Stack,
    ) -> Option<ShapeHit> {
        ClosestTriangle::new(self, ray, within).search_on::<L>(stack)
    }

    /// [`Geometric::occludes_one`](crate::geometry::shape::Geometric::occludes_one) within a kernel that already runs on a level.
    #[inline(always)]
    pub fn occludes_on<L: Level>(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        stack: &mut Stack,
    ) -> bool {
        AnyTriangle::new(self, ray, within).search_on::<L>(stack)
    }
}

/// The search for the closest triangle. Certain hits of the filter are not tested again; only their t is computed.
pub(super) struct ClosestTriangle<'a> {
    mesh: &'a Mesh,
    ray: &'a TraversalRay,
    /// Set at the first leaf.
    sheared: Option<ShearedRay>,
    pub nearest: NearestPart,
}

impl<'a> ClosestTriangle<'a> {
    #[inline(always)]
    pub fn new(mesh: &'a Mesh, ray: &'a TraversalRay, within: RayInterval<f64>) -> Self {
        let range = PreparedRay::splat(ray).coincidence_range(mesh.mesh.tree().space().reach());
        Self { mesh, ray, sheared: None, nearest: NearestPart::new(within, range) }
    }
}

/// The search for any triangle.
pub(super) struct AnyTriangle<'a> {
    mesh: &'a Mesh,
    ray: &'a TraversalRay,
    sheared: Option<ShearedRay>,
    within: RayInterval<f64>,
    pub found: bool,
}

impl<'a> AnyTriangle<'a> {
    #[inline(always)]
    pub fn new(mesh: &'a Mesh, ray: &'a TraversalRay, within: RayInterval<f64>) -> Self {
        Self { mesh, ray, sheared: None, within, found: false }
    }
}

/// The search for all triangles within bounds.
struct EveryTriangle<'a> {
    mesh: &'a Mesh,
    ray: PreparedRay<f64>,
    within: RayInterval<f64>,
    take: &'a mut dyn FnMut(ShapeHit),
}

impl<'a> PartSearch<'a> for ClosestTriangle<'a> {
    type Found = Option<ShapeHit>;

    #[inline(always)]
    fn tree(&self) -> &'a Tree {
        self.mesh.mesh.tree()
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

impl<'a> PartSearch<'a> for AnyTriangle<'a> {
    type Found = bool;

    #[inline(always)]
    fn tree(&self) -> &'a Tree {
        self.mesh.mesh.tree()
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
    slabs: &'a Slabs,
    limit: f32,
}

impl LeafVisitor for ClosestTriangle<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, leaf: u32) {
        L::prefetch(self.mesh.mesh.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32> {
        L::call(Visit { search: self, leaf, slabs, limit })
    }
}

impl SimdKernel for Visit<'_, ClosestTriangle<'_>> {
    type Output = Option<f32>;

    #[inline(always)]
    fn run<L: Level>(self) -> Option<f32> {
        let Self { search, leaf, slabs, mut limit } = self;
        let ClosestTriangle { mesh: Mesh { mesh, .. }, ray, nearest: NearestPart { within, .. }, .. } =
            *search;
        let packet = &mesh.packets()[leaf as usize];
        let sheared = search.sheared.get_or_insert_with(|| ShearedRay::new(ray, slabs));
        let classes = sheared.classify(&sheared.test_edges::<L::F32>(packet, limit), limit);
        let mut candidates = classes.hit | classes.unsure;
        if candidates == 0 {
            return Some(limit);
        }
        let (near, prepared) = (classes.near.to_array(), PreparedRay::<f64>::splat(ray));
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize & 7;
            let sure = classes.hit >> lane & 1 == 1;
            candidates &= candidates - 1;
            if sure && near[lane] > limit {
                continue;
            }
            let triangle = TriangleLanes::splat(mesh.packed_corners(packet, lane));
            let sheared = triangle.sheared(&prepared);
            if !sure && !covers(&sheared) {
                continue;
            }
            let Some(at) = triangle.crossing(&prepared, &sheared, true, within).one() else { continue };
            search.nearest.consider(at.t, packet.part(lane));
            limit = slabs.limit(search.nearest.limit());
        }
        Some(limit)
    }
}

impl LeafVisitor for AnyTriangle<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, leaf: u32) {
        L::prefetch(self.mesh.mesh.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32> {
        self.found = L::call(Visit { search: self, leaf, slabs, limit });
        (!self.found).then_some(limit)
    }
}

impl SimdKernel for Visit<'_, AnyTriangle<'_>> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(self) -> bool {
        let Self { search, leaf, slabs, limit } = self;
        let AnyTriangle { mesh: Mesh { mesh, .. }, ray, within, .. } = *search;
        let packet = &mesh.packets()[leaf as usize];
        let sheared = search.sheared.get_or_insert_with(|| ShearedRay::new(ray, slabs));
        let edge_test = sheared.test_edges::<L::F32>(packet, limit);
        // The filter's certain results assume t = 0 as the start.
        let from_start = within.min == 0.0;
        if from_start && sheared.within_whole(&edge_test, limit) != 0 {
            return true;
        }
        let classes = sheared.classify(&edge_test, limit);
        let mut candidates = classes.hit | classes.unsure;
        if candidates == 0 {
            return false;
        }
        if from_start && sheared.within(&classes, limit) != 0 {
            return true;
        }
        let prepared = PreparedRay::<f64>::splat(ray);
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize & 7;
            candidates &= candidates - 1;
            let triangle = TriangleLanes::splat(mesh.packed_corners(packet, lane));
            let sheared = triangle.sheared(&prepared);
            let covered = classes.hit >> lane & 1 == 1 || covers(&sheared);
            if triangle.crossing(&prepared, &sheared, covered, within).is_hit() {
                return true;
            }
        }
        false
    }
}

impl LeafVisitor for EveryTriangle<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        let Self { mesh: Mesh { mesh, .. }, ray, within, take } = self;
        let packet = &mesh.packets()[leaf as usize];
        for lane in 0..packet.count() {
            let triangle = TriangleLanes::splat(mesh.packed_corners(packet, lane));
            if let Some(at) = triangle.intersect(ray, *within).one() {
                take(ShapeHit::of_part(at.t, packet.part(lane)));
            }
        }
        Some(limit)
    }
}
