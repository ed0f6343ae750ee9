//! Lights at one point.

use super::LightSample;
use crate::appearance::light::{Attenuation, SpotCone};
use crate::base::lanes::{Color, Real, Vec3};
use crate::base::math::DVec3;

/// A light that is the same in all directions.
#[inline(always)]
pub fn point<F: Real>(
    position: DVec3,
    attenuation: &Attenuation,
    at: Vec3<F>,
    radiance: Color<F::F32>,
) -> LightSample<F> {
    let position = Vec3::splat(position);
    let share = attenuation.share((position - at).length());
    LightSample::from_point(at, position, radiance, share)
}

/// A light with a cone.
#[inline(always)]
pub fn spot<F: Real>(
    position: DVec3,
    cone: &SpotCone,
    attenuation: &Attenuation,
    at: Vec3<F>,
    radiance: Color<F::F32>,
) -> LightSample<F> {
    let position = Vec3::splat(position);
    let way = position - at;
    let cosine = -way.normalize_or(Vec3::zero()).dot(Vec3::splat(cone.axis));
    let share = attenuation.share(way.length()) * cone.share(cosine);
    LightSample::from_point(at, position, radiance, share)
}
