//! The squared error of a mean, estimated from the means of two parts of its samples.
//!
//! Let A be the mean of the first a samples and B the mean of the next b, all of them independent with the variance v.
//! Then the mean of (A - B)² is (1/a + 1/b) v, and the mean of all samples has the squared error v / (a + b). So
//! ab / (a + b)² (A - B)² estimates the squared error of the mean of all samples.

use crate::base::math::DVec3;

/// The numbers of samples in both parts.
#[derive(Clone, Copy, Debug)]
pub struct SampleHalves {
    first: f64,
    second: f64,
}

impl SampleHalves {
    /// The first `before` of `after` samples, and the rest.
    pub fn new(before: u32, after: u32) -> Self {
        Self { first: f64::from(before), second: f64::from(after - before) }
    }

    /// The number of all samples.
    pub fn count(&self) -> f64 {
        self.first + self.second
    }

    /// ab / (a + b)², the factor of the squared difference. It is 0 if one of the parts is empty.
    pub fn factor(&self) -> f64 {
        self.first * self.second / (self.count() * self.count())
    }

    /// A - B, from the sum of the first part and the sum of all samples.
    pub fn difference(&self, first: DVec3, all: DVec3) -> DVec3 {
        first * (1.0 / self.first) - (all - first) * (1.0 / self.second)
    }
}
