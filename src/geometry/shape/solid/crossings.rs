//! Where a ray crosses the surface of a part, and on which side of it the ray is in between.

use super::Solid;
use crate::base::lanes::Portable;
use crate::base::math::{Aabb, DVec3, Ray, gamma, min};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{CoincidenceRange, Mesh, OneRay, RayInterval, Shape};

/// A crossing of a part.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    pub t: f64,
    /// How far t may be from the true crossing.
    error: f64,
    /// In the part's own numbering.
    pub part: u32,
    pub enters: bool,
    /// Whether the ray may only touch the surface here, without a second crossing beside this one.
    grazes: bool,
}

/// Crossings of one part that rounding may have swapped: the part changes from `before` to `after`.
#[derive(Debug)]
pub struct Change {
    /// The index of the part.
    pub of: usize,
    pub low: f64,
    pub high: f64,
    pub before: bool,
    pub after: bool,
    pub crossings: Vec<Crossing>,
}

/// The largest cosine between a ray and the normal where the ray may only touch a surface: rounding hides chords of curved
/// surfaces whose ends have less than about the root of the unit roundoff.
const GRAZING: f64 = 1e-6;

/// A direction along which no scene is aligned.
const SOMEWHERE: DVec3 = DVec3::new(0.411_7, 0.623_1, 0.665_3);

/// Appends the changes of a part along a ray, in order. Returns whether the ray begins inside of the part.
pub fn changes(
    (of, shape): (usize, &Shape),
    ray: &TraversalRay,
    range: CoincidenceRange<f64>,
    all: &mut Vec<Change>,
) -> bool {
    let from = all.len();
    let crossings = crossings(shape, ray, range);
    let end = inside_at_the_end(shape, &ray.ray);
    match shape {
        Shape::Particles(_) => by_depth(of, crossings, all),
        Shape::Mesh(mesh) if mesh.mesh.is_closed() => {
            grouped(of, crossings, all);
            by_winding(mesh, &ray.ray, &mut all[from..]);
        }
        _ => {
            grouped(of, crossings, all);
            by_side(end, &mut all[from..]);
            resolve_touches(shape, &ray.ray, &mut all[from..]);
        }
    }
    // Errors may reach across other crossings, which must not change the order within the part.
    let mut low = f64::INFINITY;
    for change in all[from..].iter_mut().rev() {
        low = min(low, change.low);
        change.low = low;
    }
    all.get(from).map_or(end, |first| first.before)
}

/// All crossings of a part along a ray, in order. Errors of t grow without bounds where a ray grazes a surface, so they
/// end at the range within which hits may coincide.
fn crossings(shape: &Shape, ray: &TraversalRay, range: CoincidenceRange<f64>) -> Vec<Crossing> {
    let mut found = Vec::new();
    shape.each_crossing::<Portable>(ray, RayInterval::up_to(f64::INFINITY), &mut |at| {
        let surface = shape.surface_at(&ray.ray, at);
        let along = surface.normal.dot(ray.ray.direction);
        let way = ray.ray.direction * at.t;
        let off = (ray.ray.origin + way - surface.point).dot(surface.normal);
        // The point's own error, its distance from the ray, and the rounding of that.
        let rounding = (ray.ray.origin.abs() + way.abs()) * gamma(4);
        let error = surface.normal.abs().dot(surface.error + rounding) + off.abs();
        let most = range.end(at.t) - at.t;
        let error = if along == 0.0 { most } else { min(error / along.abs(), most) };
        let grazes = along.abs() <= GRAZING * ray.ray.direction.length() && !matches!(shape, Shape::Plane(_));
        found.push(Crossing { t: at.t, error, part: at.part, enters: along < 0.0, grazes });
    });
    found.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
    found
}

/// Whether a ray ends inside of a shape.
pub fn inside_at_the_end(shape: &Shape, ray: &Ray) -> bool {
    match shape {
        Shape::Plane(plane) => {
            let along = plane.normal.dot(ray.direction);
            if along == 0.0 { plane.normal.dot(ray.origin - plane.point) < 0.0 } else { along < 0.0 }
        }
        Shape::Solid(Solid(inner)) if !inner.is_open => {
            let ends: Vec<bool> = inner.parts.iter().map(|part| inside_at_the_end(part, ray)).collect();
            inner.operation.is_inside(&ends)
        }
        _ => false,
    }
}

/// Appends the crossings of a part, those together whose bounds overlap.
fn grouped(of: usize, crossings: Vec<Crossing>, all: &mut Vec<Change>) {
    let from = all.len();
    for at in crossings {
        let (low, high) = (at.t - at.error, at.t + at.error);
        match all[from..].last_mut() {
            Some(last) if low <= last.high => {
                last.high = if last.high < high { high } else { last.high };
                last.low = min(last.low, low);
                last.crossings.push(at);
            }
            _ => all.push(Change { of, low, high, before: false, after: false, crossings: vec![at] }),
        }
    }
}

impl Change {
    /// Whether the ray may stay on its side.
    fn may_touch(&self) -> bool {
        // A double root may be reported twice, both times from the same side, and a touched rim by a face beside it.
        self.crossings.iter().any(|at| at.grazes)
    }

    /// Exits less entries.
    fn exits(&self) -> isize {
        self.crossings.iter().map(|at| if at.enters { -1 } else { 1 }).sum()
    }
}

/// The changes of a part whose surface encloses it once. Which side a crossing shows says where the ray was before.
fn by_side(end: bool, changes: &mut [Change]) {
    let mut behind = end;
    for change in changes.iter_mut().rev() {
        let exits = change.exits();
        change.after = behind;
        change.before = if exits == 0 || change.may_touch() { behind } else { exits > 0 };
        behind = change.before;
    }
}

/// Decides which of the crossings that may be touches change sides: those at which the states before and behind differ.
/// Behind them, states are those before the next crossing.
fn resolve_touches(shape: &Shape, ray: &Ray, changes: &mut [Change]) {
    for index in 0..changes.len() {
        if !changes[index].may_touch() {
            continue;
        }
        let state = match index.checked_sub(1).map(|last| &changes[last]) {
            None => is_inside(shape, ray.origin),
            Some(last) if last.may_touch() || last.exits() == 0 => last.after,
            Some(last) => last.exits() < 0,
        };
        changes[index].before = state;
        if let Some(last) = index.checked_sub(1) {
            changes[last].after = state;
        }
    }
}

/// Whether a point is inside of a shape: by the first crossing in some direction.
#[inline(never)]
fn is_inside(shape: &Shape, point: DVec3) -> bool {
    if is_outside_of_bounds(shape, point) {
        return false;
    }
    let ray = TraversalRay::new(Ray { origin: point, direction: SOMEWHERE });
    let first = shape.intersect_up_to(&ray, f64::INFINITY);
    match first {
        Some(at) => shape.surface_at(&ray.ray, at).normal.dot(SOMEWHERE) > 0.0,
        None => inside_at_the_end(shape, &ray.ray),
    }
}

fn is_outside_of_bounds(shape: &Shape, point: DVec3) -> bool {
    let is_outside = |bounds: Aabb| point.cmplt(bounds.min).any() || point.cmpgt(bounds.max).any();
    shape.bounds().is_some_and(is_outside)
}

/// The changes of spheres that may overlap: the ray is inside while it is in any of them.
fn by_depth(of: usize, crossings: Vec<Crossing>, all: &mut Vec<Change>) {
    let from = all.len();
    let mut depth = 0i64;
    let alone = |part: u32| crossings.iter().filter(|at| at.part == part).count() == 1;
    let touches: Vec<bool> = crossings.iter().map(|at| at.grazes && alone(at.part)).collect();
    for (at, _) in crossings.into_iter().zip(touches).rev().filter(|(_, touches)| !touches) {
        let after = depth > 0;
        depth += if at.enters { -1 } else { 1 };
        let (low, high) = (at.t - at.error, at.t + at.error);
        all.push(Change { of, low, high, before: depth > 0, after, crossings: vec![at] });
    }
    all[from..].reverse();
}

/// The changes of a closed mesh: a point is inside where the surface winds around it, whatever the direction of its
/// triangles. So shells may overlap, and a shell in another may leave a hollow or not.
fn by_winding(mesh: &Mesh, ray: &Ray, changes: &mut [Change]) {
    let turns: Vec<Turn> = changes.iter().map(|change| Turn::at(mesh, &change.crossings)).collect();
    // Edges may count wrongly where a ray meets them exactly. Then the number at the origin tells.
    let total: i64 = turns.iter().map(|turn| turn.number).sum();
    let excess = if is_outside_of_bounds(&Shape::Mesh(mesh.clone()), ray.origin) {
        total
    } else if turns.iter().any(|turn| turn.is_doubtful) {
        total - winding_number(mesh, ray.origin)
    } else {
        0
    };
    let doubtful = turns.iter().position(|turn| turn.is_doubtful).unwrap_or(0);
    let mut number = 0;
    for (index, (change, turn)) in changes.iter_mut().zip(&turns).enumerate().rev() {
        change.after = number != 0;
        number += turn.number - if index == doubtful { excess } else { 0 };
        change.before = number != 0;
    }
}

/// How often a surface winds around a point.
#[inline(never)]
fn winding_number(mesh: &Mesh, point: DVec3) -> i64 {
    let shape = Shape::Mesh(mesh.clone());
    let ray = TraversalRay::new(Ray { origin: point, direction: SOMEWHERE });
    let range = super::coincidence_range(&ray, super::reach(&shape));
    let mut all = Vec::new();
    grouped(0, crossings(&shape, &ray, range), &mut all);
    all.iter().map(|change| Turn::at(mesh, &change.crossings).number).sum()
}

/// What a place on a ray adds to the winding number.
struct Turn {
    /// Exits less entries.
    number: i64,
    /// Whether the ray meets an edge, at which faces turn both ways.
    is_doubtful: bool,
}

impl Turn {
    /// Neighbours that a ray meets at their common edge or corner count once.
    fn at(mesh: &Mesh, crossings: &[Crossing]) -> Self {
        let joins = |a: &Crossing, b: &Crossing| {
            let other = mesh.mesh.corners(b.part);
            mesh.mesh.corners(a.part).iter().any(|corner| other.contains(corner))
        };
        let (mut number, mut is_doubtful) = (0, false);
        for (index, at) in crossings.iter().enumerate() {
            let mut before = crossings[..index].iter().filter(|other| joins(at, other));
            is_doubtful |= before.clone().any(|other| other.enters != at.enters);
            if !before.any(|other| other.enters == at.enters) {
                number += if at.enters { -1 } else { 1 };
            }
        }
        Self { number, is_doubtful }
    }
}
