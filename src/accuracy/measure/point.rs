//! The measurements of a setting, and of a film layer.

use crate::accuracy::settings::Setting;
use crate::accuracy::statistics::{Bias, Concentration, ConfidenceInterval, Quartiles};

/// The cost and the errors of one setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    pub setting: Setting,
    /// Wall time per frame, in seconds.
    pub wall: Quartiles,
    /// Processor time of all threads per frame, in seconds.
    pub cpu: Option<Quartiles>,
    /// Rays per frame.
    pub rays: f64,
    /// Mean samples per pixel.
    pub samples: f64,
    /// Mean squared error of radiance, without the noise of the references.
    pub squared: ConfidenceInterval,
    /// relMSE.
    pub relative: ConfidenceInterval,
    /// PSNR of the displayed picture, in decibels.
    pub psnr: ConfidenceInterval,
    /// Mean FLIP of the displayed picture.
    pub flip: ConfidenceInterval,
    /// The error that more samples do not reduce, against the reference; on axes with a baseline, against that
    /// baseline.
    pub bias: Bias,
    /// On axes with a baseline, the largest change of a displayed value, in 0..=1.
    pub largest_change: f64,
    /// Variance of a pixel between runs, summed over its channels: the mean over pixels.
    pub variance: f64,
    /// How the squared error of a run is distributed over the pixels.
    pub concentration: Concentration,
    /// Squared error of each pixel, the mean of all runs.
    pub errors: Vec<f32>,
    /// Fraction of the pixels that hit the limit of samples.
    pub capped: f64,
    /// The displayed picture of the first run.
    pub picture: Vec<[f32; 3]>,
    /// The squared error of each run.
    pub runs: Vec<f64>,
    /// The FLIP map of the first run.
    pub flips: Vec<f32>,
}

impl Point {
    /// RMSE of the displayed picture, in 0..=1.
    pub fn displayed(&self) -> ConfidenceInterval {
        self.psnr.map(|decibels| libm::exp10(-decibels / 20.0))
    }

    /// Processor time per frame, in seconds; wall time if the system does not report processor times.
    pub fn time(&self) -> f64 {
        self.cpu.map_or(self.wall.median, |cpu| cpu.median)
    }

    /// 1 / (squared error x seconds): twice the efficiency gives the same picture in half the time.
    pub fn efficiency(&self) -> f64 {
        1.0 / (self.squared.mean * self.time())
    }

    /// RMSE of the radiance.
    pub fn error(&self) -> f64 {
        self.squared.mean.max(0.0).sqrt()
    }
}

/// A film layer at the file's own setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    pub name: String,
    /// Fraction of the picture's brightness.
    pub share: f64,
    /// Its error as a fraction of its own brightness.
    pub error: f64,
    /// Its fraction of the squared error in the worst 1 % of the pixels.
    pub of_worst: f64,
}
