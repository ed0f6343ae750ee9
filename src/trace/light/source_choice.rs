//! The choice of one among several sources: by what they may give at a point.

use super::cluster::{Cluster, clusters};
use super::importance::Importance;
use super::sampled_emitter::SampledEmitter;
use crate::base::lanes::{Mask, Real, Row, Select, Vec3};
use crate::scene::Scene;

/// The most sources that are weighed one by one at every point.
const MOST: usize = 64;

/// So many clusters are weighed of more sources: more take more time than less noise is worth. Up to so many weights also
/// fit into less memory.
const CLUSTERS: usize = 16;

/// The share of choices in which all sources are alike: of clusters, all clusters, and all sources of each. So none is chosen
/// much less often than it gives light, whatever the estimate leaves out, such as shadows.
const EVEN_SHARE: f64 = 0.1;

/// Probabilities of several sources.
pub struct SourceChoice {
    /// What the sources, or their clusters, may give.
    weighed: Vec<Importance>,
    /// None if each source is weighed by itself.
    clustered: Option<Clustered>,
}

/// Which sources are in which cluster.
struct Clustered {
    /// Cluster by cluster: each source, and the sum of the probabilities in its cluster up to it.
    sources: Vec<(u32, f64)>,
    /// Where each cluster begins there, and the end.
    starts: Vec<usize>,
    /// For each source, its cluster and its probability in it.
    of_source: Vec<(usize, f64)>,
}

impl SourceChoice {
    pub fn new(sources: &[SampledEmitter], scene: &Scene) -> Self {
        Self::of(sources.iter().map(|source| Importance::of(source, scene)).collect())
    }

    fn of(sources: Vec<Importance>) -> Self {
        if sources.len() <= MOST {
            return Self { weighed: sources, clustered: None };
        }
        let clusters = clusters(&sources, CLUSTERS);
        let weighed = clusters.iter().map(|cluster| cluster.importance).collect();
        Self { weighed, clustered: Some(Clustered::new(&clusters, sources.len())) }
    }

    /// Chooses sources at points by numbers in 0..1. Also gives their probabilities.
    #[inline(always)]
    pub fn choose<F: Real>(&self, at: Vec3<F>, u: F) -> (F::U32, F) {
        let chosen = match self.weighed.len() <= CLUSTERS {
            true => Chosen::among::<CLUSTERS>(&self.weighed, at, u),
            false => Chosen::among::<MOST>(&self.weighed, at, u),
        };
        match &self.clustered {
            None => (chosen.index, chosen.chance),
            Some(clustered) => clustered.choose(&chosen, u),
        }
    }

    /// The probabilities with which a source is chosen at points.
    #[inline(always)]
    pub fn chance<F: Real>(&self, source: usize, at: Vec3<F>) -> F {
        let (cluster, share) = match &self.clustered {
            None => (source, 1.0),
            Some(clustered) => clustered.of_source[source],
        };
        let (mut own, mut whole) = (F::splat(0.0), F::splat(0.0));
        for (index, other) in self.weighed.iter().enumerate() {
            let weight = other.at(at);
            whole = whole + weight;
            if index == cluster {
                own = weight;
            }
        }
        Weighting::new(whole, self.weighed.len()).chance(own) * F::splat(share)
    }
}

impl Clustered {
    fn new(clusters: &[Cluster], count: usize) -> Self {
        let mut all = Self { sources: Vec::new(), starts: vec![0], of_source: vec![(0, 0.0); count] };
        for (index, Cluster { members, .. }) in clusters.iter().enumerate() {
            let weighting = Weighting::new(members.iter().map(|(_, share)| share).sum(), members.len());
            let mut sum = 0.0;
            for (source, share) in members {
                let chance = weighting.chance(*share);
                sum += chance;
                all.sources.push((*source as u32, sum));
                all.of_source[*source] = (index, chance);
            }
            all.starts.push(all.sources.len());
        }
        all
    }

    /// Chooses sources of the chosen clusters, by what is left of the numbers.
    #[inline(always)]
    fn choose<F: Real>(&self, chosen: &Chosen<F>, u: F) -> (F::U32, F) {
        let (mut indices, mut chances) = (chosen.index.to_array(), chosen.chance.to_array());
        let rest = ((u - chosen.before) / chosen.chance).to_array();
        for lane in 0..F::LANES {
            let cluster = indices[lane] as usize;
            let members = &self.sources[self.starts[cluster]..self.starts[cluster + 1]];
            // Rounding may leave the last sum below 1.
            let member = members.partition_point(|(_, sum)| *sum <= rest[lane]).min(members.len() - 1);
            let source = members[member].0;
            indices[lane] = source;
            chances[lane] *= self.of_source[source as usize].1;
        }
        (F::U32::from_array(indices), F::from_array(chances))
    }
}

/// One of several at each point.
struct Chosen<F: Real> {
    index: F::U32,
    chance: F,
    /// The sum of the probabilities of those before it.
    before: F,
}

impl<F: Real> Chosen<F> {
    /// Chooses one of at most so many.
    #[inline(always)]
    fn among<const MOST: usize>(all: &[Importance], at: Vec3<F>, u: F) -> Self {
        let (mut weights, mut whole) = ([F::splat(0.0); MOST], F::splat(0.0));
        for (weight, one) in weights.iter_mut().zip(all) {
            *weight = one.at(at);
            whole = whole + *weight;
        }
        let weighting = Weighting::new(whole, all.len());
        let (mut index, mut chance, mut before) = (F::U32::splat(0), F::splat(1.0), F::splat(0.0));
        let (mut sum, mut open) = (F::splat(0.0), F::Mask::splat(true));
        // Where rounding leaves the sum below the number, it is the last one.
        for (number, weight) in (0..).zip(&weights[..all.len()]) {
            let own = weighting.chance(*weight);
            index = F::U32::select(open, F::U32::splat(number), index);
            chance = F::select(open, own, chance);
            before = F::select(open, sum, before);
            sum = sum + own;
            open = open & sum.le(u);
            if !open.any() {
                break;
            }
        }
        Self { index, chance, before }
    }
}

/// Turns weights into probabilities.
struct Weighting<F: Real> {
    /// The lanes in which the weights say anything: some source gives light, and none too much or too little for a
    /// normal number.
    has_estimate: F::Mask,
    factor: F,
    even: F,
}

impl<F: Real> Weighting<F> {
    #[inline(always)]
    fn new(whole: F, count: usize) -> Self {
        let has_estimate = F::splat(f64::MIN_POSITIVE).le(whole) & whole.lt(F::splat(f64::INFINITY));
        let even = F::splat(1.0 / count as f64);
        Self {
            has_estimate,
            factor: F::splat(1.0 - EVEN_SHARE) / whole,
            even: F::select(has_estimate, even * F::splat(EVEN_SHARE), even),
        }
    }

    #[inline(always)]
    fn chance(&self, weight: F) -> F {
        F::select(self.has_estimate, weight * self.factor, F::splat(0.0)) + self.even
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

    fn of(sources: impl Iterator<Item = Importance>) -> SourceChoice {
        SourceChoice::of(sources.collect())
    }

    fn sources(random: &mut Random, count: usize) -> SourceChoice {
        let mut source = |index: usize| {
            let (position, brightness) = (random.point(5.0), 10.0 * random.unit());
            let area = |facing| Importance::Area { center: position, brightness, least_square: 0.01, facing };
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
        of((0..count).map(&mut source))
    }

    /// The choices at eight points by eight numbers, with their probabilities.
    struct Choose<'a>(&'a SourceChoice, [DVec3; 8], [f64; 8]);

    impl SimdKernel for Choose<'_> {
        type Output = ([u32; 8], [f64; 8]);

        #[inline(always)]
        fn run<L: Level>(self) -> Self::Output {
            let (chosen, chance) = self.0.choose(lanes::<L>(self.1), L::F64::from_array(self.2));
            (chosen.to_array(), chance.to_array())
        }
    }

    /// The probabilities of so many sources at eight points.
    struct Chances<'a>(&'a SourceChoice, usize, [DVec3; 8]);

    impl SimdKernel for Chances<'_> {
        type Output = Vec<[f64; 8]>;

        #[inline(always)]
        fn run<L: Level>(self) -> Self::Output {
            let mut all = Vec::new();
            for source in 0..self.1 {
                all.push(self.0.chance::<L::F64>(source, lanes::<L>(self.2)).to_array());
            }
            all
        }
    }

    #[inline(always)]
    fn lanes<L: Level>(points: [DVec3; 8]) -> Vec3<L::F64> {
        let [x, y, z] = [0, 1, 2].map(|axis| L::F64::from_array(points.map(|point| point[axis])));
        Vec3::new(x, y, z)
    }

    /// What all levels find alike.
    fn alike<T: PartialEq + std::fmt::Debug>(find: impl Fn() -> T) -> T {
        let mut all = on_all_levels(find).into_iter().map(|(_, found)| found);
        let first = all.next().expect("there is a level");
        all.for_each(|found| assert_eq!(found, first));
        first
    }

    #[test]
    fn sources_are_chosen_as_often_as_stated() {
        let mut random = Random(4);
        for count in [2, 3, 7, 16, 17, 64, 65, 200] {
            let choice = sources(&mut random, count);
            let least = match count <= MOST {
                true => EVEN_SHARE / count as f64,
                // If one cluster has all but one of each other.
                false => EVEN_SHARE / CLUSTERS as f64 * EVEN_SHARE / (count - CLUSTERS + 1) as f64,
            };
            for _ in 0..4 {
                let point = random.point(6.0);
                let stated: Vec<f64> = alike(|| dispatch(Chances(&choice, count, [point; 8])))
                    .iter()
                    .map(|chances| chances[0])
                    .collect();
                const NUMBERS: usize = 4000;
                let mut found = vec![0.0; count];
                for first in (0..NUMBERS).step_by(8) {
                    let u = std::array::from_fn(|lane| ((first + lane) as f64 + 0.5) / NUMBERS as f64);
                    let (chosen, chances) = alike(|| dispatch(Choose(&choice, [point; 8], u)));
                    for (source, chance) in chosen.into_iter().zip(chances) {
                        assert_eq!(chance, stated[source as usize]);
                        found[source as usize] += 1.0 / NUMBERS as f64;
                    }
                }
                assert!(
                    (stated.iter().sum::<f64>() - 1.0).abs() <= 4.0 * count as f64 * f64::EPSILON,
                    "{stated:?}"
                );
                for (found, stated) in found.iter().zip(&stated) {
                    assert!((found - stated).abs() < 1.1 / NUMBERS as f64, "{found} {stated}");
                    assert!(*stated >= 0.999 * least, "{stated} {count}");
                }
            }
        }
    }

    /// Behind everything that emits to one side, far away, and at the lights themselves, all sources have a chance.
    #[test]
    fn no_place_is_without_a_choice() {
        let facing = Facing::Front(DVec3::Y);
        let lamp = |center: DVec3| Importance::Area {
            center,
            brightness: 1.0,
            least_square: f64::MIN_POSITIVE,
            facing,
        };
        let choice = of([DVec3::ZERO, DVec3::X].map(lamp).into_iter());
        let far = DVec3::splat(1e200);
        let places = [DVec3::ZERO, DVec3::X, DVec3::NEG_Y, DVec3::Y, DVec3::Y * 1e-300, DVec3::X, far, -far];
        let numbers = [0.0, 0.999_999, 0.3, 0.6, 0.5, 0.2, 0.1, 0.9];
        let (chosen, chance) = alike(|| dispatch(Choose(&choice, places, numbers)));
        let all = alike(|| dispatch(Chances(&choice, 2, places)));
        for lane in 0..8 {
            assert!((all[0][lane] + all[1][lane] - 1.0).abs() <= 8.0 * f64::EPSILON, "{lane} {all:?}");
            assert_eq!(chance[lane], all[chosen[lane] as usize][lane]);
            assert!(all.iter().all(|chance| chance[lane] >= 0.999 * EVEN_SHARE / 2.0), "{lane} {all:?}");
        }
    }

    /// Among 400 lamps of a grid, which are weighed in 16 clusters, the next one is chosen three times as often as on average.
    #[test]
    fn near_sources_of_many_are_chosen_more_often() {
        let place = |index: usize| DVec3::new((index % 20) as f64, 2.0, (index / 20) as f64);
        let lamp = |index: usize| Importance::Area {
            center: place(index),
            brightness: 1.0,
            least_square: 0.01,
            facing: Facing::All,
        };
        let choice = of((0..400).map(lamp));
        for index in [0, 19, 57, 210, 399] {
            let below = Vec3::from(place(index) - 0.5 * DVec3::Y);
            let chance = choice.chance::<f64>(index, below);
            assert!(chance > 3.0 / 400.0, "{index} {chance}");
        }
    }

    /// Lamps that are far away and give next to nothing leave the clusters to those of a room.
    #[test]
    fn far_sources_take_few_clusters() {
        let mut random = Random(2);
        let lamp = |center: DVec3| Importance::Area {
            center,
            brightness: 1.0,
            least_square: 0.01,
            facing: Facing::All,
        };
        let near: Vec<DVec3> = (0..100).map(|_| random.point(2.0)).collect();
        let far: Vec<DVec3> = (0..40).map(|_| 1e4 * random.direction()).collect();
        let choice = of(near.iter().chain(&far).map(|center| lamp(*center)));
        let mean = |pick: &dyn Fn(usize) -> usize| {
            let chance = |index: usize| {
                choice.chance::<f64>(pick(index), Vec3::from(near[index] + DVec3::splat(0.01)))
            };
            (0..100).map(chance).sum::<f64>() / 100.0
        };
        let (own, other) = (mean(&|index| index), mean(&|index| (index + 50) % 100));
        assert!(own > 3.0 * other, "{own} {other}");
    }

    /// Many sources, in metres and in millimetres: a point light and an area that give as much light have the same chance
    /// everywhere, whatever the unit of length is.
    #[test]
    fn units_of_length_choose_nothing() {
        let chances = |unit: f64| {
            let mut random = Random(9);
            let sources = (0..80).map(|index| {
                let (position, brightness) = (unit * random.point(3.0), random.unit());
                let square = unit * unit;
                let point = |attenuation| Importance::Point { position, attenuation, brightness, cone: None };
                match index % 4 {
                    0 => point(Attenuation::default()),
                    2 => point(Attenuation { constant: 0.0, linear: 0.0, quadratic: 0.5 / square }),
                    _ => Importance::Area {
                        center: position,
                        brightness: 4.0 * square * brightness,
                        least_square: 0.01 * square,
                        facing: Facing::All,
                    },
                }
            });
            let choice = of(sources);
            let chance = |source| choice.chance::<f64>(source, Vec3::zero());
            (0..80).map(chance).collect::<Vec<f64>>()
        };
        let metres = chances(1.0);
        let points: f64 = metres.iter().step_by(4).sum();
        assert!((0.2..0.8).contains(&points), "{points}");
        for unit in [f64::from(1 << 10), f64::from(1 << 20), 1.0 / f64::from(1 << 20)] {
            assert_eq!(chances(unit), metres);
        }
    }
}
