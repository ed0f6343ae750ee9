//! Fog: thin, and thinner with height along level ways.

use super::draw::Draw;
use super::measure::{Case, Effort, Verdict, way};
use super::real::{Machine, Real};
use crate::accuracy::exact::Exact;
use crate::appearance::fog::{Falloff, Fog};
use crate::appearance::light_groups::glow::Glow;
use crate::base::math::{DVec3, LaneRay, Ray};

/// A way of unit length, up to rounding, through fog that is thinner with height, from where it has its density.
#[derive(Clone, Copy)]
struct Way<R> {
    density: R,
    length: R,
    /// Of the unit direction along y, per height in which the density falls to 1/e.
    climb: R,
    fog: Fog,
    ray: Ray,
}

impl<R: Machine> Way<R> {
    fn new(density: f64, length: f64, climb: f64, falloff: Option<Falloff>) -> Self {
        let [density, length, climb] = [density, length, climb].map(R::of);
        let fog = Fog { glow: Glow::default(), density: density.wide(), falloff };
        let direction = DVec3::new((1.0 - climb.wide() * climb.wide()).sqrt(), climb.wide(), 0.0);
        Self { density, length, climb, fog, ray: Ray { origin: DVec3::ZERO, direction } }
    }

    fn judged(&self, found: R) -> Verdict {
        let wide = |value: R| Exact::of(value.wide());
        // The mean of exp(-x) over 0..climb·length is growth(-x) / -x = 1 - x/2! + x²/3! - …
        let rise = -(wide(self.climb) * wide(self.length));
        let (mut mean, mut term) = (Exact::zero(), Exact::one());
        for k in 1..60 {
            mean = mean + term / Exact::of(f64::from(k));
            term = term * rise / Exact::of(f64::from(k));
        }
        let thickness = wide(self.density) * wide(self.length) * mean;
        // 1 - exp(-x) = x - x²/2! + x³/3! - …
        let (mut opacity, mut term) = (Exact::zero(), -Exact::one());
        for k in 1..60 {
            term = term * -thickness / Exact::of(f64::from(k));
            opacity = opacity + term;
        }
        Verdict::off(((Exact::of(found.wide()) - opacity) / opacity).value().abs())
    }
}

fn ours(at: &Way<f64>) -> f64 {
    at.fog.opacity(&LaneRay::from(&at.ray), at.length)
}

fn thin<R: Machine>(effort: Effort) -> Vec<Way<R>> {
    let mut draw = Draw::new(11);
    (0..effort.inputs).map(|_| Way::new(draw.scale(1e-12, 1.0), 1.0, 0.0, None)).collect()
}

fn level<R: Machine>(effort: Effort) -> Vec<Way<R>> {
    let mut draw = Draw::new(10);
    let falloff = Some(Falloff { base: 0.0, height: 1.0 });
    let one = |k: u32| {
        let climb = if k.is_multiple_of(100) { 0.0 } else { draw.scale(1e-12, 0.5) };
        Way::new(0.3, draw.between(0.5, 2.0), climb, falloff)
    };
    (0..effort.inputs).map(one).collect()
}

pub fn cases(effort: Effort) -> Vec<Case> {
    fn judge<R: Machine>(at: &Way<R>, found: R) -> Verdict {
        at.judged(found)
    }
    /// 1 - exp(-x), as it is written down.
    fn plain<R: Machine>(at: &Way<R>) -> R {
        R::one() - (-(at.density * at.length)).exponential()
    }
    /// The integral as it is written down: density (1 - exp(-climb t)) / climb.
    fn plain_level<R: Machine>(at: &Way<R>) -> R {
        let thickness = at.density * (R::one() - (-(at.climb * at.length)).exponential()) / at.climb;
        R::one() - (-thickness).exponential()
    }
    fn grown(at: &Way<f32>) -> f32 {
        -(-(at.density * at.length)).growth()
    }
    fn grown_level(at: &Way<f32>) -> f32 {
        let climbed = at.climb * at.length;
        let way = if climbed > f32::EPSILON { -(-climbed).growth() / at.climb } else { at.length };
        -(-(at.density * way)).growth()
    }
    let case =
        |what, ways| Case { id: "SH-11", what, error: "largest relative error", wrong: "no number", ways };
    vec![
        case(
            "opacity of fog from 10^-12 to 1 thick",
            [
                way(thin::<f32>(effort), plain, judge),
                way(thin::<f64>(effort), plain, judge),
                way(thin::<f32>(effort), grown, judge),
                way(thin::<f64>(effort), ours, judge),
            ],
        ),
        case(
            "fog that thins out with height, along ways that climb by 10^-12 to 0.5 or not",
            [
                way(level::<f32>(effort), plain_level, judge),
                way(level::<f64>(effort), plain_level, judge),
                way(level::<f32>(effort), grown_level, judge),
                way(level::<f64>(effort), ours, judge),
            ],
        ),
    ]
}
