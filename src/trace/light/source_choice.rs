//! The choice of one among several sources: by what they may give at a point, or by their power if they are many.

use super::discrete_distribution::DiscreteDistribution;
use super::importance::Importance;
use super::sampled_emitter::SampledEmitter;
use crate::base::lanes::{Mask, Real, Row, Select, Vec3};
use crate::scene::Scene;

/// The most sources that are weighed at every point.
const MOST_WEIGHED: usize = 64;

/// So few need less memory.
const FEW: usize = 16;

/// The share of choices in which all sources are alike. So none is chosen much less often than it gives light, whatever
/// the estimate leaves out, such as shadows.
const EVEN_SHARE: f64 = 0.1;

/// Probabilities of several sources.
pub enum SourceChoice {
    ByPlace(Vec<Importance>),
    ByPower(DiscreteDistribution),
}

impl SourceChoice {
    pub fn new(sources: &[SampledEmitter], scene: &Scene) -> Self {
        match sources.len() <= MOST_WEIGHED {
            true => Self::ByPlace(sources.iter().map(|source| Importance::of(source, scene)).collect()),
            false => {
                Self::ByPower(DiscreteDistribution::of(sources.iter().map(|source| source.power(scene))))
            }
        }
    }

    /// Chooses sources at points by numbers in 0..1. Also gives their probabilities.
    #[inline(always)]
    pub fn choose<F: Real>(&self, at: Vec3<F>, u: F) -> (F::U32, F) {
        match self {
            Self::ByPower(distribution) => distribution.sample(u),
            Self::ByPlace(sources) if sources.len() <= FEW => weigh::<F, FEW>(sources, at, u),
            Self::ByPlace(sources) => weigh::<F, MOST_WEIGHED>(sources, at, u),
        }
    }

    /// The probabilities with which a source is chosen at points.
    #[inline(always)]
    pub fn chance<F: Real>(&self, source: usize, at: Vec3<F>) -> F {
        match self {
            Self::ByPower(distribution) => F::splat(distribution.probabilities[source]),
            Self::ByPlace(sources) => {
                let (mut own, mut whole) = (F::splat(0.0), F::splat(0.0));
                for (index, other) in sources.iter().enumerate() {
                    let weight = other.at(at);
                    whole = whole + weight;
                    if index == source {
                        own = weight;
                    }
                }
                Scale::new(whole, sources.len()).chance(own)
            }
        }
    }
}

/// Chooses one of at most so many sources at each point.
#[inline(always)]
fn weigh<F: Real, const MOST: usize>(sources: &[Importance], at: Vec3<F>, u: F) -> (F::U32, F) {
    let (mut weights, mut whole) = ([F::splat(0.0); MOST], F::splat(0.0));
    for (weight, source) in weights.iter_mut().zip(sources) {
        *weight = source.at(at);
        whole = whole + *weight;
    }
    let scale = Scale::new(whole, sources.len());
    let (mut chosen, mut chance) = (F::U32::splat(0), F::splat(1.0));
    let (mut sum, mut open) = (F::splat(0.0), F::Mask::splat(true));
    // Where rounding leaves the sum below the number, it is the last one.
    for (index, weight) in (0..).zip(&weights[..sources.len()]) {
        let own = scale.chance(*weight);
        sum = sum + own;
        chosen = F::U32::select(open, F::U32::splat(index), chosen);
        chance = F::select(open, own, chance);
        open = open & sum.le(u);
        if !open.any() {
            break;
        }
    }
    (chosen, chance)
}

/// Turns weights into probabilities.
struct Scale<F: Real> {
    /// The lanes in which the weights say anything: some source gives light, and none too much or too little for a
    /// normal number.
    known: F::Mask,
    factor: F,
    even: F,
}

impl<F: Real> Scale<F> {
    #[inline(always)]
    fn new(whole: F, count: usize) -> Self {
        let known = F::splat(f64::MIN_POSITIVE).le(whole) & whole.lt(F::splat(f64::INFINITY));
        let even = F::splat(1.0 / count as f64);
        Self {
            known,
            factor: F::splat(1.0 - EVEN_SHARE) / whole,
            even: F::select(known, even * F::splat(EVEN_SHARE), even),
        }
    }

    #[inline(always)]
    fn chance(&self, weight: F) -> F {
        F::select(self.known, weight * self.factor, F::splat(0.0)) + self.even
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::appearance::light::{Attenuation, SpotCone};
    use crate::base::lanes::tests::on_all_levels;
    use crate::base::lanes::{Level, SimdKernel, dispatch};
    use crate::base::math::DVec3;
    use crate::testing::Random;
    use crate::trace::light::importance::Facing;

    fn sources(random: &mut Random, count: usize) -> SourceChoice {
        let mut source = |index: usize| {
            let (position, brightness) = (random.point(5.0), 10.0 * random.unit());
            let area = |facing| Importance::Area { center: position, brightness, least: 0.01, facing };
            match index % 5 {
                0 => Importance::Distant(0.1 * brightness),
                1 => {
                    let attenuation = Attenuation { constant: 0.0, linear: 0.0, quadratic: 1.0 };
                    let cone = SpotCone { axis: DVec3::Y, cos_falloff_start: 0.9, cos_falloff_end: 0.5 };
                    let cone = (random.unit() < 0.5).then_some(cone);
                    Importance::Point { position, attenuation, brightness, cone }
                }
                2 => area(Facing::All),
                3 => area(Facing::Front(random.direction())),
                _ => area(Facing::Both(random.direction())),
            }
        };
        SourceChoice::ByPlace((0..count).map(&mut source).collect())
    }

    /// The choices at eight points by eight numbers, with their probabilities, and those of all sources.
    struct Choose<'a>(&'a SourceChoice, usize, [DVec3; 8], [f64; 8]);

    impl SimdKernel for Choose<'_> {
        type Output = ([u32; 8], [f64; 8], Vec<[f64; 8]>);

        #[inline(always)]
        fn run<L: Level>(self) -> Self::Output {
            let Self(choice, count, at, u) = self;
            let [x, y, z] = [0, 1, 2].map(|axis| L::F64::from_array(at.map(|point| point[axis])));
            let at = Vec3::new(x, y, z);
            let (chosen, chance) = choice.choose(at, L::F64::from_array(u));
            let mut all = Vec::new();
            for source in 0..count {
                all.push(choice.chance::<L::F64>(source, at).to_array());
            }
            (chosen.to_array(), chance.to_array(), all)
        }
    }

    #[test]
    fn sources_are_chosen_as_often_as_stated() {
        let mut random = Random(4);
        for count in [2, 3, 7, 16, 17, 64] {
            let choice = sources(&mut random, count);
            for _ in 0..20 {
                let point = random.point(6.0);
                const NUMBERS: usize = 4000;
                let (mut found, mut stated) = (vec![0.0; count], Vec::new());
                for first in (0..NUMBERS).step_by(8) {
                    let u = std::array::from_fn(|lane| ((first + lane) as f64 + 0.5) / NUMBERS as f64);
                    let all = on_all_levels(|| dispatch(Choose(&choice, count, [point; 8], u)));
                    assert!(all.iter().all(|(_, drawn)| *drawn == all[0].1));
                    let (chosen, chance, every) = &all[0].1;
                    for lane in 0..8 {
                        let source = chosen[lane] as usize;
                        assert_eq!(chance[lane], every[source][lane]);
                        found[source] += 1.0 / NUMBERS as f64;
                    }
                    stated = every.iter().map(|chance| chance[0]).collect();
                }
                assert!((stated.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{stated:?}");
                for (found, stated) in found.iter().zip(&stated) {
                    assert!((found - stated).abs() < 1.1 / NUMBERS as f64, "{found} {stated}");
                    assert!(*stated >= 0.999 * EVEN_SHARE / count as f64);
                }
            }
        }
    }

    /// Behind everything that emits to one side, far away, and at the lights themselves, all sources have a chance.
    #[test]
    fn no_place_is_without_a_choice() {
        let facing = Facing::Front(DVec3::Y);
        let lamp =
            |center: DVec3| Importance::Area { center, brightness: 1.0, least: f64::MIN_POSITIVE, facing };
        let choice = SourceChoice::ByPlace(vec![lamp(DVec3::ZERO), lamp(DVec3::X)]);
        let far = DVec3::splat(1e200);
        let places = [DVec3::ZERO, DVec3::X, DVec3::NEG_Y, DVec3::Y, DVec3::Y * 1e-300, DVec3::X, far, -far];
        for (_, (chosen, chance, all)) in on_all_levels(|| {
            dispatch(Choose(&choice, 2, places, [0.0, 0.999_999, 0.3, 0.6, 0.5, 0.2, 0.1, 0.9]))
        }) {
            for lane in 0..8 {
                assert!((all[0][lane] + all[1][lane] - 1.0).abs() < 1e-12, "{lane} {all:?}");
                assert_eq!(chance[lane], all[chosen[lane] as usize][lane]);
                assert!(all.iter().all(|chance| chance[lane] >= 0.999 * EVEN_SHARE / 2.0), "{lane} {all:?}");
            }
        }
    }
}
