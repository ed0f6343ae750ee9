//! The plane of flat shapes.

use super::{LaneHit, LaneSurface, RayInterval};
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{DAffine3, DVec3, LaneRay, gamma};

/// Where rays cross the plane through `anchor` perpendicular to `normal` (any length), within bounds. A ray within the
/// plane does not cross it.
#[inline(always)]
pub fn crossing<F: Real>(
    anchor: Vec3<F>,
    normal: Vec3<F>,
    ray: &LaneRay<F>,
    within: RayInterval<F>,
) -> LaneHit<F> {
    let along = normal.dot(ray.direction);
    let height = normal.dot(anchor - ray.origin);
    LaneHit::within(!along.eq(F::splat(0.0)), height / along, within)
}

/// Projects `near` onto the plane through `anchor` perpendicular to the unit vector `normal`.
///
/// The error bound has three terms. The first is the rounding of the projected height, a dot product over `anchor -
/// point`: at most gamma(4) of its terms, twice, as `crossing` rounds it again with a normal of another length. The
/// second is the rounding of the normal's own length, which leaves a fraction of the height. The third is the rounding
/// of the point's coordinates.
#[inline(always)]
pub fn placed<F: Real>(anchor: Vec3<F>, near: Vec3<F>, normal: Vec3<F>) -> LaneSurface<F> {
    let height = normal.dot(anchor - near);
    let point = near + normal * height;
    let error = (anchor - point).abs() * F::splat(gamma(11))
        + point.abs() * F::splat(gamma(3))
        + normal.abs() * (height.abs() * F::splat(gamma(8)));
    LaneSurface::new(point, error, normal)
}

/// Two axes of the plane perpendicular to the unit vector `normal`: right and up, for a viewer who faces the plane
/// with +y up. On planes across the y axis, up is -z (seen from above) or +z.
pub fn axes(normal: DVec3) -> (DVec3, DVec3) {
    let away = if normal.y.abs() > 0.9 { DVec3::new(0.0, 0.0, -normal.y.signum()) } else { DVec3::Y };
    let right = away.cross(normal).normalize_or(DVec3::X);
    (right, normal.cross(right))
}

/// Solves `offset` = a·`u` + b·`v` for a and b. The offset lies in the plane of `u` and `v`.
#[inline(always)]
pub fn shares<F: Real>(offset: Vec3<F>, u: Vec3<F>, v: Vec3<F>) -> [F; 2] {
    let n = u.cross(v);
    let square = n.length_squared();
    [offset.cross(v).dot(n) / square, u.cross(offset).dot(n) / square]
}

/// Whether two edges enclose an area. They do not if one is zero or if they are parallel to within rounding.
pub fn spans_a_plane(u: DVec3, v: DVec3) -> bool {
    let (Some(u), Some(v)) = (u.try_normalize(), v.try_normalize()) else { return false };
    u.cross(v).length() > 4.0 * f64::EPSILON
}

/// The unit normal of a surface moved by `affine`: the inverse transpose, computed from cofactors. So no inverse is
/// needed, and nothing overflows near a singular map. A mirrored surface keeps its outer side.
pub fn moved_normal(affine: &DAffine3, normal: DVec3) -> DVec3 {
    let m = affine.matrix3;
    let cofactors = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
    let side = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    let moved = cofactors[0] * normal.x + cofactors[1] * normal.y + cofactors[2] * normal.z;
    (moved * side).normalize_or(normal)
}
