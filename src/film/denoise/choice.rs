//! Chooses among the candidates for every pixel, by their measured errors around it.

use super::candidates::CANDIDATES;
use rayon::prelude::*;

/// Weights of the errors of pixels at a distance of 0, 1, … along an axis.
const KERNEL: [f32; 7] = [7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0];

/// The least error of a candidate that counts, as a share of that of the samples: estimates may be 0 or negative by
/// chance.
const LEAST: f32 = 1e-3;

/// Bytes per pixel of errors, differences, their sums and means, and weights.
pub const BYTES_PER_PIXEL: u64 = (size_of::<Measured>()
    + size_of::<([f32; CANDIDATES], f32)>()
    + size_of::<Surroundings>()
    + size_of::<[f32; CANDIDATES]>()
    + size_of::<f32>()) as u64;

/// How many times the squared error of the samples a squared difference may be that is plain noise.
const PLAIN: f32 = 16.0;

/// What is known of the candidates at a pixel: squares, summed over the channels, relative to its light.
#[derive(Clone, Copy, Debug, Default)]
pub struct Measured {
    /// Estimates of the squared errors of the means of both halves' candidates, if the halves are independent.
    pub errors: [f32; CANDIDATES],
    /// Estimates from the audits, which suppose nothing.
    pub audited: [f32; CANDIDATES],
    /// The squared difference to the samples that is at least there in both halves, in the same direction.
    pub differences: [f32; CANDIDATES],
}

impl Measured {
    pub fn is_finite(&self) -> bool {
        let mut all = self.errors.iter().chain(&self.audited).chain(&self.differences).copied();
        all.all(f32::is_finite)
    }
}

/// What is known of the candidates around a pixel.
struct Surroundings {
    /// The mean errors without the pixel itself, not below 0.
    errors: [f32; CANDIDATES],
    /// What is added to the error of a candidate that is refused; 0 if it is not.
    refused: [f32; CANDIDATES],
}

/// The weights of the candidates at every pixel.
pub struct Choice {
    weights: Vec<[f32; CANDIDATES]>,
    noise: Vec<f32>,
}

impl Choice {
    /// Weights by the inverse squares of mean squared errors. `measure` gives what is known of the candidates at a pixel.
    ///
    /// Errors are means around a pixel, without the pixel itself: its samples are part of its candidates. There are two
    /// exceptions. Outliers are lonely, so only the whole picture shows whether samples have a smaller error without them.
    /// And details as small as a pixel are known only there: a candidate that differs from both halves, far more than they
    /// differ from each other around it, is refused.
    ///
    /// The audits enter by sums over the picture alone, so what is chosen at a pixel hardly depends on their samples there.
    pub fn new((width, height): (usize, usize), measure: impl Fn(usize) -> Measured + Sync) -> Self {
        let own: Vec<Measured> = (0..width * height).into_par_iter().map(&measure).collect();
        let along = |pixel: usize| {
            let (x, start) = (pixel % width, pixel / width * width);
            weighted_sum(x, width, |x| &own[start + x].errors)
        };
        let rows: Vec<_> = (0..own.len()).into_par_iter().map(along).collect();
        let around = |pixel: usize| {
            let (x, y) = (pixel % width, pixel / width);
            let (mut sum, in_column) = weighted_sum(y, height, |y| &rows[y * width + x].0);
            let center = KERNEL[0] * KERNEL[0];
            sum.iter_mut().zip(&own[pixel].errors).for_each(|(sum, own)| *sum -= center * own);
            let total = rows[pixel].1 * in_column - center;
            let errors = sum.map(|sum| (sum / total).max(0.0));
            let is_detail = |both: f32| both > PLAIN * errors[0];
            let refused = own[pixel].differences.map(|both| if is_detail(both) { both } else { 0.0 });
            Surroundings { errors, refused }
        };
        let around: Vec<_> = (0..own.len()).into_par_iter().map(around).collect();
        let plain = own.iter().zip(&around).filter(|(_, around)| around.refused[1] == 0.0);
        let calibration = Calibration::new(plain.map(|(own, _)| own));
        let weights = around.par_iter().map(|around| calibration.weights(around)).collect();
        let noise = around.par_iter().map(|around| around.errors[0]).collect();
        Self { weights, noise }
    }

    pub fn weights(&self, pixel: usize) -> [f32; CANDIDATES] {
        self.weights[pixel]
    }

    /// The squared error of samples around a pixel, relative to its light.
    pub fn noise(&self, pixel: usize) -> f32 {
        self.noise[pixel]
    }
}

/// The sum of errors near a place on an axis, weighted by the kernel, and the sum of the weights. Places outside of the
/// picture do not count.
fn weighted_sum<'a>(
    center: usize,
    length: usize,
    errors: impl Fn(usize) -> &'a [f32; CANDIDATES],
) -> ([f32; CANDIDATES], f32) {
    let reach = KERNEL.len() - 1;
    let (mut sum, mut total) = ([0.0; CANDIDATES], 0.0);
    for place in center.saturating_sub(reach)..length.min(center + reach + 1) {
        let weight = KERNEL[place.abs_diff(center)];
        sum.iter_mut().zip(errors(place)).for_each(|(sum, error)| *sum += weight * error);
        total += weight;
    }
    (sum, total)
}

/// What the audits show over the whole picture, relative to the error of the samples that halves show.
struct Calibration {
    /// What is to be added to the error of each candidate.
    more: [f32; CANDIDATES],
    /// The errors of the samples with outliers, and without.
    samples: [f32; 2],
}

impl Calibration {
    fn new<'a>(pixels: impl Iterator<Item = &'a Measured>) -> Self {
        let (mut samples, mut more, mut audited) = (0.0, [0.0; CANDIDATES], [0.0; CANDIDATES]);
        for own in pixels {
            samples += f64::from(own.errors[0]);
            for candidate in 0..CANDIDATES {
                audited[candidate] += f64::from(own.audited[candidate]);
                more[candidate] += f64::from(own.audited[candidate]) - f64::from(own.errors[candidate]);
            }
        }
        let relative = |sum: f64| if samples > 0.0 { (sum / samples) as f32 } else { 0.0 };
        let [with, without, ..] = audited;
        Self { more: more.map(relative), samples: [with, without].map(|sum| relative(sum).max(LEAST)) }
    }

    /// The weights of candidates. If the samples have no error, they are the picture.
    fn weights(&self, around: &Surroundings) -> [f32; CANDIDATES] {
        let Surroundings { errors, refused } = around;
        let (samples, mut weights) = (errors[0], [0.0; CANDIDATES]);
        weights[0] = 1.0;
        if !(samples > 0.0 && errors.iter().all(|error| error.is_finite())) {
            return weights;
        }
        let least = LEAST * self.samples[0].min(self.samples[1]);
        for (candidate, weight) in weights.iter_mut().enumerate() {
            let error = match self.samples.get(candidate) {
                Some(error) => *error,
                None => (errors[candidate] / samples + self.more[candidate]).max(0.0),
            };
            // The samples are there twice, mostly alike.
            let share = if candidate < 2 { 0.5 } else { 1.0 };
            let error = error + refused[candidate] / samples + least;
            *weight = share / (error * error);
        }
        let sum: f32 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    }
}
