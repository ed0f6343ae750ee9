//! The remaining error of an adaptively sampled film.

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
    /// The noise from an estimate `square` of the squared error under independent samples. `variance` is the variance
    /// of the estimate, and `truth` the variance of the true squared error. `gain` is the factor by which
    /// stratification reduces the squared error at best; the reported error assumes half of that reduction.
    ///
    /// The estimate and the truth are sums of squares. If each is distributed like a sum of n squares of normal
    /// numbers, whose relative variance is 2 / n, their ratio has Fisher's F distribution with these two degrees of
    /// freedom.
    pub fn of_square(square: f64, (variance, truth): (f64, f64), gain: f64) -> Self {
        if square == 0.0 {
            return Self::default();
        }
        let freedom = |variance: f64| 2.0 * square * square / variance;
        let at = |z: f64| square * f_quantile(z, freedom(truth), freedom(variance));
        // 95 % of a normal distribution are within 1.96 standard deviations.
        let (low, high) = ((gain * at(-1.96)).sqrt(), at(1.96).sqrt());
        Self { error: ((1.0 + gain) / 2.0 * square).sqrt(), low, high, ..Self::default() }
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
