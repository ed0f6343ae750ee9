//! What a few measurements tell of all.

/// A mean, and the interval that holds the true one in 95 of 100 cases.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    pub mean: f64,
    pub low: f64,
    pub high: f64,
}

impl Estimate {
    /// Of independent measurements, by Student's t. One alone has no interval.
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

    /// The same of something that rises or falls with what was measured.
    pub fn map(self, of: impl Fn(f64) -> f64) -> Self {
        let (low, high) = (of(self.low), of(self.high));
        Self { mean: of(self.mean), low: low.min(high), high: low.max(high) }
    }

    /// The root; of what is below 0, none.
    pub fn root(self) -> Self {
        self.map(|value| value.max(0.0).sqrt())
    }
}

/// The quantile 0.975 of Student's t: Cornish and Fisher's expansion around the normal distribution's (Abramowitz and
/// Stegun 26.7.5), good to 0.01 from three degrees of freedom on; below, from tables.
fn student(freedom: usize) -> f64 {
    const NORMAL: f64 = 1.959_963_985;
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
pub struct Spread {
    pub median: f64,
    pub lower: f64,
    pub upper: f64,
}

impl Spread {
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

/// Least squares: how much y rises with x. None of fewer than two different x.
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
    fn quantiles_are_those_of_tables() {
        for (freedom, wanted) in [(3, 3.182), (7, 2.365), (15, 2.131), (31, 2.040), (1000, 1.962)] {
            assert!((student(freedom) - wanted).abs() < 0.01, "{freedom}: {}", student(freedom));
        }
    }

    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        let mut random = Random(5);
        let holds = (0..4000).filter(|_| {
            let values: Vec<f64> = (0..16).map(|_| random.unit() + random.unit() + random.unit()).collect();
            let estimate = Estimate::of(&values);
            (estimate.low..=estimate.high).contains(&1.5)
        });
        let share = holds.count() as f64 / 4000.0;
        assert!((share - 0.95).abs() < 0.015, "{share}");
    }

    #[test]
    fn quartiles_lie_between_values() {
        let spread = Spread::of(&[5.0, 1.0, 2.0, 4.0, 3.0]);
        assert_eq!((spread.lower, spread.median, spread.upper), (2.0, 3.0, 4.0));
        assert_eq!(Spread::of(&[1.0, 2.0]).median, 1.5);
        assert_eq!(Spread::of(&[]), Spread::default());
    }

    #[test]
    fn a_line_has_its_slope() {
        assert_eq!(slope(&[(0.0, 1.0), (1.0, 0.5), (2.0, 0.0)]), Some(-0.5));
        assert_eq!(slope(&[(1.0, 1.0)]), None);
    }
}
