//! The nearest hits along eight rays, or along one.

use super::Hit;
use crate::base::lanes::{Bits, LaneKernel, Level, Mask, Real, Row, Select};
use crate::base::math::smaller;
use crate::geometry::shape::{Crossing, LaneHit, PreparedRay, Span, Vicinity, eight};
use crate::scene::Geometry;

/// What rays meet first.
#[derive(Clone, Copy)]
pub struct LaneHits<F: Real> {
    pub at: LaneHit<F>,
    /// Indices of the primitives; [`NOTHING`] where nothing is met.
    pub primitive: F::U32,
}

/// The primitive of what meets none.
pub const NOTHING: u32 = u32::MAX;

impl<F: Real> LaneHits<F> {
    #[inline(always)]
    pub fn none() -> Self {
        Self { at: LaneHit::none(), primitive: F::U32::splat(NOTHING) }
    }

    #[inline(always)]
    pub(super) fn store(&self) -> HitRows {
        let (primitives, parts) = (self.primitive.to_array(), self.at.part.to_array());
        let mut rows = HitRows {
            t: eight(self.at.t),
            primitives: [NOTHING; 8],
            parts: [0; 8],
            crowded: self.at.crowded.bits(),
        };
        for lane in 0..F::LANES {
            (rows.primitives[lane], rows.parts[lane]) = (primitives[lane], parts[lane]);
        }
        rows
    }
}

/// Eight hits in memory.
#[derive(Clone, Copy, Debug)]
pub struct HitRows {
    pub t: [f64; 8],
    pub primitives: [u32; 8],
    pub parts: [u32; 8],
    /// A bit for each next to which there is another one.
    pub crowded: u32,
}

impl HitRows {
    #[inline(always)]
    pub fn load<F: Real>(&self) -> LaneHits<F> {
        LaneHits {
            at: LaneHit {
                t: F::load(&self.t, 0),
                part: F::U32::load(&self.parts, 0),
                crowded: F::Mask::from_bits(self.crowded),
            },
            primitive: F::U32::load(&self.primitives, 0),
        }
    }

    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Option<Hit> {
        let (t, part, primitive) = (self.t[lane], self.parts[lane], self.primitives[lane]);
        let crowded = self.crowded >> lane & 1 == 1;
        (primitive != NOTHING).then_some(Hit { at: Crossing { t, part, crowded }, primitive })
    }

    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, hit: Option<Hit>) {
        if let Some(Hit { at, primitive }) = hit {
            (self.t[lane], self.parts[lane], self.primitives[lane]) = (at.t, at.part, primitive);
            self.crowded = self.crowded & !(1 << lane) | u32::from(at.crowded) << lane;
        }
    }
}

/// The nearest hit along one ray.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    pub hit: Option<Hit>,
    pub vicinity: Vicinity<f64>,
}

impl Found {
    /// Beyond this t nothing is of interest.
    #[inline(always)]
    pub fn limit(&self, max: f64) -> f64 {
        self.hit.map_or(max, |hit| smaller(max, self.vicinity.end(hit.at.t)))
    }

    /// Takes a hit that is within the limit if it is nearer, or as near and of an earlier primitive.
    #[inline(always)]
    pub fn consider(&mut self, mut at: Crossing, primitive: u32) {
        if let Some(mut best) = self.hit {
            let close = best.at.t <= self.vicinity.end(at.t);
            let better = at.t < best.at.t || at.t == best.at.t && primitive < best.primitive;
            if !better {
                best.at.crowded |= close;
                self.hit = Some(best);
                return;
            }
            at.crowded |= close;
        }
        self.hit = Some(Hit { at, primitive });
    }
}

/// The search for the nearest hits along eight rays.
pub struct Nearest<'a, F: Real> {
    pub ray: &'a PreparedRay<F>,
    pub within: Span<F>,
    vicinity: Vicinity<F>,
    pub hits: LaneHits<F>,
    /// Beyond these t nothing is of interest; lanes that are not wanted have none.
    pub limit: F,
}

impl<'a, F: Real> Nearest<'a, F> {
    #[inline(always)]
    pub fn new(ray: &'a PreparedRay<F>, reach: f64, within: Span<F>, wanted: F::Mask) -> Self {
        let limit = F::select(wanted, within.max, F::splat(-1.0));
        Self { ray, within, vicinity: ray.vicinity(reach), hits: LaneHits::none(), limit }
    }

    /// Tests primitives of these indices, in any order.
    #[inline(always)]
    pub fn test(&mut self, geometry: &Geometry, indices: &[u32]) {
        F::Level::call_with(Test { nearest: self, geometry, indices });
    }

    #[inline(always)]
    fn consider(&mut self, index: u32, at: LaneHit<F>) {
        let index = F::U32::splat(index);
        let best = &mut self.hits;
        let better = at.t.lt(best.at.t) | (at.t.eq(best.at.t) & at.is_hit() & index.lt(best.primitive));
        let close = at.is_hit() & best.at.t.le(self.vicinity.end(at.t));
        best.at.crowded = close | (best.at.crowded & !better) | (at.crowded & better);
        best.at.t = F::select(better, at.t, best.at.t);
        best.at.part = F::U32::select(better, at.part, best.at.part);
        best.primitive = F::U32::select(better, index, best.primitive);
        let limit = self.vicinity.end(best.at.t);
        self.limit = F::select(at.is_hit(), self.limit.min(limit), self.limit);
    }

    /// From which t on, and up to which, lanes look.
    #[inline(always)]
    pub fn bounds(&self) -> [[f64; 8]; 2] {
        [eight(self.within.min), eight(self.within.max)]
    }
}

struct Test<'a, 'n, F: Real> {
    nearest: &'a mut Nearest<'n, F>,
    geometry: &'a Geometry,
    indices: &'a [u32],
}

impl<F: Real> LaneKernel<F::Level> for Test<'_, '_, F> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { nearest, geometry, indices } = self;
        for &index in indices {
            let within = Span { min: nearest.within.min, max: nearest.limit };
            let at = geometry.primitives[index as usize].intersect(nearest.ray, within);
            if at.is_hit().any() {
                nearest.consider(index, at);
            }
        }
    }
}
