//! Area lights.

use super::{LightSample, Receiver};
use crate::base::lanes::{Color, Mask, Real, Vec3};
use crate::geometry::shape::{Geometric, Rectangle, Sphere};

/// Samples a sphere, which emits outwards.
#[inline(always)]
pub fn sphere<F: Real>(
    sphere: &Sphere,
    at: &Receiver<F>,
    [u, v]: [F; 2],
    radiance: Color<F::F32>,
) -> LightSample<F> {
    let (surface, _, pdf) = sphere.sample_from(at.point, at.eye, u, v);
    // Points inside receive no light.
    let distance = (at.point - Vec3::splat(sphere.center)).length();
    let pdf = F::select(F::splat(sphere.radius).le(distance), pdf, F::splat(0.0));
    LightSample::from_surface(at, &surface, radiance, pdf)
}

/// Samples a rectangle, which emits to one side or both.
#[inline(always)]
pub fn rectangle<F: Real>(
    rectangle: &Rectangle,
    one_sided: bool,
    at: &Receiver<F>,
    [u, v]: [F; 2],
    radiance: Color<F::F32>,
) -> LightSample<F> {
    let (surface, _, pdf) = rectangle.sample_from(at.point, at.eye, u, v);
    let in_front = F::splat(0.0).lt(surface.normal.dot(at.point - surface.point));
    let shines = in_front | F::Mask::splat(!one_sided);
    LightSample::from_surface(at, &surface, radiance, F::select(shines, pdf, F::splat(0.0)))
}
