//! The search for triangles along eight rays: they share the nodes of the tree and what has to be known of each triangle.

use super::Mesh;
use super::search::{Any, Nearest};
use crate::base::lanes::{Bits, Level, Mask, Real, Row, Select, SimdKernel, lanes};
use crate::geometry::bvh::{Branch, BundleLeaves, BundleSlabs, BundleStack, Probe, Slabs, Stack};
use crate::geometry::mesh::ShearedRays;
use crate::geometry::shape::triangle::TriangleLanes;
use crate::geometry::shape::{Crossing, LaneHit, PreparedRay, RayRows, Span, Vicinity};

/// The search for the nearest triangles, or for `ANY`, along those of eight rays whose bits are set.
pub(super) struct BundleSearch<'a, const ANY: bool> {
    pub mesh: &'a Mesh,
    pub rays: &'a RayRows,
    pub wanted: u32,
    /// Beyond which t, and before which.
    pub span: &'a [[f64; 8]; 2],
}

impl<const ANY: bool> SimdKernel for BundleSearch<'_, ANY> {
    type Output = MeshHits;

    #[inline(always)]
    fn run<L: Level>(self) -> Self::Output {
        let Self { mesh, rays, wanted, span } = self;
        let (found, alone) = self.search::<L>();
        let mut found =
            MeshHits { t: found.t.to_array(), parts: found.part.to_array(), crowded: found.crowded.bits() };
        for ray in lanes(alone & wanted) {
            let probe = Probe::new(rays.one(ray));
            let within = Span { min: span[0][ray], max: span[1][ray] };
            let hit = match ANY {
                true => mesh.any_on::<L>(&probe, within, &mut Stack::default()).then_some(Crossing::at(0.0)),
                false => mesh.nearest_on::<L>(&probe, within, &mut Stack::default()),
            };
            if let Some(at) = hit {
                found.set(ray, at);
            }
        }
        found
    }
}

/// What eight rays meet of a mesh, in memory.
pub(super) struct MeshHits {
    /// Infinite where there is no hit; of any triangle, just finite.
    pub t: [f64; 8],
    pub parts: [u32; 8],
    /// A bit for each hit next to which there is another one.
    pub crowded: u32,
}

impl MeshHits {
    #[inline(always)]
    fn set(&mut self, ray: usize, Crossing { t, part, crowded }: Crossing) {
        (self.t[ray], self.parts[ray]) = (t, part);
        self.crowded = self.crowded & !(1 << ray) | u32::from(crowded) << ray;
    }
}

impl<const ANY: bool> BundleSearch<'_, ANY> {
    /// Gives what is found, and those rays that have to be asked for alone: they come from afar, or are not longest along
    /// the same axis as the others.
    #[inline(always)]
    fn search<L: Level>(&self) -> (LaneHit<L::F64>, u32) {
        let &Self { mesh, rays, wanted, span: [min, max] } = self;
        let (ray, found) = (rays.load::<L>(), LaneHit::none());
        let tree = mesh.mesh.tree();
        let (slabs, near, afar) = BundleSlabs::<L>::new(tree, ray.origin, ray.direction, wanted);
        if near == 0 {
            return (found, afar);
        }
        let prepared = PreparedRay::new(ray);
        let Some((axes, shear)) = prepared.shear(near) else { return (found, near | afar) };
        let span = Span { min: L::F64::from_array(*min), max: L::F64::from_array(*max) };
        let limits = L::F64::select(L::Mask::from_bits(near), span.max, L::F64::splat(-1.0));
        let mut bundle = Bundle::<L, ANY> {
            mesh,
            rays,
            prepared: &prepared,
            slabs: &slabs,
            sheared: ShearedRays::new(&slabs, axes, shear),
            vicinity: prepared.vicinity(tree.space().reach()),
            span,
            limits,
            limit: slabs.limit(limits),
            found,
            alone: [None; 8],
        };
        tree.walk_together(&slabs, near, &mut bundle, &mut BundleStack::default());
        (bundle.found, afar)
    }
}

/// Eight searches at once.
struct Bundle<'a, L: Level, const ANY: bool> {
    mesh: &'a Mesh,
    rays: &'a RayRows,
    prepared: &'a PreparedRay<L::F64>,
    slabs: &'a BundleSlabs<L>,
    sheared: ShearedRays<L>,
    vicinity: Vicinity<L::F64>,
    span: Span<L::F64>,
    /// The t before which hits are of interest: a little beyond the best, so that it is known what else is near it; below 0
    /// once a search is over.
    limits: L::F64,
    limit: L::F32,
    found: LaneHit<L::F64>,
    /// Rays that have gone on alone.
    alone: [Option<(Probe, Slabs)>; 8],
}

impl<L: Level, const ANY: bool> Bundle<'_, L, ANY> {
    /// Takes what is hit along some of the rays.
    #[inline(always)]
    fn take(&mut self, rays: L::Mask, at: LaneHit<L::F64>) {
        let end = match ANY {
            true => L::F64::splat(-1.0),
            false => self.vicinity.end(at.t).min(self.span.max),
        };
        self.found = LaneHit::select(rays, at, self.found);
        self.limits = L::F64::select(rays, end, self.limits);
        self.limit = self.slabs.limit(self.limits);
    }
}

impl<L: Level, const ANY: bool> BundleLeaves<L> for Bundle<'_, L, ANY> {
    const ALONE: bool = true;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        let mesh = &self.mesh.mesh;
        let packet = &mesh.packets()[leaf as usize];
        for lane in 0..packet.count() {
            let candidates = self.sheared.sift(packet, lane, self.limit) & rays;
            if candidates == 0 {
                continue;
            }
            let triangle = TriangleLanes::<L::F64>::splat(mesh.packed_corners(packet, lane));
            let at = triangle.intersect(self.prepared, Span { min: self.span.min, max: self.limits });
            let hit = at.is_hit() & L::Mask::from_bits(candidates);
            if !hit.any() {
                continue;
            }
            let (part, best) = (L::U32::splat(packet.part(lane)), &mut self.found);
            let nearer = hit & (at.t.lt(best.t) | at.t.eq(best.t) & part.lt(best.part));
            let crowded = hit & best.t.le(self.vicinity.end(at.t));
            best.crowded = best.crowded | crowded;
            if nearer.any() {
                self.take(nearer, LaneHit { t: at.t, part, crowded });
            }
        }
    }

    #[inline(always)]
    fn part(&mut self, ray: usize, below: Branch) {
        let (mesh, hit) = (self.mesh, self.found.lane(ray));
        let within = Span { min: self.span.min.to_array()[ray], max: self.span.max.to_array()[ray] };
        if ANY && hit.is_some() {
            return;
        }
        let slot = &mut self.alone[ray];
        if slot.is_none() {
            let probe = Probe::new(self.rays.one(ray));
            *slot = Slabs::new::<L::Narrow>(mesh.mesh.tree(), &probe, within.max).map(|slabs| (probe, slabs));
        }
        let Some((probe, slabs)) = slot else { return };
        let tree = mesh.mesh.tree();
        let found = if ANY {
            let mut search = Any::new(mesh, probe, within);
            tree.walk_below::<L>(below, slabs, slabs.limit(within.max), &mut search);
            search.found.then_some(Crossing::at(0.0))
        } else {
            let mut search = Nearest::new(mesh, probe, within);
            search.hit = hit;
            tree.walk_below::<L>(below, slabs, slabs.limit(search.limit()), &mut search);
            search.hit
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
