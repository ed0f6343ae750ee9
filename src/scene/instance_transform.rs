//! The transform between the world and a shape that keeps its own space.

use crate::base::digest::Content;
use crate::base::lanes::{Real, Vec3, transform_vector};
use crate::base::math::{Aabb, DAffine3, DMat3, DVec3, LaneRay, Ray, absolute, gamma};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{LaneSurface, Shape};

/// The transform between the world and a shape that keeps its own space.
#[derive(Clone, Debug, PartialEq, Content)]
pub struct InstanceTransform {
    pub to_world: DAffine3,
    /// The inverse for directions. For points, the origin of the shape in the world is subtracted first. So rounding
    /// does not grow with the distance from the world's origin.
    back: DMat3,
    /// Distance in the shape's space between a point of the surface and the origin of a ray that starts there, at
    /// most.
    pub(super) origin_error: f64,
}

impl InstanceTransform {
    pub fn new(shape: &Shape, to_world: DAffine3, back: DMat3) -> Self {
        let transform = Self { to_world, back, origin_error: 0.0 };
        let origin_error = shape.bounds().map_or(0.0, |bounds| transform.origin_error(bounds));
        Self { origin_error, ..transform }
    }

    /// Largest distance in the shape's space between a point of a shape within `bounds` and the origin of a ray that
    /// starts there. It covers the point's error in the world, the offset along the normal, and the rounding of the
    /// inverse. No shape has an error above gamma(64) of its coordinates.
    fn origin_error(&self, bounds: Aabb) -> f64 {
        let farthest = bounds.min.abs().max(bounds.max.abs());
        let (back, reach) = (self.back.abs(), self.to_world.matrix3.abs() * farthest);
        let own = DVec3::splat(farthest.length() * gamma(64));
        let error = DVec3::from(self.error::<f64>(farthest.into(), own.into(), reach.into()));
        let in_world = reach + self.to_world.translation.abs();
        let moved = DVec3::splat(2.0 * error.length() + in_world.max_element() * gamma(2));
        (back * moved).length() + (back * reach * gamma(5)).length()
    }

    #[inline(always)]
    pub fn ray_to_object<F: Real>(&self, ray: &LaneRay<F>) -> LaneRay<F> {
        LaneRay {
            origin: transform_vector(&self.back, ray.origin - Vec3::splat(self.to_world.translation)),
            direction: transform_vector(&self.back, ray.direction),
        }
    }

    /// A bound of the factor by which vectors grow on their way into the shape's space: the Frobenius norm of the
    /// matrix.
    pub fn most_growth_to_object(&self) -> f64 {
        let [x, y, z] = [self.back.x_axis, self.back.y_axis, self.back.z_axis].map(DVec3::length_squared);
        (x + y + z).sqrt()
    }

    #[inline(always)]
    pub fn traversal_ray_to_object(&self, ray: &TraversalRay) -> TraversalRay {
        let LaneRay { origin, direction } = self.ray_to_object(&LaneRay::from(&ray.ray));
        TraversalRay::new(Ray { origin: origin.into(), direction: direction.into() })
    }

    /// The factor by which areas perpendicular to the world's unit vectors `normal` have grown. It is the determinant
    /// times the length of M⁻ᵀ n for the shape's normal n; here n is derived from the world's normal.
    #[inline(always)]
    pub fn stretch<F: Real>(&self, normal: Vec3<F>) -> F {
        let back = transform_vector(&self.to_world.matrix3.transpose(), normal).length();
        F::splat(self.to_world.matrix3.determinant().abs()) / back
    }

    /// The error in the world of a point that is known to `error` in the shape's space. `local` and `way` are absolute
    /// values: the point, and its offset in the world from the shape's origin.
    #[inline(always)]
    fn error<F: Real>(&self, local: Vec3<F>, error: Vec3<F>, way: Vec3<F>) -> Vec3<F> {
        let forth = absolute(&self.to_world);
        let there = transformed(&forth, local) * F::splat(gamma(5));
        // A difference, three products, and the matrix.
        let and_back =
            transform_vector(&forth.matrix3, transform_vector(&self.back.abs(), way)) * F::splat(gamma(5));
        transform_vector(&forth.matrix3, error) + there + and_back
    }

    /// The unit normal in the world.
    #[inline(always)]
    pub fn moved_normal<F: Real>(&self, normal: Vec3<F>) -> Vec3<F> {
        transform_vector(&self.back.transpose(), normal).normalize_or(normal)
    }

    /// The surface in the world. Its error is the shape's own error, the rounding of the map, and that of the inverse,
    /// because the next ray from this point is moved back into the shape's space.
    #[inline(always)]
    pub fn moved<F: Real>(&self, local: &LaneSurface<F>) -> LaneSurface<F> {
        let point = transformed(&self.to_world, local.point);
        let way = (point - Vec3::splat(self.to_world.translation)).abs();
        let error = self.error(local.point.abs(), local.error, way);
        let (back, normal) = (self.back.transpose(), self.moved_normal(local.normal));
        // A non-uniform scale may turn the shading normal past the surface's horizon.
        let shading = transform_vector(&back, local.shading).normalize_or(local.shading);
        let shading = shading.negate_where(shading.dot(normal).lt(F::splat(0.0)));
        let lift = transform_vector(&self.to_world.matrix3, local.lift);
        LaneSurface { point, error, normal, shading, lift }
    }
}

/// A point transformed by an affine map, in glam's order of operations.
#[inline(always)]
pub(super) fn transformed<F: Real>(affine: &DAffine3, point: Vec3<F>) -> Vec3<F> {
    transform_vector(&affine.matrix3, point) + Vec3::splat(affine.translation)
}
