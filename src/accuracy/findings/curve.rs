//! What the curve of error against time says.

use super::{factor, percent};
use crate::accuracy::measure::{Measured, Point};
use crate::accuracy::settings::Axis;
use crate::accuracy::statistics::slope;

/// A power law through points of samples, times and errors.
#[derive(Clone, Copy, Debug)]
pub struct Curve {
    /// By which power of the samples the error changes, and the time.
    error: f64,
    time: f64,
}

impl Curve {
    /// Factors of samples and of time that multiply the error by `factor`.
    pub fn to_error(self, factor: f64) -> (f64, f64) {
        let samples = libm::pow(factor, 1.0 / self.error);
        (samples, libm::pow(samples, self.time))
    }

    /// Factors of samples and of the error that multiply the time by `factor`.
    pub fn to_time(self, factor: f64) -> (f64, f64) {
        let samples = libm::pow(factor, 1.0 / self.time);
        (samples, libm::pow(samples, self.error))
    }
}

impl Measured {
    /// Points that no other one beats in both time and error. Those that are short by intent are not compared.
    pub fn front(&self, error: impl Fn(&Point) -> f64) -> Vec<&Point> {
        let compared =
            |point: &&Point| matches!(point.setting.axis, Axis::Samples | Axis::Noise | Axis::Antialias);
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

    /// The curve of fixed samples around the file's own setting.
    pub fn curve(&self) -> Option<Curve> {
        let axis = if self.random { Axis::Samples } else { Axis::Antialias };
        let own = self.own().time();
        // What costs far less is mostly what every frame costs.
        let near = |point: &&&Point| point.error() > 0.0 && point.time() > 0.1 * own;
        let on = self.on(axis);
        let near: Vec<_> = on.iter().filter(near).collect();
        let of = |value: fn(&Point) -> f64| {
            let line = near.iter().map(|point| (libm::log(point.samples), libm::log(value(point))));
            slope(&line.collect::<Vec<_>>())
        };
        let curve = Curve { error: of(Point::error)?, time: of(Point::time)? };
        (curve.error < 0.0 && curve.time > 0.0).then_some(curve)
    }

    /// By which factor time grows if the error is to be halved.
    pub fn price_of_half(&self) -> Option<f64> {
        self.curve().map(|curve| curve.to_error(0.5).1)
    }

    /// How many times fewer samples Sobol points need than independent random numbers, for the same error.
    pub fn sobol(&self) -> Option<String> {
        let own = self.points.iter().filter(|point| point.setting.axis == Axis::Samples);
        let pairs = own.filter_map(|point| {
            let twin = self
                .points
                .iter()
                .find(|other| other.setting.axis == Axis::Independent && other.samples == point.samples)?;
            Some((point, twin.squared.mean / point.squared.mean))
        });
        let (point, gain) = pairs.max_by(|a, b| a.0.samples.total_cmp(&b.0.samples))?;
        // Independent samples divide the squared error by their number.
        Some(match gain {
            gain if gain > 1.1 => format!(
                "Sobol sampling needs {} times fewer samples than independent random numbers, as measured with {}",
                factor(gain),
                point.setting.value
            ),
            _ => format!(
                "Sobol sampling gains nothing here: {} samples are as good if they are independent",
                point.setting.value
            ),
        })
    }

    /// Noise targets against fixed numbers of samples, at the same error.
    pub fn adaptive(&self) -> Option<String> {
        let uniform = self.on(Axis::Samples);
        let usable =
            uniform.iter().filter(|point| point.error() > 0.0 && point.time() > 0.1 * self.own().time());
        let logs: Vec<_> = usable.map(|point| (libm::log(point.error()), libm::log(point.time()))).collect();
        let steepness = slope(&logs)?;
        let count = logs.len() as f64;
        let mean = logs.iter().fold((0.0, 0.0), |sum, at| (sum.0 + at.0 / count, sum.1 + at.1 / count));
        let noisy = self.on(Axis::Noise);
        let compared = noisy.iter().filter(|point| point.error() > 0.0).map(|point| {
            let same = libm::exp(mean.1 + steepness * (libm::log(point.error()) - mean.0));
            (point, point.time() / same)
        });
        // The one next to the file's own setting says most of it.
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
