//! Rotations: matrices from angles, quaternions between keys.

use super::{Angle, DMat3, DQuat, DVec3};

/// The rotation by `angle` about the unit vector `axis` (Rodrigues). Quarter turns about the coordinate axes
/// are exact, and angles that differ by whole turns give the same bits.
pub fn axis_angle(axis: DVec3, angle: Angle) -> DMat3 {
    let turn = angle.cos_sin();
    let column = |e: DVec3| e * turn.x + axis.cross(e) * turn.y + axis * (axis.dot(e) * (1.0 - turn.x));
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}

/// Rotations about the fixed axes x, then y, then z.
pub fn euler_xyz(x: Angle, y: Angle, z: Angle) -> DMat3 {
    axis_angle(DVec3::Z, z) * axis_angle(DVec3::Y, y) * axis_angle(DVec3::X, x)
}

/// Spherical interpolation along the shorter arc; `s` = 0 gives `a`, 1 gives ±`b`.
///
/// The angle is atan2 of the chord lengths |b - a| and |b + a| (Kahan). This keeps full relative accuracy for nearly
/// equal rotations, unlike the arc cosine of the dot product.
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
    use crate::base::math::UNIT_ROUNDOFF;

    fn angle_between(a: DQuat, b: DQuat) -> f64 {
        let b = if a.dot(b) < 0.0 { -b } else { b };
        4.0 * libm::atan2((b - a).length(), (b + a).length())
    }

    #[test]
    fn ca_04_near_identical_rotations_interpolate_evenly() {
        let start = DQuat::from_axis_angle(DVec3::new(0.1, 0.9, 0.2).normalize(), 0.7);
        let axis = DVec3::new(0.3, 0.5, 0.8).normalize();
        for angle in [0.0, 1e-8, 1e-5, 1e-4, 5e-4, 1e-3, 0.01, 3.0] {
            let end = DQuat::from_axis_angle(axis, angle) * start;
            for step in 0..=100 {
                let s = f64::from(step) * 0.01;
                let q = slerp(start, end, s);
                assert!((q.length() - 1.0).abs() <= 8.0 * UNIT_ROUNDOFF);
                let turned = angle_between(start, q);
                assert!((turned - s * angle).abs() <= 1e-12 + 1e-9 * angle, "{angle} {s}: {turned}");
            }
        }
    }

    fn about_y(degrees: f64) -> DQuat {
        DQuat::from_rotation_y(Angle(degrees).radians())
    }

    #[test]
    fn ca_05_half_a_turn_goes_the_way_of_its_axis() {
        let quarter = slerp(about_y(0.0), about_y(180.0), 0.5);
        assert!((quarter * DVec3::X - DVec3::NEG_Z).length() <= 1e-12);
        assert_eq!(axis_angle(DVec3::Y, Angle(180.0)) * DVec3::X, DVec3::NEG_X);
        assert_eq!(axis_angle(DVec3::Y, Angle(90.0)) * DVec3::X, DVec3::NEG_Z);
        assert_eq!(axis_angle(DVec3::Y, Angle(765.0)), axis_angle(DVec3::Y, Angle(45.0)));
    }

    #[test]
    fn ca_05_the_short_way_from_350_to_10_passes_0() {
        let middle = slerp(about_y(350.0), about_y(10.0), 0.5);
        assert!((middle * DVec3::X - DVec3::X).length() <= 1e-12);
    }

    #[test]
    fn euler_angles_turn_about_x_first() {
        // y goes to z about x, and z stays z about z.
        assert_eq!(euler_xyz(Angle(90.0), Angle(0.0), Angle(90.0)) * DVec3::Y, DVec3::Z);
    }
}
