//! The intervals in which a ray is inside of a solid.
//!
//! Each part reports all its crossings along the whole ray, with an error bound of t. Crossings whose bounds overlap are
//! one place: all of them happen at once. The solid has a surface there if the ray is inside before and outside behind,
//! or the reverse. So faces that coincide leave no sheet between them, whatever rounding has made of their order.
//!
//! What a ray hits depends on the ray alone, not on the interval that is searched.

use super::{Operation, Solid};
use crate::base::lanes::Portable;
use crate::base::math::{Aabb, DVec3, Ray, min};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{CoincidenceRange, OneRay, PreparedRay, RayInterval, Shape, ShapeHit};

/// A crossing of a part.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    t: f64,
    /// How far t may be from the true crossing.
    error: f64,
    /// In the part's own numbering.
    part: u32,
    enters: bool,
    /// Whether the ray may only touch the surface here, without a second crossing beside this one.
    grazes: bool,
}

/// The largest cosine between a ray and the normal where the ray may only touch a surface: rounding hides chords of curved
/// surfaces whose ends have less than about the root of the unit roundoff.
const GRAZING: f64 = 1e-6;

/// Crossings of one part that rounding may have swapped: the part changes from `before` to `after`.
#[derive(Debug)]
struct Change {
    of: usize,
    low: f64,
    high: f64,
    before: bool,
    after: bool,
    crossings: Vec<Crossing>,
}

impl Change {
    /// Whether the ray may stay on its side.
    fn may_touch(&self) -> bool {
        // A double root may be reported twice, both times from the same side.
        self.crossings.iter().all(|at| at.grazes)
    }
}

impl Solid {
    /// All hits along a ray, from its origin on, in order.
    #[inline(never)]
    pub(super) fn hits(&self, ray: &TraversalRay) -> Vec<ShapeHit> {
        let range = PreparedRay::<f64>::splat(ray).coincidence_range(self.0.reach);
        let count = self.0.parts.len();
        let mut changes = Vec::new();
        let mut states = Vec::with_capacity(count);
        for (of, shape) in self.0.parts.iter().enumerate() {
            let from = changes.len();
            let crossings = crossings(shape, ray, range);
            let end = inside_at_the_end(shape, &ray.ray);
            match shape {
                Shape::Particles(_) => by_depth(of, crossings, &mut changes),
                _ => {
                    by_side(of, crossings, end, &mut changes);
                    resolve_touches(shape, &ray.ray, &mut changes[from..]);
                }
            }
            if changes.len() == from && !end && self.needs(of) {
                return Vec::new();
            }
            states.push(changes.get(from).map_or(end, |first| first.before));
        }
        changes.sort_by(|a, b| a.low.total_cmp(&b.low).then(a.of.cmp(&b.of)));
        let mut hits = Vec::new();
        let mut from = 0;
        while from < changes.len() {
            let mut high = changes[from].high;
            let more = changes[from + 1..].iter().take_while(|next| {
                let joins = next.low <= high;
                high = if joins && high < next.high { next.high } else { high };
                joins
            });
            let to = from + 1 + more.count();
            self.place(&changes[from..to], &mut states, &mut hits);
            from = to;
        }
        for index in 1..hits.len() {
            if hits[index].t <= range.end(hits[index - 1].t) {
                hits[index - 1].coincident = true;
                hits[index].coincident = true;
            }
        }
        hits
    }

    /// Adds the hits of a place, and brings the states of the parts behind it.
    fn place(&self, changes: &[Change], states: &mut [bool], hits: &mut Vec<ShapeHit>) {
        let was = states.to_vec();
        for change in changes {
            states[change.of] = change.after;
        }
        let hit = |of: usize, at: &Crossing| ShapeHit::of_part(at.t, self.0.first[of] + at.part);
        if self.0.is_open {
            let is_kept = |states: &[bool]| states[1..].iter().all(|inside| *inside);
            if is_kept(&was) || is_kept(states) {
                let own = changes.iter().filter(|change| change.of == 0);
                hits.extend(own.flat_map(|change| change.crossings.iter().map(|at| hit(0, at))));
            }
            return;
        }
        let enters = self.is_inside(states);
        if self.is_inside(&was) == enters {
            return;
        }
        // The first part in the order of the file that turns the same way.
        let all = changes.iter().flat_map(|change| change.crossings.iter().map(|at| (change.of, at)));
        let best = all.min_by(|(a, at), (b, other)| {
            let is_other = |of: usize, at: &Crossing| (at.enters != self.is_turned(of)) != enters;
            let order = is_other(*a, at).cmp(&is_other(*b, other)).then(a.cmp(b));
            order.then(at.t.total_cmp(&other.t))
        });
        hits.extend(best.map(|(of, at)| hit(of, at)));
    }

    /// Whether nothing is inside of the solid that is outside of a part.
    fn needs(&self, part: usize) -> bool {
        match self.0.operation {
            Operation::Intersection => true,
            Operation::Difference => part == 0,
            Operation::Union => false,
        }
    }

    /// Whether a place is inside of the solid, from where it is inside of the parts.
    fn is_inside(&self, states: &[bool]) -> bool {
        match self.0.operation {
            Operation::Intersection => states.iter().all(|inside| *inside),
            Operation::Union => states.iter().any(|inside| *inside),
            Operation::Difference => {
                states.split_first().is_some_and(|(first, rest)| *first && !rest.contains(&true))
            }
        }
    }
}

/// All crossings of a part along a ray, in order. Errors of t grow without bounds where a ray grazes a surface, so they
/// end at the range within which hits may coincide.
fn crossings(shape: &Shape, ray: &TraversalRay, range: CoincidenceRange<f64>) -> Vec<Crossing> {
    let mut found = Vec::new();
    shape.each_crossing::<Portable>(ray, RayInterval::up_to(f64::INFINITY), &mut |at| {
        let surface = shape.surface_at(&ray.ray, at);
        let along = surface.normal.dot(ray.ray.direction);
        let off = (ray.ray.origin + ray.ray.direction * at.t - surface.point).dot(surface.normal);
        let (error, most) = (surface.normal.abs().dot(surface.error) + off.abs(), range.end(at.t) - at.t);
        let error = if along == 0.0 { most } else { min(error / along.abs(), most) };
        let grazes = along.abs() <= GRAZING * ray.ray.direction.length() && !matches!(shape, Shape::Plane(_));
        found.push(Crossing { t: at.t, error, part: at.part, enters: along < 0.0, grazes });
    });
    found.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
    found
}

/// Whether a ray ends inside of a shape.
fn inside_at_the_end(shape: &Shape, ray: &Ray) -> bool {
    match shape {
        Shape::Plane(plane) => {
            let along = plane.normal.dot(ray.direction);
            if along == 0.0 { plane.normal.dot(ray.origin - plane.point) < 0.0 } else { along < 0.0 }
        }
        Shape::Solid(solid) if !solid.0.is_open => {
            let ends: Vec<bool> = solid.0.parts.iter().map(|part| inside_at_the_end(part, ray)).collect();
            solid.is_inside(&ends)
        }
        _ => false,
    }
}

/// The changes of a part whose surface encloses it once. Which side a crossing shows says where the ray was before. At an
/// edge, neighbouring faces may report the same crossing, or one face the entry and another the exit.
fn by_side(of: usize, crossings: Vec<Crossing>, end: bool, changes: &mut Vec<Change>) {
    let from = changes.len();
    for at in crossings {
        let (low, high) = (at.t - at.error, at.t + at.error);
        match changes[from..].last_mut() {
            Some(last) if low <= last.high => {
                last.high = if last.high < high { high } else { last.high };
                last.low = min(last.low, low);
                last.crossings.push(at);
            }
            _ => changes.push(Change { of, low, high, before: false, after: false, crossings: vec![at] }),
        }
    }
    let mut behind = end;
    for change in changes[from..].iter_mut().rev() {
        let entries = change.crossings.iter().filter(|at| at.enters).count();
        let exits = change.crossings.len() - entries;
        change.after = behind;
        change.before = if entries == exits || change.may_touch() { behind } else { exits > entries };
        behind = change.before;
    }
}

/// Decides which of the crossings that may be touches change sides: those at which the states before and behind differ.
/// Behind them, states are those before the next crossing.
fn resolve_touches(shape: &Shape, ray: &Ray, changes: &mut [Change]) {
    let Some(first) = changes.first() else { return };
    let mut state = match first.may_touch() {
        true => is_inside(shape, ray.origin),
        false => first.before,
    };
    for change in changes {
        if change.may_touch() {
            change.before = state;
        }
        state = change.after;
    }
}

/// Whether a point is inside of a shape: by the first crossing in a direction along which no shape is aligned.
#[inline(never)]
fn is_inside(shape: &Shape, point: DVec3) -> bool {
    const SOMEWHERE: DVec3 = DVec3::new(0.411_7, 0.623_1, 0.665_3);
    let is_outside = |bounds: Aabb| point.cmplt(bounds.min).any() || point.cmpgt(bounds.max).any();
    if shape.bounds().is_some_and(is_outside) {
        return false;
    }
    let ray = TraversalRay::new(Ray { origin: point, direction: SOMEWHERE });
    let first = shape.intersect_up_to(&ray, f64::INFINITY);
    match first {
        Some(at) => shape.surface_at(&ray.ray, at).normal.dot(SOMEWHERE) > 0.0,
        None => inside_at_the_end(shape, &ray.ray),
    }
}

/// The changes of spheres that may overlap: the ray is inside while it is in any of them.
fn by_depth(of: usize, crossings: Vec<Crossing>, changes: &mut Vec<Change>) {
    let from = changes.len();
    let mut depth = 0i64;
    let alone = |part: u32| crossings.iter().filter(|at| at.part == part).count() == 1;
    let touches: Vec<bool> = crossings.iter().map(|at| at.grazes && alone(at.part)).collect();
    for (at, _) in crossings.into_iter().zip(touches).rev().filter(|(_, touches)| !touches) {
        let after = depth > 0;
        depth += if at.enters { -1 } else { 1 };
        let (low, high) = (at.t - at.error, at.t + at.error);
        changes.push(Change { of, low, high, before: depth > 0, after, crossings: vec![at] });
    }
    changes[from..].reverse();
}
