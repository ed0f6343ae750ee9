//! Random inputs, which are the same in every run.

use crate::base::math::{Angle, DVec3};
use crate::sampling::hash;

/// Random numbers from a seed.
pub struct InputRng {
    seed: u32,
    count: u32,
}

impl InputRng {
    pub fn new(seed: u32) -> Self {
        Self { seed, count: 0 }
    }

    /// Uniform in 0..1, with all 53 bits of an f64.
    pub fn unit(&mut self) -> f64 {
        self.count += 1;
        let [high, low] = [0, 1].map(|part| u64::from(hash([self.seed, self.count, part])));
        ((high << 32 | low) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Between two positive numbers, uniform in the logarithm.
    pub fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.unit())
    }

    /// A unit vector, uniform over the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let z = self.uniform(-1.0, 1.0);
        let turn = Angle(360.0 * self.unit()).cos_sin() * ((1.0 - z) * (1.0 + z)).sqrt();
        DVec3::new(turn.x, turn.y, z)
    }

    /// A vector perpendicular to a unit vector, with a length between `inner` and `outer`.
    pub fn ring(&mut self, axis: DVec3, inner: f64, outer: f64) -> DVec3 {
        let (u, v) = axis.any_orthonormal_pair();
        let turn = Angle(360.0 * self.unit()).cos_sin() * self.uniform(inner, outer);
        u * turn.x + v * turn.y
    }
}
