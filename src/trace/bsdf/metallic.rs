//! The metallic-roughness surface (glTF 2.0, appendix B): a boundary of microfacets over a diffuse base.

use crate::appearance::material::Coat;
use crate::appearance::optics::{Microfacet, schlick};
use crate::base::lanes::{Color, Lookup, Real, Row, Single, Vec3, out_of_line};
use crate::sampling::LocalFrame;
use crate::trace::materials::{Column, LobeTable};
use std::f64::consts::PI;

/// Surfaces with a lower roughness are sharp mirrors. Their highlight is narrower than a tenth of a degree.
const SMOOTH: f32 = 0.01;

/// The parameters of the surface in each lane.
#[derive(Clone, Copy)]
pub struct Metallic<F: Real> {
    /// The strength of the lobe.
    pub strength: F::F32,
    base: Color<F::F32>,
    metallic: F::F32,
    roughness: F::F32,
    /// The reflectance of a boundary to the medium at normal incidence.
    boundary: F::F32,
}

impl<F: Real> Metallic<F> {
    #[inline(always)]
    pub fn none() -> Self {
        let zero = F::F32::splat(0.0);
        Self { strength: zero, base: Color::black(), metallic: zero, roughness: zero, boundary: zero }
    }

    /// Gathers the parameters from rows of a table, with indices of refraction.
    #[inline(always)]
    pub fn gather(table: &LobeTable, at: &Lookup, ior: F) -> Self {
        let ratio = (ior - F::splat(1.0)) / (ior + F::splat(1.0));
        Self {
            strength: table.number(Column::MICROFACET, at),
            base: table.color(Column::BASE, at),
            metallic: table.number(Column::METALLIC, at),
            roughness: table.number(Column::ROUGHNESS, at),
            boundary: (ratio * ratio).to_f32(),
        }
    }

    /// The boundary of a clear coat without a base: of the index of refraction 1.5, as in `KHR_materials_clearcoat`.
    #[inline(always)]
    pub fn coat(strength: F::F32, roughness: F::F32) -> Self {
        let zero = F::F32::splat(0.0);
        let boundary = F::F32::splat(Coat::REFLECTANCE);
        Self { strength, base: Color::black(), metallic: zero, roughness, boundary }
    }

    /// Lanes whose surface is a sharp mirror.
    #[inline(always)]
    pub fn is_smooth(&self) -> F::Mask {
        self.roughness.lt(F::F32::splat(SMOOTH))
    }

    /// The distribution of microfacets. In smooth lanes it has the least roughness, and its results are not used.
    #[inline(always)]
    pub fn microfacet(&self) -> Microfacet<F> {
        let roughness = self.roughness.max(F::F32::splat(SMOOTH)).to_f64();
        Microfacet { alpha: roughness * roughness }
    }

    /// The reflectance of microfacets, from the cosine of the angle to them. It is Schlick's approximation between the
    /// reflectance at normal incidence (the base colour of metals, else that of a boundary to the medium) and 1.
    #[inline(always)]
    pub fn fresnel(&self, cosine: F) -> Color<F::F32> {
        let normal = Color::grey(self.boundary).lerp(self.base, self.metallic);
        let one = F::F32::splat(1.0);
        normal + (Color::grey(one) - normal) * schlick(F::splat(0.0), cosine).to_f32()
    }

    /// The diffuse albedo below the boundary, without Fresnel's factor.
    #[inline(always)]
    pub fn below(&self) -> Color<F::F32> {
        self.base * (F::F32::splat(1.0) - self.metallic)
    }

    /// The shares of light from the diffuse base and from the microfacets, for directions that light the surface.
    #[inline(always)]
    pub fn share(
        &self,
        to_eye: Vec3<F>,
        frame: &LocalFrame<F>,
        to_light: Vec3<F>,
    ) -> (Color<F::F32>, Color<F::F32>) {
        share(self, to_eye, frame, to_light)
    }

    /// The share of light that is not reflected at the boundary as a whole, from the cosine of the angle to the normal.
    #[inline(always)]
    pub fn passed(&self, cosine: F) -> F::F32 {
        F::F32::splat(1.0) - self.fresnel(cosine).r * self.strength
    }

    /// The density per steradian of [`Bsdf::glossy_sample`](super::Bsdf::glossy_sample). It is 0 if the surface is
    /// smooth.
    #[inline(always)]
    pub fn pdf(&self, to_eye: Vec3<F>, frame: &LocalFrame<F>, direction: Vec3<F>) -> F {
        pdf(self, to_eye, frame, direction)
    }
}

out_of_line! {
    fn share<'k, F>(
        metallic: &'k Metallic<F>,
        to_eye: Vec3<F>,
        frame: &'k LocalFrame<F>,
        to_light: Vec3<F>,
    ) -> (Color<F::F32>, Color<F::F32>) {
        let normal = frame.z;
        let half = (to_eye + to_light).normalize_or(normal);
        let fresnel = metallic.fresnel(to_eye.dot(half));
        let one = Color::grey(F::F32::splat(1.0));
        let below = metallic.below() * (one - fresnel) * normal.dot(to_light).to_f32();
        let glossy = metallic.microfacet().reflected(frame.to_local(to_eye), frame.to_local(to_light));
        let glossy = F::select(metallic.is_smooth(), F::splat(0.0), F::splat(PI) * glossy);
        (below * metallic.strength, fresnel * glossy.to_f32() * metallic.strength)
    }
}

out_of_line! {
    fn pdf<'k, F>(
        metallic: &'k Metallic<F>,
        to_eye: Vec3<F>,
        frame: &'k LocalFrame<F>,
        direction: Vec3<F>,
    ) -> F {
        let zero = F::splat(0.0);
        let (eye, light) = (frame.to_local(to_eye), frame.to_local(direction));
        let pdf = metallic.microfacet().pdf(eye, light);
        F::select(zero.lt(light.z) & !metallic.is_smooth(), pdf, zero)
    }
}
