//! Shapes around an axis, in a space of their own where that is the y axis.

use super::{Surface, flat};
use crate::camera::Ray;
use crate::digest::content;
use crate::math::{DAffine3, DMat3, DVec2, DVec3, UNIT_ROUNDOFF, gamma, perpendicular};
use std::f64::consts::TAU;

/// A point and three perpendicular unit vectors: the axes of a shape, of which y is its own one. A mirrored
/// shape has a left-handed frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    pub origin: DVec3,
    pub axes: DMat3,
}

content!(struct Frame { origin, axes });

impl Frame {
    /// The frame at `origin` whose y axis is the unit vector `axis`; upright, its axes are those of space.
    pub fn along(origin: DVec3, axis: DVec3) -> Self {
        let (right, up) = flat::axes(axis);
        Self { origin, axes: DMat3::from_cols(unit(right), unit(axis), unit(-up)) }
    }

    /// A ray in the frame; t stays the same.
    #[inline]
    pub fn local(&self, ray: &Ray) -> Ray {
        Ray { origin: self.local_point(ray.origin), direction: self.along_axes(ray.direction) }
    }

    pub fn local_point(&self, point: DVec3) -> DVec3 {
        self.along_axes(point - self.origin)
    }

    #[inline]
    fn along_axes(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.axes.x_axis.dot(v), self.axes.y_axis.dot(v), self.axes.z_axis.dot(v))
    }

    /// The surface at a point of the frame, with a unit normal, where the shape is known to `error`.
    ///
    /// What is added to that along the normal is the way out of the frame and, as the next ray is moved into
    /// it, back: a product with the axes each way (gamma(3), and the absolute values of an orthogonal matrix
    /// lengthen a vector by 5/3 at most), the difference from the origin (1 u), and the axes, which are
    /// perpendicular unit vectors to within 6 u. The sum with the origin rounds each coordinate.
    pub fn surface(&self, point: DVec3, normal: DVec3, error: f64) -> Surface {
        let placed = self.origin + self.axes * point;
        let normal = self.axes * normal;
        let error = error + rounding(point.length());
        Surface::new(placed, normal.abs() * error + placed.abs() * gamma(1), normal)
    }

    /// How far from the seam between two smooth parts a point must stay, for a ray that [`Frame::surface`]
    /// is the start of, on either side, to be on the right side of both parts: the point's own error, then
    /// the ray's offset, which is at most that and a rounding of each coordinate, then the error of the test
    /// from there. `reach` is the shape's extent and `error` that of [`Frame::surface`].
    pub fn clearance(&self, reach: f64, error: f64) -> f64 {
        4.0 * (error + rounding(reach)) + gamma(8) * (self.origin.length() + reach)
    }

    /// The frame moved by `affine`, which scales evenly.
    pub fn moved(&self, affine: &DAffine3) -> Self {
        let m = affine.matrix3 * self.axes;
        let y = unit(m.y_axis);
        let x = unit(perpendicular(m.x_axis, y));
        let z = if m.determinant() < 0.0 { y.cross(x) } else { x.cross(y) };
        Self { origin: affine.transform_point3(self.origin), axes: DMat3::from_cols(x, y, unit(z)) }
    }

    /// How far circles of radius 1 around the axis reach along each axis of space: sqrt(1 - a²), from the
    /// frame's other two axes, which does not cancel.
    pub fn circle_reach(&self) -> DVec3 {
        let (x, z) = (self.axes.x_axis, self.axes.z_axis);
        (x * x + z * z).map(f64::sqrt)
    }
}

/// Divided by its length: one rounding less than glam's product with the inverse length.
fn unit(v: DVec3) -> DVec3 {
    v / v.length()
}

fn rounding(length: f64) -> f64 {
    length * gamma(18)
}

/// The share of a turn around the y axis, eastwards: 0.25 at +z, 0.5 at +x, and the seam at -x; below 1.
pub fn around(point: DVec3) -> f64 {
    let share = 0.5 - libm::atan2(point.z, point.x) / TAU;
    if share < 1.0 { share } else { 0.0 }
}

/// The two coordinates across the y axis.
#[inline]
pub fn across(v: DVec3) -> DVec2 {
    DVec2::new(v.x, v.z)
}

/// The factor by which `affine` scales in every direction; none if there is no such factor.
pub fn even_scale(affine: &DAffine3) -> Option<f64> {
    let m = affine.matrix3;
    let gram = m.transpose() * m;
    let square = gram.x_axis.x;
    // Off by more than the rounding of the product: not even.
    let off = (gram - DMat3::from_diagonal(DVec3::splat(square))).abs();
    let largest = off.x_axis.max(off.y_axis).max(off.z_axis).max_element();
    (largest <= square * 64.0 * UNIT_ROUNDOFF).then(|| square.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    /// How far the axes are from perpendicular unit vectors.
    fn defect(frame: &Frame) -> f64 {
        let off = (frame.axes.transpose() * frame.axes - DMat3::IDENTITY).abs();
        off.x_axis.max(off.y_axis).max(off.z_axis).max_element()
    }

    #[test]
    fn upright_frames_are_those_of_space() {
        assert_eq!(Frame::along(DVec3::ONE, DVec3::Y).axes, DMat3::IDENTITY);
    }

    #[test]
    fn axes_are_perpendicular_unit_vectors() {
        let mut random = Random(1);
        let mut worst = 0.0f64;
        for _ in 0..20_000 {
            let frame = Frame::along(DVec3::ZERO, random.direction());
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
