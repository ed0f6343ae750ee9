//! Shadow rays: how much of a light arrives in spite of what stands in the way.

use super::lights::{Arrival, Origin};
use super::media::Media;
use super::place::Passed;
use super::tracer::{Face, Met, Tracer, Work};
use crate::camera::Ray;
use crate::color::Rgb;
use crate::material::{Lobes, Medium};
use crate::math::DVec3;
use crate::shape::Surface;
use crate::tree::Probe;

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
    pub fn passing(&self, arrival: &Arrival, surface: &Surface, media: Media, work: &mut Work) -> Passing {
        let (ray, t_max) = arrival.shadow_ray(surface);
        if ray.direction == DVec3::ZERO {
            return Passing::all_or_nothing(false);
        }
        work.counts.rays.shadow += 1;
        if !self.clear {
            let mut passing =
                Passing::all_or_nothing(self.bvh.occluded(self.scene.geometry, &Probe::new(ray), t_max));
            if self.media {
                let here = work.nesting.here(media, &self.scene.shading.materials);
                passing.absorb(here, ray.direction.length() * t_max);
            }
            return passing;
        }
        let lists = work.nesting.count();
        let passing = self.transmitted(arrival, (&ray, t_max), media, work);
        work.nesting.forget_beyond(lists);
        passing
    }

    /// [`Tracer::passing`] surface by surface: the product of what each of them lets pass, in their order along the ray.
    fn transmitted(
        &self,
        arrival: &Arrival,
        (ray, t_max): (&Ray, f64),
        mut media: Media,
        work: &mut Work,
    ) -> Passing {
        let mut share = Passing::all_or_nothing(false);
        let mut passed: Option<Passed> = None;
        let first = || self.bvh.closest_between(self.scene.geometry, &Probe::new(*ray), (0.0, t_max));
        loop {
            let from = passed.map_or(0.0, |passed| passed.t);
            let stop = self.next_stop((ray, passed), t_max, first, media, work);
            if self.media && !stop.is_some_and(|stop| stop.again) {
                let length = ray.direction.length() * (stop.map_or(t_max, |stop| stop.passed.t) - from);
                share.absorb(work.nesting.here(media, &self.scene.shading.materials), length);
            }
            let Some(stop) = stop else { return share };
            let Met::Surface(face) = self.met(ray, stop, 0.0) else { return Passing::all_or_nothing(true) };
            work.counts.evaluations.paint += u64::from(!face.material.paints.is_empty());
            let passes = self.straight_through(&face, arrival);
            share.dim(passes.whole, passes.unbent);
            media = face.boundary.map_or(media, |boundary| boundary.passed);
            if share.whole == Rgb::ZERO {
                return share;
            }
            work.counts.rays.shadow += u64::from(face.passed.goes_on());
            passed = Some(face.passed);
        }
    }

    /// The share that passes a surface straight on.
    fn straight_through(&self, face: &Face, arrival: &Arrival) -> Passing {
        let Lobes { transparency, refraction, .. } = face.lobes;
        let unbent = Passing { whole: transparency, unbent: transparency };
        let Some(boundary) = &face.boundary else { return unbent };
        if boundary.hidden {
            return Passing::all_or_nothing(false);
        }
        if !self.refractive_shadows {
            return unbent;
        }
        let reflected = boundary.straight(face.material.fresnel, arrival.direction, face.surface.normal);
        let passes = 1.0 - reflected as f32;
        Passing { whole: transparency + refraction * passes, ..unbent }
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
