//! Inverses of affine maps.

use super::{DAffine3, DMat3, DVec3, dot_plus};

/// The inverse of an affine map, refined once. None if the map is singular or not finite.
#[inline]
pub fn inverse(affine: &DAffine3) -> Option<DAffine3> {
    if is_identity(&affine.matrix3) {
        // A constant matrix, which goes through no memory.
        let translation = -(DMat3::IDENTITY * affine.translation);
        return translation.is_finite().then_some(DAffine3 { matrix3: DMat3::IDENTITY, translation });
    }
    let matrix3 = inverse_matrix(affine.matrix3)?;
    let inverse = DAffine3 { matrix3, translation: -(matrix3 * affine.translation) };
    inverse.is_finite().then_some(inverse)
}

/// Whether a matrix is the identity, bit for bit, as those of most objects are: they are only moved. A negative zero is
/// left to general formulas, which may keep it.
#[inline]
pub fn is_identity(m: &DMat3) -> bool {
    // Without branches.
    let pairs = m.to_cols_array().into_iter().zip(DMat3::IDENTITY.to_cols_array());
    pairs.fold(0, |differs, (own, identity)| differs | own.to_bits() ^ identity.to_bits()) == 0
}

/// The inverse of a matrix, refined once. None if it is singular or not finite.
fn inverse_matrix(m: DMat3) -> Option<DMat3> {
    let determinant = m.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let first = m.inverse();
    // Cancellation leaves an error in the cofactors of a badly scaled matrix. A Newton step squares this error, if the
    // difference from the identity is computed exactly enough.
    let rows = m.transpose();
    let left = |column: DVec3, unit: DVec3| {
        let minus = |row: DVec3, one: f64| dot_plus(-row, column, one);
        let DVec3 { x, y, z } = unit;
        DVec3::new(minus(rows.x_axis, x), minus(rows.y_axis, y), minus(rows.z_axis, z))
    };
    let left = DMat3::from_cols(
        left(first.x_axis, DVec3::X),
        left(first.y_axis, DVec3::Y),
        left(first.z_axis, DVec3::Z),
    );
    Some(first + first * left)
}

/// Whether a map is flat: it has no inverse, however it came about. A scale of 0 along an axis gives exactly 0 here, but
/// in products with further maps, rounding may leave something else.
#[inline]
pub fn is_flat(affine: &DAffine3) -> bool {
    affine.matrix3.determinant() == 0.0
}

/// An affine map of absolute values.
pub fn absolute(affine: &DAffine3) -> DAffine3 {
    DAffine3 { matrix3: affine.matrix3.abs(), translation: affine.translation.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::{Angle, axis_angle};
    use crate::testing::Random;

    #[test]
    fn xf_04_badly_scaled_transforms_invert() {
        let turn = axis_angle(DVec3::new(0.6, 0.48, 0.64), Angle(40.0));
        let m = DMat3::from_diagonal(DVec3::new(1e3, 1e-3, 1.0)) * turn;
        let back = inverse(&DAffine3::from_mat3(m)).expect("an inverse");
        let off = (m * back.matrix3 - DMat3::IDENTITY).abs();
        assert!(off.x_axis.max(off.y_axis).max(off.z_axis).max_element() <= 1e-9);
        assert_eq!(inverse(&DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))), None);
        assert_eq!(inverse(&DAffine3::from_scale(DVec3::new(1.0, f64::NAN, 1.0))), None);
    }

    /// Turned scales of 0 are flat to the last bit. Most products with a further map are not, so these must not be asked.
    #[test]
    fn scales_of_zero_are_flat() {
        let mut random = Random(6);
        let mut turned = |scale: DVec3| {
            let turn = axis_angle(random.point(1.0).normalize(), Angle(360.0 * random.unit()));
            DAffine3::from_mat3(turn * DMat3::from_diagonal(scale))
        };
        let mut slivers = 0;
        for axis in DMat3::IDENTITY.to_cols_array_2d().map(DVec3::from_array).into_iter().cycle().take(300) {
            let [flat, thin, inner] =
                [1.0, 1.0 - 1e-9, 0.5].map(|less| turned(DVec3::splat(1.5) * (1.0 - less * axis)));
            assert!(is_flat(&flat) && !is_flat(&thin) && !is_flat(&inner));
            slivers += u32::from(!is_flat(&(flat * inner)));
        }
        assert!(slivers > 100, "{slivers}");
    }
}
