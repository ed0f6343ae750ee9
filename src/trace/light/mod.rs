//! Sampling of light for next-event estimation: direction, radiance and density.
//!
//! The unit of light: a light of radiance 1 gives radiance 1 on a facing surface of diffuse 1. For light from an area,
//! [`LightSample::radiance`] is its radiance over π and the density of its direction.

mod area;
mod area_table;
mod cluster;
mod emission;
mod evaluate;
mod importance;
mod punctual;
mod sampled_emitter;
mod sampler;
mod source_choice;
mod source_group;
mod sky;

pub use evaluate::emitted_radiance;
pub use sampler::{LightSampler, Scattering};
pub use source_group::LightRequest;

use super::spawn::{spawn, spawn_lifted};
use crate::base::lanes::{Color, Mask, Real, Select, Vec3};
use crate::base::math::{DVec3, LaneRay};
use crate::geometry::shape::LaneSurface;
use crate::sampling::FrameAxes;
use std::f64::consts::PI;

/// The points that receive light.
#[derive(Clone, Copy)]
pub struct Receiver<'a, F> {
    pub point: Vec3<F>,
    /// The axes around the direction to the eye.
    pub eye: &'a FrameAxes<F>,
    /// The largest rounding error of a point of any surface, as a length.
    pub rounding: f64,
}

/// A light sample in each lane, without occlusion.
#[derive(Clone, Copy)]
pub struct LightSample<F: Real> {
    /// Unit vector towards the light.
    pub direction: Vec3<F>,
    /// The factor of the share that the surface reflects.
    pub radiance: Color<F::F32>,
    /// The density per steradian of the direction; 0 for a delta distribution.
    pub pdf: F,
    /// The end of the shadow ray; arbitrary for distant light.
    pub end: Vec3<F>,
    pub is_distant: F::Mask,
    /// Lanes whose light objects may block.
    pub casts_shadows: F::Mask,
    /// Lanes that receive light.
    pub is_lit: F::Mask,
}

/// Shadow rays, and the t up to which nothing may block them.
#[derive(Clone, Copy)]
pub struct ShadowRay<F> {
    pub ray: LaneRay<F>,
    pub t_max: F,
}

impl<F: Real> LightSample<F> {
    #[inline(always)]
    pub fn none() -> Self {
        let no = F::Mask::splat(false);
        Self {
            direction: Vec3::splat(DVec3::Y),
            radiance: Color::black(),
            pdf: F::splat(0.0),
            end: Vec3::zero(),
            is_distant: no,
            casts_shadows: F::Mask::splat(true),
            is_lit: no,
        }
    }

    /// Light from points, of which this share arrives.
    #[inline(always)]
    fn from_point(at: Vec3<F>, position: Vec3<F>, radiance: Color<F::F32>, share: F) -> Self {
        Self {
            direction: (position - at).normalize_or(Vec3::zero()),
            radiance: radiance * share.to_f32(),
            end: position,
            is_lit: F::splat(0.0).lt(share),
            ..Self::none()
        }
    }

    /// Light from points of surfaces, sampled with these densities per steradian. Lanes of density 0 get no light.
    #[inline(always)]
    pub fn from_surface(at: &Receiver<F>, surface: &LaneSurface<F>, radiance: Color<F::F32>, pdf: F) -> Self {
        let way = surface.point - at.point;
        // The error bound covers the rounding of other surfaces into which the light may be set.
        let rounding = F::splat(at.rounding);
        let reach = Vec3::new(rounding, rounding, rounding);
        let surface = LaneSurface { error: surface.error.max(reach), ..*surface };
        let each = (F::splat(1.0) / (F::splat(PI) * pdf)).to_f32();
        Self {
            direction: way.normalize_or(Vec3::zero()),
            radiance: radiance * each,
            pdf,
            end: spawn(&surface, -way).origin,
            is_lit: F::splat(0.0).lt(pdf),
            ..Self::none()
        }
    }

    /// Light from infinitely far away, sampled with these densities; 0 for a delta distribution.
    #[inline(always)]
    fn distant(direction: Vec3<F>, radiance: Color<F::F32>, pdf: F) -> Self {
        let all = F::Mask::splat(true);
        Self { direction, radiance, pdf, is_distant: all, is_lit: all, ..Self::none() }
    }

    /// The same light, from sources that are chosen with this probability.
    #[inline(always)]
    pub fn with_chance(self, chance: F) -> Self {
        let radiance = self.radiance * (F::splat(1.0) / chance).to_f32();
        Self { radiance, pdf: self.pdf * chance, ..self }
    }

    /// The distance of the light from a point.
    #[inline(always)]
    pub fn distance(&self, from: Vec3<F>) -> F {
        F::select(self.is_distant, F::splat(f64::INFINITY), (self.end - from).length())
    }

    /// The shadow rays from surfaces to the light. If the surface is at the light, the ray has no direction.
    #[inline(always)]
    pub fn shadow_ray(&self, surface: &LaneSurface<F>) -> ShadowRay<F> {
        let towards = Vec3::select(self.is_distant, self.direction, self.end - surface.point);
        let origin = spawn_lifted(surface, towards).origin;
        let direction = Vec3::select(self.is_distant, self.direction, self.end - origin);
        let t_max = F::select(self.is_distant, F::splat(f64::INFINITY), F::splat(1.0));
        ShadowRay { ray: LaneRay { origin, direction }, t_max }
    }
}

impl<F: Real> Select<F::Mask> for LightSample<F> {
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            direction: Vec3::select(mask, yes.direction, no.direction),
            radiance: Color::select(mask, yes.radiance, no.radiance),
            pdf: F::select(mask, yes.pdf, no.pdf),
            end: Vec3::select(mask, yes.end, no.end),
            is_distant: (mask & yes.is_distant) | (!mask & no.is_distant),
            casts_shadows: (mask & yes.casts_shadows) | (!mask & no.casts_shadows),
            is_lit: (mask & yes.is_lit) | (!mask & no.is_lit),
        }
    }
}
