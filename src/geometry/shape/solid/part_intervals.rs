//! The intervals in which a ray is inside of one part of a solid.

use super::crossings::{Crossings, PartHit};
use super::{Solid, reach};
use crate::base::math::{Aabb, DVec3, Ray, max, min};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::mesh::TriangleMesh;
use crate::geometry::shape::{OneRay, ParticleSet, Particles, PreparedRay, Shape};
use std::ops::Range;

/// Hits of one part whose order is uncertain. The ray's side changes from `before` to `after`.
#[derive(Clone, Debug)]
pub struct IntervalEnd {
    /// The index of the part.
    pub of: usize,
    /// The bounds of t.
    pub low: f64,
    pub high: f64,
    /// Whether the ray is inside of the part.
    pub before: bool,
    pub after: bool,
    /// Indices of the hits.
    pub hits: Range<usize>,
}

/// The hits and interval ends of all parts along one ray.
#[derive(Debug, Default)]
pub struct PartIntervals {
    pub hits: Vec<PartHit>,
    pub ends: Vec<IntervalEnd>,
}

/// A direction along which no scene is aligned.
const SOMEWHERE: DVec3 = DVec3::new(0.411_7, 0.623_1, 0.665_3);

impl PartIntervals {
    pub fn clear(&mut self) {
        self.hits.clear();
        self.ends.clear();
    }

    /// Appends the hits of the part with the index `of`, which are in order, and their interval ends. Returns whether the
    /// ray begins inside of the part.
    pub fn add(&mut self, (of, shape): (usize, &Shape), ray: &Ray, hits: &[PartHit]) -> bool {
        let (first_hit, first_end) = (self.hits.len(), self.ends.len());
        self.hits.extend_from_slice(hits);
        match shape {
            Shape::Particles(_) => self.add_each(of, first_hit),
            _ => self.add_groups(of, first_hit),
        }
        let Self { hits, ends } = self;
        let ends = &mut ends[first_end..];
        let end = ends_inside(shape, ray);
        match shape {
            Shape::Particles(Particles(set)) => set_sides_by_depth(set, ray, (hits, first_hit), ends),
            Shape::Mesh(mesh) if mesh.mesh.is_closed() => {
                set_sides_by_winding((shape, &mesh.mesh), ray, hits, ends);
            }
            _ => set_sides_by_normals((shape, end), ray, hits, ends),
        }
        // Bounds may reach across other ends of the part, whose order is known.
        let mut low = f64::INFINITY;
        for end in ends.iter_mut().rev() {
            low = min(low, end.low);
            end.low = low;
        }
        ends.first().map_or(end, |first| first.before)
    }

    /// Appends an interval end for each hit.
    fn add_each(&mut self, of: usize, first_hit: usize) {
        let each = self.hits.iter().enumerate().skip(first_hit);
        self.ends.extend(each.map(|(index, hit)| IntervalEnd::new(of, index, hit)));
    }

    /// Appends an interval end for all hits whose bounds overlap.
    fn add_groups(&mut self, of: usize, first_hit: usize) {
        let first_end = self.ends.len();
        for (index, hit) in self.hits.iter().enumerate().skip(first_hit) {
            let next = IntervalEnd::new(of, index, hit);
            match self.ends[first_end..].last_mut() {
                Some(last) if next.low <= last.high => {
                    last.low = min(last.low, next.low);
                    last.high = max(last.high, next.high);
                    last.hits.end = index + 1;
                }
                _ => self.ends.push(next),
            }
        }
    }
}

impl IntervalEnd {
    fn new(of: usize, index: usize, hit: &PartHit) -> Self {
        let (low, high) = (hit.t - hit.error, hit.t + hit.error);
        Self { of, low, high, before: false, after: false, hits: index..index + 1 }
    }

    /// Exits less entries.
    fn exits(&self, hits: &[PartHit]) -> i64 {
        hits[self.hits.clone()].iter().map(|hit| if hit.enters() { -1 } else { 1 }).sum()
    }

    /// The ray's steepest direction along a normal, without sign.
    fn steepness(&self, hits: &[PartHit]) -> f64 {
        hits[self.hits.clone()].iter().map(|hit| hit.along.abs()).fold(0.0, max)
    }
}

/// Whether a ray ends inside of a shape.
pub fn ends_inside(shape: &Shape, ray: &Ray) -> bool {
    match shape {
        Shape::Plane(plane) => {
            let along = plane.normal.dot(ray.direction);
            if along == 0.0 { plane.normal.dot(ray.origin - plane.point) < 0.0 } else { along < 0.0 }
        }
        Shape::Solid(Solid(inner)) if !inner.is_open => {
            let inside: Vec<bool> = inner.parts.iter().map(|part| ends_inside(part, ray)).collect();
            inner.operation.is_inside(&inside)
        }
        _ => false,
    }
}

/// Sets the sides of a ray before and behind interval ends, for a part that is one solid, from the normals at the hits. A
/// ray that touches the surface may hit it once, so entries and exits that do not alternate are touches. `end`: whether
/// the ray ends inside.
fn set_sides_by_normals((shape, end): (&Shape, bool), ray: &Ray, hits: &[PartHit], ends: &mut [IntervalEnd]) {
    // For now, `after` differs from `before` where the ray crosses the surface.
    let mut last: Option<usize> = None;
    for index in 0..ends.len() {
        let exits = ends[index].exits(hits);
        if exits == 0 {
            continue;
        }
        ends[index].after = true;
        match last.filter(|last| (ends[*last].exits(hits) > 0) == (exits > 0)) {
            // The ray touches the surface where it grazes it more.
            Some(last) if ends[index].steepness(hits) <= ends[last].steepness(hits) => {
                ends[index].after = false;
                continue;
            }
            Some(last) => ends[last].after = false,
            None => {}
        }
        last = Some(index);
    }
    if let Some(last) = last.map(|last| &mut ends[last])
        && (last.exits(hits) < 0) != end
    {
        last.after = false;
    }
    let mut state = end;
    if let Some(first) = ends.iter_mut().find(|end| end.after) {
        state = first.exits(hits) > 0;
        let is_doubtful = || hits[first.hits.clone()].iter().any(|hit| hit.may_touch);
        if state
            && (is_outside_of_bounds(shape, ray.origin) || is_doubtful() && !is_inside(shape, ray.origin))
        {
            first.after = false;
            state = false;
        }
    }
    for end in ends {
        let crosses = end.after;
        end.before = state;
        state ^= crosses;
        end.after = state;
    }
}

/// Whether a point is inside of a shape: by the first hit in some direction.
#[inline(never)]
fn is_inside(shape: &Shape, point: DVec3) -> bool {
    let ray = TraversalRay::new(Ray { origin: point, direction: SOMEWHERE });
    let first = shape.intersect_up_to(&ray, f64::INFINITY);
    match first {
        Some(at) => shape.surface_at(&ray.ray, at).normal.dot(SOMEWHERE) > 0.0,
        None => ends_inside(shape, &ray.ray),
    }
}

fn is_outside_of_bounds(shape: &Shape, point: DVec3) -> bool {
    let is_outside = |bounds: Aabb| point.cmplt(bounds.min).any() || point.cmpgt(bounds.max).any();
    shape.bounds().is_some_and(is_outside)
}

/// Sets the sides for spheres that may overlap: the ray is inside while it is in any of them.
fn set_sides_by_depth(
    set: &ParticleSet,
    ray: &Ray,
    (hits, first_hit): (&[PartHit], usize),
    ends: &mut [IntervalEnd],
) {
    let hits = &hits[first_hit..];
    // A ray that touches a sphere may hit it once, though it begins outside of it.
    let touches = |hit: &PartHit| {
        let sphere = &set.spheres()[hit.part as usize];
        let begins_outside = || (ray.origin - sphere.center).length() > sphere.radius;
        hit.may_touch && hits.iter().filter(|other| other.part == hit.part).count() == 1 && begins_outside()
    };
    let mut depth = 0i64;
    for (end, hit) in ends.iter_mut().zip(hits).rev() {
        end.after = depth > 0;
        if !touches(hit) {
            depth += if hit.enters() { -1 } else { 1 };
        }
        end.before = depth > 0;
    }
}

/// Sets the sides for a closed mesh. A point is inside where the winding number is not 0, in whichever direction the
/// triangles are wound. So shells may overlap, and a shell within another may leave a hollow.
fn set_sides_by_winding(
    (shape, mesh): (&Shape, &TriangleMesh),
    ray: &Ray,
    hits: &[PartHit],
    ends: &mut [IntervalEnd],
) {
    let step = |end: &IntervalEnd| WindingStep::at(mesh, &hits[end.hits.clone()]);
    let (mut total, mut doubtful) = (0, None);
    for (index, end) in ends.iter().enumerate() {
        let WindingStep { exits, is_doubtful } = step(end);
        total += exits;
        doubtful = doubtful.or(is_doubtful.then_some(index));
    }
    // A ray that meets an edge exactly may count it wrongly. A ray in another direction gives the number at the origin.
    let excess = if is_outside_of_bounds(shape, ray.origin) {
        total
    } else if doubtful.is_some() {
        total - winding_number((shape, mesh), ray.origin)
    } else {
        0
    };
    let doubtful = doubtful.unwrap_or(0);
    let mut number = 0;
    for (index, end) in ends.iter_mut().enumerate().rev() {
        end.after = number != 0;
        number += step(end).exits - if index == doubtful { excess } else { 0 };
        end.before = number != 0;
    }
}

/// The winding number of a mesh around a point.
#[inline(never)]
fn winding_number((shape, mesh): (&Shape, &TriangleMesh), point: DVec3) -> i64 {
    let ray = Ray { origin: point, direction: SOMEWHERE };
    let range = PreparedRay::<f64>::splat(&TraversalRay::new(ray)).coincidence_range(reach(shape));
    let mut crossings = Crossings::default();
    crossings.search(0, shape, &ray, range);
    let mut all = PartIntervals { hits: crossings.of(0).to_vec(), ends: Vec::new() };
    all.add_groups(0, 0);
    all.ends.iter().map(|end| WindingStep::at(mesh, &all.hits[end.hits.clone()]).exits).sum()
}

/// The change of the winding number at an interval end.
struct WindingStep {
    /// Exits less entries.
    exits: i64,
    /// Whether the ray meets an edge between an entry and an exit.
    is_doubtful: bool,
}

impl WindingStep {
    /// Neighbouring triangles that the ray meets at their common edge or corner count once.
    fn at(mesh: &TriangleMesh, hits: &[PartHit]) -> Self {
        let are_neighbours = |a: &PartHit, b: &PartHit| {
            let other = mesh.corners(b.part);
            mesh.corners(a.part).iter().any(|corner| other.contains(corner))
        };
        let (mut exits, mut is_doubtful) = (0, false);
        for (index, hit) in hits.iter().enumerate() {
            let mut before = hits[..index].iter().filter(|other| are_neighbours(hit, other));
            is_doubtful |= before.clone().any(|other| other.enters() != hit.enters());
            if !before.any(|other| other.enters() == hit.enters()) {
                exits += if hit.enters() { -1 } else { 1 };
            }
        }
        Self { exits, is_doubtful }
    }
}
