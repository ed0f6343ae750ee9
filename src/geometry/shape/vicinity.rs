//! How near to each other hits along a ray have to be for their surfaces to be compared.

use crate::base::lanes::{Real, Vec3};

/// How near to each other hits along a ray have to be for their surfaces to be compared, and not only their t, as rounding
/// may have exchanged them.
#[derive(Clone, Copy, Debug)]
pub struct Vicinity<F> {
    /// The t in which the ray comes as far as its own coordinates and those of what it may meet.
    reach: F,
}

/// As a share of the coordinates and the way. The rounding of any surface is below 128 u of these, so that of two surfaces it is
/// less than this over every cosine above 2^-17: only where they are seen from less than two seconds of arc above
/// themselves, t alone decides.
const SHARE: f64 = 1.0 / (1u64 << 28) as f64;

impl<F: Real> Vicinity<F> {
    /// Along a ray from `origin`, of whose direction's largest coordinate this is the inverse, for what lies between
    /// coordinates up to `reach`.
    #[inline(always)]
    pub fn new(origin: Vec3<F>, per_longest: F, reach: f64) -> Self {
        Self { reach: (F::splat(reach) + origin.abs().max_element()) * per_longest.abs() }
    }

    /// Before which t hits are near one at `t`.
    #[inline(always)]
    pub fn end(self, t: F) -> F {
        t + (t + self.reach) * F::splat(SHARE)
    }
}
