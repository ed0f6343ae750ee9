//! The surfaces that a ray crosses at a place, and which of them coincide.

use super::super::media::Passage;
use super::super::spawn::spawn;
use super::super::tracer::Tracer;
use crate::bvh::Hit;
use crate::camera::Ray;
use crate::math::{DVec3, smaller};
use crate::shape::{Crossing, Shape, Surface};
use crate::tree::Probe;

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
    pub surface: Surface,
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

/// Scratch memory for the surfaces at a place.
#[derive(Debug, Default)]
pub struct Members {
    hits: Vec<Hit>,
    pub crossings: Vec<Crossing>,
    pub all: Vec<Member>,
    pub passages: Vec<Passage>,
}

impl Tracer<'_> {
    /// Collects the surfaces from `t` on whose order along the ray is uncertain.
    pub fn gather(&self, ray: &Ray, (t, t_max): (f64, f64), members: &mut Members) {
        let Members { hits, all, .. } = members;
        let probe = Probe::new(*ray);
        let vicinity = self.bvh.vicinity(&probe);
        let mut looked = vicinity.end(t);
        loop {
            hits.clear();
            all.clear();
            let between = (t.next_down(), smaller(looked, t_max));
            self.bvh.crossings(self.scene.geometry, &probe, between, hits);
            hits.sort_by(|a, b| a.at.t.total_cmp(&b.at.t).then(a.primitive.cmp(&b.primitive)));
            all.extend(hits.iter().map(|hit| self.member(ray, *hit)));
            all.truncate(uncertain(all));
            // The search must reach far beyond the last of them; a long chain of close surfaces needs a longer one.
            let last = all.last().map_or(t, |member| member.hit.at.t);
            if last - t <= 0.5 * (looked - t) || looked >= t_max {
                break;
            }
            looked = t + 2.0 * (vicinity.end(last) - t);
        }
        layer(all);
    }

    /// Whether a ray that starts behind the surface of a mesh would be out of what it has entered, or back in what it has left:
    /// at a sharp edge, the error bound of the point may reach through the other face. Then not exactly one face lies between
    /// the origins of rays on both sides.
    pub fn grazes_an_edge(
        &self,
        hit: &Hit,
        surface: &Surface,
        enters: bool,
        found: &mut Vec<Crossing>,
    ) -> bool {
        let primitive = &self.scene.geometry.primitives[hit.primitive as usize];
        if !matches!(primitive.shape, Shape::Mesh(_)) {
            return false;
        }
        let out = if enters { surface.normal } else { -surface.normal };
        let [from, to] = [out, -out].map(|side| spawn(surface, side).origin);
        let across = Ray { origin: from, direction: to - from };
        found.clear();
        primitive.crossings(&Probe::new(across), 0.0, 1.0, found);
        let alike = |at: &Crossing| (primitive.surface(&across, *at).normal.dot(out) >= 0.0) == enters;
        found.is_empty() || !found.iter().all(alike)
    }

    fn member(&self, ray: &Ray, hit: Hit) -> Member {
        let surface = self.surface(ray, &hit);
        let passage = self.passage(ray, &hit, &surface);
        let class = match passage {
            None => Class::Light,
            Some(passage) if self.refracts(&passage) => Class::Boundary,
            Some(_) => Class::Surface,
        };
        let passage = passage.unwrap_or_default();
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

/// A surface with an error bound that includes all surfaces that coincide with it.
pub fn holding(seen: &Member, all: &[Member]) -> Surface {
    let normal = seen.surface.normal;
    let lying_in = all.iter().filter(|member| member.layer == seen.layer);
    let reach =
        |member: &Member| (member.surface.point - seen.surface.point).dot(normal).abs() + member.error;
    let widest = lying_in.map(reach).fold(seen.error, f64::max);
    Surface { error: seen.surface.error + normal.abs() * (widest - seen.error), ..seen.surface }
}
