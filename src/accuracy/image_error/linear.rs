//! Squared errors of radiance, and of displayed values.

use crate::base::color::Rgb;

/// Added to the squared reference in [`ReferencePair::relative_squared_error`], to limit the weight of black pixels.
/// 0.01 is the usual value (Rousselle, Knaus, Zwicker, *Adaptive Sampling and Reconstruction using Greedy Error
/// Minimization*, 2011).
pub const RELATIVE_FLOOR: f64 = 0.01;

/// Two references A and B from independent samples.
///
/// The mean of (x - A)(x - B) is the squared error of x without the noise of the references: the noise of A, B and x is
/// independent, so its products have a mean of zero. Over few pixels the result may be negative.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferencePair {
    pub a: Vec<Rgb>,
    pub b: Vec<Rgb>,
}

impl ReferencePair {
    /// Mean over pixels and channels of (x - A)(x - B).
    pub fn squared_error(&self, x: &[Rgb]) -> f64 {
        self.mean(x, |x, a, b| (x - a) * (x - b))
    }

    /// The squared error of each pixel: the mean over its channels of (x - A)(x - B).
    pub fn squared_errors(&self, x: &[Rgb]) -> Vec<f64> {
        let product = |((x, a), b): ((&Rgb, &Rgb), &Rgb)| {
            let x = x.as_dvec3();
            (x - a.as_dvec3()).dot(x - b.as_dvec3()) / 3.0
        };
        x.iter().zip(&self.a).zip(&self.b).map(product).collect()
    }

    /// Mean over pixels and channels of (x - A)(x - B) / (R² + [`RELATIVE_FLOOR`]), where R is the mean of A and B:
    /// relMSE.
    pub fn relative_squared_error(&self, x: &[Rgb]) -> f64 {
        self.mean(x, |x, a, b| {
            let reference = 0.5 * (a + b);
            (x - a) * (x - b) / (reference * reference + RELATIVE_FLOOR)
        })
    }

    /// The mean of both references, which is the best estimate.
    pub fn best(&self) -> Vec<Rgb> {
        self.a.iter().zip(&self.b).map(|(a, b)| ((a.as_dvec3() + b.as_dvec3()) * 0.5).as_vec3()).collect()
    }

    /// The squared error of [`ReferencePair::best`]: a quarter of the squared difference.
    pub fn noise(&self) -> f64 {
        mean_squared_error(&self.a, &self.b) / 4.0
    }

    /// Mean of both references over pixels and channels.
    pub fn brightness(&self) -> f64 {
        self.mean(&self.a, |_, a, b| 0.5 * (a + b))
    }

    fn mean(&self, x: &[Rgb], of: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let pixels = x.iter().zip(&self.a).zip(&self.b);
        let sum: f64 = pixels
            .map(|((x, a), b)| {
                let (x, a, b) = (x.as_dvec3(), a.as_dvec3(), b.as_dvec3());
                of(x.x, a.x, b.x) + of(x.y, a.y, b.y) + of(x.z, a.z, b.z)
            })
            .sum();
        sum / (3 * self.a.len()).max(1) as f64
    }
}

/// Mean over pixels and channels of the squared difference.
pub fn mean_squared_error(x: &[Rgb], y: &[Rgb]) -> f64 {
    let squares = x.iter().zip(y).map(|(x, y)| (x.as_dvec3() - y.as_dvec3()).length_squared());
    squares.sum::<f64>() / (3 * x.len()).max(1) as f64
}

/// Peak signal-to-noise ratio in decibels for displayed values in 0..=1 with this mean squared error; infinite if the
/// error is 0.
pub fn psnr(mean_squared_error: f64) -> f64 {
    -10.0 * libm::log10(mean_squared_error)
}
