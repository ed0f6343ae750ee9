//! Sampling: frames around directions, and distant small lights.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Number, Vector3};
use crate::base::math::exact::Exact;
use crate::base::math::{Angle, DVec3};
use crate::geometry::shape::{Geometric, Sphere};
use crate::sampling::{FrameAxes, LocalFrame};

type Axes<R> = [Vector3<R>; 3];

/// Frisvad's frame (2012), which divides by 1 + z.
fn frisvad<R: Float>(n: &Vector3<R>) -> Axes<R> {
    let Vector3([x, y, z]) = *n;
    let one = R::one();
    if z < R::of(-0.999_999_9) {
        return [Vector3([R::zero(), -one, R::zero()]), Vector3([-one, R::zero(), R::zero()]), *n];
    }
    let a = one / (one + z);
    let b = -x * y * a;
    [Vector3([one - x * x * a, b, -x]), Vector3([b, one - y * y * a, -y]), *n]
}

/// The frame of Duff and others (2017), with the sign of z.
fn duff(n: &Vector3<f32>) -> Axes<f32> {
    let Vector3([x, y, z]) = *n;
    let sign = 1.0f32.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [Vector3([1.0 + sign * x * x * a, sign * b, -sign * x]), Vector3([b, sign + y * y * a, -y]), *n]
}

fn frames(workload: Workload) -> Case {
    fn inputs<R: Float>(workload: Workload) -> Vec<Vector3<R>> {
        let mut rng = InputRng::new(14);
        let one = |_| {
            let (off, turn) = (rng.log_uniform(3e-5, 0.1), Angle(360.0 * rng.unit()).cos_sin());
            let across = turn * libm::sin(off);
            Vector3::<R>::of(DVec3::new(across.x, across.y, -libm::cos(off))).unit()
        };
        (0..workload.inputs).map(one).collect()
    }
    fn ours(n: &Vector3<f64>) -> Axes<f64> {
        let LocalFrame { x, y, z } = LocalFrame::from_z(n.wide().into());
        [x, y, z].map(|axis| Vector3::of(axis.into()))
    }
    fn judge<R: Float>(_: &Vector3<R>, axes: Axes<R>) -> Verdict {
        let [x, y, z] = axes.map(Vector3::wide);
        let lengths = [x, y].map(|axis| (axis.length() - 1.0).abs());
        let angles = [x.dot(y), y.dot(z), z.dot(x)].map(f64::abs);
        Verdict::off(lengths.into_iter().chain(angles).fold(0.0, |a, b| if a > b { a } else { b }))
    }
    Case {
        id: "SA-06",
        what: "frame around directions 3·10^-5 to 0.1 radians off -z",
        error: "largest defect of lengths and right angles",
        wrong: "no number",
        methods: [
            method(inputs::<f32>(workload), frisvad, judge),
            method(inputs::<f64>(workload), frisvad, judge),
            method(inputs::<f32>(workload), duff, judge),
            method(inputs::<f64>(workload), ours, judge),
        ],
    }
}

/// A spherical light and its distance.
#[derive(Clone, Copy)]
struct DistantLight<R> {
    radius: R,
    distance: R,
    light: Sphere,
}

fn lights<R: Float>(workload: Workload) -> Vec<DistantLight<R>> {
    let mut rng = InputRng::new(16);
    let one = |_| {
        let (radius, distance) = (R::of(rng.log_uniform(1e-6, 0.5)), R::one());
        let light = Sphere { center: DVec3::X * distance.wide(), radius: radius.wide() };
        DistantLight { radius, distance, light }
    };
    (0..workload.inputs).map(one).collect()
}

/// The pdf of directions in the cone around a sphere: 1 / (2π (1 - cos θ)).
fn pdf<R: Float>(at: &DistantLight<R>) -> R {
    let sine = at.radius / at.distance;
    let cosine = (R::one() - sine * sine).sqrt();
    R::one() / (R::of(std::f64::consts::TAU) * (R::one() - cosine))
}

/// The same, with 1 - cos θ as sin² θ / (1 + cos θ).
fn stable_pdf<R: Number>(at: &DistantLight<R>, tau: R) -> R {
    let sine = at.radius / at.distance;
    let cosine = ((R::one() - sine) * (R::one() + sine)).sqrt();
    (R::one() + cosine) / (tau * sine * sine)
}

fn small_lights(workload: Workload) -> Case {
    fn stable(at: &DistantLight<f32>) -> f32 {
        stable_pdf(at, std::f32::consts::TAU)
    }
    fn ours(at: &DistantLight<f64>) -> f64 {
        let eye = FrameAxes::identity();
        let (_, _, pdf) = at.light.sample_from(DVec3::ZERO.into(), &eye, 0.5, 0.5);
        pdf
    }
    fn judge<R: Float>(at: &DistantLight<R>, found: R) -> Verdict {
        let exact =
            DistantLight { radius: Exact::of(at.radius.wide()), distance: Exact::one(), light: at.light };
        // 2π as a double-double number.
        let tau = Exact { high: std::f64::consts::TAU, low: 2.449_293_598_294_706_4e-16 };
        let exact = stable_pdf(&exact, tau);
        Verdict::off(((Exact::of(found.wide()) - exact) / exact).value().abs())
    }
    Case {
        id: "SH-18",
        what: "density of directions to a light of radius 10^-6 to 0.5 at distance 1 (ours: with a point of it)",
        error: "largest relative error",
        wrong: "no number",
        methods: [
            method(lights::<f32>(workload), pdf, judge),
            method(lights::<f64>(workload), pdf, judge),
            method(lights::<f32>(workload), stable, judge),
            method(lights::<f64>(workload), ours, judge),
        ],
    }
}

pub fn cases(workload: Workload) -> Vec<Case> {
    vec![frames(workload), small_lights(workload)]
}
