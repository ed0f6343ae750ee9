//! Equirectangular mapping: longitude across, latitude up.

use crate::base::lanes::{Real, Vec3};
use crate::base::math::{Angle, DVec2, DVec3, atan2, cos_sin_of_turns};
use std::f64::consts::FRAC_1_PI;

/// Maps directions to u and v, both from 0 to 1: -z is in the middle, +x a quarter to its right, +y at the top. Arc
/// tangents keep their digits near the poles, where arc sines lose half of them.
#[inline(always)]
pub fn uv<F: Real>(direction: Vec3<F>) -> [F; 2] {
    let Vec3 { x, y, z } = direction;
    // If the squares underflow, the direction points to a pole, where the longitude has no effect.
    let level = (x * x + z * z).sqrt();
    [longitude(direction), F::splat(0.5) + atan2(y, level) * F::splat(FRAC_1_PI)]
}

/// The u of [`uv`].
#[inline(always)]
pub fn longitude<F: Real>(direction: Vec3<F>) -> F {
    F::splat(0.5) + atan2(direction.x, -direction.z) * F::splat(0.5 * FRAC_1_PI)
}

/// The inverse of [`uv`].
pub fn direction(uv: DVec2) -> DVec3 {
    let latitude = Angle(180.0 * (uv.y - 0.5)).cos_sin();
    around::<f64>(uv.x, latitude.y, latitude.x).into()
}

/// Directions at longitudes in 0..=1, with these heights along +y and these distances from that axis.
#[inline(always)]
pub fn around<F: Real>(longitude: F, height: F, level: F) -> Vec3<F> {
    // The half turn keeps every angle at or above 0.
    let (cosine, sine) = cos_sin_of_turns(longitude);
    Vec3::new(-(level * sine), height, level * cosine)
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
            assert!((direction(uv(d.into()).into()) - d).length() < 1e-14);
        }
        assert_eq!(uv::<f64>(DVec3::NEG_Z.into()), [0.5; 2]);
        assert_eq!(uv::<f64>(DVec3::X.into()), [0.75, 0.5]);
        assert_eq!(uv::<f64>(DVec3::Y.into())[1], 1.0);
    }
}
