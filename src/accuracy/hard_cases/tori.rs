//! Tori: roots of quartic equations.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Number, Vector3};
use crate::base::math::exact::Exact;
use crate::base::math::{Angle, DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{OneRay, Torus};
use std::rc::Rc;

const MAJOR: f64 = 1.0;
const MINOR: f64 = 0.25;

#[derive(Clone)]
struct TorusRay<R> {
    origin: Vector3<R>,
    /// Of unit length, up to rounding.
    direction: Vector3<R>,
    torus: Rc<Torus>,
    probe: TraversalRay,
}

/// Coefficients of t⁴ + a t³ + b t² + c t + d along a line, for the torus of radii 1 and `minor` around the y axis.
pub fn quartic<R: Number>(minor: f64, origin: Vector3<R>, direction: Vector3<R>) -> [R; 4] {
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

/// The smallest root of a quartic above a bound, by Ferrari's method (Schwarze, *Graphics Gems*, 1990).
pub fn ferrari<R: Float>([a, b, c, d]: [R; 4], above: R) -> Option<R> {
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
    let (u, v) = (u.sqrt(), v.sqrt());
    let v = if q < R::zero() { -v } else { v };
    let mut best = None;
    for (linear, constant) in [(v, z - u), (-v, z + u)] {
        let square = quarter * linear * linear - constant;
        if square < R::zero() {
            continue;
        }
        let root = square.sqrt();
        for x in [-half * linear - root, -half * linear + root] {
            let x = x - quarter * a;
            if x > above && best.is_none_or(|best| x < best) {
                best = Some(x);
            }
        }
    }
    best
}

/// A real root of z³ + a z² + b z + c, by Cardano's method.
fn resolvent<R: Float>(a: R, b: R, c: R) -> R {
    let third = R::of(1.0 / 3.0);
    let p = third * (b - third * a * a);
    let q = R::of(0.5) * (R::of(2.0 / 27.0) * a * a * a - third * a * b + c);
    let discriminant = q * q + p * p * p;
    let root = if discriminant < R::zero() {
        let length = (-p).sqrt();
        let turn = (-q / (length * length * length)).max(-R::one()).min(R::one());
        R::of(2.0) * length * (third * turn.acos()).cos()
    } else {
        let root = discriminant.sqrt();
        (root - q).cbrt() - (root + q).cbrt()
    };
    root - third * a
}

fn textbook<R: Float>(at: &TorusRay<R>) -> Option<R> {
    ferrari(quartic(MINOR, at.origin, at.direction), R::zero())
}

/// Ferrari's root from the line's point next to the centre, with two steps of Newton's method.
pub fn polished(minor: f64, origin: Vector3<f32>, direction: Vector3<f32>) -> Option<f32> {
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

fn stable(at: &TorusRay<f32>) -> Option<f32> {
    polished(MINOR, at.origin, at.direction)
}

fn ours(at: &TorusRay<f64>) -> Option<f64> {
    at.torus.intersect_up_to(&at.probe, f64::INFINITY).map(|at| at.t)
}

/// The distance of the hit from the surface.
fn judge<R: Float>(at: &TorusRay<R>, found: Option<R>) -> Verdict {
    let Some(t) = found else { return Verdict::WRONG };
    let Vector3([x, y, z]) = at.origin.to::<Exact>() + at.direction.to::<Exact>() * Exact::of(t.wide());
    let out = (x * x + z * z).sqrt() - Exact::of(MAJOR);
    let off = ((out * out + y * y).sqrt() - Exact::of(MINOR)).value().abs();
    let verdict = Verdict::off(off);
    Verdict { wrong: verdict.wrong || off > 0.1 * MINOR, ..verdict }
}

fn inputs<R: Float>(distance: f64, workload: Workload) -> Vec<TorusRay<R>> {
    let mut rng = InputRng::new(18);
    let torus = Rc::new(Torus::new(DVec3::ZERO, DVec3::Y, MAJOR, MINOR));
    let one = |_| {
        let turn = Angle(360.0 * rng.unit()).cos_sin();
        let circle = DVec3::new(turn.x, 0.0, turn.y);
        let aim = circle * MAJOR + rng.direction() * rng.uniform(0.0, 0.23);
        let from = rng.direction() * distance;
        let (origin, direction) = (Vector3::<R>::of(from), Vector3::<R>::of((aim - from).normalize()));
        let probe = TraversalRay::new(Ray { origin: origin.wide(), direction: direction.wide() });
        TorusRay { origin, direction, torus: Rc::clone(&torus), probe }
    };
    // Fewer inputs, because these methods and their judge are slow.
    (0..workload.inputs / 4).map(one).collect()
}

fn case(what: &'static str, distance: f64, workload: Workload) -> Case {
    Case {
        id: "INT-18",
        what,
        error: "largest distance of the hit from the surface",
        wrong: "missed, or off by a tenth of the tube",
        methods: [
            method(inputs::<f32>(distance, workload), textbook, judge),
            method(inputs::<f64>(distance, workload), textbook, judge),
            method(inputs::<f32>(distance, workload), stable, judge),
            method(inputs::<f64>(distance, workload), ours, judge),
        ],
    }
}

pub fn cases(workload: Workload) -> Vec<Case> {
    vec![
        case("torus of radii 1 and 0.25, seen from 5 away", 5.0, workload),
        case("the same, seen from 1000 away", 1e3, workload),
    ]
}
