//! Shadow rays: how much of a light arrives in spite of what stands in the way.

use super::coincident::Crossed;
use super::lights::{Arrival, Origin};
use super::media::Media;
use super::tracer::{Face, Met, Tracer, Work};
use crate::camera::Ray;
use crate::color::Rgb;
use crate::material::{Lobes, Medium};
use crate::math::DVec3;
use crate::shape::Surface;
use crate::tree::Probe;

/// Surfaces that a shadow ray passes at most; what lies behind more is in shadow. Each one brings the ray nearer to
/// its light, so it ends by itself: this bounds how long that takes, and whatever rounding might do against it.
pub const PASSED: u32 = 4096;

/// The share of a light that arrives in spite of what stands in the way.
#[derive(Clone, Copy, Debug)]
pub struct Passing {
    pub whole: Rgb,
    /// The part of it that has passed nothing by refraction.
    pub unbent: Rgb,
}

impl Passing {
    fn all_or_nothing(blocked: bool) -> Self {
        let share = if blocked { Rgb::ZERO } else { Rgb::ONE };
        Self { whole: share, unbent: share }
    }

    fn absorb(&mut self, medium: Medium, length: f64) {
        let left = medium.transmittance(length);
        self.dim(left, left);
    }

    fn dim(&mut self, whole: Rgb, unbent: Rgb) {
        self.whole *= whole;
        self.unbent *= unbent;
    }
}

impl Tracer<'_> {
    /// The share of the light that arrives at a surface, on its side that is seen, in spite of what stands in
    /// the way.
    pub fn passing(&self, arrival: &Arrival, surface: &Surface, media: &Media, work: &mut Work) -> Passing {
        let (ray, t_max) = arrival.shadow_ray(surface);
        if ray.direction == DVec3::ZERO {
            return Passing::all_or_nothing(false);
        }
        work.counts.rays.shadow += 1;
        if !self.clear {
            let mut passing =
                Passing::all_or_nothing(self.bvh.occluded(self.scene.geometry, &Probe::new(ray), t_max));
            if self.media {
                passing.absorb(media.here(&self.scene.shading.materials), ray.direction.length() * t_max);
            }
            return passing;
        }
        self.transmitted(arrival, ray, t_max, *media, work)
    }

    /// [`Tracer::passing`] surface by surface: the product of what each of them lets pass.
    fn transmitted(
        &self,
        arrival: &Arrival,
        mut ray: Ray,
        mut t_max: f64,
        mut media: Media,
        work: &mut Work,
    ) -> Passing {
        let mut share = Passing::all_or_nothing(false);
        let mut crossed: Option<Crossed> = None;
        for _ in 0..=PASSED {
            if let Some(Met::Surface(face)) = self.lying_in(crossed.as_ref(), 0.0) {
                let (passes, beyond) = self.straight_through(&face, arrival, media);
                share.dim(passes.whole, passes.unbent);
                media = beyond;
                if share.whole == Rgb::ZERO {
                    return share;
                }
                crossed = Some(face.crossed(crossed, arrival.direction));
                continue;
            }
            let hit = self.bvh.closest_before(self.scene.geometry, &Probe::new(ray), t_max);
            let length = ray.direction.length() * hit.map_or(t_max, |hit| hit.at.t);
            if self.media {
                share.absorb(media.here(&self.scene.shading.materials), length);
            }
            let Some(hit) = hit else { return share };
            let Met::Surface(face) = self.met(&ray, hit, 0.0) else { break };
            work.counts.evaluations.paint += u64::from(!face.material.paints.is_empty());
            let (passes, beyond) = self.straight_through(&face, arrival, media);
            share.dim(passes.whole, passes.unbent);
            media = beyond;
            if share.whole == Rgb::ZERO {
                return share;
            }
            crossed = Some(face.crossed(None, arrival.direction));
            let Some(rest) = arrival.beyond(&face.surface) else { return share };
            (ray, t_max) = rest;
            work.counts.rays.shadow += 1;
        }
        Passing::all_or_nothing(true)
    }

    /// The share that passes a surface straight on, and what is around the light beyond it.
    fn straight_through(&self, face: &Face, arrival: &Arrival, media: Media) -> (Passing, Media) {
        let Lobes { transparency, refraction, .. } = face.lobes;
        let unbent = Passing { whole: transparency, unbent: transparency };
        let Some(boundary) = self.boundary(face, &media) else { return (unbent, media) };
        if boundary.hidden {
            return (Passing::all_or_nothing(false), boundary.passed);
        }
        if !self.refractive_shadows {
            return (unbent, boundary.passed);
        }
        let reflected = boundary.straight(face.material.fresnel, arrival.direction, face.surface.normal);
        let passes = 1.0 - reflected as f32;
        (Passing { whole: transparency + refraction * passes, ..unbent }, boundary.passed)
    }

    /// The share of the light that the fog lets pass on its way to a surface.
    pub fn clearness(&self, arrival: &Arrival, surface: &Surface, work: &mut Work) -> f32 {
        let Some(fog) = &self.fog else { return 1.0 };
        work.counts.evaluations.fog += 1;
        let length = match &arrival.from {
            Origin::Point(point) => (*point - surface.point).length(),
            Origin::Surface(target) => (target.point - surface.point).length(),
            Origin::Infinity => f64::INFINITY,
        };
        let way = Ray { origin: surface.point, direction: arrival.direction };
        1.0 - fog.opacity(&way, length) as f32
    }
}
