//! Rotations as unit quaternions: from files' angles, and between keys.

use super::{Angle, DQuat, DVec3};

/// The rotation by `angle` about the unit vector `axis`. Half and whole turns are exact, and angles one
/// double turn apart give the same bits.
pub fn axis_angle(axis: DVec3, angle: Angle) -> DQuat {
    // A quaternion turns at half speed, so the half angle is reduced to one turn of its own.
    let half = Angle(angle.0 * 0.5).cos_sin();
    let v = axis * half.y;
    DQuat::from_xyzw(v.x, v.y, v.z, half.x)
}

/// Rotations about the fixed axes x, then y, then z.
pub fn euler_xyz(x: Angle, y: Angle, z: Angle) -> DQuat {
    axis_angle(DVec3::Z, z) * axis_angle(DVec3::Y, y) * axis_angle(DVec3::X, x)
}

/// Spherical interpolation along the shorter arc; `s` = 0 gives `a`, 1 gives ±`b`.
///
/// The angle comes from atan2 of the chord lengths |b - a| and |b + a| (Kahan), which keeps full relative
/// accuracy for nearly equal rotations, where the arc cosine of the dot product has none.
pub fn slerp(a: DQuat, b: DQuat, s: f64) -> DQuat {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    let half_angle = libm::atan2((b - a).length(), (b + a).length());
    let angle = 2.0 * half_angle;
    let sine = libm::sin(angle);
    if sine == 0.0 {
        return a;
    }
    let (wa, wb) = (libm::sin((1.0 - s) * angle) / sine, libm::sin(s * angle) / sine);
    (a * wa + b * wb).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::UNIT_ROUNDOFF;

    fn angle_between(a: DQuat, b: DQuat) -> f64 {
        let b = if a.dot(b) < 0.0 { -b } else { b };
        4.0 * libm::atan2((b - a).length(), (b + a).length())
    }

    #[test]
    fn near_identical_rotations_interpolate_evenly() {
        let start = axis_angle(DVec3::new(0.1, 0.9, 0.2).normalize(), Angle::from_radians(0.7));
        let axis = DVec3::new(0.3, 0.5, 0.8).normalize();
        for angle in [0.0, 1e-8, 1e-5, 1e-4, 5e-4, 1e-3, 0.01, 3.0] {
            let end = axis_angle(axis, Angle::from_radians(angle)) * start;
            for step in 0..=100 {
                let s = f64::from(step) * 0.01;
                let q = slerp(start, end, s);
                assert!((q.length() - 1.0).abs() <= 8.0 * UNIT_ROUNDOFF);
                let turned = angle_between(start, q);
                assert!((turned - s * angle).abs() <= 1e-12 + 1e-9 * angle, "{angle} {s}: {turned}");
            }
        }
    }

    #[test]
    fn half_a_turn_goes_the_way_of_its_axis() {
        let quarter = slerp(axis_angle(DVec3::Y, Angle(0.0)), axis_angle(DVec3::Y, Angle(180.0)), 0.5);
        assert!((quarter * DVec3::X - DVec3::NEG_Z).length() <= 1e-12);
        assert_eq!(axis_angle(DVec3::Y, Angle(180.0)), DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0));
    }

    #[test]
    fn the_short_way_from_350_to_10_passes_0() {
        let middle = slerp(axis_angle(DVec3::Y, Angle(350.0)), axis_angle(DVec3::Y, Angle(10.0)), 0.5);
        assert!((middle * DVec3::X - DVec3::X).length() <= 1e-12);
    }

    #[test]
    fn euler_angles_turn_about_x_first() {
        let q = euler_xyz(Angle(90.0), Angle(0.0), Angle(90.0));
        // y → z about x, and z stays z about z.
        assert!((q * DVec3::Y - DVec3::Z).length() <= 1e-15);
    }
}
