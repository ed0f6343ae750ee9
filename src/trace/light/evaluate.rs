//! Single lights: samples of their light, and their radiance where paths hit them.

use super::{LightSample, Receiver, area, punctual};
use crate::appearance::light::{Light, Source};
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Mask, Real, Select, Vec3};
use crate::base::math::DVec3;
use crate::geometry::shape::{Rectangle, RectangleLanes, SphereLanes};

/// What all samples of a rectangle have in common.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// The unit normal.
    pub normal: DVec3,
    /// 1 over the area.
    pub per_area: f64,
}

impl Face {
    pub fn new(rectangle: &Rectangle) -> Self {
        Self { normal: rectangle.normal(), per_area: 1.0 / rectangle.u.cross(rectangle.v).length() }
    }

    /// The face of a light; of no meaning for other lights than rectangles.
    pub fn of_light(light: &Light) -> Self {
        match &light.source {
            Source::Rectangle { rectangle, .. } => Self::new(rectangle),
            _ => Self { normal: DVec3::Y, per_area: 0.0 },
        }
    }
}

/// Samples the light of one light at points. Only [sampled](Source::is_sampled) lights use u and v, which are in 0..1.
#[inline(always)]
pub fn sample_light<F: Real>(
    (light, face): (&Light, &Face),
    at: &Receiver<F>,
    [u, v]: [F; 2],
) -> LightSample<F> {
    let radiance = Color::splat(light.radiance);
    let sample = match &light.source {
        Source::Point { position, attenuation } => {
            punctual::point(*position, attenuation, at.point, radiance)
        }
        Source::Spot { position, cone, attenuation } => {
            punctual::spot(*position, cone, attenuation, at.point, radiance)
        }
        Source::Directional { to_light } => {
            LightSample::distant(Vec3::splat(*to_light), radiance, F::splat(0.0))
        }
        Source::Sphere(sphere) => {
            area::spheres(&SphereLanes::splat(sphere), F::Mask::splat(false), at, [u, v], radiance)
        }
        Source::Rectangle { rectangle, one_sided } => {
            let lanes = RectangleLanes::with_normal(rectangle, face.normal);
            area::rectangles(
                (&lanes, F::splat(face.per_area)),
                F::Mask::splat(!one_sided),
                at,
                [u, v],
                radiance,
            )
        }
    };
    LightSample { casts_shadows: F::Mask::splat(light.shadows), ..sample }
}

/// The radiance of a light that is part of the geometry, where paths hit it. `outside` are the lanes on the side of its
/// normal.
#[inline(always)]
pub fn emitted_radiance<F: Real>(light: &Light, outside: F::Mask) -> Color<F::F32> {
    let shines = match light.source {
        Source::Sphere(_) => outside,
        Source::Rectangle { one_sided: true, .. } => outside,
        Source::Rectangle { one_sided: false, .. } => F::Mask::splat(true),
        Source::Point { .. } | Source::Spot { .. } | Source::Directional { .. } => F::Mask::splat(false),
    };
    Color::select(shines, Color::splat(light.radiance), Color::splat(Rgb::ZERO))
}
