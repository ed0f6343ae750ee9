//! Rough surfaces as microfacets with the GGX distribution.
//!
//! All vectors are unit vectors in a frame whose z axis is the normal. `eye` and `light` point away from the surface.
//! Walter et al., *Microfacet Models for Refraction through Rough Surfaces* (2007); Heitz, *Understanding the
//! Masking-Shadowing Function* (2014).

use crate::base::lanes::{Real, Vec3};
use crate::base::math::DVec3;
use crate::sampling::direction_at_height;
use std::f64::consts::PI;

/// The GGX distribution of width `alpha`, above 0. `alpha` is the square of the roughness of glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacet<F> {
    pub alpha: F,
}

impl<F: Real> Microfacet<F> {
    /// D: the density of microfacets with the normal `half`, per steradian and projected area.
    #[inline(always)]
    fn normal_distribution(self, half: Vec3<F>) -> F {
        let a2 = self.alpha * self.alpha;
        // cos²θ (α² - 1) + 1 subtracts nearly equal numbers at narrow peaks. This sum does not.
        let below = half.z * half.z * a2 + half.x * half.x + half.y * half.y;
        a2 / (F::splat(PI) * below * below)
    }

    /// Smith's Λ: the ratio of masked to visible microfacets from direction `v`.
    #[inline(always)]
    fn lambda(self, v: Vec3<F>) -> F {
        let one = F::splat(1.0);
        let tangent2 = (v.x * v.x + v.y * v.y) / (v.z * v.z);
        F::splat(0.5) * ((one + self.alpha * self.alpha * tangent2).sqrt() - one)
    }

    /// The microfacet BRDF times the cosine of the light's angle, without Fresnel's factor, for light above the
    /// surface. Masking and shadowing are correlated by height. It is 0 if the eye is not above the surface.
    #[inline(always)]
    pub fn reflected(self, eye: Vec3<F>, light: Vec3<F>) -> F {
        let half = (eye + light).normalize_or(Vec3::splat(DVec3::Z));
        let visible = F::splat(1.0) / (F::splat(1.0) + self.lambda(eye) + self.lambda(light));
        let brdf = self.normal_distribution(half) * visible / (F::splat(4.0) * eye.z);
        F::select(F::splat(0.0).lt(eye.z), brdf, F::splat(0.0))
    }

    /// Samples the normal of a microfacet that `eye` sees, from two numbers in 0..1 (Dupuy and Benyoub, *Sampling
    /// Visible GGX Normals with Spherical Caps*, 2023). After a stretch that turns the microfacets into a hemisphere,
    /// reflected directions fill a spherical cap uniformly. The axis of the cap is the axis of the frame, so an eye
    /// along the normal needs no special case.
    #[inline(always)]
    pub fn sample(self, eye: Vec3<F>, u: F, v: F) -> Vec3<F> {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let eye = Vec3::new(self.alpha * eye.x, self.alpha * eye.y, eye.z).normalize();
        let half = eye + direction_at_height(one - u * (one + eye.z), v);
        Vec3::new(self.alpha * half.x, self.alpha * half.y, half.z.max(zero))
            .normalize_or(Vec3::splat(DVec3::Z))
    }

    /// The density per steradian of the directions `light` that reflect `eye` at normals from [`Microfacet::sample`].
    /// It is 0 if the eye is not above the surface.
    #[inline(always)]
    pub fn pdf(self, eye: Vec3<F>, light: Vec3<F>) -> F {
        let half = (eye + light).normalize_or(Vec3::splat(DVec3::Z));
        let pdf =
            self.normal_distribution(half) / ((F::splat(1.0) + self.lambda(eye)) * F::splat(4.0) * eye.z);
        F::select(F::splat(0.0).lt(eye.z), pdf, F::splat(0.0))
    }
}
