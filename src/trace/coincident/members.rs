//! The surfaces that a ray crosses at a place, and which of them coincide.

use crate::base::math::{DVec3, Ray, smaller};
use crate::geometry::bvh::Probe;
use crate::geometry::shape::{Shape, Span, Surface};
use crate::scene::top_level::Hit;
use crate::trace::context::TraceContext;
use crate::trace::materials::LobeSet;
use crate::trace::medium::{Enclosure, Passage};

/// The order of surfaces that coincide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Lights, which may be mounted flush with a surface.
    Light,
    /// Surfaces that do not refract, in file order. Opaque ones hide the faces of bodies that stand on them.
    Surface,
    /// Refracting surfaces, which together form one boundary.
    Boundary,
}

/// One of the surfaces at a place.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    pub hit: Hit,
    surface: Surface,
    /// The normal on the side to which the ray goes.
    along: DVec3,
    /// Error bound of the point along the normal.
    error: f64,
    pub class: Class,
    pub passage: Passage,
    /// Surfaces of one layer coincide; layers are numbered along the ray.
    pub layer: usize,
}

impl Member {
    /// The distance along the normal to another surface behind this one. Surfaces that cross each other here have two normals:
    /// then the larger of both distances, which belongs to the surface that faces the ray more directly.
    fn to(&self, other: &Self) -> f64 {
        let way = other.surface.point - self.surface.point;
        let (a, b) = (way.dot(self.along), way.dot(other.along));
        if a > b { a } else { b }
    }

    /// Whether another surface is not certainly behind this one.
    fn hides(&self, other: &Self) -> bool {
        self.to(other) <= self.error + other.error
    }
}

impl TraceContext<'_> {
    /// The surfaces from `t` on whose order along the ray is uncertain.
    pub fn gather(&self, ray: &Ray, (t, t_max): (f64, f64)) -> Vec<Member> {
        let probe = Probe::new(*ray);
        let vicinity = self.bvh.vicinity(&probe);
        let mut looked = vicinity.end(t);
        loop {
            let mut hits = Vec::new();
            let within = Span { min: t.next_down(), max: smaller(looked, t_max) };
            self.bvh.each_hit(self.scene.geometry, &probe, within, &mut |hit| hits.push(hit));
            hits.sort_by(|a, b| a.at.t.total_cmp(&b.at.t).then(a.primitive.cmp(&b.primitive)));
            let mut all: Vec<_> = hits.iter().map(|hit| self.member(ray, *hit)).collect();
            all.truncate(uncertain(&all));
            // The search must reach far beyond the last of them; a long chain of close surfaces needs a longer one.
            let last = all.last().map_or(t, |member| member.hit.at.t);
            if last - t <= 0.5 * (looked - t) || looked >= t_max {
                layer(&mut all);
                return all;
            }
            looked = t + 2.0 * (vicinity.end(last) - t);
        }
    }

    fn member(&self, ray: &Ray, hit: Hit) -> Member {
        let primitive = &self.scene.geometry.primitives[hit.primitive as usize];
        let surface = primitive.surface_at(ray, hit.at);
        let material = primitive.material(hit.at.part);
        let class = match material {
            None => Class::Light,
            Some(material) if self.lobes_of(material).has(LobeSet::REFRACTION) => Class::Boundary,
            Some(_) => Class::Surface,
        };
        let of = Enclosure { primitive: hit.primitive, material: material.unwrap_or_default() };
        let passage = Passage { of, enters: surface.normal.dot(ray.direction) <= 0.0, grazes: false };
        let along = if surface.normal.dot(ray.direction) < 0.0 { -surface.normal } else { surface.normal };
        let error = surface.normal.abs().dot(surface.error);
        Member { hit, surface, along, error, class, passage, layer: 0 }
    }

    /// Keeps the first of several hits of one surface.
    pub fn merge(&self, all: &mut Vec<Member>) {
        let mut count = 0;
        for next in 0..all.len() {
            if !all[..count].iter().any(|kept| self.is_one(kept, &all[next])) {
                all.swap(count, next);
                count += 1;
            }
        }
        all.truncate(count);
    }

    /// Whether two hits are of one surface: neighbouring triangles at an edge or a corner of a mesh, or two triangles that are
    /// the two sides of a sheet.
    fn is_one(&self, kept: &Member, next: &Member) -> bool {
        let same =
            kept.layer == next.layer && kept.class == next.class && kept.hit.primitive == next.hit.primitive;
        same && (kept.passage.enters == next.passage.enters || self.have_same_corners(&kept.hit, &next.hit))
    }

    /// Whether two triangles of a mesh have the same corners.
    fn have_same_corners(&self, a: &Hit, b: &Hit) -> bool {
        let Shape::Mesh(mesh) = &self.scene.geometry.primitives[a.primitive as usize].shape else {
            return false;
        };
        let [a, b] = [a, b].map(|hit| mesh.mesh.corners(hit.at.part));
        a.iter().all(|corner| b.contains(corner))
    }
}

/// The number of surfaces, from the first on, that rounding may have put in another order.
fn uncertain(all: &[Member]) -> usize {
    let mut count = 1;
    for next in 1..all.len() {
        let (before, other) = (&all[..count], &all[next]);
        if before.iter().any(|member| member.hit.at.t == other.hit.at.t || member.hides(other)) {
            count = next + 1;
        }
    }
    count
}

/// Sorts surfaces along the first one's normal, and gives those that coincide the same number.
fn layer(all: &mut [Member]) {
    let Some(first) = all.first() else { return };
    let (point, along) = (first.surface.point, first.along);
    all.sort_by(|a, b| {
        let [a, b] = [a, b].map(|member| (member.surface.point - point).dot(along));
        a.total_cmp(&b)
    });
    let mut number = 0;
    for next in 1..all.len() {
        let mut lies_in = all[..next].iter().filter(|member| member.layer == number);
        if !lies_in.any(|member| member.hides(&all[next])) {
            number += 1;
        }
        all[next].layer = number;
    }
}

/// How much farther than a surface's error bound, along its normal, others may lie that coincide with it.
fn beyond(seen: &Member, all: &[Member]) -> f64 {
    let lying_in = all.iter().filter(|member| member.layer == seen.layer);
    let apart = lying_in.map(|other| {
        let way = other.surface.point - seen.surface.point;
        way.dot(seen.surface.normal).abs() + other.error - seen.error
    });
    apart.fold(0.0, f64::max)
}

/// [`beyond`], the largest of some surfaces.
pub fn reach(seen: &[Member], all: &[Member]) -> f64 {
    seen.iter().map(|member| beyond(member, all)).fold(0.0, f64::max)
}

/// A surface with an error bound that includes all surfaces that coincide with it.
pub fn holding(seen: &Member, all: &[Member]) -> Surface {
    let Surface { error, normal, .. } = seen.surface;
    Surface { error: error + normal.abs() * beyond(seen, all), ..seen.surface }
}
