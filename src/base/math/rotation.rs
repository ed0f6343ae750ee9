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

/// A quaternion (x, y, z, w) of any length above 0 as one of length 1; none if it is zero. Scaled first, so that its
/// length neither underflows nor overflows.
pub fn unit_quaternion(parts: [f64; 4]) -> Option<DQuat> {
    let largest = parts.iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    (largest > 0.0).then(|| DQuat::from_array(parts.map(|part| part / largest)).normalize())
}

/// The rotation that turns z to the z axis of a matrix, and y to the side on which its y axis is (Gram-Schmidt). The
/// identity if these have no direction.
pub fn orthonormal(matrix: DMat3) -> DMat3 {
    let Some(z) = matrix.z_axis.try_normalize() else { return DMat3::IDENTITY };
    let beside = matrix.y_axis.try_normalize().and_then(|y| (y - z * z.dot(y)).try_normalize());
    let Some(y) = beside else { return DMat3::IDENTITY };
    DMat3::from_cols(y.cross(z), y, z)
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

/// Why a matrix is no rotation and scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotRigid {
    /// A column has no length, or none that a number can hold.
    Flat,
    /// Two columns meet at this angle in degrees.
    Sheared(f64),
}

/// The largest error of a number that is rounded to four decimal places.
pub const ROUNDED: f64 = 0.5e-4;

/// Lengths that differ from 1 by at most this count as 1. The errors of a column's three elements change its length by
/// at most √3 [`ROUNDED`].
const UNIT_LENGTH: f64 = 2.0 * ROUNDED;

/// Cosines up to this count as 0. With errors e and f of at most √3 [`ROUNDED`] each, perpendicular unit vectors x and y
/// have the product (x + e)·(y + f) = x·f + e·y + e·f, which is at most 2 √3 [`ROUNDED`] + 3 [`ROUNDED`]² = 1.73213e-4.
/// Divided by the lengths, which are at least 1 - √3 [`ROUNDED`] each, it is at most 1.73243e-4.
const PERPENDICULAR: f64 = 1.74e-4;

/// The rotation and the scale along the axes of an object, R · diag(s), that make up a matrix. The scale of matrices
/// that mirror is negative along all axes. Of rounded matrices, the rotation is the nearest one.
///
/// # Errors
/// If the matrix shears, or flattens space.
pub fn rotation_and_scale(matrix: DMat3) -> Result<(DQuat, DVec3), NotRigid> {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let lengths = columns.map(DVec3::length);
    if !lengths.iter().all(|length| (1e-30..=1e30).contains(length)) {
        return Err(NotRigid::Flat);
    }
    let [x, y, z] = [0, 1, 2].map(|axis: usize| columns[axis] / lengths[axis]);
    let cosines = [x.dot(y), y.dot(z), z.dot(x)];
    if let Some(cosine) = cosines.into_iter().find(|cosine| cosine.abs() > PERPENDICULAR) {
        return Err(NotRigid::Sheared(libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees()));
    }
    let unit = lengths.iter().all(|length| (length - 1.0).abs() <= UNIT_LENGTH);
    let scale = if unit { DVec3::ONE } else { DVec3::from_array(lengths) };
    let units = DMat3::from_cols(x, y, z);
    let sign = if units.determinant() < 0.0 { -1.0 } else { 1.0 };
    Ok((DQuat::from_mat3(&nearest_rotation(units * sign)).normalize(), scale * sign))
}

/// The rotation nearest to a matrix that nearly is one: the polar factor, by Newton's iteration, whose error is squared
/// in every step (Higham 1986).
fn nearest_rotation(mut matrix: DMat3) -> DMat3 {
    // From 2e-4 to less than 1e-29.
    for _ in 0..3 {
        matrix = (matrix + matrix.inverse().transpose()) * 0.5;
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::UNIT_ROUNDOFF;
    use crate::testing::Random;

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

    #[test]
    fn quaternions_of_any_length_are_rotations() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        for length in [1e-300, 1e-20, 1.0, 3.0, 1e300] {
            let found = unit_quaternion([0.0, length, 0.0, length]).expect("a rotation");
            assert!((found - DQuat::from_xyzw(0.0, half, 0.0, half)).length() < 1e-15, "{length}");
        }
        assert_eq!(unit_quaternion([0.0; 4]), None);
    }

    #[test]
    fn orthonormal_matrices_are_rotations() {
        let turned = axis_angle(DVec3::Y, Angle(90.0));
        assert_eq!(orthonormal(turned), turned);
        let flat = DMat3::from_cols(DVec3::ZERO, DVec3::new(0.0, 3.0, 4.0), DVec3::new(0.0, 0.0, 2.0));
        assert_eq!(orthonormal(flat), DMat3::IDENTITY);
        for lost in [DMat3::ZERO, DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Z)] {
            assert_eq!(orthonormal(lost), DMat3::IDENTITY);
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

    #[test]
    fn matrices_are_rotations_and_scales() {
        let turn = DQuat::from_axis_angle(DVec3::new(0.3, -0.5, 0.8).normalize(), 2.0);
        let matrix = DMat3::from_quat(turn);
        let near = |found: DQuat| angle_between(found, turn);
        // Exact up to rounding, with and without mirroring.
        for scale in [DVec3::ONE, DVec3::new(2.0, 0.5, 3e5), DVec3::splat(-1.0), DVec3::new(-2.0, -2.0, -7.0)]
        {
            let (found, factors) = rotation_and_scale(matrix * DMat3::from_diagonal(scale)).expect("rigid");
            assert!(near(found) < 8.0 * UNIT_ROUNDOFF, "{found}");
            assert!((factors / scale - DVec3::ONE).abs().max_element() < 8.0 * UNIT_ROUNDOFF, "{factors}");
        }
        // Rounded to six places.
        let rounded = DMat3::from_cols_array(&matrix.to_cols_array().map(|v| (v * 1e6).round() / 1e6));
        let (found, scale) = rotation_and_scale(rounded).expect("rigid");
        assert_eq!(scale, DVec3::ONE);
        assert!(near(found) < 2e-6);
        assert!((found.length() - 1.0).abs() < 4.0 * UNIT_ROUNDOFF);
        let sheared = matrix * DMat3::from_cols(DVec3::X, DVec3::new(0.01, 1.0, 0.0), DVec3::Z);
        assert!(
            matches!(rotation_and_scale(sheared), Err(NotRigid::Sheared(angle)) if (angle - 89.427).abs() < 1e-3)
        );
        assert_eq!(rotation_and_scale(DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0))), Err(NotRigid::Flat));
    }

    /// Whatever the rotation is, its matrix is recognised after rounding to four places.
    #[test]
    fn rotations_rounded_to_four_places_are_rotations() {
        let mut random = Random(17);
        for _ in 0..100_000 {
            let axis = random.point(1.0);
            let turn = DQuat::from_xyzw(axis.x, axis.y, axis.z, 2.0 * random.unit() - 1.0).normalize();
            let rounded = DMat3::from_quat(turn).to_cols_array().map(|element| (element * 1e4).round() / 1e4);
            let (found, scale) = rotation_and_scale(DMat3::from_cols_array(&rounded)).expect("rigid");
            assert_eq!(scale, DVec3::ONE, "{turn}");
            // The nearest rotation is at most twice as far from the matrix as the exact one.
            assert!(angle_between(found, turn) <= 2.0 * 3.0 * ROUNDED, "{turn}");
        }
    }
}
