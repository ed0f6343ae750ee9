//! The shadows of relief on itself.

use super::Bsdf;
use crate::base::lanes::{Real, Vec3};

impl<F: Real> Bsdf<'_, F> {
    /// The share of light from a direction that the relief lets pass. Normals that are turned towards a light would shine up
    /// to the horizon of the flat surface and end there abruptly. As a distribution of microfacets whose slope is that of
    /// the turned normal, the relief shadows itself: Smith's G1 of GGX (Estevez, Lecocq, Stein, *A microfacet-based
    /// shadowing function to solve the bump terminator problem*, in *Ray Tracing Gems*, 2019). It only removes light, so a
    /// surface reflects at most what it would without.
    #[inline(always)]
    pub(super) fn relief_shadow(&self, to_light: Vec3<F>) -> F::F32 {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        // The squared tangent of an angle, from its cosine.
        let tangent = |cosine: F| {
            let square = cosine * cosine;
            (one - square).max(zero) / square
        };
        let turned = tangent(self.surface.normal.dot(self.normal));
        // The variance of slopes that puts the turned normal at twice its deviation, at most 1.
        let alpha = (turned * F::splat(0.125)).min(one);
        let cosine = self.surface.normal.dot(to_light);
        let share = F::splat(2.0) / (one + (one + alpha * tangent(cosine)).sqrt());
        F::select(zero.lt(cosine), share, zero).to_f32()
    }
}
