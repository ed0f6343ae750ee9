//! Orthonormal frames around a direction.

use crate::math::DVec3;

/// A right-handed orthonormal frame whose z axis is a given direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub x: DVec3,
    pub y: DVec3,
    pub z: DVec3,
}

impl Frame {
    /// The frame around the unit vector `z` (Duff et al., *Building an Orthonormal Basis, Revisited*, 2017):
    /// one sign, no branch and no cancellation, also at z = -1. Rounding leaves a part of both axes along z, up to 6 u,
    /// which is taken away; then no two axes are off a right angle by more than 4 u.
    pub fn around(z: DVec3) -> Self {
        let sign = 1.0_f64.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        let x = DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x);
        let y = DVec3::new(b, sign + z.y * z.y * a, -z.y);
        Self { x: x - z * x.dot(z), y: y - z * y.dot(z), z }
    }

    /// A vector given along the frame's axes.
    pub fn to_world(&self, v: DVec3) -> DVec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// A vector's parts along the frame's axes.
    pub fn to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::UNIT_ROUNDOFF;
    use crate::testing::Random;

    fn assert_orthonormal(z: DVec3) {
        let Frame { x, y, z } = Frame::around(z);
        for v in [x, y, z] {
            assert!((v.length() - 1.0).abs() <= 4.0 * UNIT_ROUNDOFF, "{z}: length {}", v.length());
        }
        for (v, w) in [(x, y), (y, z), (z, x)] {
            assert!(v.dot(w).abs() <= 4.0 * UNIT_ROUNDOFF, "{z}: {}", v.dot(w));
        }
        assert!((x.cross(y) - z).length() <= 8.0 * UNIT_ROUNDOFF, "right-handed around {z}");
    }

    /// The basis of Frisvad (2012) cancels next to -z: in f32 it is off by 0.6.
    #[test]
    fn sa_06_orthonormal_everywhere() {
        assert_orthonormal(DVec3::NEG_Z);
        assert_orthonormal(DVec3::Z);
        for k in 0..=350 {
            let e = libm::pow(10.0, -4.5 + 0.01 * f64::from(k));
            for phi in [0.0, 1.0, 2.5, 4.0] {
                let s = libm::sin(e);
                let z = DVec3::new(s * libm::cos(phi), s * libm::sin(phi), -libm::cos(e));
                assert_orthonormal(z.normalize());
            }
        }
        let mut random = Random(3);
        for _ in 0..1_000_000 {
            assert_orthonormal(random.point(1.0).normalize());
        }
    }
}
