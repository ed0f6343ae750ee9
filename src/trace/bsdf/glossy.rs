//! Samples of the microfacets of a metallic-roughness surface, and of a coat.

use super::Bsdf;
use super::metallic::Metallic;
use crate::appearance::optics::reflect;
use crate::base::lanes::{Color, Real, Select, Vec3, out_of_line};
use crate::sampling::LocalFrame;

impl<F: Real> Bsdf<'_, F> {
    /// Samples a reflection at a microfacet of the surface below the coat, from two numbers in 0..1. If it is smooth,
    /// this is the ideal reflection.
    #[inline(always)]
    pub fn glossy_sample(&self, u: F, v: F) -> GlossySample<F> {
        sample(&self.metallic, self.to_eye, &self.frame, u, v)
    }

    /// The same of the coat.
    #[inline(always)]
    pub fn coat_sample(&self, u: F, v: F) -> GlossySample<F> {
        sample(&self.coat, self.to_eye, &self.frame, u, v)
    }
}

/// A sampled reflection at a microfacet.
#[derive(Clone, Copy)]
pub struct GlossySample<F: Real> {
    pub direction: Vec3<F>,
    /// The reflected share of light, over its density.
    pub share: Color<F::F32>,
    /// Lanes with a valid sample.
    pub is_drawn: F::Mask,
    /// Lanes whose surface is a sharp mirror. Their direction is [`Bsdf::mirrored`], not this one.
    pub is_smooth: F::Mask,
}

out_of_line! {
    fn sample<'k, F>(
        metallic: &'k Metallic<F>,
        to_eye: Vec3<F>,
        frame: &'k LocalFrame<F>,
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
