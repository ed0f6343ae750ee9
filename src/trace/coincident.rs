//! Places where several surfaces coincide, such as a glass on a table or two slabs that share a face.
//!
//! The result at such a place depends only on its surfaces, not on the order into which rounding has put the hits. Rays
//! that pass a surface straight on keep their origin. So each crossing counts once, no matter how close the next one
//! is.

mod surfaces;

use super::context::TraceContext;
use super::medium::{MediaLists, Passage};
use super::spawn::spawn_ray;
use crate::appearance::material::Material;
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::ray_kinds::RayKind;
use crate::geometry::shape::{RayInterval, Shape, Surface};
use crate::scene::top_level::Hit;
use surfaces::{CoincidentSurface, SurfaceClass};

/// A hit at a place where surfaces coincide: a single surface, or a boundary that several surfaces form together.
#[derive(Clone, Debug)]
pub struct Event {
    hits: Vec<Hit>,
    /// For each hit, how the ray passes it, if this is a boundary.
    pub passages: Vec<Passage>,
    /// The number of the next event for a ray that continues straight on, or [`NO_EVENT`].
    pub next: u32,
    /// The last t of the place.
    pub t_last: f64,
    /// How far other surfaces that coincide with it may be, along its normal and beyond its own error bound.
    pub reach: f64,
}

impl Event {
    /// The surface that a ray inside these media sees.
    fn hit(&self, media: &MediaLists, inside: u32, materials: &[Material]) -> Hit {
        match self.hits[..] {
            [only] => only,
            _ => self.hits[media.visible(inside, &self.passages, materials)],
        }
    }
}

/// Stands for the absence of an event.
pub const NO_EVENT: u32 = 0;

/// Stands for the absence of an event at an [isolated](crate::geometry::shape::ShapeHit::isolated) hit.
pub const ISOLATED: u32 = u32::MAX;

/// The events of a wave.
#[derive(Debug, Default)]
pub struct Events(Vec<Event>);

impl Events {
    pub fn clear(&mut self) {
        self.0.clear();
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn get(&self, number: u32) -> Option<&Event> {
        self.0.get((number as usize).checked_sub(1)?)
    }

    /// The hit of a ray inside these media at the event of this number, if there is one.
    #[inline]
    pub fn hit(
        &self,
        number: u32,
        (media, inside): (&MediaLists, u32),
        materials: &[Material],
    ) -> Option<Hit> {
        Some(self.get(number)?.hit(media, inside, materials))
    }

    fn push(&mut self, event: Event) -> u32 {
        self.0.push(event);
        self.0.len() as u32
    }
}

impl TraceContext<'_> {
    /// The first event at the place that begins at `t`: its number, or [`NO_EVENT`] if the place has only one surface.
    #[inline(never)]
    pub fn resolve(&self, (ray, kind): (&Ray, RayKind), (t, t_max): (f64, f64), events: &mut Events) -> u32 {
        let mut all = self.coincident_surfaces((ray, kind), (t, t_max));
        if all.len() < 2 {
            return NO_EVENT;
        }
        let t_last = all.iter().map(|member| member.hit.at.t).fold(t, f64::max);
        all.sort_by_key(|member| (member.layer, member.class, member.hit.primitive, member.hit.at.part));
        self.merge(&mut all);
        let is_bound = |a: &CoincidentSurface, b: &CoincidentSurface| {
            a.class == SurfaceClass::Boundary && b.class == a.class && a.layer == b.layer
        };
        let mut next = NO_EVENT;
        for stop in all.chunk_by(is_bound).rev() {
            let bounds = stop[0].class == SurfaceClass::Boundary;
            let passages = stop.iter().filter(|_| bounds).map(|member| self.passage(member, &all)).collect();
            let hits = stop.iter().map(|member| member.hit).collect();
            next = events.push(Event {
                hits,
                passages,
                next,
                t_last,
                reach: surfaces::max_extra_error(stop, &all),
            });
        }
        next
    }

    /// How a ray passes a refracting surface of the place.
    fn passage(&self, member: &CoincidentSurface, all: &[CoincidentSurface]) -> Passage {
        let (passage, surface) = (member.passage, surfaces::with_extra_error(member, all));
        let seen = if passage.enters { surface } else { Surface { normal: -surface.normal, ..surface } };
        let (primitive, out) = (passage.of.primitive, seen.normal);
        let mut grazes = false;
        if self.may_graze(primitive) {
            let origins = [out, -out].map(|side| spawn_ray(&seen, side).origin);
            grazes = self.grazes_an_edge(primitive, origins, out, passage.enters);
        }
        Passage { grazes, ..passage }
    }

    /// Whether a primitive needs the test [`Self::grazes_an_edge`]: only meshes and solids do.
    pub fn may_graze(&self, primitive: u32) -> bool {
        matches!(self.scene.geometry.primitives[primitive as usize].shape, Shape::Mesh(_) | Shape::Solid(_))
    }

    /// Whether a ray passes a mesh or a solid at a sharp edge, so that it is on the same side of the surface before and
    /// behind. There, the error bound of the point may reach through the other face. The test casts a ray from the
    /// spawn origin on the side of the normal `out` to the one on the other side. It must cross at least one face, and
    /// all faces in the direction of the passage.
    #[inline(never)]
    pub fn grazes_an_edge(&self, primitive: u32, [from, to]: [DVec3; 2], out: DVec3, enters: bool) -> bool {
        let primitive = &self.scene.geometry.primitives[primitive as usize];
        // On a face through the origin, both origins may be neighbours of zero, about 1e-323 apart. With a direction of
        // that length, the t of other hits of the shape would overflow, so the direction is scaled, by a power of two.
        let exponent = libm::ilogb((to - from).abs().max_element()).clamp(-1074, 1023);
        let direction = (to - from).map(|v| libm::scalbn(v, -exponent));
        let across = Ray { origin: from, direction };
        let within = RayInterval::up_to(libm::scalbn(1.0, exponent));
        let (mut count, mut alike) = (0, true);
        primitive.each_crossing(&TraversalRay::new(across), within, &mut |at| {
            count += 1;
            alike &= (primitive.normal_at(&across, at).dot(out) >= 0.0) == enters;
        });
        count == 0 || !alike
    }
}
