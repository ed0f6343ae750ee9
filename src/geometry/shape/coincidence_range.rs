//! The range of t within which hits along a ray may coincide.

use crate::base::lanes::{Real, Vec3};

/// The range of t within which rounding may have swapped hits. The order of such hits is decided by their surfaces,
/// not by t alone.
#[derive(Clone, Copy, Debug)]
pub struct CoincidenceRange<F> {
    /// The t in which the ray covers its own coordinates and those of the scene.
    reach: F,
}

/// Range as a fraction of coordinates and distance. The rounding of one surface is below 128 u of these. The rounding
/// of two is below this fraction divided by any cosine above 2^-17. So t alone decides only at grazing angles of less
/// than two arc seconds.
const SHARE: f64 = 1.0 / (1u64 << 28) as f64;

impl<F: Real> CoincidenceRange<F> {
    /// For a ray from `origin`. `per_longest` is the inverse of its direction's largest component, and `reach` the
    /// largest coordinate of the scene.
    #[inline(always)]
    pub fn new(origin: Vec3<F>, per_longest: F, reach: f64) -> Self {
        Self { reach: (F::splat(reach) + origin.abs().max_element()) * per_longest.abs() }
    }

    /// The end of the range that begins at `t`.
    #[inline(always)]
    pub fn end(self, t: F) -> F {
        t + (t + self.reach) * F::splat(SHARE)
    }

    /// That of one lane.
    #[inline(always)]
    pub fn lane(self, lane: usize) -> CoincidenceRange<f64> {
        CoincidenceRange { reach: self.reach.to_array()[lane] }
    }
}
