//! What all flat shapes share: the plane they lie in.

use super::{Probe, Surface};
use crate::camera::Ray;
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

/// The surface where a ray crosses the plane through `anchor` across the unit vector `normal`.
///
/// The ray's point is projected onto the plane along the normal. What remains is the rounding of the
/// projection's height, a dot product over `anchor - point` (at most gamma(4) of its terms; twice, as
/// [`crossing`] rounds it again with a normal of another length), that of the normal's own length, which
/// leaves a part of the height that was projected away, and that of the point's coordinates.
pub fn surface(anchor: DVec3, normal: DVec3, ray: &Ray, t: f64) -> Surface {
    let near = ray.at(t);
    let height = normal.dot(anchor - near);
    let point = near + normal * height;
    let error = (anchor - point).abs() * gamma(11)
        + point.abs() * gamma(3)
        + normal.abs() * (height.abs() * gamma(8));
    Surface { point, error, normal }
}

/// The unit normal of a surface moved by `affine`: the inverse transpose, by cofactors, so that no inverse
/// is needed and nothing overflows near a singular one.
pub fn moved_normal(affine: &DAffine3, normal: DVec3) -> DVec3 {
    let m = affine.matrix3;
    let cofactors = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
    (cofactors[0] * normal.x + cofactors[1] * normal.y + cofactors[2] * normal.z).normalize_or(normal)
}
