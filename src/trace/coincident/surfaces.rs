//! The surfaces that a ray crosses at a place, and the groups of them that coincide.

use crate::base::math::{DVec3, Ray, min};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::ray_kinds::RayKind;
use crate::geometry::shape::{RayInterval, Surface};
use crate::scene::top_level::Hit;
use crate::trace::context::TraceContext;
use crate::trace::materials::LobeSet;
use crate::trace::medium::{Enclosure, Passage};

/// The order of coincident surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SurfaceClass {
    /// Lights, which may be mounted flush with a surface.
    Light,
    /// Surfaces that do not refract, in file order. Opaque ones hide the faces of bodies on top of them.
    Surface,
    /// Refracting surfaces, which form one boundary together.
    Boundary,
}

/// A surface at a place.
#[derive(Clone, Copy, Debug)]
pub struct CoincidentSurface {
    pub hit: Hit,
    surface: Surface,
    /// The normal on the side to which the ray continues.
    along: DVec3,
    /// Error bound of the point along the normal.
    error: f64,
    pub class: SurfaceClass,
    pub passage: Passage,
    /// Surfaces of one layer coincide. Layers are numbered along the ray.
    pub layer: usize,
}

impl CoincidentSurface {
    /// The distance along the normal to another surface behind this one. Surfaces that cross each other here have two
    /// normals. Then it is the larger of both distances, which belongs to the surface that faces the ray more directly.
    fn distance_to(&self, other: &Self) -> f64 {
        let way = other.surface.point - self.surface.point;
        let (a, b) = (way.dot(self.along), way.dot(other.along));
        if a > b { a } else { b }
    }

    /// Whether another surface is not certainly behind this one.
    fn may_coincide(&self, other: &Self) -> bool {
        self.distance_to(other) <= self.error + other.error
    }
}

impl TraceContext<'_> {
    /// The surfaces from `t` on whose order along the ray is uncertain.
    pub fn coincident_surfaces(
        &self,
        (ray, kind): (&Ray, RayKind),
        (t, t_max): (f64, f64),
    ) -> Vec<CoincidentSurface> {
        let bvh = self.bvh.of(kind);
        let probe = TraversalRay::new(*ray);
        let coincidence_range = bvh.coincidence_range(&probe);
        let mut searched_to = coincidence_range.end(t);
        loop {
            let mut hits = Vec::new();
            let within = RayInterval { min: t.next_down(), max: min(searched_to, t_max) };
            bvh.each_hit(self.scene.geometry, &probe, within, &mut |hit| hits.push(hit));
            // Trees find hits in any order, and parts in several leaves more than once.
            let place = |hit: &Hit| (hit.primitive, hit.at.part);
            hits.sort_by(|a, b| a.at.t.total_cmp(&b.at.t).then(place(a).cmp(&place(b))));
            hits.dedup_by(|a, b| a.at.t == b.at.t && place(a) == place(b));
            let mut all: Vec<_> = hits.iter().map(|hit| self.coincident_surface(ray, *hit)).collect();
            all.truncate(count_uncertain(&all));
            // The search must reach far beyond the last of them. A long chain of close surfaces needs a longer search.
            let last = all.last().map_or(t, |member| member.hit.at.t);
            if last - t <= 0.5 * (searched_to - t) || searched_to >= t_max {
                number_layers(&mut all);
                return all;
            }
            searched_to = t + 2.0 * (coincidence_range.end(last) - t);
        }
    }

    fn coincident_surface(&self, ray: &Ray, hit: Hit) -> CoincidentSurface {
        let primitive = &self.scene.geometry.primitives[hit.primitive as usize];
        let surface = primitive.surface_at(ray, hit.at);
        let material = primitive.material(hit.at.part);
        let class = match material {
            None => SurfaceClass::Light,
            Some(material) if self.lobes_of(material).has(LobeSet::REFRACTION) => SurfaceClass::Boundary,
            Some(_) => SurfaceClass::Surface,
        };
        let of = Enclosure { primitive: hit.primitive, material: material.unwrap_or_default() };
        let passage = Passage { of, enters: surface.normal.dot(ray.direction) <= 0.0, grazes: false };
        let along = if surface.normal.dot(ray.direction) < 0.0 { -surface.normal } else { surface.normal };
        let error = surface.normal.abs().dot(surface.error);
        CoincidentSurface { hit, surface, along, error, class, passage, layer: 0 }
    }

    /// Keeps the first of several hits of the same surface.
    pub fn merge(&self, all: &mut Vec<CoincidentSurface>) {
        let mut count = 0;
        for next in 0..all.len() {
            if !all[..count].iter().any(|kept| self.is_one(kept, &all[next])) {
                all.swap(count, next);
                count += 1;
            }
        }
        all.truncate(count);
    }

    /// Whether two hits belong to the same surface: neighbouring triangles at an edge or corner of a mesh, or two
    /// triangles that are the two sides of a sheet.
    fn is_one(&self, kept: &CoincidentSurface, next: &CoincidentSurface) -> bool {
        let same =
            kept.layer == next.layer && kept.class == next.class && kept.hit.primitive == next.hit.primitive;
        same && (kept.passage.enters == next.passage.enters || self.have_same_corners(&kept.hit, &next.hit))
    }

    /// Whether two triangles of a mesh have the same corners.
    fn have_same_corners(&self, a: &Hit, b: &Hit) -> bool {
        let shape = &self.scene.geometry.primitives[a.primitive as usize].shape;
        let [a, b] = [a, b].map(|hit| shape.triangle_of(hit.at.part));
        a.zip(b).is_some_and(|(a, b)| a.iter().all(|corner| b.contains(corner)))
    }
}

/// The number of surfaces at the start whose order may be changed by rounding.
fn count_uncertain(all: &[CoincidentSurface]) -> usize {
    let mut count = 1;
    for next in 1..all.len() {
        let (before, other) = (&all[..count], &all[next]);
        if before.iter().any(|member| member.hit.at.t == other.hit.at.t || member.may_coincide(other)) {
            count = next + 1;
        }
    }
    count
}

/// Sorts surfaces along the normal of the first one, and numbers the layers of coincident surfaces.
fn number_layers(all: &mut [CoincidentSurface]) {
    let Some(first) = all.first() else { return };
    let (point, along) = (first.surface.point, first.along);
    all.sort_by(|a, b| {
        let [a, b] = [a, b].map(|member| (member.surface.point - point).dot(along));
        a.total_cmp(&b)
    });
    let mut number = 0;
    for next in 1..all.len() {
        let mut lies_in = all[..next].iter().filter(|member| member.layer == number);
        if !lies_in.any(|member| member.may_coincide(&all[next])) {
            number += 1;
        }
        all[next].layer = number;
    }
}

/// How far coincident surfaces may be from a surface, along its normal and beyond its own error bound.
fn extra_error(seen: &CoincidentSurface, all: &[CoincidentSurface]) -> f64 {
    let lying_in = all.iter().filter(|member| member.layer == seen.layer);
    let apart = lying_in.map(|other| {
        let way = other.surface.point - seen.surface.point;
        way.dot(seen.surface.normal).abs() + other.error - seen.error
    });
    apart.fold(0.0, f64::max)
}

/// The largest [`extra_error`] of some surfaces.
pub fn max_extra_error(seen: &[CoincidentSurface], all: &[CoincidentSurface]) -> f64 {
    seen.iter().map(|member| extra_error(member, all)).fold(0.0, f64::max)
}

/// The surface with an error bound that includes all surfaces that coincide with it.
pub fn with_extra_error(seen: &CoincidentSurface, all: &[CoincidentSurface]) -> Surface {
    let Surface { error, normal, .. } = seen.surface;
    Surface { error: error + normal.abs() * extra_error(seen, all), ..seen.surface }
}
