//! Searches a mesh along a bundle of eight rays, which share the nodes of the tree and the data of each triangle.

use super::Mesh;
use crate::base::lanes::{Bits, Level, Mask, Real, Row, Select, SimdKernel, lanes};
use crate::geometry::bvh::{BundleSlabs, BundleStack, BundleVisitor, NodeRef, Slabs, TraversalRay};
use crate::geometry::mesh::ShearedRays;
use crate::geometry::shape::part_search::{PartSearch, any_part_on, nearest_part_on};
use crate::geometry::shape::triangle::TriangleLanes;
use crate::geometry::shape::{CoincidenceRange, LaneHit, PreparedRay, RayInterval, ShapeHit, StoredRays};

/// The search for the closest triangles, or for any (`ANY`), along the rays whose bits are set.
pub(super) struct BundleSearch<'a, const ANY: bool> {
    pub mesh: &'a Mesh,
    pub rays: &'a StoredRays,
    pub wanted: u32,
    /// The minima and maxima of t.
    pub span: &'a [[f64; 8]; 2],
}

impl<const ANY: bool> SimdKernel for BundleSearch<'_, ANY> {
    type Output = StoredMeshHits;

    #[inline(always)]
    fn run<L: Level>(self) -> Self::Output {
        let Self { mesh, rays, wanted, span } = self;
        let (found, alone) = self.search::<L>();
        let mut found = StoredMeshHits {
            t: found.t.to_array(),
            parts: found.part.to_array(),
            coincident: found.coincident.bits(),
        };
        for ray in lanes(alone & wanted) {
            let single = TraversalRay::new(rays.one(ray));
            let within = RayInterval { min: span[0][ray], max: span[1][ray] };
            let hit = match ANY {
                true => any_part_on::<L>(mesh, &single, within, None).then_some(ShapeHit::at(0.0)),
                false => nearest_part_on::<L>(mesh, &single, within, None),
            };
            if let Some(at) = hit {
                found.set(ray, at);
            }
        }
        found
    }
}

/// Hits of eight rays with a mesh, in memory.
pub(super) struct StoredMeshHits {
    /// Infinite without a hit; for `ANY`, any finite number.
    pub t: [f64; 8],
    pub parts: [u32; 8],
    /// A bit for each hit that another one may coincide with.
    pub coincident: u32,
}

impl StoredMeshHits {
    #[inline(always)]
    fn set(&mut self, ray: usize, ShapeHit { t, part, coincident, .. }: ShapeHit) {
        (self.t[ray], self.parts[ray]) = (t, part);
        self.coincident = self.coincident & !(1 << ray) | u32::from(coincident) << ray;
    }
}

impl<const ANY: bool> BundleSearch<'_, ANY> {
    /// Returns the hits, and the rays to be searched one by one: those from far away, and those that are longest along
    /// another axis than the rest.
    #[inline(always)]
    fn search<L: Level>(&self) -> (LaneHit<L::F64>, u32) {
        let &Self { mesh, rays, wanted, span: [min, max] } = self;
        let (ray, found) = (rays.load::<L>(), LaneHit::none());
        let tree = mesh.mesh.tree();
        let (slabs, near, afar) = BundleSlabs::<L>::new(tree, &ray, L::F64::from_array(*min), wanted);
        if near == 0 {
            return (found, afar);
        }
        let prepared = PreparedRay::new(ray);
        let Some((axes, shear)) = prepared.shear(near) else { return (found, near | afar) };
        let span = RayInterval { min: L::F64::from_array(*min), max: L::F64::from_array(*max) };
        let limits = L::F64::select(L::Mask::from_bits(near), span.max, L::F64::splat(-1.0));
        let mut bundle = BundleWalk::<L, ANY> {
            mesh,
            rays,
            prepared: &prepared,
            slabs: &slabs,
            sheared: ShearedRays::new(&slabs, axes, shear),
            coincidence_range: prepared.coincidence_range(tree.space().reach()),
            span,
            limits,
            limit: slabs.limit(limits),
            found,
            alone: [None; 8],
        };
        tree.walk_bundle(&slabs, near, &mut bundle, &mut BundleStack::default());
        (bundle.found, afar)
    }
}

/// The state of eight searches.
struct BundleWalk<'a, L: Level, const ANY: bool> {
    mesh: &'a Mesh,
    rays: &'a StoredRays,
    prepared: &'a PreparedRay<L::F64>,
    slabs: &'a BundleSlabs<L>,
    sheared: ShearedRays<L>,
    coincidence_range: CoincidenceRange<L::F64>,
    span: RayInterval<L::F64>,
    /// The limits of t: slightly beyond the closest hit, to find coincident hits; below 0 when a search has ended.
    limits: L::F64,
    limit: L::F32,
    found: LaneHit<L::F64>,
    /// Rays that have left the bundle.
    alone: [Option<(TraversalRay, Slabs)>; 8],
}

impl<L: Level, const ANY: bool> BundleWalk<'_, L, ANY> {
    /// Records the hits of some rays.
    #[inline(always)]
    fn take(&mut self, rays: L::Mask, at: LaneHit<L::F64>) {
        let end = match ANY {
            true => L::F64::splat(-1.0),
            false => self.coincidence_range.end(at.t).min(self.span.max),
        };
        self.found = LaneHit::select(rays, at, self.found);
        self.limits = L::F64::select(rays, end, self.limits);
        self.limit = self.slabs.limit(self.limits);
    }
}

impl<L: Level, const ANY: bool> BundleVisitor<L> for BundleWalk<'_, L, ANY> {
    const ALONE: bool = true;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        let mesh = &self.mesh.mesh;
        let packet = &mesh.packets()[leaf as usize];
        for lane in 0..packet.count() {
            let candidates = self.sheared.classify(packet, lane, self.limit) & rays;
            if candidates == 0 {
                continue;
            }
            let triangle = TriangleLanes::<L::F64>::splat(mesh.packed_corners(packet, lane));
            let at = triangle.intersect(self.prepared, RayInterval { min: self.span.min, max: self.limits });
            let hit = at.is_hit() & L::Mask::from_bits(candidates);
            if !hit.any() {
                continue;
            }
            let (part, best) = (L::U32::splat(packet.part(lane)), &mut self.found);
            let nearer = hit & (at.t.lt(best.t) | at.t.eq(best.t) & part.lt(best.part));
            // A triangle in several leaves does not coincide with itself.
            let coincident = hit & !part.eq(best.part) & best.t.le(self.coincidence_range.end(at.t));
            best.coincident = best.coincident | coincident;
            if nearer.any() {
                self.take(nearer, LaneHit { t: at.t, part, coincident, isolated: 0 });
            }
        }
    }

    #[inline(always)]
    fn continue_alone(&mut self, ray: usize, below: NodeRef) {
        let (mesh, hit) = (self.mesh, self.found.lane(ray));
        let within = RayInterval { min: self.span.min.to_array()[ray], max: self.span.max.to_array()[ray] };
        if ANY && hit.is_some() {
            return;
        }
        let slot = &mut self.alone[ray];
        if slot.is_none() {
            let single = TraversalRay::new(self.rays.one(ray));
            *slot = Slabs::new::<L::Narrow>(mesh.mesh.tree(), &single, [within.min, within.max])
                .map(|slabs| (single, slabs));
        }
        let Some((single, slabs)) = slot else { return };
        let tree = mesh.mesh.tree();
        let found = if ANY {
            let mut search = PartSearch::any(mesh, single, within);
            tree.walk_below::<L>(below, slabs, slabs.limit(within.max), &mut search);
            search.kept.found.then_some(ShapeHit::at(0.0))
        } else {
            let mut search = PartSearch::nearest(mesh, single, within);
            search.kept.hit = hit;
            tree.walk_below::<L>(below, slabs, slabs.limit(search.kept.limit()), &mut search);
            search.kept.hit
        };
        if found != hit {
            self.take(L::Mask::from_bits(1 << ray), LaneHit::splat(found));
        }
    }

    #[inline(always)]
    fn limit(&self) -> L::F32 {
        self.limit
    }
}
