//! The closest hit of a ray with a shape of many parts.

use super::{CoincidenceRange, RayInterval, ShapeHit};
use crate::base::math::min;

/// The closest part so far along one ray. Of equally near parts, the one with the lowest index.
#[derive(Clone, Copy, Debug)]
pub struct NearestPart {
    pub within: RayInterval<f64>,
    pub coincidence_range: CoincidenceRange<f64>,
    pub hit: Option<ShapeHit>,
    /// Whether to find out if the hit is isolated.
    pub isolates: bool,
}

impl NearestPart {
    #[inline(always)]
    pub fn new(within: RayInterval<f64>, coincidence_range: CoincidenceRange<f64>) -> Self {
        Self { within, coincidence_range, hit: None, isolates: false }
    }

    /// The t beyond which hits do not count.
    #[inline(always)]
    pub fn limit(&self) -> f64 {
        self.hit.map_or(self.within.max, |best| min(self.within.max, self.coincidence_range.end(best.t)))
    }

    /// Records a hit before the limit if it is closer, or equally close with a lower index. A part in several leaves
    /// does not coincide with itself.
    #[inline(always)]
    pub fn consider(&mut self, at: ShapeHit) {
        let ShapeHit { t, part, .. } = at;
        self.hit = Some(match self.hit {
            None => at,
            Some(best) if part == best.part => best,
            Some(best) if t < best.t || t == best.t && part < best.part => {
                ShapeHit { coincident: best.t <= self.coincidence_range.end(t), ..at }
            }
            Some(best) => {
                ShapeHit { coincident: best.coincident || t <= self.coincidence_range.end(best.t), ..best }
            }
        });
    }
}
