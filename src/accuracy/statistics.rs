//! Confidence intervals, biases and quartiles from a few measurements.

use crate::base::math::DVec3;
use crate::sampling::hash;

/// A mean, and its confidence interval at a level of 95 %.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConfidenceInterval {
    pub mean: f64,
    pub low: f64,
    pub high: f64,
}

impl ConfidenceInterval {
    /// The interval of independent measurements, by Student's t. A single measurement has an interval of width 0.
    pub fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count.max(1.0);
        if values.len() < 2 {
            return Self { mean, low: mean, high: mean };
        }
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        let reach = student(values.len() - 1) * (squares / (count - 1.0) / count).sqrt();
        Self { mean, low: mean - reach, high: mean + reach }
    }

    /// The interval of independent measurements with heavy tails, by the bootstrap of Student's ratio (Efron and
    /// Tibshirani, *An Introduction to the Bootstrap*, 12.5). If a few values are far larger than the rest, intervals
    /// by Student's t contain the true mean too rarely.
    pub fn bootstrapped(values: &[f64]) -> Self {
        let own = Moments::of(values.iter().copied());
        let all = Self::of(values);
        if values.len() < 4 || own.error == 0.0 {
            return all;
        }
        let count = values.len() as u64;
        let draw = |round: u32, place: u32| {
            let bits = u64::from(hash([round, place, 77]));
            values[((bits * count) >> 32) as usize]
        };
        let resampled = (0..RESAMPLES).map(|round| Moments::of((0..count as u32).map(|at| draw(round, at))));
        let ratio = |of: Moments| (of.error > 0.0).then(|| (of.mean - own.mean) / of.error);
        let mut ratios: Vec<f64> = resampled.filter_map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let at = |share: f64| ratios.get((share * ratios.len() as f64) as usize).copied().unwrap_or(0.0);
        Self { mean: own.mean, low: own.mean - at(0.975) * own.error, high: own.mean - at(0.025) * own.error }
    }

    /// The interval of a monotonic function of the measured value.
    pub fn map(self, of: impl Fn(f64) -> f64) -> Self {
        let (low, high) = (of(self.low), of(self.high));
        Self { mean: of(self.mean), low: low.min(high), high: low.max(high) }
    }

    /// The interval of the square root; negative values count as 0.
    pub fn root(self) -> Self {
        self.map(|value| value.max(0.0).sqrt())
    }
}

/// Number of bootstrap resamples.
const RESAMPLES: u32 = 999;

/// A mean and its standard error.
#[derive(Clone, Copy)]
struct Moments {
    mean: f64,
    error: f64,
}

impl Moments {
    fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        let squares: f64 = values.map(|value| (value - mean) * (value - mean)).sum();
        Self { mean, error: (squares / (count - 1.0) / count).sqrt() }
    }
}

/// The squared bias: the squared error that does not decrease with more samples, with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bias(pub ConfidenceInterval);

impl Bias {
    /// The squared bias from two independent measurements of each pixel's difference: it is the mean of their products.
    ///
    /// Let x = m + n and y = m + n' with noise of the variance s². The variance of x y is 2 m² s² + s⁴; for normal
    /// noise it is the mean of (x - y)² ((x + y) / 2)². A firefly in only one of the two measurements would enter
    /// that estimate with its fourth power, but it changes x y only by its product with the other value. So its
    /// contribution is limited to that.
    pub fn of(x: &[DVec3], y: &[DVec3]) -> Self {
        let count = x.len().max(1) as f64;
        let squared = |v: DVec3| v.length_squared() / 3.0;
        let mut offs: Vec<f64> = x.iter().zip(y).map(|(x, y)| squared(*x - *y)).collect();
        offs.sort_by(f64::total_cmp);
        // Twice the noise of most pixels.
        let usual = offs[..offs.len() - offs.len() / 100].iter().sum::<f64>() / count;
        let (mut sum, mut variance) = (0.0, 0.0);
        for (x, y) in x.iter().zip(y) {
            let (off, middle) = (squared(*x - *y), squared((*x + *y) * 0.5));
            let (least, most) = (squared(*x).min(squared(*y)), squared(*x).max(squared(*y)));
            let is_firefly = off > FIREFLY * usual && most > 100.0 * least;
            sum += x.dot(*y) / 3.0;
            variance += off * if is_firefly { middle.min(least + usual / 2.0) } else { middle };
        }
        let (mean, reach) = (sum / count, NORMAL * variance.sqrt() / count);
        Self(ConfidenceInterval { mean, low: mean - reach, high: mean + reach })
    }

    /// Whether the bias is significant: its interval does not contain 0.
    pub fn is_certain(self) -> bool {
        self.0.low > 0.0
    }

    /// The bias (not squared), if it is significant.
    pub fn root(self) -> Option<f64> {
        self.is_certain().then(|| self.0.mean.sqrt())
    }

    /// The upper bound of the bias (not squared).
    pub fn most(self) -> f64 {
        self.0.high.max(0.0).sqrt()
    }
}

/// How a squared error is distributed over the pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Concentration {
    /// Fraction of the error in the worst hundredth of the pixels.
    pub worst_hundredth: f64,
    /// Fraction of the pixels that contain nine tenths of the error.
    pub nine_tenths: f64,
}

impl Concentration {
    /// The concentration of squared errors of pixels. Noise of the references can make values negative; they count as
    /// 0.
    pub fn of(squares: &[f64]) -> Self {
        let mut sorted: Vec<f64> = squares.iter().map(|square| square.max(0.0)).collect();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let (count, whole) = (sorted.len().max(1), sorted.iter().sum::<f64>());
        if whole <= 0.0 {
            return Self { worst_hundredth: 0.0, nine_tenths: 1.0 };
        }
        let worst: f64 = sorted.iter().take(count.div_ceil(100)).sum();
        let mut sum = 0.0;
        let enough = sorted.iter().take_while(|square| {
            let before = sum;
            sum += **square;
            before < 0.9 * whole
        });
        Self { nine_tenths: enough.count() as f64 / count as f64, worst_hundredth: worst / whole }
    }

    /// Whether few pixels hold most of the error. Then the errors of renders are not normally distributed.
    pub fn is_heavy(self) -> bool {
        self.worst_hundredth > 0.5
    }
}

/// The quantile 0.975 of the normal distribution.
const NORMAL: f64 = 1.959_963_985;

/// Minimum squared difference of a firefly, as a multiple of that of most pixels.
const FIREFLY: f64 = 30.0;

/// The quantile 0.975 of Student's t: Cornish and Fisher's expansion around the normal distribution's (Abramowitz and
/// Stegun 26.7.5), good to 0.01 from three degrees of freedom on; below, from tables.
fn student(freedom: usize) -> f64 {
    let (z, n) = (NORMAL, freedom as f64);
    let square = z * z;
    let (z3, z5) = (square * z, square * square * z);
    let (z7, z9) = (z5 * square, z5 * square * square);
    match freedom {
        0 => f64::INFINITY,
        1 => 12.706,
        2 => 4.303,
        _ => {
            z + (z3 + z) / (4.0 * n)
                + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n * n)
                + (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * n * n * n)
                + (79.0 * z9 + 776.0 * z7 + 1482.0 * z5 - 1920.0 * z3 - 945.0 * z) / (92160.0 * n * n * n * n)
        }
    }
}

/// Median and quartiles of times, which have no normal distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quartiles {
    pub median: f64,
    pub lower: f64,
    pub upper: f64,
}

impl Quartiles {
    pub fn of(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * sorted.len().saturating_sub(1) as f64;
            let (below, above) = (place.floor() as usize, place.ceil() as usize);
            let part = place - place.floor();
            sorted.get(below).zip(sorted.get(above)).map_or(0.0, |(a, b)| a * (1.0 - part) + b * part)
        };
        Self { median: at(0.5), lower: at(0.25), upper: at(0.75) }
    }
}

/// The slope of y over x by least squares; `None` for fewer than two different x.
pub fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let count = points.len() as f64;
    let (x, y) =
        points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / count, sum.1 + point.1 / count));
    let width: f64 = points.iter().map(|point| (point.0 - x) * (point.0 - x)).sum();
    let product: f64 = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
    (width > 0.0).then(|| product / width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn quantiles_match_tables() {
        for (freedom, wanted) in [(3, 3.182), (7, 2.365), (15, 2.131), (31, 2.040), (1000, 1.962)] {
            assert!((student(freedom) - wanted).abs() < 0.01, "{freedom}: {}", student(freedom));
        }
    }

    #[test]
    fn intervals_contain_the_mean_in_95_of_100_cases() {
        let mut random = Random(5);
        let holds = (0..4000).filter(|_| {
            let values: Vec<f64> = (0..16).map(|_| random.unit() + random.unit() + random.unit()).collect();
            let estimate = ConfidenceInterval::of(&values);
            (estimate.low..=estimate.high).contains(&1.5)
        });
        let share = holds.count() as f64 / 4000.0;
        assert!((share - 0.95).abs() < 0.015, "{share}");
    }

    #[test]
    fn bootstrap_intervals_are_better_for_heavy_tails() {
        let mut random = Random(9);
        // exp(1.5 z) of a normal z has the mean exp(1.125).
        let normal = |random: &mut Random| (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
        let truth: f64 = {
            let all: Vec<f64> = (0..400_000).map(|_| libm::exp(1.5 * normal(&mut random))).collect();
            all.iter().sum::<f64>() / all.len() as f64
        };
        let (mut student, mut bootstrap) = (0, 0);
        for _ in 0..600 {
            let values: Vec<f64> = (0..16).map(|_| libm::exp(1.5 * normal(&mut random))).collect();
            let holds =
                |estimate: ConfidenceInterval| u32::from((estimate.low..=estimate.high).contains(&truth));
            student += holds(ConfidenceInterval::of(&values));
            bootstrap += holds(ConfidenceInterval::bootstrapped(&values));
        }
        assert!(student < 510 && bootstrap > student + 25, "{student} {bootstrap} of 600");
    }

    #[test]
    fn only_significant_biases_are_reported() {
        let mut random = Random(4);
        let mut noisy = |bias: f64, every: usize| -> Vec<DVec3> {
            let mut one = |pixel: usize| {
                let own = if pixel.is_multiple_of(every) { bias } else { 0.0 };
                let normal = (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
                DVec3::splat(0.3 * normal + own)
            };
            (0..1000).map(&mut one).collect()
        };
        let none = (0..300).filter(|_| Bias::of(&noisy(0.0, 1), &noisy(0.0, 1)).is_certain()).count();
        assert!(none < 25, "{none} of 300");
        let holds = (0..300).filter(|_| {
            let Bias(found) = Bias::of(&noisy(0.3, 1), &noisy(0.3, 1));
            (found.low..=found.high).contains(&0.09)
        });
        let share = holds.count() as f64 / 300.0;
        assert!((0.9..=0.99).contains(&share), "{share}");
        // A firefly in one of the two measurements is noise, and does not widen the interval much.
        let mut firefly = noisy(0.3, 1);
        firefly[500] = DVec3::splat(300.0);
        assert!(Bias::of(&firefly, &noisy(0.3, 1)).most() < 1.0);
        // A large bias in few pixels counts: only noise makes it uncertain, not its variation between pixels.
        let few = Bias::of(&noisy(10.0, 250), &noisy(10.0, 250));
        assert!((few.root().expect("a bias") / 0.4f64.sqrt() - 1.0).abs() < 0.1, "{few:?}");
        assert!(Bias::of(&noisy(0.0, 1), &noisy(0.0, 1)).most() > 0.0);
        assert_eq!(Bias::of(&[DVec3::ZERO; 9], &[DVec3::ZERO; 9]).most(), 0.0);
    }

    #[test]
    fn nine_tenths_of_an_error_lie_in_few_pixels() {
        let mut squares = vec![0.001; 999];
        squares.push(99.0);
        let found = Concentration::of(&squares);
        assert!((found.worst_hundredth - 0.99).abs() < 0.001 && found.is_heavy(), "{found:?}");
        assert_eq!(found.nine_tenths, 0.001);
        let even = Concentration::of(&[1.0; 1000]);
        assert!(
            (even.nine_tenths - 0.9).abs() < 0.002 && (even.worst_hundredth - 0.01).abs() < 1e-9,
            "{even:?}"
        );
        assert_eq!(Concentration::of(&[0.0; 4]).nine_tenths, 1.0);
    }

    #[test]
    fn quartiles_lie_between_values() {
        let spread = Quartiles::of(&[5.0, 1.0, 2.0, 4.0, 3.0]);
        assert_eq!((spread.lower, spread.median, spread.upper), (2.0, 3.0, 4.0));
        assert_eq!(Quartiles::of(&[1.0, 2.0]).median, 1.5);
        assert_eq!(Quartiles::of(&[]), Quartiles::default());
    }

    #[test]
    fn a_line_has_its_slope() {
        assert_eq!(slope(&[(0.0, 1.0), (1.0, 0.5), (2.0, 0.0)]), Some(-0.5));
        assert_eq!(slope(&[(1.0, 1.0)]), None);
    }
}
