//! The cost and the benefit of robust intersections on the scene's own rays.

use crate::accuracy::measure::Measured;
use crate::base::units::{factor, percent};

impl Measured {
    /// A sentence about the pixels that textbook formulas in f32 get wrong, and the cost of Kinora's formulas.
    pub(super) fn robust(&self) -> Option<String> {
        let found = self.robustness.as_ref()?;
        let (cheap, ours) = (found.hits.first()?, found.hits.last()?);
        let kinora = found.starts.last()?;
        let wrong = match found.wrong_pixels() {
            0.0 => format!("none of {} pixels", found.pixels.len()),
            share => format!("{} of the pixels", percent(share)),
        };
        Some(format!(
            "Robustness here: textbook formulas in f32 with fixed offsets get {wrong} wrong, Kinora {} of {} rays; a \
             hit takes {:.0} ns instead of {:.0} ns ({} times)",
            ours.wrong + kinora.false_shadows + kinora.lost_shadows,
            ours.rays + kinora.rays,
            ours.nanoseconds,
            cheap.nanoseconds,
            factor(ours.nanoseconds / cheap.nanoseconds)
        ))
    }
}
