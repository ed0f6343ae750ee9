//! The fuzzy mirror lobe.

use super::Bsdf;
use crate::appearance::material::MIN_FUZZ;
use crate::appearance::optics::Fuzz;
use crate::base::lanes::{Color, Real, Row, Single, Vec3};
use std::f64::consts::PI;

impl<F: Real> Bsdf<'_, F> {
    /// Lanes in which the mirror is fuzzy. In the others it is sharp.
    #[inline(always)]
    pub fn is_fuzzy(&self) -> F::Mask {
        F::F32::splat(MIN_FUZZ).le(self.fuzz)
    }

    /// The share of light that the fuzzy mirror reflects, for directions that light the surface.
    #[inline(always)]
    pub(super) fn fuzzy_share(&self, to_light: Vec3<F>) -> Color<F::F32> {
        self.mirror * (F::splat(PI) * self.fuzzy_pdf(to_light)).to_f32()
    }

    /// Samples a direction from three numbers in 0..1.
    #[inline(always)]
    pub fn fuzzy_sample(&self, u: [F; 3]) -> Vec3<F> {
        Fuzz(self.fuzz.to_f64()).sample(self.mirrored(), u)
    }

    /// The density per steradian of [`Bsdf::fuzzy_sample`]. It is 0 if the mirror is sharp.
    #[inline(always)]
    pub(super) fn fuzzy_pdf(&self, direction: Vec3<F>) -> F {
        let pdf = Fuzz(self.fuzz.to_f64()).pdf(self.mirrored(), direction);
        F::select(self.is_fuzzy(), pdf, F::splat(0.0))
    }
}
