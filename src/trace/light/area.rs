//! Area lights.

use super::{LightSample, Receiver};
use crate::base::lanes::{Color, Real};
use crate::geometry::shape::{RectangleLanes, SphereLanes};

/// Samples spheres, which emit outwards; those of `both_sides` inwards, too.
#[inline(always)]
pub fn spheres<F: Real>(
    sphere: &SphereLanes<F>,
    both_sides: F::Mask,
    at: &Receiver<F>,
    [u, v]: [F; 2],
    radiance: Color<F::F32>,
) -> LightSample<F> {
    let (surface, pdf) = sphere.sample_from(at.point, at.eye, u, v);
    let is_outside = sphere.radius.le((at.point - sphere.center).length());
    let pdf = F::select(is_outside | both_sides, pdf, F::splat(0.0));
    LightSample::from_surface(at, &surface, radiance, pdf)
}

/// Samples rectangles, which emit to the side of their normal; those of `both_sides` to the other side, too. `per_area`
/// is 1 over their areas.
#[inline(always)]
pub fn rectangles<F: Real>(
    (rectangle, per_area): (&RectangleLanes<F>, F),
    both_sides: F::Mask,
    at: &Receiver<F>,
    [u, v]: [F; 2],
    radiance: Color<F::F32>,
) -> LightSample<F> {
    let surface = rectangle.sample_area(u, v);
    let pdf = surface.pdf_from(at.point, per_area);
    let in_front = F::splat(0.0).lt(surface.normal.dot(at.point - surface.point));
    LightSample::from_surface(at, &surface, radiance, F::select(in_front | both_sides, pdf, F::splat(0.0)))
}
