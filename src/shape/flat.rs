//! What all flat shapes share: the plane they lie in.

use super::{Probe, Surface};
use crate::math::{DAffine3, DVec3, gamma};

/// Where the ray crosses the plane through `anchor` across `normal` (any length): the t in 0 < t < `t_max`.
/// A ray within the plane does not cross it.
#[inline]
pub fn crossing(anchor: DVec3, normal: DVec3, probe: &Probe, t_max: f64) -> Option<f64> {
    let along = normal.dot(probe.ray.direction);
    let height = normal.dot(anchor - probe.ray.origin);
    let t = height / along;
    (along != 0.0 && t > 0.0 && t < t_max).then_some(t)
}

/// The surface at `near` on the plane through `anchor` across the unit vector `normal`.
///
/// `near` is projected onto the plane along the normal. What remains is the rounding of the projection's
/// height, a dot product over `anchor - near` (at most gamma(4) of its terms; twice, as [`crossing`] rounds
/// it again with a normal of another length), and that of the point's own coordinates.
pub fn surface(anchor: DVec3, normal: DVec3, near: DVec3) -> Surface {
    let point = near + normal * normal.dot(anchor - near);
    let error = (anchor - point).abs() * gamma(11) + point.abs() * gamma(3);
    Surface { point, error, normal }
}

/// The unit normal of a surface moved by `affine`: the inverse transpose, by cofactors, so that no inverse
/// is needed and nothing overflows near a singular one.
pub fn moved_normal(affine: &DAffine3, normal: DVec3) -> DVec3 {
    let m = affine.matrix3;
    let cofactors = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
    (cofactors[0] * normal.x + cofactors[1] * normal.y + cofactors[2] * normal.z).normalize_or(normal)
}
