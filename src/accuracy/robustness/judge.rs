//! What each way makes of the rays of a pixel.

use super::OFFSETS;
use super::bodies::{Body, Textbook, sound};
use super::rays::{Met, Scenery, Target};
use crate::accuracy::exact::Exact;
use crate::accuracy::hard_cases::real::{Machine, Real, V};
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::Probe;
use crate::trace::spawn::spawn_ray;

/// How rays to lights are started.
pub const START_NAMES: [&str; 5] = [
    "fixed offset 0.001, f32",
    "fixed offset 0.00001, f32",
    "fixed offset 0.001, f64",
    "fixed offset 0.00001, f64",
    "error bounds, f64 (Kinora)",
];

/// What the cheap way (a textbook in f32 with an offset of 0.001) makes wrong in a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blemish {
    /// The ray meets something else.
    WrongHit,
    /// The place shadows itself.
    FalseShadow,
    /// Something near casts no shadow.
    LostShadow,
}

/// What the ways make of the rays of a pixel.
#[derive(Default)]
pub struct PixelVerdict {
    pub rays: u32,
    /// As in the ways of hard cases.
    pub wrong_hits: [u32; 4],
    /// The same of the camera's ray alone.
    wrong_first: [bool; 4],
    /// None where nothing is lit.
    pub starts: Option<StartVerdict>,
    pub shade: f32,
}

#[derive(Default)]
pub struct StartVerdict {
    pub false_shadow: [bool; START_NAMES.len()],
    pub lost_shadow: [bool; START_NAMES.len()],
}

impl PixelVerdict {
    pub fn blemish(&self) -> Option<Blemish> {
        if self.wrong_first[0] {
            return Some(Blemish::WrongHit);
        }
        let starts = self.starts.as_ref()?;
        if starts.false_shadow[0] {
            return Some(Blemish::FalseShadow);
        }
        starts.lost_shadow[0].then_some(Blemish::LostShadow)
    }
}

/// How far from the truth a hit may be, as a share of its distance.
const OFF: f64 = 1e-3;

pub fn judge(scenery: &Scenery, pixel: u32, size: (u32, u32)) -> PixelVerdict {
    let ray = scenery.camera_ray((pixel % size.0, pixel / size.0), size);
    let mut verdict = PixelVerdict::default();
    let met = hits(scenery, &ray, 0.0, &mut verdict);
    verdict.wrong_first = verdict.wrong_hits.map(|wrong| wrong > 0);
    let Some(met) = met else { return verdict };
    verdict.shade = met.surface.normal.dot(ray.direction.normalize()).abs() as f32;
    let way = scenery.bounce(&met.surface, ray.origin, pixel);
    hits(scenery, &spawn_ray(&met.surface, way), OFFSETS[0], &mut verdict);
    if let Some(light) = scenery.light_for(&met.surface, ray.origin, pixel) {
        verdict.starts = Some(starts(scenery, &ray, &met, light));
    }
    verdict
}

/// Judges a ray, and gives what Kinora finds along it. All ways but Kinora's begin it so far from its origin.
fn hits(scenery: &Scenery, ray: &Ray, offset: f64, verdict: &mut PixelVerdict) -> Option<Met> {
    let near = scenery.near(ray, true);
    let met = scenery.met(ray);
    let exact = nearest::<Exact>(scenery, &near, ray, |body, o, d| body.hit(o, d, Exact::zero()));
    let ours = met.as_ref().map(|met| met.t);
    let begun = &Ray { origin: ray.at(offset), ..*ray };
    let [textbook, wide, stable] = [
        nearest::<f32>(scenery, &near, begun, |body, o, d| body.hit(o, d, 0.0).filter(sound)),
        nearest::<f64>(scenery, &near, begun, |body, o, d| body.hit(o, d, 0.0).filter(sound)),
        nearest::<f32>(scenery, &near, begun, |body, o, d| body.stable(o, d).filter(sound)),
    ]
    .map(|t| t.map(|t| t + offset));
    let found = [textbook, wide, stable, ours];
    verdict.rays += 1;
    for (wrong, found) in verdict.wrong_hits.iter_mut().zip(found) {
        let right = match (found, exact) {
            (Some(t), Some(exact)) => (t - exact).abs() <= OFF * exact,
            (found, exact) => found.is_some() == exact.is_some(),
        };
        *wrong += u32::from(!right);
    }
    met
}

fn nearest<R: Textbook>(
    scenery: &Scenery,
    near: &[Target],
    ray: &Ray,
    hit: impl Fn(&Body<R>, V<R>, V<R>) -> Option<R>,
) -> Option<f64> {
    let (origin, direction) = (V::of(ray.origin), V::of(ray.direction));
    let bodies = near.iter().filter_map(|&(index, part)| Body::new(scenery.primitive(index), part));
    bodies.filter_map(|body| hit(&body, origin, direction)).map(Real::wide).reduce(f64::min)
}

/// Judges how a ray to a light is started.
fn starts(scenery: &Scenery, ray: &Ray, met: &Met, light: DVec3) -> StartVerdict {
    let towards = Ray { origin: met.surface.point, direction: light - met.surface.point };
    let mut near = scenery.near(&towards, false);
    near.extend(scenery.own(met.target));
    near.sort_unstable();
    near.dedup();
    let exact = truly_blocked(scenery, &near, ray, met.target, light);
    let own = spawn_ray(&met.surface, light - met.surface.point);
    let own = Probe::new(Ray { direction: light - own.origin, ..own });
    let ours = near.iter().any(|&(index, _)| scenery.primitive(index).blocks(&own, 1.0));
    // What Kinora and twice the digits do not agree on is judged below, as all else is.
    let Some(exact) = exact else { return StartVerdict::default() };
    let of = |offset: f64, wide: bool| match wide {
        false => blocked::<f32>(scenery, &near, ray, met.target, light, offset),
        true => blocked::<f64>(scenery, &near, ray, met.target, light, offset),
    };
    let [large, small] = OFFSETS;
    let found = [of(large, false), of(small, false), of(large, true), of(small, true), Some(ours)];
    StartVerdict {
        false_shadow: found.map(|found| found == Some(true) && !exact),
        lost_shadow: found.map(|found| found == Some(false) && exact),
    }
}

/// Whether anything lies between the exact point and the light; none where the exact formula misses what Kinora hits.
fn truly_blocked(
    scenery: &Scenery,
    near: &[Target],
    ray: &Ray,
    target: Target,
    light: DVec3,
) -> Option<bool> {
    // Of the way to the light: far less than any offset, far more than what is left of the point's own root.
    const LEAST: f64 = 1e-12;
    let (origin, direction) = (V::<Exact>::of(ray.origin), V::of(ray.direction));
    let body = Body::<Exact>::new(scenery.primitive(target.0), target.1)?;
    let point = origin + direction * body.hit(origin, direction, Exact::zero())?;
    let way = V::of(light) - point;
    let blocks = |&(index, part): &Target| {
        let body = Body::<Exact>::new(scenery.primitive(index), part);
        body.and_then(|body| body.hit(point, way, Exact::of(LEAST))).is_some_and(|t| t < Exact::one())
    };
    Some(near.iter().any(blocks))
}

/// The textbook: the point as it comes, and whatever is further away than the offset. None where it misses the surface.
fn blocked<R: Textbook + Machine>(
    scenery: &Scenery,
    near: &[Target],
    ray: &Ray,
    target: Target,
    light: DVec3,
    offset: f64,
) -> Option<bool> {
    let (origin, direction) = (V::<R>::of(ray.origin), V::of(ray.direction));
    let body = Body::<R>::new(scenery.primitive(target.0), target.1)?;
    let t = body.hit(origin, direction, R::zero()).filter(sound)?;
    let point = origin + direction * t;
    let way = V::of(light) - point;
    let distance = way.length();
    let way = way * (R::one() / distance);
    let blocks = |&(index, part): &Target| {
        let body = Body::<R>::new(scenery.primitive(index), part);
        body.and_then(|body| body.hit(point, way, R::of(offset))).is_some_and(|t| t < distance)
    };
    Some(near.iter().any(blocks))
}
