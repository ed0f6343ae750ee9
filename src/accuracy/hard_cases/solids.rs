//! Cylinders and cones from afar, and boxes along their faces.

use super::draw::Draw;
use super::measure::{Case, Effort, Verdict, way};
use super::real::{Machine, Real, V};
use crate::accuracy::exact::Exact;
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::Probe;
use crate::geometry::shape::{Cone, Cuboid, Cylinder, OneRay, Shape};
use std::rc::Rc;

/// A closed solid around the y axis: its radius is `base` + `slope`·y from `low` to 1.
#[derive(Clone, Copy)]
pub struct Profile {
    pub base: f64,
    pub slope: f64,
    pub low: f64,
    /// Whether it has ends.
    pub closed: bool,
}

const CYLINDER: Profile = Profile { base: 1.0, slope: 0.0, low: -1.0, closed: true };
/// With its tip at y = 1.
const CONE: Profile = Profile { base: 1.0, slope: -1.0, low: 0.0, closed: true };

#[derive(Clone)]
struct Aimed<R> {
    profile: Profile,
    origin: V<R>,
    direction: V<R>,
    shape: Rc<Shape>,
    probe: Probe,
}

/// The textbook: roots of the side's quadratic between the ends, and ends within their radius; the nearest of them beyond
/// `least`.
pub fn nearest<R: Real>(profile: &Profile, origin: V<R>, direction: V<R>, least: R) -> Option<R> {
    let (base, slope, low) = (R::of(profile.base), R::of(profile.slope), R::of(profile.low));
    let V([x, y, z]) = origin;
    let V([dx, dy, dz]) = direction;
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
        let root = discriminant.root();
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

/// The same from the point of the line next to the middle.
pub fn recentred(profile: &Profile, origin: V<f32>, direction: V<f32>) -> Option<f32> {
    let shift = -origin.dot(direction) / direction.dot(direction);
    let near = origin + direction * shift;
    // From there on the whole line counts, so it is begun before the solid.
    let back = (4.0 * profile.base as f32).max(4.0) / direction.length();
    nearest(profile, near - direction * back, direction, (back - shift).max(0.0)).map(|t| t + (shift - back))
}

fn stable(at: &Aimed<f32>) -> Option<f32> {
    recentred(&at.profile, at.origin, at.direction)
}

fn textbook<R: Machine>(at: &Aimed<R>) -> Option<R> {
    nearest(&at.profile, at.origin, at.direction, R::zero())
}

fn ours(at: &Aimed<f64>) -> Option<f64> {
    at.shape.hit(&at.probe, f64::INFINITY).map(|at| at.t)
}

fn judge<R: Machine>(at: &Aimed<R>, found: Option<R>) -> Verdict {
    let exact = nearest::<Exact>(&at.profile, at.origin.to(), at.direction.to(), Exact::zero());
    match (found, exact) {
        (Some(t), Some(exact)) => {
            let off = (Exact::of(t.wide()) - exact).value().abs() * at.direction.wide().length();
            // An answer on the far side of the solid is no near miss: the rays are aimed well within.
            Verdict { off: Some(off), wrong: off > 0.1 }
        }
        (found, exact) => Verdict::wrong_if(found.is_some() != exact.is_some()),
    }
}

/// Rays from afar at points well within the solid.
fn inputs<R: Machine>(profile: Profile, shape: &Rc<Shape>, distance: f64, effort: Effort) -> Vec<Aimed<R>> {
    let mut draw = Draw::new(9);
    let one = |_| {
        let height = draw.between(profile.low, 1.0) * 0.8;
        let radius = 0.8 * (profile.base + profile.slope * height);
        let aim = draw.ring(DVec3::Y, 0.0, radius) + DVec3::Y * height;
        let from = draw.direction() * distance;
        let (origin, direction) = (V::<R>::of(from), V::<R>::of((aim - from).normalize()));
        let probe = Probe::new(Ray { origin: origin.wide(), direction: direction.wide() });
        Aimed { profile, origin, direction, shape: Rc::clone(shape), probe }
    };
    (0..effort.inputs).map(one).collect()
}

fn solid(
    what: &'static str,
    profile: Profile,
    shape: Option<Shape>,
    distance: f64,
    effort: Effort,
) -> Option<Case> {
    let shape = Rc::new(shape?);
    Some(Case {
        id: "INT-09",
        what,
        error: "largest error of t, in radii",
        wrong: "missed, or off by 0.1",
        ways: [
            way(inputs::<f32>(profile, &shape, distance, effort), textbook, judge),
            way(inputs::<f64>(profile, &shape, distance, effort), textbook, judge),
            way(inputs::<f32>(profile, &shape, distance, effort), stable, judge),
            way(inputs::<f64>(profile, &shape, distance, effort), ours, judge),
        ],
    })
}

/// A ray and the box from 0 to 1.
#[derive(Clone, Copy)]
struct Along<R> {
    origin: V<R>,
    direction: V<R>,
    probe: Probe,
}

/// Kay and Kajiya's slabs, with the minima and maxima that most programs write.
fn slabs<R: Machine>(at: &Along<R>) -> bool {
    let (mut enter, mut leave) = (R::zero(), R::of(f64::INFINITY));
    for axis in 0..3 {
        let inverse = R::one() / at.direction.0[axis];
        let a = (R::zero() - at.origin.0[axis]) * inverse;
        let b = (R::one() - at.origin.0[axis]) * inverse;
        enter = enter.larger(a.smaller(b));
        leave = leave.smaller(a.larger(b));
    }
    enter <= leave
}

/// Planes by the sign of the direction; comparisons keep what was there before something that is no number (Ize 2013).
fn signed_slabs(at: &Along<f32>) -> bool {
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

/// Rays along an axis through corners, edges and middles of a face: all of them meet the box.
fn along<R: Machine>() -> Vec<Along<R>> {
    let mut rays = Vec::new();
    for (x, y) in [0.0, 0.5, 1.0].into_iter().flat_map(|x| [0.0, 0.5, 1.0].map(|y| (x, y))) {
        for (dx, dy) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)] {
            let ray = Ray { origin: DVec3::new(x, y, -1.0), direction: DVec3::new(dx, dy, 1.0) };
            rays.push(Along {
                origin: V::of(ray.origin),
                direction: V::of(ray.direction),
                probe: Probe::new(ray),
            });
        }
    }
    rays
}

fn flat_rays() -> Case {
    const BOX: Cuboid = Cuboid { min: DVec3::ZERO, max: DVec3::ONE };
    fn judge<R>(_: &Along<R>, found: bool) -> Verdict {
        Verdict::wrong_if(!found)
    }
    Case {
        id: "BVH-01",
        what: "rays along an axis, in the faces and edges of a box",
        error: "",
        wrong: "box missed",
        ways: [
            way(along::<f32>(), slabs, judge),
            way(along::<f64>(), slabs, judge),
            way(along::<f32>(), signed_slabs, judge),
            way(along::<f64>(), |at| BOX.blocks(&at.probe, f64::INFINITY), judge),
        ],
    }
}

pub fn cases(effort: Effort) -> Vec<Case> {
    let cylinder = || Cylinder::new(DVec3::NEG_Y, DVec3::Y, 1.0, true).map(Shape::Cylinder);
    let cone = || Cone::new(DVec3::ZERO, DVec3::Y, 1.0, 0.0, true).map(Shape::Cone);
    let solids = [
        solid("closed cylinder, seen from 10^4 radii away", CYLINDER, cylinder(), 1e4, effort),
        solid("closed cone, seen from 10^4 radii away", CONE, cone(), 1e4, effort),
        solid("closed cone, seen from 10^6 radii away", CONE, cone(), 1e6, effort),
    ];
    solids.into_iter().flatten().chain([flat_rays()]).collect()
}
