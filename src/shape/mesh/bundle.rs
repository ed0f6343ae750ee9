//! The search for triangles along eight rays: they share the nodes of the tree and what has to be known of each triangle.

use super::Mesh;
use super::search::{Any, Nearest};
use crate::lanes::{Level, Mask, Real, Row, SimdKernel, lanes};
use crate::math::smaller;
use crate::mesh::ShearedRays;
use crate::shape::triangle::TriangleLanes;
use crate::shape::{Crossing, PreparedRay, RayRows, Span, Vicinity};
use crate::tree::{Branch, BundleLeaves, BundleSlabs, BundleStack, Probe, Slabs};

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
        let mut found = MeshHits { t: [f64::INFINITY; 8], parts: [0; 8], crowded: 0 };
        let alone = self.search::<L>(&mut found);
        for ray in lanes(alone & wanted) {
            let probe = Probe::new(rays.one(ray));
            let within = Span { min: span[0][ray], max: span[1][ray] };
            let hit = match ANY {
                true => mesh.any(&probe, within).then_some(Crossing::at(0.0)),
                false => mesh.nearest(&probe, within),
            };
            if let Some(at) = hit {
                found.set(ray, at);
            }
        }
        found
    }
}

/// What eight rays meet of a mesh.
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

    #[inline(always)]
    fn get(&self, ray: usize) -> Option<Crossing> {
        let (t, part, crowded) = (self.t[ray], self.parts[ray], self.crowded >> ray & 1 == 1);
        (t < f64::INFINITY).then_some(Crossing { t, part, crowded })
    }
}

impl<const ANY: bool> BundleSearch<'_, ANY> {
    /// Gives those rays that have to be asked for alone: they come from afar, or are not longest along the same axis as
    /// the others.
    #[inline(always)]
    fn search<L: Level>(&self, found: &mut MeshHits) -> u32 {
        let &Self { mesh, rays, wanted, span } = self;
        let ray = rays.load::<L>();
        let tree = mesh.mesh.tree();
        let (slabs, near, afar) = BundleSlabs::<L>::new(tree, ray.origin, ray.direction, wanted);
        if near == 0 {
            return afar;
        }
        let Some(sheared) = ShearedRays::<L>::new(&slabs, ray.direction, near) else { return near | afar };
        let limit = slabs.limit(L::F64::from_array(span[1]));
        let (prepared, limits, alone) = (PreparedRay::new(ray), span[1], [None; 8]);
        let vicinity = prepared.vicinity(tree.space().reach());
        let mut bundle = Bundle::<L, ANY> {
            mesh,
            rays,
            prepared: &prepared,
            slabs: &slabs,
            sheared,
            vicinity,
            span,
            limits,
            limit,
            found,
            alone,
        };
        tree.walk_together(&slabs, near, &mut bundle, &mut BundleStack::default());
        afar
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
    span: &'a [[f64; 8]; 2],
    /// The t before which hits are of interest: a little beyond the best, so that it is known what else is near it; below 0
    /// once a search is over.
    limits: [f64; 8],
    limit: L::F32,
    found: &'a mut MeshHits,
    /// Rays that have gone on alone.
    alone: [Option<(Probe, Slabs)>; 8],
}

impl<L: Level, const ANY: bool> Bundle<'_, L, ANY> {
    /// Notes what is hit along a ray; nothing before `end` is beyond interest then.
    #[inline(always)]
    fn note(&mut self, ray: usize, at: Crossing, end: f64) {
        self.found.set(ray, at);
        self.limits[ray] = if ANY { -1.0 } else { smaller(end, self.span[1][ray]) };
    }
}

impl<L: Level, const ANY: bool> BundleLeaves<L> for Bundle<'_, L, ANY> {
    const ALONE: bool = true;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        let mesh = &self.mesh.mesh;
        let packet = &mesh.packets()[leaf as usize];
        let mut nearer = false;
        for lane in 0..packet.count() {
            let mut candidates = self.sheared.sift(packet, lane, self.limit) & rays;
            if ANY {
                candidates &= L::F64::splat(0.0).le(L::F64::from_array(self.limits)).bits();
            }
            if candidates == 0 {
                continue;
            }
            let triangle = TriangleLanes::<L::F64>::splat(mesh.packed_corners(packet, lane));
            let within = Span { min: L::F64::from_array(self.span[0]), max: L::F64::from_array(self.limits) };
            let hits = triangle.intersect(self.prepared, within);
            let (part, t, ends) =
                (packet.part(lane), hits.t.to_array(), self.vicinity.end(hits.t).to_array());
            for ray in lanes(hits.is_hit().bits() & candidates) {
                let (t, best) = (t[ray], self.found.t[ray]);
                if t < best || t == best && part < self.found.parts[ray] {
                    self.note(ray, Crossing { t, part, crowded: best <= ends[ray] }, ends[ray]);
                    nearer = true;
                } else {
                    self.found.crowded |= 1 << ray;
                }
            }
        }
        if nearer {
            self.limit = self.slabs.limit(L::F64::from_array(self.limits));
        }
    }

    #[inline(always)]
    fn part(&mut self, ray: usize, below: Branch) {
        let (mesh, hit) = (self.mesh, self.found.get(ray));
        let within = Span { min: self.span[0][ray], max: self.span[1][ray] };
        if ANY && hit.is_some() {
            return;
        }
        let slot = &mut self.alone[ray];
        if slot.is_none() {
            let probe = Probe::new(self.rays.one(ray));
            *slot = Slabs::new::<L>(mesh.mesh.tree(), &probe, within.max).map(|slabs| (probe, slabs));
        }
        let Some((probe, slabs)) = *slot else { return };
        let tree = mesh.mesh.tree();
        if ANY {
            let limit = slabs.limit(within.max);
            let mut search = Any::new(mesh, &probe, within);
            tree.walk_below::<L>(below, &slabs, limit, &mut search);
            if !search.found {
                return;
            }
            self.note(ray, Crossing::at(0.0), 0.0);
        } else {
            let mut search = Nearest::new(mesh, &probe, within);
            search.hit = hit;
            let limit = slabs.limit(search.limit());
            tree.walk_below::<L>(below, &slabs, limit, &mut search);
            match search.hit {
                Some(found) if search.hit != hit => self.note(ray, found, search.limit()),
                _ => return,
            }
        }
        self.limit = self.slabs.limit(L::F64::from_array(self.limits));
    }

    #[inline(always)]
    fn limit(&self) -> L::F32 {
        self.limit
    }
}
