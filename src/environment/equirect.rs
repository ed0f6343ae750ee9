//! Directions on a rectangle: longitude across, latitude up.

use crate::math::{Angle, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Where a direction is, both from 0 to 1: -z is in the middle, +x a quarter to the right of it, +y at the top.
/// Arc tangents keep their digits near the poles, where arc sines lose half of them.
pub fn uv(direction: DVec3) -> DVec2 {
    let level = libm::hypot(direction.x, direction.z);
    DVec2::new(longitude(direction), 0.5 + libm::atan2(direction.y, level) / PI)
}

/// The u of [`uv`].
pub fn longitude(direction: DVec3) -> f64 {
    0.5 + libm::atan2(direction.x, -direction.z) / TAU
}

/// The inverse of [`uv`].
pub fn direction(uv: DVec2) -> DVec3 {
    let latitude = Angle(180.0 * (uv.y - 0.5)).cos_sin();
    around(uv.x, latitude.y, latitude.x)
}

/// The direction at a longitude with `height` along +y, at the distance `level` from that axis.
pub fn around(longitude: f64, height: f64, level: f64) -> DVec3 {
    let turn = Angle(360.0 * (longitude - 0.5)).cos_sin();
    DVec3::new(level * turn.y, height, -level * turn.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn there_and_back() {
        let mut random = Random(11);
        for _ in 0..10_000 {
            let d = random.direction();
            assert!((direction(uv(d)) - d).length() < 1e-14);
        }
        assert_eq!(uv(DVec3::NEG_Z), DVec2::splat(0.5));
        assert_eq!(uv(DVec3::X), DVec2::new(0.75, 0.5));
        assert_eq!(uv(DVec3::Y).y, 1.0);
    }
}
