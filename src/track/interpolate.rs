//! Types that can be animated, and their interpolation between keys.

use super::spline::catmull_rom;
use crate::base::color::Rgb;
use crate::base::math::{Angle, DQuat, DVec3, slerp};
use crate::base::time::Fraction;

/// The interpolations that a type supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modes {
    /// Steps only: booleans and names.
    Step,
    /// Every easing between two keys, but not splines through several.
    Ease,
    All,
}

/// A type that keys can animate.
pub trait Animate: Clone + PartialEq {
    const MODES: Modes;

    /// The value at the fraction `s` from `a` (0) to `b` (1). For easings that overshoot, `s` is outside 0..=1.
    fn mix(a: &Self, b: &Self, s: Fraction) -> Self;

    /// The value at the fraction `s` from `points[1]` to `points[2]`, on a spline through all four points.
    fn spline(points: [&Self; 4], s: f64) -> Self {
        Self::mix(points[1], points[2], Fraction::real(s))
    }

    /// The value at the fraction `s` of a cubic Hermite curve between two values. The tangents at its ends are per
    /// length of the segment. Values that only step hold.
    fn hermite(ends: [&Self; 2], _tangents: [&Self; 2], _s: f64) -> Self {
        ends[0].clone()
    }
}

/// The weights of a cubic Hermite curve at the fraction `s`: of its ends, and of the tangents there.
fn hermite_weights(s: f64) -> [f64; 4] {
    let (square, cube) = (s * s, s * s * s);
    [2.0 * cube - 3.0 * square + 1.0, 3.0 * square - 2.0 * cube, cube - 2.0 * square + s, cube - square]
}

/// Values that only step: the value of a key holds until the next key.
macro_rules! steps {
    ($($type:ty),*) => {$(
        impl Animate for $type {
            const MODES: Modes = Modes::Step;

            fn mix(a: &Self, _: &Self, _: Fraction) -> Self {
                a.clone()
            }
        }
    )*};
}
steps!(bool, usize);

impl Animate for f64 {
    const MODES: Modes = Modes::All;

    fn mix(a: &Self, b: &Self, s: Fraction) -> Self {
        a + (b - a) * s.num / s.den
    }

    fn spline(p: [&Self; 4], s: f64) -> Self {
        catmull_rom(p.map(|&v| DVec3::new(v, 0.0, 0.0)), s).x
    }

    fn hermite([a, b]: [&Self; 2], [leaving, arriving]: [&Self; 2], s: f64) -> Self {
        let [of_a, of_b, of_leaving, of_arriving] = hermite_weights(s);
        a * of_a + leaving * of_leaving + b * of_b + arriving * of_arriving
    }
}

impl Animate for DVec3 {
    const MODES: Modes = Modes::All;

    fn mix(a: &Self, b: &Self, s: Fraction) -> Self {
        *a + (*b - *a) * s.num / s.den
    }

    fn spline(p: [&Self; 4], s: f64) -> Self {
        catmull_rom(p.map(|&v| v), s)
    }

    fn hermite([a, b]: [&Self; 2], [leaving, arriving]: [&Self; 2], s: f64) -> Self {
        let [of_a, of_b, of_leaving, of_arriving] = hermite_weights(s);
        *a * of_a + *leaving * of_leaving + *b * of_b + *arriving * of_arriving
    }
}

/// Colours mix in linear light.
impl Animate for Rgb {
    const MODES: Modes = Modes::All;

    fn mix(a: &Self, b: &Self, s: Fraction) -> Self {
        DVec3::mix(&a.as_dvec3(), &b.as_dvec3(), s).as_vec3()
    }

    fn spline(p: [&Self; 4], s: f64) -> Self {
        catmull_rom(p.map(|&v| v.as_dvec3()), s).as_vec3()
    }

    fn hermite(ends: [&Self; 2], tangents: [&Self; 2], s: f64) -> Self {
        let ([a, b], [leaving, arriving]) = (ends.map(|v| v.as_dvec3()), tangents.map(|v| v.as_dvec3()));
        DVec3::hermite([&a, &b], [&leaving, &arriving], s).as_vec3()
    }
}

impl Animate for Angle {
    const MODES: Modes = Modes::All;

    fn mix(a: &Self, b: &Self, s: Fraction) -> Self {
        Angle::mix(*a, *b, s)
    }

    fn spline(p: [&Self; 4], s: f64) -> Self {
        Self(f64::spline(p.map(|angle| &angle.0), s))
    }
}

impl Animate for DQuat {
    const MODES: Modes = Modes::Ease;

    fn mix(a: &Self, b: &Self, s: Fraction) -> Self {
        slerp(*a, *b, s.value())
    }

    /// The curve of the four components, scaled to length 1.
    fn hermite([a, b]: [&Self; 2], [leaving, arriving]: [&Self; 2], s: f64) -> Self {
        let [of_a, of_b, of_leaving, of_arriving] = hermite_weights(s);
        let curve = *a * of_a + *leaving * of_leaving + *b * of_b + *arriving * of_arriving;
        if curve.length_squared() > 0.0 { curve.normalize() } else { *a }
    }
}

/// A value above zero that changes by equal factors in equal times, so that zooms look even.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogScale(pub f64);

impl Animate for LogScale {
    const MODES: Modes = Modes::Ease;

    fn mix(a: &Self, b: &Self, s: Fraction) -> Self {
        if a == b {
            return *a;
        }
        Self(a.0 * libm::exp(libm::log(b.0 / a.0) * s.value()))
    }
}
