//! Cylinders and cones from afar, and boxes with rays in their faces.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Number, Vector3};
use crate::base::math::exact::Exact;
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{Cone, Cuboid, Cylinder, OneRay, Shape};
use std::rc::Rc;

/// A solid of revolution around the y axis: its radius is `base` + `slope`·y for y from `low` to 1.
#[derive(Clone, Copy)]
pub struct Profile {
    pub base: f64,
    pub slope: f64,
    pub low: f64,
    /// Whether it has end caps.
    pub closed: bool,
}

const CYLINDER: Profile = Profile { base: 1.0, slope: 0.0, low: -1.0, closed: true };
/// With the tip at y = 1.
const CONE: Profile = Profile { base: 1.0, slope: -1.0, low: 0.0, closed: true };

#[derive(Clone)]
struct SolidRay<R> {
    profile: Profile,
    origin: Vector3<R>,
    direction: Vector3<R>,
    shape: Rc<Shape>,
    probe: TraversalRay,
}

/// The textbook: the smallest t above `least` of the roots of the side's quadratic between the ends, and of the hits
/// with the end caps.
pub fn nearest<R: Number>(
    profile: &Profile,
    origin: Vector3<R>,
    direction: Vector3<R>,
    least: R,
) -> Option<R> {
    let (base, slope, low) = (R::of(profile.base), R::of(profile.slope), R::of(profile.low));
    let Vector3([x, y, z]) = origin;
    let Vector3([dx, dy, dz]) = direction;
    let (radius, growth) = (base + slope * y, slope * dy);
    let a = dx * dx + dz * dz - growth * growth;
    let b = x * dx + z * dz - radius * growth;
    let c = x * x + z * z - radius * radius;
    let discriminant = b * b - a * c;
    let mut best = None;
    let mut take = |t: R| {
        if t > least && best.is_none_or(|best| t < best) {
            best = Some(t);
        }
    };
    if discriminant >= R::zero() {
        let root = discriminant.sqrt();
        for t in [(-b - root) / a, (-b + root) / a] {
            let height = y + t * dy;
            if height >= low && height <= R::one() {
                take(t);
            }
        }
    }
    for end in [low, R::one()].into_iter().filter(|_| profile.closed) {
        let t = (end - y) / dy;
        let (px, pz, radius) = (x + t * dx, z + t * dz, base + slope * end);
        if px * px + pz * pz <= radius * radius {
            take(t);
        }
    }
    best
}

/// The same from the line's point next to the centre.
pub fn recentred(profile: &Profile, origin: Vector3<f32>, direction: Vector3<f32>) -> Option<f32> {
    let shift = -origin.dot(direction) / direction.dot(direction);
    let near = origin + direction * shift;
    // The solid may begin before that point, so the line starts in front of the solid.
    let back = (4.0 * profile.base as f32).max(4.0) / direction.length();
    nearest(profile, near - direction * back, direction, (back - shift).max(0.0)).map(|t| t + (shift - back))
}

fn stable(at: &SolidRay<f32>) -> Option<f32> {
    recentred(&at.profile, at.origin, at.direction)
}

fn textbook<R: Float>(at: &SolidRay<R>) -> Option<R> {
    nearest(&at.profile, at.origin, at.direction, R::zero())
}

fn ours(at: &SolidRay<f64>) -> Option<f64> {
    at.shape.intersect_up_to(&at.probe, f64::INFINITY).map(|at| at.t)
}

fn judge<R: Float>(at: &SolidRay<R>, found: Option<R>) -> Verdict {
    let exact = nearest::<Exact>(&at.profile, at.origin.to(), at.direction.to(), Exact::zero());
    match (found, exact) {
        (Some(t), Some(exact)) => {
            let off = (Exact::of(t.wide()) - exact).value().abs() * at.direction.wide().length();
            // All rays are aimed well inside the solid, so a larger error is a hit with another part of it.
            Verdict { off: Some(off), wrong: off > 0.1 }
        }
        (found, exact) => Verdict::wrong_if(found.is_some() != exact.is_some()),
    }
}

/// Rays from afar towards points well inside the solid.
fn inputs<R: Float>(
    profile: Profile,
    shape: &Rc<Shape>,
    distance: f64,
    workload: Workload,
) -> Vec<SolidRay<R>> {
    let mut rng = InputRng::new(9);
    let one = |_| {
        let height = rng.uniform(profile.low, 1.0) * 0.8;
        let radius = 0.8 * (profile.base + profile.slope * height);
        let aim = rng.ring(DVec3::Y, 0.0, radius) + DVec3::Y * height;
        let from = rng.direction() * distance;
        let (origin, direction) = (Vector3::<R>::of(from), Vector3::<R>::of((aim - from).normalize()));
        let probe = TraversalRay::new(Ray { origin: origin.wide(), direction: direction.wide() });
        SolidRay { profile, origin, direction, shape: Rc::clone(shape), probe }
    };
    (0..workload.inputs).map(one).collect()
}

fn solid(
    what: &'static str,
    profile: Profile,
    shape: Option<Shape>,
    distance: f64,
    workload: Workload,
) -> Option<Case> {
    let shape = Rc::new(shape?);
    Some(Case {
        id: "INT-09",
        what,
        error: "largest error of t, in radii",
        wrong: "missed, or off by 0.1",
        methods: [
            method(inputs::<f32>(profile, &shape, distance, workload), textbook, judge),
            method(inputs::<f64>(profile, &shape, distance, workload), textbook, judge),
            method(inputs::<f32>(profile, &shape, distance, workload), stable, judge),
            method(inputs::<f64>(profile, &shape, distance, workload), ours, judge),
        ],
    })
}

/// A ray at the box from 0 to 1.
#[derive(Clone, Copy)]
struct FaceRay<R> {
    origin: Vector3<R>,
    direction: Vector3<R>,
    probe: TraversalRay,
}

/// The slab test of Kay and Kajiya, with minima and maxima as in most programs.
fn slabs<R: Float>(at: &FaceRay<R>) -> bool {
    let (mut enter, mut leave) = (R::zero(), R::of(f64::INFINITY));
    for axis in 0..3 {
        let inverse = R::one() / at.direction.0[axis];
        let a = (R::zero() - at.origin.0[axis]) * inverse;
        let b = (R::one() - at.origin.0[axis]) * inverse;
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    enter <= leave
}

/// The slab test with planes sorted by the sign of the direction; comparisons with NaN keep the previous value (Ize
/// 2013).
fn signed_slabs(at: &FaceRay<f32>) -> bool {
    let (mut enter, mut leave) = (0.0, f32::INFINITY);
    for axis in 0..3 {
        let inverse = 1.0 / at.direction.0[axis];
        let a = (0.0 - at.origin.0[axis]) * inverse;
        let b = (1.0 - at.origin.0[axis]) * inverse;
        let (near, far) = if inverse.is_sign_positive() { (a, b) } else { (b, a) };
        if near > enter {
            enter = near;
        }
        if far < leave {
            leave = far;
        }
    }
    enter <= leave * (1.0 + 4.0 * f32::EPSILON)
}

/// Rays along an axis through corners, edges and the centre of a face: all of them hit the box.
fn along<R: Float>() -> Vec<FaceRay<R>> {
    let mut rays = Vec::new();
    for (x, y) in [0.0, 0.5, 1.0].into_iter().flat_map(|x| [0.0, 0.5, 1.0].map(|y| (x, y))) {
        for (dx, dy) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)] {
            let ray = Ray { origin: DVec3::new(x, y, -1.0), direction: DVec3::new(dx, dy, 1.0) };
            rays.push(FaceRay {
                origin: Vector3::of(ray.origin),
                direction: Vector3::of(ray.direction),
                probe: TraversalRay::new(ray),
            });
        }
    }
    rays
}

fn flat_rays() -> Case {
    const BOX: Cuboid = Cuboid { min: DVec3::ZERO, max: DVec3::ONE };
    fn judge<R>(_: &FaceRay<R>, found: bool) -> Verdict {
        Verdict::wrong_if(!found)
    }
    Case {
        id: "BVH-01",
        what: "rays along an axis, in the faces and edges of a box",
        error: "",
        wrong: "box missed",
        methods: [
            method(along::<f32>(), slabs, judge),
            method(along::<f64>(), slabs, judge),
            method(along::<f32>(), signed_slabs, judge),
            method(along::<f64>(), |at| BOX.occludes_up_to(&at.probe, f64::INFINITY), judge),
        ],
    }
}

pub fn cases(workload: Workload) -> Vec<Case> {
    let cylinder = || Cylinder::new(DVec3::NEG_Y, DVec3::Y, 1.0, true).map(Shape::Cylinder);
    let cone = || Cone::new(DVec3::ZERO, DVec3::Y, 1.0, 0.0, true).map(Shape::Cone);
    let solids = [
        solid("closed cylinder, seen from 10^4 radii away", CYLINDER, cylinder(), 1e4, workload),
        solid("closed cone, seen from 10^4 radii away", CONE, cone(), 1e4, workload),
        solid("closed cone, seen from 10^6 radii away", CONE, cone(), 1e6, workload),
    ];
    solids.into_iter().flatten().chain([flat_rays()]).collect()
}
