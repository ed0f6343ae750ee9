//! The highlights of Phong and Blinn.

use super::Bsdf;
use crate::base::lanes::{Color, Real, Vec3};
use crate::base::math::DVec3;
use crate::trace::materials::LobeSet;

impl<F: Real> Bsdf<'_, F> {
    /// The highlight of light from a direction that lights the surface.
    #[inline(always)]
    pub(super) fn highlight(&self, to_light: Vec3<F>) -> Color<F::F32> {
        let cosine = match self.lobes.has(LobeSet::PHONG) {
            true => self.mirrored().dot(to_light),
            false => self.normal.dot((to_light + self.to_eye).normalize_or(Vec3::splat(DVec3::ZERO))),
        };
        self.specular * self.shininess.raise(cosine).to_f32()
    }
}
