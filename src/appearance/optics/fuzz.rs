//! Fuzzy mirrors.

use crate::base::lanes::{Real, Vec3};
use crate::sampling::uniform_ball;
use std::f64::consts::PI;

/// A mirror that scatters its reflections (Shirley, *Ray Tracing in One Weekend*). It adds a point of a ball of radius
/// `fuzz`, uniform over the volume, to the mirrored direction (a unit vector). Directions below the surface are lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fuzz<F>(pub F);

impl<F: Real> Fuzz<F> {
    /// Samples a direction around `mirrored` from three numbers in 0..1.
    #[inline(always)]
    pub fn sample(self, mirrored: Vec3<F>, u: [F; 3]) -> Vec3<F> {
        (mirrored + uniform_ball(u) * self.0).normalize_or(mirrored)
    }

    /// The density of [`Fuzz::sample`] per steradian in `direction`. It integrates the uniform density over the chord
    /// of the ball along `direction`, seen from the start of the mirrored direction. From t₀ to t₁ along the chord it
    /// is ∫ t² dt / (4/3 π fuzz³) = (t₁³ - t₀³) / (4 π fuzz³).
    #[inline(always)]
    pub fn pdf(self, mirrored: Vec3<F>, direction: Vec3<F>) -> F {
        let zero = F::splat(0.0);
        let along = mirrored.dot(direction);
        let across = (mirrored - direction * along).length();
        let square = (self.0 - across) * (self.0 + across);
        let half = square.max(zero).sqrt();
        let cube = self.0 * self.0 * self.0;
        let (near, far) = ((along - half).max(zero), (along + half).max(zero));
        // The difference of cubes, in a form without cancellation.
        let apart = half * (F::splat(3.0) * along * along + square) / (F::splat(2.0 * PI) * cube);
        let from_start = far * far * far / (F::splat(4.0 * PI) * cube);
        let pdf = F::select(zero.lt(near), apart, from_start);
        F::select(zero.lt(square), pdf, zero)
    }
}
