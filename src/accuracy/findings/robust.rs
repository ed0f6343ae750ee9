//! The cost and the benefit of robust intersections on the scene's own rays.

use crate::accuracy::measure::Measured;
use crate::accuracy::robustness::{HitErrors, ShadowRayErrors};
use crate::base::units::{factor, percent};

impl Measured {
    /// A sentence about the rays that textbook formulas in f32 get wrong, and the cost of Kinora's formulas.
    pub(super) fn robust(&self) -> Option<String> {
        let found = self.robustness.as_ref()?;
        let (cheap, ours) = (found.hits.first()?, found.hits.last()?);
        let wrong = |hits: &HitErrors, starts: &ShadowRayErrors| {
            let rays = f64::from(hits.rays + starts.rays);
            percent(f64::from(hits.wrong + starts.false_shadows + starts.lost_shadows) / rays.max(1.0))
        };
        Some(format!(
            "Robustness here: textbook formulas in f32 with fixed offsets get {} of the rays wrong, Kinora {}; a hit \
             takes {:.0} ns instead of {:.0} ns ({} times)",
            wrong(cheap, found.starts.first()?),
            wrong(ours, found.starts.last()?),
            ours.nanoseconds,
            cheap.nanoseconds,
            factor(ours.nanoseconds / cheap.nanoseconds)
        ))
    }
}
