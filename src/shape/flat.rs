//! What all flat shapes share: the plane they lie in.

use super::Surface;
use crate::camera::Ray;
use crate::math::{DAffine3, DVec2, DVec3, gamma};
use crate::tree::Probe;

/// Where the ray crosses the plane through `anchor` across `normal` (any length): the t in `after` < t < `t_max`.
/// A ray within the plane does not cross it.
#[inline]
pub fn crossing(anchor: DVec3, normal: DVec3, probe: &Probe, after: f64, t_max: f64) -> Option<f64> {
    let along = normal.dot(probe.ray.direction);
    let height = normal.dot(anchor - probe.ray.origin);
    let t = height / along;
    (along != 0.0 && t > after && t < t_max).then_some(t)
}

/// The surface where a ray crosses the plane through `anchor` across the unit vector `normal`.
///
/// The ray's point is projected onto the plane along the normal. What remains is the rounding of the
/// projection's height, a dot product over `anchor - point` (at most gamma(4) of its terms; twice, as
/// [`crossing`] rounds it again with a normal of another length), that of the normal's own length, which
/// leaves a part of the height that was projected away, and that of the point's coordinates.
pub fn surface(anchor: DVec3, normal: DVec3, ray: &Ray, t: f64) -> Surface {
    placed(anchor, ray.at(t), normal)
}

/// The point of the plane through `anchor` across the unit vector `normal` that is next to `near`.
pub fn placed(anchor: DVec3, near: DVec3, normal: DVec3) -> Surface {
    let height = normal.dot(anchor - near);
    let point = near + normal * height;
    let error = (anchor - point).abs() * gamma(11)
        + point.abs() * gamma(3)
        + normal.abs() * (height.abs() * gamma(8));
    Surface::new(point, error, normal)
}

/// Two axes of the plane across the unit vector `normal`, to the right and upwards for who looks at the
/// plane against its normal with +y up; on planes across the y axis, with -z (from above) or +z up.
pub fn axes(normal: DVec3) -> (DVec3, DVec3) {
    let away = if normal.y.abs() > 0.9 { DVec3::new(0.0, 0.0, -normal.y.signum()) } else { DVec3::Y };
    let right = away.cross(normal).normalize_or(DVec3::X);
    (right, normal.cross(right))
}

/// The a and b of `offset` = a·`u` + b·`v`, for an offset in their plane.
pub fn shares(offset: DVec3, u: DVec3, v: DVec3) -> DVec2 {
    let n = u.cross(v);
    DVec2::new(offset.cross(v).dot(n), u.cross(offset).dot(n)) / n.length_squared()
}

/// Whether two edges enclose an area: not if one vanishes or they are parallel to within rounding.
pub fn spans_a_plane(u: DVec3, v: DVec3) -> bool {
    let (Some(u), Some(v)) = (u.try_normalize(), v.try_normalize()) else { return false };
    u.cross(v).length() > 4.0 * f64::EPSILON
}

/// The unit normal of a surface moved by `affine`: the inverse transpose, by cofactors, so that no inverse
/// is needed and nothing overflows near a singular one. It stays on its side of what is mirrored.
pub fn moved_normal(affine: &DAffine3, normal: DVec3) -> DVec3 {
    let m = affine.matrix3;
    let cofactors = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
    let side = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    let moved = cofactors[0] * normal.x + cofactors[1] * normal.y + cofactors[2] * normal.z;
    (moved * side).normalize_or(normal)
}
