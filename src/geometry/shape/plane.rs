//! Infinite planes.

use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, flat};
use crate::base::digest::Content;
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay};

/// The infinite plane through `point`, perpendicular to the unit vector `normal`.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct Plane {
    /// A point of the plane.
    pub point: DVec3,
    /// The unit normal.
    pub normal: DVec3,
}

impl Geometric for Plane {
    const NAME: &'static str = "Plane";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let point = parameters.vector("point", Some(DVec3::ZERO));
        let normal = parameters.unit_vector("normal", Some(DVec3::Y));
        Some(Self { point: point?, normal: normal? })
    }

    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        flat::crossing(Vec3::splat(self.point), Vec3::splat(self.normal), &ray.ray, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        flat::placed(Vec3::splat(self.point), ray.at(at.t), Vec3::splat(self.normal))
    }

    fn bounds(&self) -> Option<Aabb> {
        None
    }

    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let normal = flat::moved_normal(affine, self.normal);
        Some(Self { point: affine.transform_point3(self.point), normal })
    }

    /// Distances from the plane's point along `flat::axes`.
    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, _: F::U32) -> [F; 2] {
        let (right, up) = flat::axes(self.normal);
        let offset = point - Vec3::splat(self.point);
        [offset.dot(Vec3::splat(right)), offset.dot(Vec3::splat(up))]
    }

    fn uv_ends(&self, _: u32) -> [bool; 2] {
        [false; 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Ray;
    use crate::geometry::bvh::TraversalRay;
    use crate::geometry::shape::OneRay;

    const GROUND: Plane = Plane { point: DVec3::ZERO, normal: DVec3::Y };

    fn hit(origin: DVec3, direction: DVec3) -> Option<f64> {
        GROUND.intersect_up_to(&TraversalRay::new(Ray { origin, direction }), f64::INFINITY).map(|hit| hit.t)
    }

    #[test]
    fn int_17_parallel_and_in_plane_rays_miss() {
        assert_eq!(hit(DVec3::Y, DVec3::X), None);
        assert_eq!(hit(DVec3::ZERO, DVec3::X), None);
        assert!(hit(DVec3::Y, DVec3::new(1.0, -1e-300, 0.0)).is_none_or(f64::is_finite));
        assert_eq!(hit(DVec3::Y, DVec3::NEG_Y), Some(1.0));
        assert_eq!(hit(DVec3::Y, DVec3::Y), None);
    }

    #[test]
    fn xf_01_normals_stay_perpendicular_under_uneven_scale() {
        let slope = Plane { point: DVec3::ZERO, normal: DVec3::new(1.0, 1.0, 0.0).normalize() };
        let moved = slope.transformed(&DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0))).expect("a plane");
        assert!((moved.normal - DVec3::new(1.0, 2.0, 0.0) / 5f64.sqrt()).length() < 1e-15);
    }
}
