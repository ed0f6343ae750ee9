//! What random numbers are bent into: frames around directions, and small lights far away.

use super::draw::Draw;
use super::measure::{Case, Effort, Verdict, way};
use super::real::{Machine, Real, V};
use crate::accuracy::exact::Exact;
use crate::base::math::{Angle, DVec3};
use crate::geometry::shape::{Geometric, Sphere};
use crate::sampling::Frame;

type Axes<R> = [V<R>; 3];

/// Frisvad's frame (2012), which divides by 1 + z.
fn frisvad<R: Machine>(n: &V<R>) -> Axes<R> {
    let V([x, y, z]) = *n;
    let one = R::one();
    if z < R::of(-0.999_999_9) {
        return [V([R::zero(), -one, R::zero()]), V([-one, R::zero(), R::zero()]), *n];
    }
    let a = one / (one + z);
    let b = -x * y * a;
    [V([one - x * x * a, b, -x]), V([b, one - y * y * a, -y]), *n]
}

/// Duff's and others' (2017), with the sign of z.
fn duff(n: &V<f32>) -> Axes<f32> {
    let V([x, y, z]) = *n;
    let sign = 1.0f32.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [V([1.0 + sign * x * x * a, sign * b, -sign * x]), V([b, sign + y * y * a, -y]), *n]
}

fn frames(effort: Effort) -> Case {
    fn inputs<R: Machine>(effort: Effort) -> Vec<V<R>> {
        let mut draw = Draw::new(14);
        let one = |_| {
            let (off, turn) = (draw.scale(3e-5, 0.1), Angle(360.0 * draw.unit()).cos_sin());
            let across = turn * libm::sin(off);
            V::<R>::of(DVec3::new(across.x, across.y, -libm::cos(off))).unit()
        };
        (0..effort.inputs).map(one).collect()
    }
    fn ours(n: &V<f64>) -> Axes<f64> {
        let Frame { x, y, z } = Frame::around(n.wide().into());
        [x, y, z].map(|axis| V::of(axis.into()))
    }
    fn judge<R: Machine>(_: &V<R>, axes: Axes<R>) -> Verdict {
        let [x, y, z] = axes.map(V::wide);
        let lengths = [x, y].map(|axis| (axis.length() - 1.0).abs());
        let angles = [x.dot(y), y.dot(z), z.dot(x)].map(f64::abs);
        Verdict::off(lengths.into_iter().chain(angles).fold(0.0, |a, b| if a > b { a } else { b }))
    }
    Case {
        id: "SA-06",
        what: "frame around directions 3·10^-5 to 0.1 radians off -z",
        error: "largest defect of lengths and right angles",
        wrong: "no number",
        ways: [
            way(inputs::<f32>(effort), frisvad, judge),
            way(inputs::<f64>(effort), frisvad, judge),
            way(inputs::<f32>(effort), duff, judge),
            way(inputs::<f64>(effort), ours, judge),
        ],
    }
}

/// A spherical light and its distance.
#[derive(Clone, Copy)]
struct Far<R> {
    radius: R,
    distance: R,
    light: Sphere,
}

fn lights<R: Machine>(effort: Effort) -> Vec<Far<R>> {
    let mut draw = Draw::new(16);
    let one = |_| {
        let (radius, distance) = (R::of(draw.scale(1e-6, 0.5)), R::one());
        let light = Sphere { center: DVec3::X * distance.wide(), radius: radius.wide() };
        Far { radius, distance, light }
    };
    (0..effort.inputs).map(one).collect()
}

/// The density of directions within the cone that holds a sphere: 1 / (2π (1 - cos θ)).
fn density<R: Machine>(at: &Far<R>) -> R {
    let sine = at.radius / at.distance;
    let cosine = (R::one() - sine * sine).root();
    R::one() / (R::of(std::f64::consts::TAU) * (R::one() - cosine))
}

/// 1 - cos θ as sin² θ / (1 + cos θ).
fn stable_density<R: Real>(at: &Far<R>, tau: R) -> R {
    let sine = at.radius / at.distance;
    let cosine = ((R::one() - sine) * (R::one() + sine)).root();
    (R::one() + cosine) / (tau * sine * sine)
}

fn small_lights(effort: Effort) -> Case {
    fn stable(at: &Far<f32>) -> f32 {
        stable_density(at, std::f32::consts::TAU)
    }
    fn ours(at: &Far<f64>) -> f64 {
        let eye = Frame::identity();
        let (_, _, pdf) = at.light.sample_from(DVec3::ZERO.into(), &eye, 0.5, 0.5);
        pdf
    }
    fn judge<R: Machine>(at: &Far<R>, found: R) -> Verdict {
        let exact = Far { radius: Exact::of(at.radius.wide()), distance: Exact::one(), light: at.light };
        // 2π to twice the digits of f64.
        let tau = Exact { high: std::f64::consts::TAU, low: 2.449_293_598_294_706_4e-16 };
        let exact = stable_density(&exact, tau);
        Verdict::off(((Exact::of(found.wide()) - exact) / exact).value().abs())
    }
    Case {
        id: "SH-18",
        what: "density of directions to a light of radius 10^-6 to 0.5 at distance 1 (ours: with a point of it)",
        error: "largest relative error",
        wrong: "no number",
        ways: [
            way(lights::<f32>(effort), density, judge),
            way(lights::<f64>(effort), density, judge),
            way(lights::<f32>(effort), stable, judge),
            way(lights::<f64>(effort), ours, judge),
        ],
    }
}

pub fn cases(effort: Effort) -> Vec<Case> {
    vec![frames(effort), small_lights(effort)]
}
