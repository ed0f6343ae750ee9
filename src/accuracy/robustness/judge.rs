//! Compares the results of each method on the rays of a pixel with the true ones.

use super::rays::{SceneRays, SurfaceHit, Target};
use super::textbook::{TextbookNumber, TextbookShape, is_finite};
use crate::accuracy::hard_cases::number::{Float, Number, Vector3};
use crate::base::math::exact::Exact;
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::trace::spawn::spawn_ray;

/// The usual fixed offsets of shadow rays, in the scene's units.
pub const OFFSETS: [f64; 2] = [1e-3, 1e-5];

/// The methods that choose the origin of shadow rays.
pub const ORIGIN_METHODS: [&str; 5] = [
    "fixed offset 0.001, f32",
    "fixed offset 0.00001, f32",
    "fixed offset 0.001, f64",
    "fixed offset 0.00001, f64",
    "error bounds, f64 (Kinora)",
];

/// The error of the cheap method (textbook formulas in f32, an offset of 0.001) in a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelError {
    /// The camera ray has a wrong hit.
    WrongHit,
    /// A lit point is shadowed by its own or a neighbouring surface.
    FalseShadow,
    /// A nearby surface casts no shadow.
    LostShadow,
}

/// The errors of all methods on the rays of a pixel.
#[derive(Default)]
pub struct PixelVerdict {
    pub rays: u32,
    /// Wrong hits of each method of the hard cases.
    pub wrong_hits: [u32; 4],
    /// Whether the camera ray has a wrong hit.
    wrong_first: [bool; 4],
    /// `None` if no shadow ray is traced.
    pub starts: Option<ShadowVerdict>,
    pub shade: f32,
}

#[derive(Default)]
pub struct ShadowVerdict {
    pub false_shadow: [bool; ORIGIN_METHODS.len()],
    pub lost_shadow: [bool; ORIGIN_METHODS.len()],
}

impl PixelVerdict {
    pub fn error(&self) -> Option<PixelError> {
        if self.wrong_first[0] {
            return Some(PixelError::WrongHit);
        }
        let starts = self.starts.as_ref()?;
        if starts.false_shadow[0] {
            return Some(PixelError::FalseShadow);
        }
        starts.lost_shadow[0].then_some(PixelError::LostShadow)
    }
}

/// Hits with a larger relative error of t count as wrong.
const WRONG_HIT: f64 = 1e-3;

pub fn judge(rays: &SceneRays, pixel: u32, size: (u32, u32)) -> PixelVerdict {
    let ray = rays.camera_ray((pixel % size.0, pixel / size.0), size);
    let mut verdict = PixelVerdict::default();
    let hit = hits(rays, &ray, 0.0, &mut verdict);
    verdict.wrong_first = verdict.wrong_hits.map(|wrong| wrong > 0);
    let Some(hit) = hit else { return verdict };
    verdict.shade = hit.surface.normal.dot(ray.direction.normalize()).abs() as f32;
    let way = rays.bounce(&hit.surface, ray.origin, pixel);
    hits(rays, &spawn_ray(&hit.surface, way), OFFSETS[0], &mut verdict);
    if let Some(light) = rays.light_for(&hit.surface, ray.origin, pixel) {
        verdict.starts = Some(judge_shadow_rays(rays, &ray, &hit, light));
    }
    verdict
}

/// Compares the hits of all methods along a ray, and returns Kinora's. The other methods start the ray at t = `offset`.
fn hits(rays: &SceneRays, ray: &Ray, offset: f64, verdict: &mut PixelVerdict) -> Option<SurfaceHit> {
    let near = rays.candidates(ray, true);
    let hit = rays.closest_hit(ray);
    let exact = nearest::<Exact>(rays, &near, ray, |shape, o, d| shape.hit(o, d, Exact::zero()));
    let ours = hit.as_ref().map(|hit| hit.t);
    let begun = &Ray { origin: ray.at(offset), ..*ray };
    let [textbook, wide, stable] = [
        nearest::<f32>(rays, &near, begun, |shape, o, d| shape.hit(o, d, 0.0).filter(is_finite)),
        nearest::<f64>(rays, &near, begun, |shape, o, d| shape.hit(o, d, 0.0).filter(is_finite)),
        nearest::<f32>(rays, &near, begun, |shape, o, d| shape.stable(o, d).filter(is_finite)),
    ]
    .map(|t| t.map(|t| t + offset));
    let found = [textbook, wide, stable, ours];
    verdict.rays += 1;
    for (wrong, found) in verdict.wrong_hits.iter_mut().zip(found) {
        let right = match (found, exact) {
            (Some(t), Some(exact)) => (t - exact).abs() <= WRONG_HIT * exact,
            (found, exact) => found.is_some() == exact.is_some(),
        };
        *wrong += u32::from(!right);
    }
    hit
}

fn nearest<R: TextbookNumber>(
    rays: &SceneRays,
    near: &[Target],
    ray: &Ray,
    hit: impl Fn(&TextbookShape<R>, Vector3<R>, Vector3<R>) -> Option<R>,
) -> Option<f64> {
    let (origin, direction) = (Vector3::of(ray.origin), Vector3::of(ray.direction));
    let shapes = near.iter().filter_map(|&(index, part)| TextbookShape::new(rays.primitive(index), part));
    shapes.filter_map(|shape| hit(&shape, origin, direction)).map(Number::wide).reduce(f64::min)
}

/// Compares the results of all shadow-ray origins.
fn judge_shadow_rays(rays: &SceneRays, ray: &Ray, hit: &SurfaceHit, light: DVec3) -> ShadowVerdict {
    let towards = Ray { origin: hit.surface.point, direction: light - hit.surface.point };
    let mut near = rays.candidates(&towards, false);
    near.extend(rays.neighbours(hit.target));
    near.sort_unstable();
    near.dedup();
    let exact = truly_blocked(rays, &near, ray, hit.target, light);
    let own = spawn_ray(&hit.surface, light - hit.surface.point);
    let own = TraversalRay::new(Ray { direction: light - own.origin, ..own });
    let ours = near.iter().any(|&(index, _)| rays.primitive(index).occludes_up_to(&own, 1.0));
    // `None` if double-double arithmetic misses the surface that Kinora hits; `hits` has already counted that.
    let Some(exact) = exact else { return ShadowVerdict::default() };
    let of = |offset: f64, wide: bool| match wide {
        false => blocked::<f32>(rays, &near, ray, hit.target, light, offset),
        true => blocked::<f64>(rays, &near, ray, hit.target, light, offset),
    };
    let [large, small] = OFFSETS;
    let found = [of(large, false), of(small, false), of(large, true), of(small, true), Some(ours)];
    ShadowVerdict {
        false_shadow: found.map(|found| found == Some(true) && !exact),
        lost_shadow: found.map(|found| found == Some(false) && exact),
    }
}

/// Whether a shape is between the exact point and the light; `None` if the exact formula misses the surface that Kinora
/// hits.
fn truly_blocked(rays: &SceneRays, near: &[Target], ray: &Ray, target: Target, light: DVec3) -> Option<bool> {
    // Minimum t, relative to the distance of the light: far less than any offset, far more than the error of the
    // point's own root.
    const LEAST: f64 = 1e-12;
    let (origin, direction) = (Vector3::<Exact>::of(ray.origin), Vector3::of(ray.direction));
    let shape = TextbookShape::<Exact>::new(rays.primitive(target.0), target.1)?;
    let point = origin + direction * shape.hit(origin, direction, Exact::zero())?;
    let way = Vector3::of(light) - point;
    let blocks = |&(index, part): &Target| {
        let shape = TextbookShape::<Exact>::new(rays.primitive(index), part);
        shape.and_then(|shape| shape.hit(point, way, Exact::of(LEAST))).is_some_and(|t| t < Exact::one())
    };
    Some(near.iter().any(blocks))
}

/// The textbook's shadow test: the computed point, and only hits farther away than the offset. `None` if the camera
/// ray misses the surface.
fn blocked<R: TextbookNumber + Float>(
    rays: &SceneRays,
    near: &[Target],
    ray: &Ray,
    target: Target,
    light: DVec3,
    offset: f64,
) -> Option<bool> {
    let (origin, direction) = (Vector3::<R>::of(ray.origin), Vector3::of(ray.direction));
    let shape = TextbookShape::<R>::new(rays.primitive(target.0), target.1)?;
    let t = shape.hit(origin, direction, R::zero()).filter(is_finite)?;
    let point = origin + direction * t;
    let way = Vector3::of(light) - point;
    let distance = way.length();
    let way = way * (R::one() / distance);
    let blocks = |&(index, part): &Target| {
        let shape = TextbookShape::<R>::new(rays.primitive(index), part);
        shape.and_then(|shape| shape.hit(point, way, R::of(offset))).is_some_and(|t| t < distance)
    };
    Some(near.iter().any(blocks))
}
