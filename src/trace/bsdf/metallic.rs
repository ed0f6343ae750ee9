//! The metallic-roughness surface (glTF 2.0, appendix B): a boundary of small mirrors over a diffuse base.

use super::Bsdf;
use crate::appearance::optics::{Microfacet, reflect, schlick};
use crate::base::lanes::{Color, Lookup, Real, Row, Select, Single, Vec3, out_of_line};
use crate::sampling::Frame;
use crate::trace::materials::{Column, LobeTable};
use std::f64::consts::PI;

/// Rough surfaces smoother than this are mirrors: their highlight is narrower than a tenth of a degree.
const SMOOTH: f32 = 0.01;

/// The parameters of the surface in each lane.
#[derive(Clone, Copy)]
pub struct Metallic<F: Real> {
    /// How much of the surface there is.
    pub strength: F::F32,
    base: Color<F::F32>,
    metallic: F::F32,
    roughness: F::F32,
    /// The share that a boundary to the medium reflects at right incidence.
    boundary: F::F32,
}

impl<F: Real> Metallic<F> {
    #[inline(always)]
    pub fn none() -> Self {
        let zero = F::F32::splat(0.0);
        Self { strength: zero, base: Color::black(), metallic: zero, roughness: zero, boundary: zero }
    }

    /// Of rows of a table, and indices of refraction.
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

    /// Lanes in which the small mirrors make one sharp one.
    #[inline(always)]
    pub fn is_smooth(&self) -> F::Mask {
        self.roughness.lt(F::F32::splat(SMOOTH))
    }

    /// The distribution of small mirrors; where the surface is smooth, of rough ones, for nobody to use.
    #[inline(always)]
    fn microfacet(&self) -> Microfacet<F> {
        let roughness = self.roughness.max(F::F32::splat(SMOOTH)).to_f64();
        Microfacet { alpha: roughness * roughness }
    }

    /// The share that small mirrors turned half way reflect, from the cosine of the angle to them: Schlick's between the
    /// base colour of metals, or that of a boundary to the medium, and 1.
    #[inline(always)]
    pub fn fresnel(&self, cosine: F) -> Color<F::F32> {
        let normal = Color::grey(self.boundary).lerp(self.base, self.metallic);
        let one = F::F32::splat(1.0);
        normal + (Color::grey(one) - normal) * schlick(F::splat(0.0), cosine).to_f32()
    }

    /// What the surface scatters from below its boundary, without Fresnel's factor.
    #[inline(always)]
    pub fn below(&self) -> Color<F::F32> {
        self.base * (F::F32::splat(1.0) - self.metallic)
    }

    /// The shares of light from below the boundary and from the small mirrors, where it is lit.
    #[inline(always)]
    pub fn share(
        &self,
        to_eye: Vec3<F>,
        frame: &Frame<F>,
        to_light: Vec3<F>,
    ) -> (Color<F::F32>, Color<F::F32>) {
        share(self, to_eye, frame, to_light)
    }

    /// The density per steradian of [`Bsdf::glossy_sample`]; 0 where the surface is smooth.
    #[inline(always)]
    pub fn pdf(&self, to_eye: Vec3<F>, frame: &Frame<F>, direction: Vec3<F>) -> F {
        pdf(self, to_eye, frame, direction)
    }
}

out_of_line! {
    fn share<'k, F>(
        metallic: &'k Metallic<F>,
        to_eye: Vec3<F>,
        frame: &'k Frame<F>,
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
    fn sample<'k, F>(
        metallic: &'k Metallic<F>,
        to_eye: Vec3<F>,
        frame: &'k Frame<F>,
        u: F,
        v: F,
    ) -> GlossySample<F> {
        let (eye, microfacet) = (frame.to_local(to_eye), metallic.microfacet());
        let half = microfacet.sample(eye, u, v);
        let light = reflect(-eye, half);
        let pdf = microfacet.pdf(eye, light);
        let is_drawn = F::splat(0.0).lt(light.z) & F::splat(0.0).lt(pdf);
        let share = microfacet.reflected(eye, light) / pdf;
        let share = metallic.fresnel(eye.dot(half)) * (share.to_f32() * metallic.strength);
        let is_smooth = metallic.is_smooth();
        let smooth = metallic.fresnel(frame.z.dot(to_eye)) * metallic.strength;
        let share = Color::select(is_smooth, smooth, share);
        GlossySample { direction: frame.to_world(light), share, is_drawn, is_smooth }
    }
}

out_of_line! {
    fn pdf<'k, F>(
        metallic: &'k Metallic<F>,
        to_eye: Vec3<F>,
        frame: &'k Frame<F>,
        direction: Vec3<F>,
    ) -> F {
        let zero = F::splat(0.0);
        let (eye, light) = (frame.to_local(to_eye), frame.to_local(direction));
        let pdf = metallic.microfacet().pdf(eye, light);
        F::select(zero.lt(light.z) & !metallic.is_smooth(), pdf, zero)
    }
}

impl<F: Real> Bsdf<'_, F> {
    /// The reflection in one of the surface's small mirrors for two numbers in 0..1, or in the one that it is where it is
    /// smooth.
    #[inline(always)]
    pub fn glossy_sample(&self, u: F, v: F) -> GlossySample<F> {
        sample(&self.metallic, self.to_eye, &self.frame, u, v)
    }
}

/// A reflection in a small mirror.
#[derive(Clone, Copy)]
pub struct GlossySample<F: Real> {
    pub direction: Vec3<F>,
    /// The share of the light from there that is reflected, over its density.
    pub share: Color<F::F32>,
    /// Where there is one.
    pub is_drawn: F::Mask,
    /// Lanes whose surface is one sharp mirror: then the direction is not this one.
    pub is_smooth: F::Mask,
}
