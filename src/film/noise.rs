//! The remaining error of an adaptively sampled film.

use crate::base::math::min;

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
    /// Whether the film, or a part of it, was denoised. None if it was never to be.
    pub denoised: Option<bool>,
}

impl Noise {
    /// The noise from an estimate `square` of the squared error under independent samples. The reported error assumes half
    /// of the reduction by `gain`.
    ///
    /// The estimate and the truth are sums of squares. If each is distributed like a sum of n squares of normal
    /// numbers, whose relative variance is 2 / n, their ratio has Fisher's F distribution with these two degrees of
    /// freedom.
    pub fn of_square(square: f64, variances: Variances, gain: StratificationGain) -> Self {
        if square == 0.0 {
            return Self::default();
        }
        let freedom = |variance: f64| 2.0 * square * square / variance;
        let at = |z: f64, variance: ErrorVariance| {
            square * f_quantile(z, freedom(variance.truth), freedom(variance.estimate))
        };
        let (low, high) = (
            at(-Z_95, variances.measured_with_uncertainty(square)),
            at(Z_95, variances.bound_with_uncertainty(square)),
        );
        // As if the gain and the estimate were independent, the squares of their logarithmic deviations add up.
        let deviation = libm::hypot(libm::log(low / square), libm::log(gain.low / gain.ratio));
        let low = (gain.ratio * square * libm::exp(-deviation)).sqrt();
        Self { error: (gain.reported() * square).sqrt(), low, high: high.sqrt(), ..Self::default() }
    }
}

/// 95 % of a normal distribution are within this many standard deviations.
pub const Z_95: f64 = 1.96;

/// The variance of the estimate of a squared error, and of the true squared error.
#[derive(Clone, Copy, Debug, Default)]
pub struct ErrorVariance {
    /// Of the estimate.
    pub estimate: f64,
    /// Of the true squared error.
    pub truth: f64,
}

impl ErrorVariance {
    fn add_scaled(&mut self, other: &Self, factor: f64) {
        self.estimate += factor * other.estimate;
        self.truth += factor * other.truth;
    }
}

/// Variances of a squared error.
#[derive(Clone, Copy, Debug, Default)]
pub struct Variances {
    /// An upper bound, which includes pixels whose samples have missed rare light. It gives the upper end of the interval.
    pub bound: ErrorVariance,
    /// Measured from the differences of neighbouring pixels. It gives the lower end.
    pub measured: ErrorVariance,
}

impl Variances {
    /// Adds `factor` times other variances.
    pub fn add_scaled(&mut self, other: &Self, factor: f64) {
        self.bound.add_scaled(&other.bound, factor);
        self.measured.add_scaled(&other.measured, factor);
    }

    /// The variances times a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut all = Self::default();
        all.add_scaled(self, factor);
        all
    }

    /// The bounds of an estimate `square`, enlarged by their own uncertainty.
    ///
    /// If the estimate is a sum of n squares of normal numbers, its relative bound b is the sum of their fourth powers over the
    /// square of that sum, about 3 / n. Relative to their means, squares have the variance 2, fourth powers 105 / 9 - 1 = 32 / 3,
    /// and both the covariance 15 / 3 - 1 = 4. So b has the relative variance (32 / 3 - 4 * 4 + 4 * 2) / n = 8 / 3n = 8 b / 9, as
    /// if it were measured from 9 / 4b degrees of freedom.
    fn bound_with_uncertainty(&self, square: f64) -> ErrorVariance {
        let enlarged = |bound: f64| bound * of_student(9.0 * square * square / (4.0 * bound));
        ErrorVariance { estimate: enlarged(self.bound.estimate), truth: enlarged(self.bound.truth) }
    }

    /// The measured variances of an estimate `square`, enlarged by their own uncertainty, but at most the enlarged bounds.
    ///
    /// If the estimate is a sum of n squares of normal numbers, its relative variance v is 2 / n. It is measured from n / 2
    /// pairs, and the mean fourth power of the difference of two such squares is 9 times the square of the mean second power.
    /// So it has n / 9 = 2 / 9v degrees of freedom.
    fn measured_with_uncertainty(&self, square: f64) -> ErrorVariance {
        let most = self.bound_with_uncertainty(square);
        let enlarged = |measured: f64, most: f64| {
            min(most, measured * of_student(2.0 * square * square / (9.0 * measured)))
        };
        ErrorVariance {
            estimate: enlarged(self.measured.estimate, most.estimate),
            truth: enlarged(self.measured.truth, most.truth),
        }
    }
}

/// The factor by which a variance that is measured from so many degrees of freedom grows. Student's t distribution replaces the
/// normal one, whose quantile z becomes about z (1 + (z² + 1) / 4f).
fn of_student(degrees: f64) -> f64 {
    1.0 + (Z_95 * Z_95 + 1.0) / (2.0 * degrees)
}

/// The reduction of the squared error by stratification, whose samples complement each other.
#[derive(Clone, Copy, Debug)]
pub struct StratificationGain {
    /// The squared error over that of independent samples, at best: above 0, at most 1.
    pub ratio: f64,
    /// The lower end of the interval that contains the ratio in 95 of 100 cases.
    pub low: f64,
}

impl StratificationGain {
    /// The ratio if half of the reduction holds.
    pub fn reported(self) -> f64 {
        (1.0 + self.ratio) / 2.0
    }
}

impl Default for StratificationGain {
    /// Independent samples.
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
