//! Hits in lanes.

use super::ShapeHit;
use super::lane_ray::RayInterval;
use crate::base::lanes::{Mask, Real, Row, Select};

/// Hits of rays with a shape.
#[derive(Clone, Copy)]
pub struct LaneHit<F: Real> {
    /// Infinite if a ray misses.
    pub t: F,
    /// The part of the shape, in the shape's own numbering: a triangle of a mesh, a cap.
    pub part: F::U32,
    /// Lanes in which another hit is so near that the order is uncertain.
    pub coincident: F::Mask,
    /// A bit for each lane in which no other part of a mesh is near: see [`ShapeHit::isolated`]. Bits, as hits of other
    /// shapes have none.
    pub isolated: u32,
}

impl From<ShapeHit> for LaneHit<f64> {
    fn from(ShapeHit { t, part, coincident, isolated }: ShapeHit) -> Self {
        Self { t, part, coincident, isolated: u32::from(isolated) }
    }
}

impl<F: Real> LaneHit<F> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat(at: Option<ShapeHit>) -> Self {
        match at {
            Some(ShapeHit { t, part, coincident, isolated }) => Self {
                t: F::splat(t),
                part: F::U32::splat(part),
                coincident: F::Mask::splat(coincident),
                isolated: F::Mask::splat(isolated).bits(),
            },
            None => Self::none(),
        }
    }

    #[inline(always)]
    pub fn none() -> Self {
        let no = F::Mask::splat(false);
        Self { t: F::splat(f64::INFINITY), part: F::U32::splat(0), coincident: no, isolated: 0 }
    }

    /// The hits of single rays, one per lane.
    #[inline(always)]
    pub fn from_lanes(hits: &[Option<ShapeHit>; 8]) -> Self {
        let (mut t, mut part) = (F::splat(f64::INFINITY).to_array(), F::U32::splat(0).to_array());
        let (mut coincident, mut isolated) = (0, 0);
        for lane in 0..F::LANES {
            if let Some(at) = hits[lane] {
                (t[lane], part[lane]) = (at.t, at.part);
                coincident |= u32::from(at.coincident) << lane;
                isolated |= u32::from(at.isolated) << lane;
            }
        }
        let (t, part) = (F::from_array(t), F::U32::from_array(part));
        Self { t, part, coincident: F::Mask::from_bits(coincident), isolated }
    }

    /// Hits at t in the lanes of a mask, if they are within bounds.
    #[inline(always)]
    pub fn within(mask: F::Mask, t: F, within: RayInterval<F>) -> Self {
        let hit = mask & within.min.lt(t) & t.lt(within.max);
        Self { t: F::select(hit, t, F::splat(f64::INFINITY)), ..Self::none() }
    }

    /// The hit of one lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Option<ShapeHit> {
        let t = self.t.to_array()[lane];
        let (coincident, isolated) = (self.coincident.bits() >> lane & 1, self.isolated >> lane & 1);
        (t < f64::INFINITY).then_some(ShapeHit {
            t,
            part: self.part.to_array()[lane],
            coincident: coincident == 1,
            isolated: isolated == 1,
        })
    }

    /// The lanes with a hit.
    #[inline(always)]
    pub fn is_hit(&self) -> F::Mask {
        self.t.lt(F::splat(f64::INFINITY))
    }
}

impl<F: Real> Select<F::Mask> for LaneHit<F> {
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            t: F::select(mask, yes.t, no.t),
            part: F::U32::select(mask, yes.part, no.part),
            coincident: yes.coincident & mask | no.coincident & !mask,
            isolated: select_bits(mask, yes.isolated, no.isolated),
        }
    }
}

/// The bits of one or the other number by a mask. Most often, neither has any.
#[inline(always)]
pub fn select_bits<M: Mask>(mask: M, yes: u32, no: u32) -> u32 {
    if yes | no == 0 {
        return 0;
    }
    yes & mask.bits() | no & !mask.bits()
}

impl LaneHit<f64> {
    /// The only lane.
    #[inline(always)]
    pub fn one(self) -> Option<ShapeHit> {
        self.lane(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_of_the_lanes_of_their_number() {
        for mask in [false, true] {
            for (yes, no) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                assert_eq!(
                    select_bits(<f64 as Row>::Mask::splat(mask), yes, no),
                    if mask { yes } else { no }
                );
            }
        }
    }
}
