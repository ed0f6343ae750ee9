//! Light on its way to surfaces: from where, how much, and with what density it was asked for.
//!
//! Light is measured such that a light of radiance 1 facing a surface of diffuse 1 gives radiance 1. For light from an
//! area, [`LightSample::radiance`] is its radiance over π and the density with which its direction was drawn.

mod area;
mod punctual;
mod sampler;
mod sky;

pub use sampler::{LightRequest, LightSampler};

use super::spawn::{spawn, spawn_gathering};
use crate::appearance::light::{Light, Source};
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Mask, Real, Select, Vec3};
use crate::base::math::{DVec3, LaneRay};
use crate::geometry::shape::LaneSurface;
use crate::sampling::Frame;
use std::f64::consts::PI;

/// Points that light is sampled for.
#[derive(Clone, Copy)]
pub struct Receiver<'a, F> {
    pub point: Vec3<F>,
    /// The frame around the direction to the eye.
    pub eye: &'a Frame<F>,
    /// What rounding may do to a point of any surface, at most, as a length.
    pub rounding: f64,
}

/// Light that would reach a point in each lane if nothing stood in its way.
#[derive(Clone, Copy)]
pub struct LightSample<F: Real> {
    /// Unit vector towards where it comes from.
    pub direction: Vec3<F>,
    /// What the share that the surface reflects is multiplied with.
    pub radiance: Color<F::F32>,
    /// Density per steradian with which the direction was drawn; 0 if there was no choice.
    pub pdf: F,
    /// Where shadow rays end; of light from infinitely far away, anything.
    pub end: Vec3<F>,
    pub is_distant: F::Mask,
    /// Where light comes at all.
    pub is_lit: F::Mask,
}

/// Shadow rays, and the t before which nothing may stand.
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
            is_lit: no,
        }
    }

    /// From points, where each has a share of its light for the surface.
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

    /// From points of surfaces, drawn with these densities per steradian; none where that is 0.
    #[inline(always)]
    pub fn from_surface(at: &Receiver<F>, surface: &LaneSurface<F>, radiance: Color<F::F32>, pdf: F) -> Self {
        let way = surface.point - at.point;
        // Past what other surfaces may reach to that the light is set into.
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

    /// From infinitely far away, drawn with these densities; 0 where there was no choice.
    #[inline(always)]
    fn distant(direction: Vec3<F>, radiance: Color<F::F32>, pdf: F) -> Self {
        let all = F::Mask::splat(true);
        Self { direction, radiance, pdf, is_distant: all, is_lit: all, ..Self::none() }
    }

    /// The same light, from sources that are asked only with this chance.
    #[inline(always)]
    pub fn with_chance(self, chance: F) -> Self {
        let radiance = self.radiance * (F::splat(1.0) / chance).to_f32();
        Self { radiance, pdf: self.pdf * chance, ..self }
    }

    /// How far the light comes to a point.
    #[inline(always)]
    pub fn distance(&self, from: Vec3<F>) -> F {
        F::select(self.is_distant, F::splat(f64::INFINITY), (self.end - from).length())
    }

    /// The rays from surfaces to where the light comes from. Those at the light itself have no direction.
    #[inline(always)]
    pub fn shadow_ray(&self, surface: &LaneSurface<F>) -> ShadowRay<F> {
        let towards = Vec3::select(self.is_distant, self.direction, self.end - surface.point);
        let origin = spawn_gathering(surface, towards).origin;
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
            is_lit: (mask & yes.is_lit) | (!mask & no.is_lit),
        }
    }
}

/// The light that comes from a light to points, for u and v in 0..1 if it [has to be drawn](Source::is_sampled).
#[inline(always)]
pub fn sample_light<F: Real>(light: &Light, at: &Receiver<F>, [u, v]: [F; 2]) -> LightSample<F> {
    let radiance = Color::splat(light.radiance);
    match &light.source {
        Source::Point { position, attenuation } => {
            punctual::point(*position, attenuation, at.point, radiance)
        }
        Source::Spot { position, cone, attenuation } => {
            punctual::spot(*position, cone, attenuation, at.point, radiance)
        }
        Source::Directional { to_light } => {
            LightSample::distant(Vec3::splat(*to_light), radiance, F::splat(0.0))
        }
        Source::Sphere(sphere) => area::sphere(sphere, at, [u, v], radiance),
        Source::Rectangle { rectangle, one_sided } => {
            area::rectangle(rectangle, *one_sided, at, [u, v], radiance)
        }
    }
}

/// The radiance of a light that is part of the geometry where it is seen; `outside` are the lanes that see it from the
/// side that its normal is on.
#[inline(always)]
pub fn seen_radiance<F: Real>(light: &Light, outside: F::Mask) -> Color<F::F32> {
    let shines = match light.source {
        Source::Sphere(_) => outside,
        Source::Rectangle { one_sided: true, .. } => outside,
        Source::Rectangle { one_sided: false, .. } => F::Mask::splat(true),
        Source::Point { .. } | Source::Spot { .. } | Source::Directional { .. } => F::Mask::splat(false),
    };
    Color::select(shines, Color::splat(light.radiance), Color::splat(Rgb::ZERO))
}
