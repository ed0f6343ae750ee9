//! The local frame of shapes around an axis, which is its y axis.

use super::{LaneSurface, flat};
use crate::base::digest::Content;
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{
    Angle, DAffine3, DMat3, DVec2, DVec3, LaneRay, UNIT_ROUNDOFF, atan2, gamma, is_identity, perpendicular,
};
use std::f64::consts::TAU;

/// A point and three perpendicular unit vectors; y is the axis of the shape. The frame of a mirrored shape is
/// left-handed.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct ShapeFrame {
    pub origin: DVec3,
    pub axes: DMat3,
}

/// The support of a circle of radius 1 around a unit axis, with its centre at the origin.
pub fn circle_support(axis: DVec3, direction: DVec3) -> f64 {
    direction.cross(axis).length()
}

impl ShapeFrame {
    /// The frame at `origin` whose y axis is the unit vector `axis`. If `axis` is +y, the axes are those of the world.
    pub fn along(origin: DVec3, axis: DVec3) -> Self {
        let (right, up) = flat::axes(axis);
        Self { origin, axes: DMat3::from_cols(unit(right), unit(axis), unit(-up)) }
    }

    /// Rays in the frame. t stays the same.
    #[inline(always)]
    pub fn local<F: Real>(&self, ray: &LaneRay<F>) -> LaneRay<F> {
        LaneRay { origin: self.local_point(ray.origin), direction: self.along_axes(ray.direction) }
    }

    #[inline(always)]
    pub fn local_point<F: Real>(&self, point: Vec3<F>) -> Vec3<F> {
        self.along_axes(point - Vec3::splat(self.origin))
    }

    #[inline(always)]
    fn along_axes<F: Real>(&self, v: Vec3<F>) -> Vec3<F> {
        let DMat3 { x_axis, y_axis, z_axis } = self.axes;
        Vec3::new(Vec3::splat(x_axis).dot(v), Vec3::splat(y_axis).dot(v), Vec3::splat(z_axis).dot(v))
    }

    /// A vector of the frame in world space, in glam's order of operations.
    #[inline(always)]
    fn in_space<F: Real>(&self, v: Vec3<F>) -> Vec3<F> {
        let DMat3 { x_axis, y_axis, z_axis } = self.axes;
        Vec3::splat(x_axis) * v.x + Vec3::splat(y_axis) * v.y + Vec3::splat(z_axis) * v.z
    }

    /// The surface at a point of the frame, with a unit normal. `error` is the shape's own error.
    ///
    /// The map out of the frame and back, as the next ray is moved into it, adds an error along the normal. A product
    /// with the axes each way costs gamma(3); the absolute values of an orthogonal matrix lengthen a vector by at most
    /// 5/3. The difference from the origin costs 1 u, and the axes are perpendicular unit vectors to within 6 u.
    /// Adding the origin rounds each coordinate.
    #[inline(always)]
    pub fn surface<F: Real>(&self, point: Vec3<F>, normal: Vec3<F>, error: f64) -> LaneSurface<F> {
        let placed = Vec3::splat(self.origin) + self.in_space(point);
        let normal = self.in_space(normal);
        let error = F::splat(error) + point.length() * F::splat(ROUNDING);
        LaneSurface::new(placed, normal.abs() * error + placed.abs() * F::splat(gamma(1)), normal)
    }

    /// A point of the frame, and a normal there, in space.
    pub fn placed(&self, point: DVec3, normal: DVec3) -> (DVec3, DVec3) {
        (self.origin + self.axes * point, self.axes * normal)
    }

    /// The distance that points keep from the seam between two smooth parts. A ray that starts at such a point of
    /// [`ShapeFrame::surface`], on either side, is then on the right side of both parts. It covers the point's error,
    /// the ray's offset (at most that error and a rounding of each coordinate), and the error of the next test.
    /// `reach` is the shape's extent and `error` that of [`ShapeFrame::surface`].
    pub fn clearance(&self, reach: f64, error: f64) -> f64 {
        4.0 * (error + reach * ROUNDING) + gamma(8) * (self.origin.length() + reach)
    }

    /// The frame moved by `affine`, which must scale uniformly.
    pub fn moved(&self, affine: &DAffine3) -> Self {
        let m = affine.matrix3 * self.axes;
        let y = unit(m.y_axis);
        let x = unit(perpendicular(m.x_axis, y));
        let z = if m.determinant() < 0.0 { y.cross(x) } else { x.cross(y) };
        Self { origin: affine.transform_point3(self.origin), axes: DMat3::from_cols(x, y, unit(z)) }
    }

    /// The extent of circles of radius 1 around the axis, along each world axis: sqrt(1 - a²). It is computed from the
    /// other two axes of the frame, which does not cancel.
    pub fn circle_reach(&self) -> DVec3 {
        let (x, z) = (self.axes.x_axis, self.axes.z_axis);
        (x * x + z * z).map(f64::sqrt)
    }
}

/// The vector divided by its length: one rounding less than glam's product with the inverse length.
fn unit(v: DVec3) -> DVec3 {
    v / v.length()
}

/// Relative rounding of the map out of the frame and back.
const ROUNDING: f64 = gamma(18);

/// The fraction of a turn around the y axis, eastwards, below 1: 0.25 at +z, 0.5 at +x, and the seam at -x.
#[inline(always)]
pub fn around<F: Real>(point: Vec3<F>) -> F {
    let share = F::splat(0.5) - atan2(point.z, point.x) / F::splat(TAU);
    F::select(share.lt(F::splat(1.0)), share, F::splat(0.0))
}

/// The unit vector (x, z) at a fraction of a turn: the inverse of [`around`].
pub fn at_turn(share: f64) -> DVec2 {
    Angle(180.0 - 360.0 * share).cos_sin()
}

/// The distance from the y axis.
#[inline(always)]
pub fn from_axis<F: Real>(v: Vec3<F>) -> F {
    (v.x * v.x + v.z * v.z).sqrt()
}

/// The unit vector (x, z) away from the y axis. On the axis it is +x.
#[inline(always)]
pub fn away_from_axis<F: Real>(v: Vec3<F>) -> [F; 2] {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let per_length = one / from_axis(v);
    let sound = zero.lt(per_length) & per_length.lt(F::splat(f64::INFINITY));
    [F::select(sound, v.x * per_length, one), F::select(sound, v.z * per_length, zero)]
}

/// The uniform scale factor of `affine`; none if the scale is not uniform.
pub fn even_scale(affine: &DAffine3) -> Option<f64> {
    let m = affine.matrix3;
    if is_identity(&m) {
        return Some(1.0);
    }
    let gram = m.transpose() * m;
    let square = gram.x_axis.x;
    // A difference above the rounding of the product: not uniform.
    let off = (gram - DMat3::from_diagonal(DVec3::splat(square))).abs();
    let largest = off.x_axis.max(off.y_axis).max(off.z_axis).max_element();
    (largest <= square * 64.0 * UNIT_ROUNDOFF).then(|| square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// How far the axes are from perpendicular unit vectors.
    fn defect(frame: &ShapeFrame) -> f64 {
        let off = (frame.axes.transpose() * frame.axes - DMat3::IDENTITY).abs();
        off.x_axis.max(off.y_axis).max(off.z_axis).max_element()
    }

    #[test]
    fn upright_frames_are_those_of_space() {
        assert_eq!(ShapeFrame::along(DVec3::ONE, DVec3::Y).axes, DMat3::IDENTITY);
    }

    #[test]
    fn axes_are_perpendicular_unit_vectors() {
        let mut random = Random(1);
        let mut worst = 0.0f64;
        for _ in 0..20_000 {
            let frame = ShapeFrame::along(DVec3::ZERO, random.direction());
            let turn = DAffine3::from_axis_angle(random.direction(), 7.0 * random.unit());
            let even = turn * DAffine3::from_scale(DVec3::new(-3.3, 3.3, 3.3));
            for frame in [frame, frame.moved(&turn), frame.moved(&even)] {
                worst = worst.max(defect(&frame));
            }
            assert!(frame.axes.determinant() > 0.0 && frame.moved(&even).axes.determinant() < 0.0);
        }
        assert!(worst <= 6.0 * UNIT_ROUNDOFF, "{} u", worst / UNIT_ROUNDOFF);
    }
}
