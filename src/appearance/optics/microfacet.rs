//! Rough surfaces as many small mirrors: the GGX distribution.
//!
//! All vectors are unit vectors in a frame whose z axis is the normal; `eye` and `light` lead away from the
//! surface. Walter et al., *Microfacet Models for Refraction through Rough Surfaces* (2007); Heitz,
//! *Understanding the Masking-Shadowing Function* (2014).

use crate::base::lanes::{Real, Vec3};
use crate::base::math::DVec3;
use crate::sampling::at_height;
use std::f64::consts::PI;

/// A distribution of small mirrors of width `alpha` (above 0): the square of what glTF calls roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacet<F> {
    pub alpha: F,
}

impl<F: Real> Microfacet<F> {
    /// Density of small mirrors with the normal `half`, per steradian and projected area.
    #[inline(always)]
    fn normals(self, half: Vec3<F>) -> F {
        let a2 = self.alpha * self.alpha;
        // cos²θ (α² - 1) + 1 is a difference of nearly equal numbers at narrow peaks; this sum is not.
        let below = half.z * half.z * a2 + half.x * half.x + half.y * half.y;
        a2 / (F::splat(PI) * below * below)
    }

    /// Smith's Λ: hidden over visible small mirrors from direction `v`.
    #[inline(always)]
    fn hidden(self, v: Vec3<F>) -> F {
        let one = F::splat(1.0);
        let tangent2 = (v.x * v.x + v.y * v.y) / (v.z * v.z);
        F::splat(0.5) * ((one + self.alpha * self.alpha * tangent2).sqrt() - one)
    }

    /// The share of the light from `light` that goes to `eye`, times the cosine of the light's angle, without
    /// Fresnel's factor; the light above the surface. Masking and shadowing are correlated by height. An eye that is
    /// not above sees no mirror.
    #[inline(always)]
    pub fn reflected(self, eye: Vec3<F>, light: Vec3<F>) -> F {
        let half = (eye + light).normalize_or(Vec3::splat(DVec3::Z));
        let visible = F::splat(1.0) / (F::splat(1.0) + self.hidden(eye) + self.hidden(light));
        let share = self.normals(half) * visible / (F::splat(4.0) * eye.z);
        F::select(F::splat(0.0).lt(eye.z), share, F::splat(0.0))
    }

    /// A small mirror's normal among those that `eye` sees, for two numbers in 0..1. Stretched so that the mirrors form a
    /// hemisphere, what they show fills a cap of the sphere evenly (Dupuy and Benyoub, *Sampling Visible GGX Normals with
    /// Spherical Caps*, 2023). The cap's axis is the frame's, so that nothing turns where the eye looks along the normal.
    #[inline(always)]
    pub fn sample(self, eye: Vec3<F>, u: F, v: F) -> Vec3<F> {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let eye = Vec3::new(self.alpha * eye.x, self.alpha * eye.y, eye.z).normalize();
        let half = eye + at_height(one - u * (one + eye.z), v);
        Vec3::new(self.alpha * half.x, self.alpha * half.y, half.z.max(zero))
            .normalize_or(Vec3::splat(DVec3::Z))
    }

    /// The density per steradian of directions `light` that mirror `eye` in normals from [`Microfacet::sample`]; 0 for
    /// an eye that is not above the surface.
    #[inline(always)]
    pub fn pdf(self, eye: Vec3<F>, light: Vec3<F>) -> F {
        let half = (eye + light).normalize_or(Vec3::splat(DVec3::Z));
        let pdf = self.normals(half) / ((F::splat(1.0) + self.hidden(eye)) * F::splat(4.0) * eye.z);
        F::select(F::splat(0.0).lt(eye.z), pdf, F::splat(0.0))
    }
}
