//! Rough surfaces as many small mirrors: the GGX distribution.
//!
//! All vectors are unit vectors in a frame whose z axis is the normal; `eye` and `light` lead away from the
//! surface. Walter et al., *Microfacet Models for Refraction through Rough Surfaces* (2007); Heitz,
//! *Understanding the Masking-Shadowing Function* (2014).

use crate::math::{DVec2, DVec3};
use crate::sampling::at_height;
use std::f64::consts::PI;

/// A distribution of small mirrors of width `alpha` (above 0): the square of what glTF calls roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacet {
    pub alpha: f64,
}

impl Microfacet {
    /// Density of small mirrors with the normal `half`, per solid angle and projected area.
    fn normals(self, half: DVec3) -> f64 {
        let a2 = self.alpha * self.alpha;
        // cos²θ (α² - 1) + 1 is a difference of nearly equal numbers at narrow peaks; this sum is not.
        let below = half.z * half.z * a2 + half.x * half.x + half.y * half.y;
        a2 / (PI * below * below)
    }

    /// Smith's Λ: hidden over visible small mirrors from direction `v`.
    fn hidden(self, v: DVec3) -> f64 {
        let tangent2 = (v.x * v.x + v.y * v.y) / (v.z * v.z);
        0.5 * ((1.0 + self.alpha * self.alpha * tangent2).sqrt() - 1.0)
    }

    /// The share of the light from `light` that goes to `eye`, times the cosine of the light's angle, without
    /// Fresnel's factor; the light above the surface. Masking and shadowing are correlated by height. An eye that is
    /// not above sees no mirror.
    pub fn reflected(self, eye: DVec3, light: DVec3) -> f64 {
        if eye.z <= 0.0 {
            return 0.0;
        }
        let half = (eye + light).normalize_or(DVec3::Z);
        let visible = 1.0 / (1.0 + self.hidden(eye) + self.hidden(light));
        self.normals(half) * visible / (4.0 * eye.z)
    }

    /// A small mirror's normal among those that `eye` sees. Stretched so that the mirrors form a hemisphere, what they
    /// show fills a cap of the sphere evenly (Dupuy and Benyoub, *Sampling Visible GGX Normals with Spherical Caps*,
    /// 2023). The cap's axis is the frame's, so that nothing turns where the eye looks along the normal.
    pub fn sample(self, eye: DVec3, u: DVec2) -> DVec3 {
        let eye = DVec3::new(self.alpha * eye.x, self.alpha * eye.y, eye.z).normalize();
        let half = eye + at_height(1.0 - u.x * (1.0 + eye.z), u.y);
        DVec3::new(self.alpha * half.x, self.alpha * half.y, half.z.max(0.0)).normalize_or(DVec3::Z)
    }

    /// The density of directions `light` that mirror `eye` in normals from [`Microfacet::sample`]; 0 for an eye
    /// that is not above the surface.
    pub fn density(self, eye: DVec3, light: DVec3) -> f64 {
        if eye.z <= 0.0 {
            return 0.0;
        }
        let half = (eye + light).normalize_or(DVec3::Z);
        self.normals(half) / ((1.0 + self.hidden(eye)) * 4.0 * eye.z)
    }
}
