//! Reflection: Fresnel's equations at the critical angle, and narrow highlights.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Number, Vector3};
use crate::appearance::optics::{Fresnel, Microfacet, refract};
use crate::base::math::exact::Exact;
use crate::base::math::{Angle, DVec3};

/// Light inside glass at a boundary to air with the normal +y.
#[derive(Clone, Copy)]
struct Inside<R> {
    /// Towards -y, of unit length up to rounding.
    direction: Vector3<R>,
}

/// The reflectance by Fresnel's equations, from both cosines.
fn equations<R: Number>(cosine: R, refracted: R, eta: R) -> R {
    let s = (cosine - eta * refracted) / (cosine + eta * refracted);
    let p = (eta * cosine - refracted) / (eta * cosine + refracted);
    R::of(0.5) * (s * s + p * p)
}

fn eta<R: Number>() -> R {
    R::one() / R::of(1.5)
}

/// The cosine behind the boundary from the cosine before it: 1 - (1 - cos²) / eta².
fn from_cosine<R: Float>(at: &Inside<R>) -> R {
    let cosine = at.direction.0[1].abs();
    let square = R::one() - (R::one() - cosine * cosine) / (eta::<R>() * eta());
    if square < R::zero() { R::one() } else { equations(cosine, square.sqrt(), eta()) }
}

/// The cosine behind the boundary from the sine, factored.
fn from_sine<R: Number>(direction: Vector3<R>) -> R {
    let Vector3([x, y, z]) = direction;
    let sine = (x * x + z * z).sqrt() / eta::<R>();
    let square = (R::one() - sine) * (R::one() + sine);
    if square < R::zero() { R::one() } else { equations(y.abs(), square.sqrt(), eta()) }
}

fn ours(at: &Inside<f64>) -> f64 {
    let direction = at.direction.wide();
    let bent = refract::<f64>(direction.into(), DVec3::Y.into(), 1.0 / 1.5);
    match bent.is_total {
        true => 1.0,
        false => Fresnel::Exact.reflectance(-direction.y, bent.cosine, 1.0 / 1.5),
    }
}

fn judge<R: Float>(at: &Inside<R>, found: R) -> Verdict {
    let exact = from_sine(at.direction.to::<Exact>().unit());
    Verdict::off((Exact::of(found.wide()) - exact).value().abs())
}

/// Directions at angles around `degrees`, logarithmically distributed in their distance from it.
fn around<R: Float>(degrees: f64, within: (f64, f64), workload: Workload) -> Vec<Inside<R>> {
    let mut rng = InputRng::new(8);
    let one = |_| {
        let off = rng.log_uniform(within.0, within.1) * if rng.unit() < 0.5 { -1.0 } else { 1.0 };
        let (tilt, turn) = (Angle(degrees + off).cos_sin(), Angle(360.0 * rng.unit()).cos_sin());
        Inside { direction: Vector3::of(DVec3::new(tilt.y * turn.x, -tilt.x, tilt.y * turn.y)) }
    };
    (0..workload.inputs).map(one).collect()
}

fn fresnel(what: &'static str, degrees: f64, within: (f64, f64), workload: Workload) -> Case {
    let stable = |at: &Inside<f32>| from_sine(at.direction);
    Case {
        id: "SH-05",
        what,
        error: "largest error of the reflected share",
        wrong: "no number",
        methods: [
            method(around::<f32>(degrees, within, workload), from_cosine, judge),
            method(around::<f64>(degrees, within, workload), from_cosine, judge),
            method(around::<f32>(degrees, within, workload), stable, judge),
            method(around::<f64>(degrees, within, workload), ours, judge),
        ],
    }
}

/// A nearly polished surface, with an eye and a light close to its mirror direction.
#[derive(Clone, Copy)]
struct Polished<R> {
    alpha: R,
    eye: Vector3<R>,
    light: Vector3<R>,
}

/// Smith's Λ.
fn lambda<R: Number>(alpha: R, v: Vector3<R>) -> R {
    let Vector3([x, y, z]) = v;
    let tangent = (x * x + y * y) / (z * z);
    R::of(0.5) * ((R::one() + alpha * alpha * tangent).sqrt() - R::one())
}

/// The microfacet reflection with the GGX distribution; `below` computes the term cos²θ (α² - 1) + 1 of its
/// denominator.
fn ggx<R: Number>(at: &Polished<R>, below: fn(Vector3<R>, R) -> R) -> R {
    let square = at.alpha * at.alpha;
    let below = below((at.eye + at.light).unit(), square);
    let normals = square / (R::of(std::f64::consts::PI) * below * below);
    let visible = R::one() / (R::one() + lambda(at.alpha, at.eye) + lambda(at.alpha, at.light));
    normals * visible / (R::of(4.0) * at.eye.0[2])
}

/// The term as it is usually written.
fn published<R: Number>(half: Vector3<R>, square: R) -> R {
    half.0[2] * half.0[2] * (square - R::one()) + R::one()
}

/// The term as a sum of positive numbers.
fn summed<R: Number>(half: Vector3<R>, square: R) -> R {
    let Vector3([x, y, z]) = half;
    z * z * square + x * x + y * y
}

fn polished<R: Float>(workload: Workload) -> Vec<Polished<R>> {
    let mut rng = InputRng::new(6);
    let one = |_| {
        let alpha = rng.log_uniform(1e-4, 1e-2);
        let (tilt, turn) = (Angle(rng.uniform(5.0, 70.0)).cos_sin(), Angle(360.0 * rng.unit()).cos_sin());
        let eye = DVec3::new(tilt.y * turn.x, tilt.y * turn.y, tilt.x);
        let mirrored = DVec3::new(-eye.x, -eye.y, eye.z);
        let light = (mirrored + rng.direction() * (2.0 * alpha)).normalize();
        Polished { alpha: R::of(alpha), eye: Vector3::of(eye), light: Vector3::of(light) }
    };
    (0..workload.inputs).map(one).collect()
}

fn polished_judge<R: Float>(at: &Polished<R>, found: R) -> Verdict {
    let exact = Polished { alpha: Exact::of(at.alpha.wide()), eye: at.eye.to(), light: at.light.to() };
    let exact = ggx(&exact, summed);
    Verdict::off(((Exact::of(found.wide()) - exact) / exact).value().abs())
}

fn highlights(workload: Workload) -> Case {
    fn ours(at: &Polished<f64>) -> f64 {
        Microfacet { alpha: at.alpha }.reflected(at.eye.wide().into(), at.light.wide().into())
    }
    Case {
        id: "GGX",
        what: "highlight of a polished surface, alpha from 10^-4 to 10^-2",
        error: "largest relative error",
        wrong: "no number",
        methods: [
            method(polished::<f32>(workload), |at| ggx(at, published), polished_judge),
            method(polished::<f64>(workload), |at| ggx(at, published), polished_judge),
            method(polished::<f32>(workload), |at| ggx(at, summed), polished_judge),
            method(polished::<f64>(workload), ours, polished_judge),
        ],
    }
}

pub fn cases(workload: Workload) -> Vec<Case> {
    // asin(1 / 1.5) in degrees.
    let critical = Angle::from_radians(libm::asin(1.0 / 1.5)).0;
    vec![
        fresnel(
            "Fresnel, from glass, 1 to 10^-5 degrees off the critical angle",
            critical,
            (1e-5, 1.0),
            workload,
        ),
        fresnel("Fresnel, from glass, around a right angle", 0.0, (1e-6, 10.0), workload),
        highlights(workload),
    ]
}
