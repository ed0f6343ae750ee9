//! Fuzzy mirrors.

use crate::math::DVec3;
use crate::sampling::in_ball;
use std::f64::consts::PI;

/// A mirror whose reflections are scattered: the mirrored direction (of length 1) plus a point of a ball of
/// radius `fuzz`, uniform over its volume (Shirley, *Ray Tracing in One Weekend*). Directions below the
/// surface are lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fuzz(pub f64);

impl Fuzz {
    /// A direction around `mirrored` for `u` uniform in the unit cube.
    pub fn sample(self, mirrored: DVec3, u: DVec3) -> DVec3 {
        (mirrored + in_ball(u) * self.0).normalize_or(mirrored)
    }

    /// The density of [`Fuzz::sample`] per solid angle around `direction`: the part of the ball that is seen
    /// in that direction from where the mirrored direction starts. Along the chord from t₀ to t₁ it is
    /// ∫ t² dt / (4/3 π fuzz³) = (t₁³ - t₀³) / (4 π fuzz³).
    pub fn density(self, mirrored: DVec3, direction: DVec3) -> f64 {
        let along = mirrored.dot(direction);
        let across = (mirrored - direction * along).length();
        let square = (self.0 - across) * (self.0 + across);
        if square <= 0.0 {
            return 0.0;
        }
        let half = square.sqrt();
        let cube = self.0 * self.0 * self.0;
        let (near, far) = ((along - half).max(0.0), (along + half).max(0.0));
        if near > 0.0 {
            // The difference of cubes without its cancellation.
            half * (3.0 * along * along + square) / (2.0 * PI * cube)
        } else {
            far * far * far / (4.0 * PI * cube)
        }
    }
}
