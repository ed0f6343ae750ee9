//! The closest hits along eight rays, or along one.

use crate::base::lanes::{Bits, LaneKernel, Level, Mask, Real, Row, Select};
use crate::base::math::min;
use crate::geometry::bvh::Stack;
use crate::geometry::shape::{
    CoincidenceRange, LaneHit, PreparedRay, RayInterval, ShapeHit, select_bits, store_lanes,
};
use crate::scene::{Geometry, Hit};

/// The first hits of rays.
#[derive(Clone, Copy)]
pub struct LaneHits<F: Real> {
    pub at: LaneHit<F>,
    /// Indices of the primitives, or [`NOTHING`] without a hit.
    pub primitive: F::U32,
}

/// The primitive of rays without a hit.
pub const NOTHING: u32 = u32::MAX;

impl<F: Real> LaneHits<F> {
    #[inline(always)]
    pub fn none() -> Self {
        Self { at: LaneHit::none(), primitive: F::U32::splat(NOTHING) }
    }

    #[inline(always)]
    pub(super) fn store(&self) -> StoredHits {
        let (primitives, parts) = (self.primitive.to_array(), self.at.part.to_array());
        let mut rows = StoredHits {
            t: store_lanes(self.at.t),
            primitives: [NOTHING; 8],
            parts: [0; 8],
            coincident: self.at.coincident.bits(),
            isolated: self.at.isolated,
        };
        for lane in 0..F::LANES {
            (rows.primitives[lane], rows.parts[lane]) = (primitives[lane], parts[lane]);
        }
        rows
    }
}

/// Eight hits in memory, as structure of arrays.
#[derive(Clone, Copy, Debug)]
pub struct StoredHits {
    pub t: [f64; 8],
    pub primitives: [u32; 8],
    pub parts: [u32; 8],
    /// A bit for each hit that another one may coincide with.
    pub coincident: u32,
    /// A bit for each hit near which its mesh has no other part.
    pub isolated: u32,
}

impl StoredHits {
    #[inline(always)]
    pub fn load<F: Real>(&self) -> LaneHits<F> {
        LaneHits {
            at: LaneHit {
                t: F::load(&self.t, 0),
                part: F::U32::load(&self.parts, 0),
                coincident: F::Mask::from_bits(self.coincident),
                isolated: self.isolated,
            },
            primitive: F::U32::load(&self.primitives, 0),
        }
    }

    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Option<Hit> {
        let (t, part, primitive) = (self.t[lane], self.parts[lane], self.primitives[lane]);
        let (coincident, isolated) = (self.coincident >> lane & 1 == 1, self.isolated >> lane & 1 == 1);
        (primitive != NOTHING).then_some(Hit { at: ShapeHit { t, part, coincident, isolated }, primitive })
    }

    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, hit: Option<Hit>) {
        if let Some(Hit { at, primitive }) = hit {
            (self.t[lane], self.parts[lane], self.primitives[lane]) = (at.t, at.part, primitive);
            self.coincident = self.coincident & !(1 << lane) | u32::from(at.coincident) << lane;
            self.isolated = self.isolated & !(1 << lane) | u32::from(at.isolated) << lane;
        }
    }
}

/// The closest hit so far along one ray.
#[derive(Clone, Copy, Debug)]
pub struct BestHit {
    pub hit: Option<Hit>,
    pub coincidence_range: CoincidenceRange<f64>,
}

impl BestHit {
    /// The t beyond which hits do not count.
    #[inline(always)]
    pub fn limit(&self, max: f64) -> f64 {
        self.hit.map_or(max, |hit| min(max, self.coincidence_range.end(hit.at.t)))
    }

    /// Records a hit within the limit if it is closer, or equally close and of an earlier primitive.
    #[inline(always)]
    pub fn consider(&mut self, mut at: ShapeHit, primitive: u32) {
        if let Some(mut best) = self.hit {
            let close = best.at.t <= self.coincidence_range.end(at.t);
            let better = at.t < best.at.t || at.t == best.at.t && primitive < best.primitive;
            if !better {
                best.at.coincident |= close;
                self.hit = Some(best);
                return;
            }
            at.coincident |= close;
        }
        self.hit = Some(Hit { at, primitive });
    }
}

/// The search for the closest hits along eight rays.
pub struct LaneClosestHit<'a, F: Real> {
    pub ray: &'a PreparedRay<F>,
    pub within: RayInterval<F>,
    coincidence_range: CoincidenceRange<F>,
    pub hits: LaneHits<F>,
    /// The t beyond which hits do not count; negative for unused lanes.
    pub limit: F,
}

impl<'a, F: Real> LaneClosestHit<'a, F> {
    #[inline(always)]
    pub fn new(ray: &'a PreparedRay<F>, reach: f64, within: RayInterval<F>, wanted: F::Mask) -> Self {
        let limit = F::select(wanted, within.max, F::splat(-1.0));
        Self { ray, within, coincidence_range: ray.coincidence_range(reach), hits: LaneHits::none(), limit }
    }

    /// Tests the primitives of these indices, in any order. Rays that go different ways come with a stack.
    #[inline(always)]
    pub fn test(&mut self, geometry: &Geometry, indices: &[u32], apart: Option<&mut Stack>) {
        if !indices.is_empty() {
            F::Level::call_with(Test { nearest: self, geometry, indices, apart });
        }
    }

    #[inline(always)]
    fn consider(&mut self, index: u32, at: LaneHit<F>) {
        let index = F::U32::splat(index);
        let best = &mut self.hits;
        let better = at.t.lt(best.at.t) | (at.t.eq(best.at.t) & at.is_hit() & index.lt(best.primitive));
        let close = at.is_hit() & best.at.t.le(self.coincidence_range.end(at.t));
        best.at.coincident = close | (best.at.coincident & !better) | (at.coincident & better);
        best.at.isolated = select_bits(better, at.isolated, best.at.isolated);
        best.at.t = F::select(better, at.t, best.at.t);
        best.at.part = F::U32::select(better, at.part, best.at.part);
        best.primitive = F::U32::select(better, index, best.primitive);
        let limit = self.coincidence_range.end(best.at.t);
        // Not as a choice between two limits: a load that follows the store of some lanes waits for it.
        self.limit = F::select(at.is_hit(), limit, F::splat(f64::INFINITY)).min(self.limit);
    }

    /// The minima and maxima of t.
    #[inline(always)]
    pub fn bounds(&self) -> [[f64; 8]; 2] {
        [store_lanes(self.within.min), store_lanes(self.within.max)]
    }
}

struct Test<'a, 'n, F: Real> {
    nearest: &'a mut LaneClosestHit<'n, F>,
    geometry: &'a Geometry,
    indices: &'a [u32],
    apart: Option<&'a mut Stack>,
}

impl<F: Real> LaneKernel<F::Level> for Test<'_, '_, F> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { nearest, geometry, indices, mut apart } = self;
        for &index in indices {
            let within = RayInterval { min: nearest.within.min, max: nearest.limit };
            let primitive = &geometry.primitives[index as usize];
            let at = primitive.intersect_with(nearest.ray, within, apart.as_deref_mut());
            if at.is_hit().any() {
                nearest.consider(index, at);
            }
        }
    }
}
