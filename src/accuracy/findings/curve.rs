//! Conclusions from the curve of error against time.

use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::SettingAxis;
use crate::accuracy::statistics::slope;
use crate::base::units::{factor, percent};

/// Power laws of the error and of the time over the number of samples.
#[derive(Clone, Copy, Debug)]
pub struct PowerLaw {
    /// Exponents of the number of samples.
    error: f64,
    time: f64,
}

impl PowerLaw {
    /// The factors of samples and of time at which the error is multiplied by `factor`.
    pub fn to_error(self, factor: f64) -> (f64, f64) {
        let samples = libm::pow(factor, 1.0 / self.error);
        (samples, libm::pow(samples, self.time))
    }

    /// The factors of samples and of the error at which the time is multiplied by `factor`.
    pub fn to_time(self, factor: f64) -> (f64, f64) {
        let samples = libm::pow(factor, 1.0 / self.time);
        (samples, libm::pow(samples, self.error))
    }
}

impl Measured {
    /// The points on the Pareto front of time and error. Points with a baseline do not count.
    pub fn pareto_front(&self, error: impl Fn(&Point) -> f64) -> Vec<&Point> {
        let compared = |point: &&Point| {
            matches!(point.setting.axis, SettingAxis::Samples | SettingAxis::Noise | SettingAxis::Antialias)
        };
        let mut all: Vec<&Point> = self.points.iter().filter(compared).collect();
        all.sort_by(|a, b| a.time().total_cmp(&b.time()));
        let mut least = f64::INFINITY;
        all.retain(|point| {
            let better = error(point) < least;
            least = least.min(error(point));
            better
        });
        all
    }

    /// The power law of fixed numbers of samples around the file's own setting.
    pub fn curve(&self) -> Option<PowerLaw> {
        let axis = if self.random { SettingAxis::Samples } else { SettingAxis::Antialias };
        let own = self.own().time();
        // The time of far cheaper points is mostly the fixed cost of a frame.
        let near = |point: &&&Point| point.error() > 0.0 && point.time() > 0.1 * own;
        let on = self.on(axis);
        let near: Vec<_> = on.iter().filter(near).collect();
        let of = |value: fn(&Point) -> f64| {
            let line = near.iter().map(|point| (libm::log(point.samples), libm::log(value(point))));
            slope(&line.collect::<Vec<_>>())
        };
        let curve = PowerLaw { error: of(Point::error)?, time: of(Point::time)? };
        (curve.error < 0.0 && curve.time > 0.0).then_some(curve)
    }

    /// The factor of time that halves the error.
    pub fn price_of_half(&self) -> Option<f64> {
        self.curve().map(|curve| curve.to_error(0.5).1)
    }

    /// A sentence about how many times fewer samples Sobol points need than independent random numbers, for the same
    /// error.
    pub fn sobol(&self) -> Option<String> {
        let own = self.points.iter().filter(|point| point.setting.axis == SettingAxis::Samples);
        let pairs = own.filter_map(|point| {
            let baseline = self.points.iter().find(|other| {
                other.setting.axis == SettingAxis::Independent && other.samples == point.samples
            })?;
            Some((point, baseline.squared.mean / point.squared.mean))
        });
        let (point, gain) = pairs.max_by(|a, b| a.0.samples.total_cmp(&b.0.samples))?;
        // The squared error of independent samples is inversely proportional to their number.
        Some(match gain {
            gain if gain > 1.1 => format!(
                "Sobol sampling needs {} times fewer samples than independent random numbers, as measured with {} \
                 samples",
                factor(gain),
                point.setting.value
            ),
            _ => format!(
                "Sobol sampling gains nothing here: {} independent samples have the same error",
                point.setting.value
            ),
        })
    }

    /// A sentence that compares noise targets with fixed numbers of samples at the same error.
    pub fn adaptive(&self) -> Option<String> {
        let uniform = self.on(SettingAxis::Samples);
        let usable =
            uniform.iter().filter(|point| point.error() > 0.0 && point.time() > 0.1 * self.own().time());
        let logs: Vec<_> = usable.map(|point| (libm::log(point.error()), libm::log(point.time()))).collect();
        let steepness = slope(&logs)?;
        let count = logs.len() as f64;
        let mean = logs.iter().fold((0.0, 0.0), |sum, at| (sum.0 + at.0 / count, sum.1 + at.1 / count));
        let noisy = self.on(SettingAxis::Noise);
        let compared = noisy.iter().filter(|point| point.error() > 0.0).map(|point| {
            let same = libm::exp(mean.1 + steepness * (libm::log(point.error()) - mean.0));
            (point, point.time() / same)
        });
        // The noise target closest to the error of the file's own setting is the most relevant.
        let far = |point: &Point| libm::fabs(libm::log(point.error() / self.own().error()));
        let (point, ratio) = compared.min_by(|a, b| far(a.0).total_cmp(&far(b.0)))?;
        let flags = format!("--noise {}", point.setting.quality.noise?.error);
        Some(format!(
            "{flags} takes {} times the time of fixed samples with the same error ({})",
            factor(ratio),
            percent(self.share(point.error()))
        ))
    }
}
