//! Places where several surfaces coincide: a glass on a table, two slabs that share a face.
//!
//! What is met there depends only on the surfaces at the place, not on the order in which rounding has put their hits. Rays
//! that pass a surface straight on keep their origin, so that each crossing counts once, no matter how close the next one
//! is.

mod members;

use super::context::TraceContext;
use super::medium::{MediaLists, Passage};
use super::spawn::spawn_ray;
use crate::appearance::material::Material;
use crate::base::lanes::Portable;
use crate::base::math::Ray;
use crate::geometry::bvh::Probe;
use crate::geometry::shape::{Shape, Span, Surface};
use crate::scene::top_level::Hit;
use members::{Class, Member};

/// What a ray meets at a place where surfaces coincide: a surface, or a boundary that several form together.
#[derive(Clone, Debug)]
pub struct Event {
    hits: Vec<Hit>,
    /// Of each hit, if this is a boundary.
    pub passages: Vec<Passage>,
    /// What comes next for a ray that goes straight on; [`NO_EVENT`] if nothing does.
    pub next: u32,
    /// The last t of the place.
    pub after: f64,
    /// How much farther than its own error bound, along its normal, others may lie that coincide with it.
    pub reach: f64,
}

impl Event {
    /// Which surface is seen by a ray inside of a list of media.
    fn hit(&self, media: &MediaLists, inside: u32, materials: &[Material]) -> Hit {
        match self.hits[..] {
            [only] => only,
            _ => self.hits[media.seen(inside, &self.passages, materials)],
        }
    }
}

/// The number of no event.
pub const NO_EVENT: u32 = 0;

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

    /// What a ray inside of a list of media meets at the event of a number, if there is one.
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
    /// What a ray meets first at the place that begins at `t`: its number, if there is more than one surface.
    #[inline(never)]
    pub fn resolve(&self, ray: &Ray, (t, t_max): (f64, f64), events: &mut Events) -> u32 {
        let mut all = self.gather(ray, (t, t_max));
        if all.len() < 2 {
            return NO_EVENT;
        }
        let after = all.iter().map(|member| member.hit.at.t).fold(t, f64::max);
        all.sort_by_key(|member| (member.layer, member.class, member.hit.primitive, member.hit.at.part));
        self.merge(&mut all);
        let is_bound =
            |a: &Member, b: &Member| a.class == Class::Boundary && b.class == a.class && a.layer == b.layer;
        let mut next = NO_EVENT;
        for stop in all.chunk_by(is_bound).rev() {
            let bounds = stop[0].class == Class::Boundary;
            let passages = stop.iter().filter(|_| bounds).map(|member| self.passage(member, &all)).collect();
            let hits = stop.iter().map(|member| member.hit).collect();
            next = events.push(Event { hits, passages, next, after, reach: members::reach(stop, &all) });
        }
        next
    }

    /// What happens at a surface of the place that refracts.
    fn passage(&self, member: &Member, all: &[Member]) -> Passage {
        let (passage, surface) = (member.passage, members::holding(member, all));
        let seen = if passage.enters { surface } else { Surface { normal: -surface.normal, ..surface } };
        Passage { grazes: self.grazes_an_edge(passage.of.primitive, &seen, passage.enters), ..passage }
    }

    /// Whether a ray that starts behind the surface of a mesh, turned to where the ray comes from, would be out of what it has
    /// entered, or back in what it has left: at a sharp edge, the error bound of the point may reach through the other face.
    /// Then not exactly one face lies between the origins of rays on both sides.
    #[inline(never)]
    pub fn grazes_an_edge(&self, primitive: u32, surface: &Surface, enters: bool) -> bool {
        let primitive = &self.scene.geometry.primitives[primitive as usize];
        if !matches!(primitive.shape, Shape::Mesh(_)) {
            return false;
        }
        let out = surface.normal;
        let [from, to] = [out, -out].map(|side| spawn_ray(surface, side).origin);
        let across = Ray { origin: from, direction: to - from };
        let (mut count, mut alike) = (0, true);
        primitive.each_crossing::<Portable>(&Probe::new(across), Span::up_to(1.0), &mut |at| {
            count += 1;
            alike &= (primitive.surface_at(&across, at).normal.dot(out) >= 0.0) == enters;
        });
        count == 0 || !alike
    }
}
