//! The remaining error of an adaptively sampled film.

use crate::base::math::min;
use std::ops::{Add, Mul};

/// The quality of an adaptively sampled film. Errors are root mean squares over pixels and colour channels, relative to
/// the mean of the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    pub error: f64,
    /// The true error is between `low` and `high` in 95 of 100 frames.
    pub low: f64,
    pub high: f64,
    /// Samples per pixel, as the mean over the pixels.
    pub samples: f64,
    /// Fraction of the pixels that reached the maximum number of samples, whatever their error.
    pub capped: f64,
}

impl Noise {
    /// The noise from an estimate `square` of the squared error under independent samples. The reported error assumes half
    /// of the reduction by `gain`.
    ///
    /// The estimate and the truth are sums of squares. If each is distributed like a sum of n squares of normal
    /// numbers, whose relative variance is 2 / n, their ratio has Fisher's F distribution with these two degrees of
    /// freedom.
    pub fn of_square(square: f64, variances: Variances, gain: Gain) -> Self {
        if square == 0.0 {
            return Self::default();
        }
        let freedom = |variance: f64| 2.0 * square * square / variance;
        let at = |z: f64, variance: ErrorVariance| {
            square * f_quantile(z, freedom(variance.truth), freedom(variance.estimate))
        };
        // 95 % of a normal distribution are within 1.96 standard deviations.
        let (low, high) = (at(-1.96, variances.supposed(square)), at(1.96, variances.bounds));
        // Both doubts are independent, so the squares of their logarithms add up.
        let doubt = libm::hypot(libm::log(low / square), libm::log(gain.low / gain.ratio));
        let low = (gain.ratio * square * libm::exp(-doubt)).sqrt();
        Self { error: (gain.reported() * square).sqrt(), low, high: high.sqrt(), ..Self::default() }
    }
}

/// The variance of the estimate of a squared error, and of the true squared error.
#[derive(Clone, Copy, Debug, Default)]
pub struct ErrorVariance {
    /// Of the estimate.
    pub estimate: f64,
    /// Of the true squared error.
    pub truth: f64,
}

/// Variances of a squared error.
#[derive(Clone, Copy, Debug, Default)]
pub struct Variances {
    /// Bounds, which hold even if few pixels are far off and have not shown it. They decide how large the error may be.
    pub bounds: ErrorVariance,
    /// As neighbouring pixels show them. They decide how small the error may be.
    pub shown: ErrorVariance,
}

impl Variances {
    /// The shown variances of an estimate `square`, with the doubt about them, at most the bounds.
    ///
    /// A variance of few numbers is doubtful itself: the quantile z of the normal distribution becomes that of Student's t,
    /// about z (1 + (z² + 1) / 4f) for f degrees of freedom. If the estimate is a sum of n squares of normal numbers, its
    /// relative variance v is 2 / n. Its n / 2 pairs have squared differences whose squares are 9 times the squared mean
    /// on average, so f = n / 9 = 2 / 9v.
    fn supposed(&self, square: f64) -> ErrorVariance {
        const Z: f64 = 1.96;
        let one = |shown: f64, bound: f64| {
            let doubt = (Z * Z + 1.0) / 2.0 * 4.5 * shown / (square * square);
            min(bound, shown * (1.0 + doubt))
        };
        let Self { shown, bounds } = self;
        ErrorVariance {
            estimate: one(shown.estimate, bounds.estimate),
            truth: one(shown.truth, bounds.truth),
        }
    }
}

impl Add for ErrorVariance {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { estimate: self.estimate + other.estimate, truth: self.truth + other.truth }
    }
}

impl Mul<f64> for ErrorVariance {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { estimate: self.estimate * factor, truth: self.truth * factor }
    }
}

impl Add for Variances {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { bounds: self.bounds + other.bounds, shown: self.shown + other.shown }
    }
}

impl Mul<f64> for Variances {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { bounds: self.bounds * factor, shown: self.shown * factor }
    }
}

/// How much smaller the squared error is than that of independent samples, because the points of a sequence complement each
/// other.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// The ratio of both, at best: above 0, at most 1.
    pub ratio: f64,
    /// The ratio is at least this in 95 of 100 cases.
    pub low: f64,
}

impl Gain {
    /// The ratio if half of the reduction holds.
    pub fn reported(self) -> f64 {
        (1.0 + self.ratio) / 2.0
    }
}

impl Default for Gain {
    /// None, as of independent samples.
    fn default() -> Self {
        Self { ratio: 1.0, low: 1.0 }
    }
}

/// The quantile of the F distribution that corresponds to `z` standard deviations of a normal distribution. The cube
/// root of the F distribution is approximately the ratio of two normal numbers (Paulson, "An approximate
/// normalization of the analysis of variance distribution", 1942). Infinite if the degrees of freedom are too few to
/// bound it.
fn f_quantile(z: f64, above: f64, below: f64) -> f64 {
    let (a, b) = (2.0 / (9.0 * above), 2.0 / (9.0 * below));
    // Solve ((1 - b) x - (1 - a))^2 = z^2 (b x^2 + a) for x.
    let square = (1.0 - b) * (1.0 - b) - z * z * b;
    if square <= 0.0 {
        return if z > 0.0 { f64::INFINITY } else { 0.0 };
    }
    let half = (1.0 - a) * (1.0 - b);
    let rest = (1.0 - a) * (1.0 - a) - z * z * a;
    let root = (half * half - square * rest).max(0.0).sqrt().copysign(z);
    let x = ((half + root) / square).max(0.0);
    x * x * x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of the F distribution at 2.5 % and 97.5 %. The formula is more accurate for more degrees of freedom.
    #[test]
    fn quantiles_of_f() {
        for (above, below, within, low, high) in [
            (5.0, 10.0, 0.04, 0.1511, 4.2361),
            (10.0, 20.0, 0.01, 0.2925, 2.7737),
            (60.0, 120.0, 0.001, 0.6325, 1.5299),
        ] {
            let found = [-1.96, 1.96].map(|z| f_quantile(z, above, below));
            assert!((found[0] / low - 1.0).abs() < within, "{above}, {below}: {found:?}");
            assert!((found[1] / high - 1.0).abs() < within, "{above}, {below}: {found:?}");
        }
        // With so few degrees of freedom, no value is ruled out.
        assert_eq!([-1.96, 1.96].map(|z| f_quantile(z, 0.1, 0.2)), [0.0, f64::INFINITY]);
        assert!((f_quantile(1.96, f64::INFINITY, f64::INFINITY) - 1.0).abs() < 1e-12);
    }
}
