//! Thin fog, and fog with exponential falloff along nearly horizontal segments.

use super::input_rng::InputRng;
use super::measure::{Case, Verdict, Workload, method};
use super::number::{Float, Number};
use crate::appearance::fog::{Falloff, Fog};
use crate::appearance::light_groups::GroupRadiance;
use crate::base::math::exact::Exact;
use crate::base::math::{DVec3, LaneRay, Ray};

/// A ray segment through fog with falloff, starting at the height where the fog has its density. The direction has
/// unit length up to rounding.
#[derive(Clone, Copy)]
struct FogSegment<R> {
    density: R,
    length: R,
    /// The y component of the direction over the height in which the density falls to 1/e.
    climb: R,
    fog: Fog,
    ray: Ray,
}

impl<R: Float> FogSegment<R> {
    fn new(density: f64, length: f64, climb: f64, falloff: Option<Falloff>) -> Self {
        let [density, length, climb] = [density, length, climb].map(R::of);
        let fog = Fog { in_scattering: GroupRadiance::default(), density: density.wide(), falloff };
        let direction = DVec3::new((1.0 - climb.wide() * climb.wide()).sqrt(), climb.wide(), 0.0);
        Self { density, length, climb, fog, ray: Ray { origin: DVec3::ZERO, direction } }
    }

    fn judged(&self, found: R) -> Verdict {
        let wide = |value: R| Exact::of(value.wide());
        // The mean of exp(-x) over 0..climb·length is expm1(-x) / -x = 1 - x/2! + x²/3! - …
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

fn ours(at: &FogSegment<f64>) -> f64 {
    at.fog.opacity(&LaneRay::from(&at.ray), at.length)
}

fn thin<R: Float>(workload: Workload) -> Vec<FogSegment<R>> {
    let mut rng = InputRng::new(11);
    (0..workload.inputs).map(|_| FogSegment::new(rng.log_uniform(1e-12, 1.0), 1.0, 0.0, None)).collect()
}

fn level<R: Float>(workload: Workload) -> Vec<FogSegment<R>> {
    let mut rng = InputRng::new(10);
    let falloff = Some(Falloff { base: 0.0, height: 1.0 });
    let one = |k: u32| {
        let climb = if k.is_multiple_of(100) { 0.0 } else { rng.log_uniform(1e-12, 0.5) };
        FogSegment::new(0.3, rng.uniform(0.5, 2.0), climb, falloff)
    };
    (0..workload.inputs).map(one).collect()
}

pub fn cases(workload: Workload) -> Vec<Case> {
    fn judge<R: Float>(at: &FogSegment<R>, found: R) -> Verdict {
        at.judged(found)
    }
    /// 1 - exp(-x) without expm1.
    fn plain<R: Float>(at: &FogSegment<R>) -> R {
        R::one() - (-(at.density * at.length)).exp()
    }
    /// The integral without expm1: density (1 - exp(-climb t)) / climb.
    fn plain_level<R: Float>(at: &FogSegment<R>) -> R {
        let thickness = at.density * (R::one() - (-(at.climb * at.length)).exp()) / at.climb;
        R::one() - (-thickness).exp()
    }
    fn stable(at: &FogSegment<f32>) -> f32 {
        -libm::expm1f(-(at.density * at.length))
    }
    fn stable_level(at: &FogSegment<f32>) -> f32 {
        let climbed = at.climb * at.length;
        let length = if climbed > f32::EPSILON { -libm::expm1f(-climbed) / at.climb } else { at.length };
        -libm::expm1f(-(at.density * length))
    }
    let case = |what, methods| Case {
        id: "SH-11",
        what,
        error: "largest relative error",
        wrong: "no number",
        methods,
    };
    vec![
        case(
            "opacity of fog from 10^-12 to 1 thick",
            [
                method(thin::<f32>(workload), plain, judge),
                method(thin::<f64>(workload), plain, judge),
                method(thin::<f32>(workload), stable, judge),
                method(thin::<f64>(workload), ours, judge),
            ],
        ),
        case(
            "fog that thins out with height, along ways that climb by 10^-12 to 0.5 or not",
            [
                method(level::<f32>(workload), plain_level, judge),
                method(level::<f64>(workload), plain_level, judge),
                method(level::<f32>(workload), stable_level, judge),
                method(level::<f64>(workload), ours, judge),
            ],
        ),
    ]
}
