//! Tori: roots of quartics.

use super::draw::Draw;
use super::measure::{Case, Effort, Verdict, way};
use super::real::{Machine, Real, V};
use crate::accuracy::exact::Exact;
use crate::base::math::{Angle, DVec3, Ray};
use crate::geometry::bvh::Probe;
use crate::geometry::shape::{OneRay, Torus};
use std::rc::Rc;

const MAJOR: f64 = 1.0;
const MINOR: f64 = 0.25;

#[derive(Clone)]
struct Aimed<R> {
    origin: V<R>,
    /// Of unit length, to rounding.
    direction: V<R>,
    torus: Rc<Torus>,
    probe: Probe,
}

/// Coefficients of t⁴ + a t³ + b t² + c t + d along a line, the torus of radii 1 and `minor` around the y axis.
pub fn quartic<R: Real>(minor: f64, origin: V<R>, direction: V<R>) -> [R; 4] {
    let (two, four) = (R::of(2.0), R::of(4.0));
    let ring = R::of(MAJOR * MAJOR);
    let along = origin.dot(direction);
    let k = origin.dot(origin) - ring - R::of(minor * minor);
    let (y, dy) = (origin.0[1], direction.0[1]);
    [
        four * along,
        two * k + four * along * along + four * ring * dy * dy,
        four * k * along + R::of(8.0) * ring * y * dy,
        k * k - four * ring * (R::of(minor * minor) - y * y),
    ]
}

/// Ferrari's roots of a quartic (Schwarze, *Graphics Gems*, 1990): the least one above a bound.
pub fn ferrari<R: Machine>([a, b, c, d]: [R; 4], above: R) -> Option<R> {
    let (half, quarter) = (R::of(0.5), R::of(0.25));
    let square = a * a;
    let p = b - R::of(0.375) * square;
    let q = R::of(0.125) * square * a - half * a * b + c;
    let r = R::of(-3.0 / 256.0) * square * square + R::of(1.0 / 16.0) * square * b - quarter * a * c + d;
    let z = resolvent(R::of(-0.5) * p, -r, half * r * p - R::of(0.125) * q * q);
    let (u, v) = (z * z - r, R::of(2.0) * z - p);
    if u < R::zero() || v < R::zero() {
        return None;
    }
    let (u, v) = (u.root(), v.root());
    let v = if q < R::zero() { -v } else { v };
    let mut best = None;
    for (linear, constant) in [(v, z - u), (-v, z + u)] {
        let square = quarter * linear * linear - constant;
        if square < R::zero() {
            continue;
        }
        let root = square.root();
        for x in [-half * linear - root, -half * linear + root] {
            let x = x - quarter * a;
            if x > above && best.is_none_or(|best| x < best) {
                best = Some(x);
            }
        }
    }
    best
}

/// A real root of z³ + a z² + b z + c (Cardano).
fn resolvent<R: Machine>(a: R, b: R, c: R) -> R {
    let third = R::of(1.0 / 3.0);
    let p = third * (b - third * a * a);
    let q = R::of(0.5) * (R::of(2.0 / 27.0) * a * a * a - third * a * b + c);
    let discriminant = q * q + p * p * p;
    let root = if discriminant < R::zero() {
        let length = (-p).root();
        let turn = (-q / (length * length * length)).larger(-R::one()).smaller(R::one());
        R::of(2.0) * length * (third * turn.arc_cosine()).cosine()
    } else {
        let root = discriminant.root();
        (root - q).cube_root() - (root + q).cube_root()
    };
    root - third * a
}

fn textbook<R: Machine>(at: &Aimed<R>) -> Option<R> {
    ferrari(quartic(MINOR, at.origin, at.direction), R::zero())
}

/// From the point of the line next to the centre, with two of Newton's steps.
pub fn polished(minor: f64, origin: V<f32>, direction: V<f32>) -> Option<f32> {
    let shift = -origin.dot(direction);
    let near = origin + direction * shift;
    let [a, b, c, d] = quartic(minor, near, direction);
    let mut t = ferrari([a, b, c, d], (-2.0f32).max(-shift))?;
    for _ in 0..2 {
        let value = (((t + a) * t + b) * t + c) * t + d;
        let slope = ((4.0 * t + 3.0 * a) * t + 2.0 * b) * t + c;
        t -= value / slope;
    }
    Some(t + shift)
}

fn stable(at: &Aimed<f32>) -> Option<f32> {
    polished(MINOR, at.origin, at.direction)
}

fn ours(at: &Aimed<f64>) -> Option<f64> {
    at.torus.hit(&at.probe, f64::INFINITY).map(|at| at.t)
}

/// How far the answer lies from the tube.
fn judge<R: Machine>(at: &Aimed<R>, found: Option<R>) -> Verdict {
    let Some(t) = found else { return Verdict::WRONG };
    let V([x, y, z]) = at.origin.to::<Exact>() + at.direction.to::<Exact>() * Exact::of(t.wide());
    let out = (x * x + z * z).sqrt() - Exact::of(MAJOR);
    let off = ((out * out + y * y).sqrt() - Exact::of(MINOR)).value().abs();
    let verdict = Verdict::off(off);
    Verdict { wrong: verdict.wrong || off > 0.1 * MINOR, ..verdict }
}

fn inputs<R: Machine>(distance: f64, effort: Effort) -> Vec<Aimed<R>> {
    let mut draw = Draw::new(18);
    let torus = Rc::new(Torus::new(DVec3::ZERO, DVec3::Y, MAJOR, MINOR));
    let one = |_| {
        let turn = Angle(360.0 * draw.unit()).cos_sin();
        let circle = DVec3::new(turn.x, 0.0, turn.y);
        let aim = circle * MAJOR + draw.direction() * draw.between(0.0, 0.23);
        let from = draw.direction() * distance;
        let (origin, direction) = (V::<R>::of(from), V::<R>::of((aim - from).normalize()));
        let probe = Probe::new(Ray { origin: origin.wide(), direction: direction.wide() });
        Aimed { origin, direction, torus: Rc::clone(&torus), probe }
    };
    // Ferrari's and ours are slow, and so is their judge.
    (0..effort.inputs / 4).map(one).collect()
}

fn case(what: &'static str, distance: f64, effort: Effort) -> Case {
    Case {
        id: "INT-18",
        what,
        error: "largest distance of the hit from the surface",
        wrong: "missed, or off by a tenth of the tube",
        ways: [
            way(inputs::<f32>(distance, effort), textbook, judge),
            way(inputs::<f64>(distance, effort), textbook, judge),
            way(inputs::<f32>(distance, effort), stable, judge),
            way(inputs::<f64>(distance, effort), ours, judge),
        ],
    }
}

pub fn cases(effort: Effort) -> Vec<Case> {
    vec![
        case("torus of radii 1 and 0.25, seen from 5 away", 5.0, effort),
        case("the same, seen from 1000 away", 1e3, effort),
    ]
}
