//! The diffuse (Lambertian) lobe.

use super::Bsdf;
use crate::base::lanes::{Color, Real, Vec3};
use crate::sampling::{cosine_hemisphere, cosine_hemisphere_pdf};

impl<F: Real> Bsdf<'_, F> {
    /// The diffuse share of light, for directions that light the surface.
    #[inline(always)]
    pub(super) fn diffuse_share(&self, to_light: Vec3<F>) -> Color<F::F32> {
        self.diffuse * self.normal.dot(to_light).to_f32()
    }

    /// Samples a direction from two numbers in 0..1, with the density cosine / π.
    #[inline(always)]
    pub(super) fn diffuse_sample(&self, u: F, v: F) -> Vec3<F> {
        self.frame.to_world(cosine_hemisphere(u, v))
    }

    /// The density per steradian of [`Bsdf::diffuse_sample`].
    #[inline(always)]
    pub(super) fn diffuse_pdf(&self, direction: Vec3<F>) -> F {
        cosine_hemisphere_pdf(self.normal.dot(direction))
    }
}
