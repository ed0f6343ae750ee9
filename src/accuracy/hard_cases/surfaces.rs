//! What surfaces reflect: Fresnel's equations at the critical angle, and narrow highlights.

use super::draw::Draw;
use super::measure::{Case, Effort, Verdict, way};
use super::real::{Machine, Real, V};
use crate::accuracy::exact::Exact;
use crate::appearance::optics::{Fresnel, Microfacet, refract};
use crate::base::math::{Angle, DVec3};

/// Light within glass, at a boundary to air across +y.
#[derive(Clone, Copy)]
struct Inside<R> {
    /// Down and to the right, of unit length to rounding.
    direction: V<R>,
}

/// The reflected share by Fresnel's equations from both cosines.
fn equations<R: Real>(cosine: R, refracted: R, eta: R) -> R {
    let s = (cosine - eta * refracted) / (cosine + eta * refracted);
    let p = (eta * cosine - refracted) / (eta * cosine + refracted);
    R::of(0.5) * (s * s + p * p)
}

fn eta<R: Real>() -> R {
    R::one() / R::of(1.5)
}

/// The cosine behind the boundary from that before it: 1 - (1 - cos²) / eta².
fn from_cosine<R: Machine>(at: &Inside<R>) -> R {
    let cosine = at.direction.0[1].absolute();
    let square = R::one() - (R::one() - cosine * cosine) / (eta::<R>() * eta());
    if square < R::zero() { R::one() } else { equations(cosine, square.root(), eta()) }
}

/// From the sine, factored.
fn from_sine<R: Real>(direction: V<R>) -> R {
    let V([x, y, z]) = direction;
    let sine = (x * x + z * z).root() / eta::<R>();
    let square = (R::one() - sine) * (R::one() + sine);
    if square < R::zero() { R::one() } else { equations(y.absolute(), square.root(), eta()) }
}

fn ours(at: &Inside<f64>) -> f64 {
    let direction = at.direction.wide();
    let bent = refract::<f64>(direction.into(), DVec3::Y.into(), 1.0 / 1.5);
    match bent.is_total {
        true => 1.0,
        false => Fresnel::Exact.reflectance(-direction.y, bent.cosine, 1.0 / 1.5),
    }
}

fn judge<R: Machine>(at: &Inside<R>, found: R) -> Verdict {
    let exact = from_sine(at.direction.to::<Exact>().unit());
    Verdict::off((Exact::of(found.wide()) - exact).value().abs())
}

/// Angles around some degrees, nearer and nearer to these.
fn around<R: Machine>(degrees: f64, within: (f64, f64), effort: Effort) -> Vec<Inside<R>> {
    let mut draw = Draw::new(8);
    let one = |_| {
        let off = draw.scale(within.0, within.1) * if draw.unit() < 0.5 { -1.0 } else { 1.0 };
        let (tilt, turn) = (Angle(degrees + off).cos_sin(), Angle(360.0 * draw.unit()).cos_sin());
        Inside { direction: V::of(DVec3::new(tilt.y * turn.x, -tilt.x, tilt.y * turn.y)) }
    };
    (0..effort.inputs).map(one).collect()
}

fn fresnel(what: &'static str, degrees: f64, within: (f64, f64), effort: Effort) -> Case {
    let stable = |at: &Inside<f32>| from_sine(at.direction);
    Case {
        id: "SH-05",
        what,
        error: "largest error of the reflected share",
        wrong: "no number",
        ways: [
            way(around::<f32>(degrees, within, effort), from_cosine, judge),
            way(around::<f64>(degrees, within, effort), from_cosine, judge),
            way(around::<f32>(degrees, within, effort), stable, judge),
            way(around::<f64>(degrees, within, effort), ours, judge),
        ],
    }
}

/// A nearly polished surface, an eye and a light close to where it mirrors that.
#[derive(Clone, Copy)]
struct Polished<R> {
    alpha: R,
    eye: V<R>,
    light: V<R>,
}

/// Smith's Λ.
fn hidden<R: Real>(alpha: R, v: V<R>) -> R {
    let V([x, y, z]) = v;
    let tangent = (x * x + y * y) / (z * z);
    R::of(0.5) * ((R::one() + alpha * alpha * tangent).root() - R::one())
}

/// The GGX distribution as it is printed, with cos²θ (α² - 1) + 1; `below` gives that, and the rest is the same.
fn ggx<R: Real>(at: &Polished<R>, below: fn(V<R>, R) -> R) -> R {
    let square = at.alpha * at.alpha;
    let below = below((at.eye + at.light).unit(), square);
    let normals = square / (R::of(std::f64::consts::PI) * below * below);
    let visible = R::one() / (R::one() + hidden(at.alpha, at.eye) + hidden(at.alpha, at.light));
    normals * visible / (R::of(4.0) * at.eye.0[2])
}

fn printed<R: Real>(half: V<R>, square: R) -> R {
    half.0[2] * half.0[2] * (square - R::one()) + R::one()
}

fn summed<R: Real>(half: V<R>, square: R) -> R {
    let V([x, y, z]) = half;
    z * z * square + x * x + y * y
}

fn polished<R: Machine>(effort: Effort) -> Vec<Polished<R>> {
    let mut draw = Draw::new(6);
    let one = |_| {
        let alpha = draw.scale(1e-4, 1e-2);
        let (tilt, turn) = (Angle(draw.between(5.0, 70.0)).cos_sin(), Angle(360.0 * draw.unit()).cos_sin());
        let eye = DVec3::new(tilt.y * turn.x, tilt.y * turn.y, tilt.x);
        let mirrored = DVec3::new(-eye.x, -eye.y, eye.z);
        let light = (mirrored + draw.direction() * (2.0 * alpha)).normalize();
        Polished { alpha: R::of(alpha), eye: V::of(eye), light: V::of(light) }
    };
    (0..effort.inputs).map(one).collect()
}

fn polished_judge<R: Machine>(at: &Polished<R>, found: R) -> Verdict {
    let exact = Polished { alpha: Exact::of(at.alpha.wide()), eye: at.eye.to(), light: at.light.to() };
    let exact = ggx(&exact, summed);
    Verdict::off(((Exact::of(found.wide()) - exact) / exact).value().abs())
}

fn highlights(effort: Effort) -> Case {
    fn ours(at: &Polished<f64>) -> f64 {
        Microfacet { alpha: at.alpha }.reflected(at.eye.wide().into(), at.light.wide().into())
    }
    Case {
        id: "GGX",
        what: "highlight of a polished surface, alpha from 10^-4 to 10^-2",
        error: "largest relative error",
        wrong: "no number",
        ways: [
            way(polished::<f32>(effort), |at| ggx(at, printed), polished_judge),
            way(polished::<f64>(effort), |at| ggx(at, printed), polished_judge),
            way(polished::<f32>(effort), |at| ggx(at, summed), polished_judge),
            way(polished::<f64>(effort), ours, polished_judge),
        ],
    }
}

pub fn cases(effort: Effort) -> Vec<Case> {
    // asin(1 / 1.5) in degrees.
    let critical = Angle::from_radians(libm::asin(1.0 / 1.5)).0;
    vec![
        fresnel(
            "Fresnel, from glass, 1 to 10^-5 degrees off the critical angle",
            critical,
            (1e-5, 1.0),
            effort,
        ),
        fresnel("Fresnel, from glass, around a right angle", 0.0, (1e-6, 10.0), effort),
        highlights(effort),
    ]
}
