//! The search for triangles along a single ray.

use super::Mesh;
use crate::base::lanes::{Level, Row, SimdKernel};
use crate::base::math::smaller;
use crate::geometry::bvh::{Leaves, Probe, Slabs, Stack};
use crate::geometry::mesh::Sheared;
use crate::geometry::shape::triangle::{TriangleLanes, covers};
use crate::geometry::shape::{Crossing, PreparedRay, Span, Vicinity};

impl Mesh {
    /// The nearest triangle within bounds; of equally near ones that of the lowest index.
    pub fn nearest(&self, probe: &Probe, within: Span<f64>) -> Option<Crossing> {
        let mut nearest = Nearest::new(self, probe, within);
        self.mesh.tree().walk(probe, within.max, &mut nearest);
        nearest.hit
    }

    /// Whether there is a triangle within bounds.
    pub fn any(&self, probe: &Probe, within: Span<f64>) -> bool {
        let mut any = Any::new(self, probe, within);
        self.mesh.tree().walk(probe, within.max, &mut any);
        any.found
    }

    /// Gives all triangles within bounds to `take`, in no order.
    pub fn each(&self, probe: &Probe, within: Span<f64>, take: &mut dyn FnMut(Crossing)) {
        let mut all = All { mesh: self, ray: PreparedRay::splat(probe), within, take };
        self.mesh.tree().walk(probe, within.max, &mut all);
    }

    /// [`Mesh::nearest`] on a level that is at work already.
    #[inline(always)]
    pub fn nearest_on<L: Level>(
        &self,
        probe: &Probe,
        within: Span<f64>,
        stack: &mut Stack,
    ) -> Option<Crossing> {
        L::Narrow::call(Walk { search: Nearest::new(self, probe, within), stack })
    }

    /// [`Mesh::any`] on a level that is at work already.
    #[inline(always)]
    pub fn any_on<L: Level>(&self, probe: &Probe, within: Span<f64>, stack: &mut Stack) -> bool {
        L::Narrow::call(Walk { search: Any::new(self, probe, within), stack })
    }
}

/// The search for the nearest triangle. What the filter is sure of is not tested again; only its t is computed.
pub(super) struct Nearest<'a> {
    mesh: &'a Mesh,
    probe: &'a Probe,
    /// There from the first leaf on.
    sheared: Option<Sheared>,
    within: Span<f64>,
    vicinity: Vicinity<f64>,
    pub hit: Option<Crossing>,
}

impl<'a> Nearest<'a> {
    #[inline(always)]
    pub fn new(mesh: &'a Mesh, probe: &'a Probe, within: Span<f64>) -> Self {
        let vicinity = PreparedRay::splat(probe).vicinity(mesh.mesh.tree().space().reach());
        Self { mesh, probe, sheared: None, within, vicinity, hit: None }
    }

    /// Beyond which t nothing is of interest.
    #[inline(always)]
    pub fn limit(&self) -> f64 {
        self.hit.map_or(self.within.max, |best| smaller(self.within.max, self.vicinity.end(best.t)))
    }

    /// Takes a triangle before the limit if it is nearer, or as near and of a lower index.
    #[inline(always)]
    fn consider(&mut self, t: f64, part: u32) {
        let at = Crossing::of_part(t, part);
        self.hit = Some(match self.hit {
            None => at,
            Some(best) if t < best.t || t == best.t && part < best.part => {
                Crossing { crowded: best.t <= self.vicinity.end(t), ..at }
            }
            Some(best) => Crossing { crowded: best.crowded || t <= self.vicinity.end(best.t), ..best },
        });
    }
}

/// The search for any triangle.
pub(super) struct Any<'a> {
    mesh: &'a Mesh,
    probe: &'a Probe,
    sheared: Option<Sheared>,
    within: Span<f64>,
    pub found: bool,
}

impl<'a> Any<'a> {
    #[inline(always)]
    pub fn new(mesh: &'a Mesh, probe: &'a Probe, within: Span<f64>) -> Self {
        Self { mesh, probe, sheared: None, within, found: false }
    }
}

/// The search for all triangles within bounds.
struct All<'a> {
    mesh: &'a Mesh,
    ray: PreparedRay<f64>,
    within: Span<f64>,
    take: &'a mut dyn FnMut(Crossing),
}

/// A search from the root on.
struct Walk<'a, S> {
    search: S,
    stack: &'a mut Stack,
}

impl SimdKernel for Walk<'_, Nearest<'_>> {
    type Output = Option<Crossing>;

    #[inline(always)]
    fn run<L: Level>(mut self) -> Option<Crossing> {
        let Nearest { mesh: Mesh { mesh, .. }, probe, within, .. } = self.search;
        mesh.tree().walk_on::<L>(probe, within.max, &mut self.search, self.stack);
        self.search.hit
    }
}

impl SimdKernel for Walk<'_, Any<'_>> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(mut self) -> bool {
        let Any { mesh: Mesh { mesh, .. }, probe, within, .. } = self.search;
        mesh.tree().walk_on::<L>(probe, within.max, &mut self.search, self.stack);
        self.search.found
    }
}

/// The visit of a leaf.
struct Visit<'a, S> {
    search: &'a mut S,
    leaf: u32,
    slabs: &'a Slabs,
    limit: f32,
}

impl Leaves for Nearest<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, leaf: u32) {
        L::prefetch(self.mesh.mesh.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32> {
        L::call(Visit { search: self, leaf, slabs, limit })
    }
}

impl SimdKernel for Visit<'_, Nearest<'_>> {
    type Output = Option<f32>;

    #[inline(always)]
    fn run<L: Level>(self) -> Option<f32> {
        let Self { search, leaf, slabs, mut limit } = self;
        let Nearest { mesh: Mesh { mesh, .. }, probe, within, .. } = *search;
        let packet = &mesh.packets()[leaf as usize];
        let sheared = search.sheared.get_or_insert_with(|| Sheared::new(probe, slabs));
        let sieve = sheared.sift(&sheared.pass::<L::F32>(packet, limit), limit);
        let mut candidates = sieve.hit | sieve.unsure;
        if candidates == 0 {
            return Some(limit);
        }
        let (near, ray) = (sieve.near.to_array(), PreparedRay::<f64>::splat(probe));
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize & 7;
            let sure = sieve.hit >> lane & 1 == 1;
            candidates &= candidates - 1;
            if sure && near[lane] > limit {
                continue;
            }
            let triangle = TriangleLanes::splat(mesh.packed_corners(packet, lane));
            let sheared = triangle.sheared(&ray);
            if !sure && !covers(&sheared) {
                continue;
            }
            let Some(at) = triangle.crossing(&ray, &sheared, true, within).one() else { continue };
            search.consider(at.t, packet.part(lane));
            limit = slabs.limit(search.limit());
        }
        Some(limit)
    }
}

impl Leaves for Any<'_> {
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

impl SimdKernel for Visit<'_, Any<'_>> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(self) -> bool {
        let Self { search, leaf, slabs, limit } = self;
        let Any { mesh: Mesh { mesh, .. }, probe, within, .. } = *search;
        let packet = &mesh.packets()[leaf as usize];
        let sheared = search.sheared.get_or_insert_with(|| Sheared::new(probe, slabs));
        let passed = sheared.pass::<L::F32>(packet, limit);
        // What is sure is so from the start on.
        let from_start = within.min == 0.0;
        if from_start && sheared.within_whole(&passed, limit) != 0 {
            return true;
        }
        let sieve = sheared.sift(&passed, limit);
        let mut candidates = sieve.hit | sieve.unsure;
        if candidates == 0 {
            return false;
        }
        if from_start && sheared.within(&sieve, limit) != 0 {
            return true;
        }
        let ray = PreparedRay::<f64>::splat(probe);
        while candidates != 0 {
            let lane = candidates.trailing_zeros() as usize & 7;
            candidates &= candidates - 1;
            let triangle = TriangleLanes::splat(mesh.packed_corners(packet, lane));
            let sheared = triangle.sheared(&ray);
            let covered = sieve.hit >> lane & 1 == 1 || covers(&sheared);
            if triangle.crossing(&ray, &sheared, covered, within).is_hit() {
                return true;
            }
        }
        false
    }
}

impl Leaves for All<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        let Self { mesh: Mesh { mesh, .. }, ray, within, take } = self;
        let packet = &mesh.packets()[leaf as usize];
        for lane in 0..packet.count() {
            let triangle = TriangleLanes::splat(mesh.packed_corners(packet, lane));
            if let Some(at) = triangle.intersect(ray, *within).one() {
                take(Crossing::of_part(at.t, packet.part(lane)));
            }
        }
        Some(limit)
    }
}
