//! Easings: the progress from one key to the next over time.

use std::f64::consts::PI;

/// How a value changes from one key to the next. The curves are those of easings.net and of CSS.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[warn(missing_docs)]
pub enum Ease {
    /// Holds until the next key, then jumps.
    Step,
    /// At a constant speed.
    #[default]
    Linear,
    /// 3s² - 2s³: zero speed at both ends.
    Smooth,
    /// 6s⁵ - 15s⁴ + 10s³: zero speed and acceleration at both ends.
    Smoother,
    /// A cubic Bézier curve from (0, 0) to (1, 1) with the control points (x1, y1) and (x2, y2). Both x are in 0..=1.
    Bezier([f64; 4]),
    /// A centripetal Catmull-Rom curve through the neighbouring keys.
    CatmullRom,
    /// A named curve that eases at the start, at the end or at both.
    Named(Curve, End),
}

/// The ends at which a [`Curve`] eases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    In,
    Out,
    InOut,
}

/// The shape of a named easing, defined at its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curve {
    Sine,
    Quad,
    Cubic,
    Quart,
    Quint,
    Expo,
    Circ,
    Back,
    Elastic,
    Bounce,
}

const CURVES: [(&str, Curve); 10] = [
    ("Sine", Curve::Sine),
    ("Quad", Curve::Quad),
    ("Cubic", Curve::Cubic),
    ("Quart", Curve::Quart),
    ("Quint", Curve::Quint),
    ("Expo", Curve::Expo),
    ("Circ", Curve::Circ),
    ("Back", Curve::Back),
    ("Elastic", Curve::Elastic),
    ("Bounce", Curve::Bounce),
];

/// The easings with a name of their own, not composed of an [`End`] and a [`Curve`].
const PLAIN: [(&str, Ease); 9] = [
    ("Step", Ease::Step),
    ("Linear", Ease::Linear),
    ("Smooth", Ease::Smooth),
    ("Smoother", Ease::Smoother),
    ("CatmullRom", Ease::CatmullRom),
    // The keywords of CSS (css-easing-1, section 2.3).
    ("Ease", Ease::Bezier([0.25, 0.1, 0.25, 1.0])),
    ("EaseIn", Ease::Bezier([0.42, 0.0, 1.0, 1.0])),
    ("EaseOut", Ease::Bezier([0.0, 0.0, 0.58, 1.0])),
    ("EaseInOut", Ease::Bezier([0.42, 0.0, 0.58, 1.0])),
];

#[warn(missing_docs)]
impl Ease {
    /// The easing with a name such as `Smooth`, `EaseOut` or `InOutQuad`.
    pub fn named(name: &str) -> Option<Self> {
        let plain = PLAIN.iter().find(|(plain, _)| *plain == name).map(|(_, ease)| *ease);
        plain.or_else(|| Self::combinations().find(|(full, _)| full == name).map(|(_, ease)| ease))
    }

    /// All names that [`Ease::named`] accepts.
    pub fn names() -> impl Iterator<Item = String> {
        let plain = PLAIN.iter().map(|(name, _)| (*name).to_owned());
        plain.chain(Self::combinations().map(|(name, _)| name))
    }

    fn combinations() -> impl Iterator<Item = (String, Self)> {
        let ends = [("In", End::In), ("Out", End::Out), ("InOut", End::InOut)];
        CURVES.iter().flat_map(move |&(name, curve)| {
            ends.map(|(prefix, end)| (format!("{prefix}{name}"), Self::Named(curve, end)))
        })
    }

    /// The eased fraction for the linear fraction `s` in 0..=1; 0 → 0 and 1 → 1. `Step` and `CatmullRom` are not
    /// functions of `s` alone, so they return `s`.
    pub fn apply(self, s: f64) -> f64 {
        match self {
            Self::Step | Self::Linear | Self::CatmullRom => s,
            Self::Smooth => s * s * (3.0 - 2.0 * s),
            Self::Smoother => s * s * s * (s * (6.0 * s - 15.0) + 10.0),
            Self::Bezier(points) => bezier(points, s),
            Self::Named(curve, End::In) => curve.start(s),
            Self::Named(curve, End::Out) => 1.0 - curve.start(1.0 - s),
            Self::Named(Curve::Back, End::InOut) => both_ends(s, |s| back(s, BACK * 1.525)),
            Self::Named(Curve::Elastic, End::InOut) => both_ends(s, |s| elastic(s, 4.5)),
            Self::Named(curve, End::InOut) => both_ends(s, |s| curve.start(s)),
        }
    }
}

impl Curve {
    fn start(self, s: f64) -> f64 {
        match self {
            Self::Sine => 1.0 - libm::cos(s * PI * 0.5),
            Self::Quad => s * s,
            Self::Cubic => s * s * s,
            Self::Quart => s * s * s * s,
            Self::Quint => s * s * s * s * s,
            Self::Expo if s <= 0.0 => 0.0,
            Self::Expo => libm::exp2(10.0 * (s - 1.0)),
            Self::Circ => 1.0 - (1.0 - s * s).max(0.0).sqrt(),
            Self::Back => back(s, BACK),
            Self::Elastic => elastic(s, 3.0),
            Self::Bounce => 1.0 - bounce(1.0 - s),
        }
    }
}

/// The first half eases in, and the second half is its mirror image.
fn both_ends(s: f64, start: impl Fn(f64) -> f64) -> f64 {
    if s < 0.5 { start(2.0 * s) * 0.5 } else { 1.0 - start(2.0 - 2.0 * s) * 0.5 }
}

/// The parameter with which `Back` overshoots by a tenth of the change.
const BACK: f64 = 1.701_58;

fn back(s: f64, overshoot: f64) -> f64 {
    s * s * ((overshoot + 1.0) * s - overshoot)
}

/// A decaying oscillation with the period `period` / 10.
fn elastic(s: f64, period: f64) -> f64 {
    if s <= 0.0 || s >= 1.0 {
        return s;
    }
    let phase = (s * 10.0 - 10.0 - period * 0.25) * (2.0 * PI / period);
    -libm::exp2(10.0 * s - 10.0) * libm::sin(phase)
}

/// Four parabolas, like a bouncing ball that comes to rest.
fn bounce(s: f64) -> f64 {
    const N: f64 = 7.5625;
    const D: f64 = 2.75;
    let (center, floor) = match s * D {
        t if t < 1.0 => (0.0, 0.0),
        t if t < 2.0 => (1.5, 0.75),
        t if t < 2.5 => (2.25, 0.9375),
        _ => (2.625, 0.984_375),
    };
    let t = s - center / D;
    N * t * t + floor
}

/// The y of the cubic where its x is `s`. For control points with x in 0..=1, x is monotone, so bisection finds the
/// point.
fn bezier([x1, y1, x2, y2]: [f64; 4], s: f64) -> f64 {
    let cubic = |a: f64, b: f64, t: f64| {
        let u = 1.0 - t;
        3.0 * u * u * t * a + 3.0 * u * t * t * b + t * t * t
    };
    if s <= 0.0 || s >= 1.0 {
        return s;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = (low + high) * 0.5;
        if cubic(x1, x2, middle) < s { low = middle } else { high = middle }
    }
    cubic(y1, y2, (low + high) * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_leads_from_0_to_1() {
        let names: Vec<_> = Ease::names().collect();
        assert_eq!(names.len(), 39);
        for name in names {
            let ease = Ease::named(&name).expect("a listed name");
            assert!(ease.apply(0.0).abs() < 1e-12, "{name}");
            assert!((ease.apply(1.0) - 1.0).abs() < 1e-12, "{name}");
            assert!((0..=100).all(|k| ease.apply(f64::from(k) / 100.0).is_finite()), "{name}");
        }
        assert_eq!(Ease::named("InOutQuaint"), None);
    }

    #[test]
    fn known_points() {
        let at = |name: &str, s: f64| Ease::named(name).expect("a name").apply(s);
        assert_eq!(at("Smooth", 0.25), 0.15625);
        assert_eq!(at("InQuad", 0.5), 0.25);
        assert_eq!(at("OutCubic", 0.5), 0.875);
        assert_eq!(at("InOutQuart", 0.25), 0.03125);
        assert!((at("InBack", 0.5) + 0.087_697_5).abs() < 1e-12);
        assert!((at("OutBounce", 0.5) - 0.765_625).abs() < 1e-12);
        // easings.net: outElastic(0.5) = 2^-5 sin((5 - 0.75) 2π/3) + 1.
        assert!((at("OutElastic", 0.5) - 1.015_625).abs() < 1e-12);
        // css-easing: ease at one half.
        assert!((at("Ease", 0.5) - 0.802_403_387).abs() < 1e-8);
        assert!((Ease::Bezier([0.0, 0.0, 1.0, 1.0]).apply(0.3) - 0.3).abs() < 1e-12);
    }

    #[test]
    fn in_out_is_continuous_in_the_middle() {
        for name in Ease::names().filter(|name| name.starts_with("InOut")) {
            let ease = Ease::named(&name).expect("a name");
            assert!((ease.apply(0.5 - 1e-14) - ease.apply(0.5)).abs() < 1e-6, "{name}");
        }
    }
}
