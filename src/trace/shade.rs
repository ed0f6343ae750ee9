//! Local reflection: how much of a light's radiance a surface sends to the eye.
//!
//! What a surface scatters is counted in shares: π times its bidirectional reflectance times the cosine of the
//! light's angle, so that a facing light of radiance 1 on a surface of diffuse 1 gives radiance 1.

use crate::color::Rgb;
use crate::material::{Highlight, Lobes, Material};
use crate::math::DVec3;
use crate::optics::{Fuzz, Microfacet, reflect};
use crate::sampling::{Frame, cosine_hemisphere_density};
use crate::shape::Surface;
use std::f64::consts::PI;

/// Rough surfaces smoother than this are mirrors: their highlight is narrower than a tenth of a degree.
const SMOOTH: f32 = 0.01;

/// A point of a surface as the eye sees it.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    pub material: &'a Material,
    /// The material's lobes at the point.
    pub lobes: &'a Lobes,
    /// Turned towards the eye.
    pub surface: &'a Surface,
    /// Unit vector.
    pub to_eye: DVec3,
}

impl Seen<'_> {
    /// The normal to shade with: the smooth one, unless it faces away from the eye.
    pub fn normal(&self) -> DVec3 {
        let smooth = self.surface.shading;
        if smooth.dot(self.to_eye) > 0.0 { smooth } else { self.surface.normal }
    }

    /// The shares of the light from `to_light` (a unit vector) in what is scattered and in the highlight.
    /// Black when the light is behind the surface: then there is no highlight either.
    pub fn reflected(&self, to_light: DVec3) -> (Rgb, Rgb) {
        let normal = self.normal();
        let cosine = normal.dot(to_light);
        if cosine <= 0.0 || self.surface.normal.dot(to_light) <= 0.0 {
            return (Rgb::ZERO, Rgb::ZERO);
        }
        let mut scattered = self.lobes.diffuse * cosine as f32;
        if self.lobes.fuzz > 0.0 {
            let density = Fuzz(f64::from(self.lobes.fuzz)).density(self.mirrored(), to_light);
            scattered += self.lobes.mirror * (PI * density) as f32;
        }
        if self.lobes.microfacet > 0.0 {
            scattered += self.rough(to_light) * self.lobes.microfacet;
        }
        if self.lobes.specular == Rgb::ZERO {
            return (scattered, Rgb::ZERO);
        }
        (scattered, self.lobes.specular * self.highlight(to_light) as f32)
    }

    /// The direction in which a mirror shows the eye what it does.
    pub fn mirrored(&self) -> DVec3 {
        reflect(-self.to_eye, self.normal())
    }

    fn highlight(&self, to_light: DVec3) -> f64 {
        let cosine = match self.material.highlight {
            Highlight::Phong => self.mirrored().dot(to_light),
            Highlight::BlinnPhong => self.normal().dot((to_light + self.to_eye).normalize_or_zero()),
        };
        self.material.shininess.raise(cosine)
    }

    /// The distribution of the rough surface's small mirrors; none if it is smooth.
    pub fn microfacet(&self) -> Option<Microfacet> {
        let roughness = self.lobes.roughness;
        (roughness >= SMOOTH).then(|| Microfacet { alpha: f64::from(roughness) * f64::from(roughness) })
    }

    /// The share that small mirrors turned half way reflect, from the cosine of the angle to them (glTF 2.0,
    /// appendix B): Schlick's between the base colour of metals, or that of a boundary to the medium, and 1.
    pub fn metallic_fresnel(&self, cosine: f64) -> Rgb {
        let eta = self.material.medium.ior;
        let boundary = ((eta - 1.0) / (eta + 1.0) * (eta - 1.0) / (eta + 1.0)) as f32;
        let normal = Rgb::splat(boundary).lerp(self.lobes.base, self.lobes.metallic);
        normal + (Rgb::ONE - normal) * crate::optics::schlick(0.0, cosine) as f32
    }

    /// The metallic-roughness surface's share, without its strength.
    fn rough(&self, to_light: DVec3) -> Rgb {
        let half = (self.to_eye + to_light).normalize_or(self.normal());
        let fresnel = self.metallic_fresnel(self.to_eye.dot(half));
        let cosine = self.normal().dot(to_light);
        let below = self.rough_base() * (Rgb::ONE - fresnel) * cosine as f32;
        let Some(microfacet) = self.microfacet() else { return below };
        let frame = Frame::around(self.normal());
        let shine = microfacet.reflected(frame.to_local(self.to_eye), frame.to_local(to_light));
        below + fresnel * (PI * shine) as f32
    }

    /// What the metallic-roughness surface scatters from below its boundary, without Fresnel's factor.
    pub fn rough_base(&self) -> Rgb {
        self.lobes.base * (1.0 - self.lobes.metallic)
    }

    /// Density of cosine-weighted directions.
    pub fn diffuse_density(&self, direction: DVec3) -> f64 {
        cosine_hemisphere_density(self.normal().dot(direction))
    }
}
