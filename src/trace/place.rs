//! The next surface along a ray, also where several surfaces coincide: a glass on a table, two slabs that share a face.
//!
//! The result depends only on the surfaces at that place, not on the order in which rounding has put their hits. Rays that
//! pass a surface straight on keep their origin, so that each crossing counts once, no matter how close the next one is.

mod members;

pub use members::Members;

use super::media::{Boundary, Enclosure, Media, Nesting, Passage};
use super::tracer::{Tracer, Work};
use crate::bvh::{Hit, Hits};
use crate::camera::Ray;
use crate::shape::{Rays, Surface, lanes};
use crate::tree::Probe;
use members::{Class, Member, holding};

/// The progress of a ray that has passed a surface straight on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// The t of the surface.
    pub t: f64,
    /// The search for the next hit starts beyond this t.
    beyond: f64,
    /// The number of stops that are done at this place, if more are left.
    stops: Option<usize>,
}

impl Passed {
    /// Whether the next stop has to be searched for along the ray.
    pub fn goes_on(&self) -> bool {
        self.stops.is_none()
    }
}

/// The next surface along a ray, or the boundary that several of them form.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    pub hit: Hit,
    /// Its error bound includes all surfaces that coincide with it, so that rays start beyond them.
    pub surface: Surface,
    /// The two media, if the surface refracts.
    pub boundary: Option<Boundary>,
    /// The state of a ray that passes this straight on.
    pub passed: Passed,
    /// Whether the ray had another stop at this place before.
    pub again: bool,
}

impl Tracer<'_> {
    /// The next stop before `t_max`. `first` finds the closest hit of a ray that has not passed anything yet.
    #[inline]
    pub fn next_stop(
        &self,
        (ray, passed): (&Ray, Option<Passed>),
        t_max: f64,
        first: impl FnOnce() -> Option<Hit>,
        media: Media,
        work: &mut Work,
    ) -> Option<Stop> {
        let hit = match passed {
            None => first()?,
            Some(Passed { t, stops: Some(stops), .. }) => {
                return self.stop_at(ray, (t, t_max), stops, media, (&mut work.members, &mut work.nesting));
            }
            Some(Passed { beyond, .. }) => {
                self.bvh.closest_between(self.scene.geometry, &Probe::new(*ray), (beyond, t_max))?
            }
        };
        let t = hit.at.t;
        if hit.at.crowded
            && let Some(stop) =
                self.stop_at(ray, (t, t_max), 0, media, (&mut work.members, &mut work.nesting))
        {
            return Some(stop);
        }
        let surface = self.surface(ray, &hit);
        let boundary = self
            .media
            .then(|| self.alone(ray, &hit, &surface, media, (&mut work.members, &mut work.nesting)))
            .flatten();
        Some(Stop { hit, surface, boundary, passed: Passed { t, beyond: t, stops: None }, again: false })
    }

    /// Corrects the hits of those of eight rays that are at coincident surfaces, none of which refracts; gives the surfaces.
    #[cold]
    #[inline(never)]
    pub fn settle(&self, rays: &Rays, hits: &mut Hits) -> Vec<(usize, Surface)> {
        let (mut members, mut nesting) = (Members::default(), Nesting::default());
        let mut places = Vec::new();
        for lane in lanes(hits.at.met & hits.at.crowded) {
            let (ray, from) = (rays.one(lane), (hits.at.t[lane], f64::INFINITY));
            let scratch = (&mut members, &mut nesting);
            if let Some(stop) = self.stop_at(&ray, from, 0, Media::default(), scratch) {
                hits.set(lane, stop.hit);
                places.push((lane, stop.surface));
            }
        }
        places
    }

    /// The boundary of a single surface, if it refracts.
    fn alone(
        &self,
        ray: &Ray,
        hit: &Hit,
        surface: &Surface,
        media: Media,
        (members, nesting): (&mut Members, &mut Nesting),
    ) -> Option<Boundary> {
        let mut passage = self.passage(ray, hit, surface).filter(|passage| self.refracts(passage))?;
        passage.grazes = self.grazes_an_edge(hit, surface, passage.enters, &mut members.crossings);
        Some(nesting.boundary(media, &[passage], &self.scene.shading.materials))
    }

    fn refracts(&self, passage: &Passage) -> bool {
        self.scene.shading.materials[passage.of.material as usize].refracts()
    }

    /// What a ray enters or leaves at a surface; none for lights.
    fn passage(&self, ray: &Ray, hit: &Hit, surface: &Surface) -> Option<Passage> {
        let material = self.scene.geometry.primitives[hit.primitive as usize].material(hit.at.part)?;
        let of = Enclosure { primitive: hit.primitive, material };
        Some(Passage { of, enters: surface.normal.dot(ray.direction) <= 0.0, grazes: false })
    }

    /// The stop after the first `before` ones at the place that begins at `t`; none if there are no more.
    #[inline(never)]
    fn stop_at(
        &self,
        ray: &Ray,
        (t, t_max): (f64, f64),
        before: usize,
        media: Media,
        (members, nesting): (&mut Members, &mut Nesting),
    ) -> Option<Stop> {
        self.gather(ray, (t, t_max), members);
        let Members { all, passages, crossings, .. } = members;
        let beyond = all.iter().map(|member| member.hit.at.t).fold(t, f64::max);
        all.sort_by_key(|member| (member.layer, member.class, member.hit.primitive, member.hit.at.part));
        self.merge(all);
        let is_bound =
            |a: &Member, b: &Member| a.class == Class::Boundary && b.class == a.class && a.layer == b.layer;
        let mut stops = all.chunk_by(is_bound).skip(before);
        let (stop, more) = (stops.next()?, stops.next().is_some());
        let bounds = stop[0].class == Class::Boundary;
        passages.clear();
        if bounds {
            passages.extend(stop.iter().map(|member| {
                let (passage, surface) = (member.passage, holding(member, all));
                let grazes = self.grazes_an_edge(&member.hit, &surface, passage.enters, crossings);
                Passage { grazes, ..passage }
            }));
        }
        let boundary = bounds.then(|| nesting.boundary(media, passages, &self.scene.shading.materials));
        let seen = &stop[boundary.map_or(0, |boundary| boundary.seen)];
        let passed = Passed { t, beyond, stops: more.then_some(before + 1) };
        Some(Stop { hit: seen.hit, surface: holding(seen, all), boundary, passed, again: before > 0 })
    }
}
