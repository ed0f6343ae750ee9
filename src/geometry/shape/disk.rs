//! Flat disks.

use super::frame::circle_support;
use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, flat};
use crate::base::digest::Content;
use crate::base::lanes::{Real, Row, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay, cos_sin_of_turns, gamma};

/// The flat disk of `radius` (above 0) around `center`, perpendicular to the unit vector `normal`.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct Disk {
    pub center: DVec3,
    pub normal: DVec3,
    pub radius: f64,
}

impl Geometric for Disk {
    const NAME: &'static str = "Disk";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let center = parameters.vector("center", Some(DVec3::ZERO));
        let normal = parameters.unit_vector("normal", Some(DVec3::Y));
        let radius = parameters.positive("radius", Some(1.0));
        Some(Self { center: center?, normal: normal?, radius: radius? })
    }

    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        let center = Vec3::splat(self.center);
        let at = flat::crossing(center, Vec3::splat(self.normal), &ray.ray, within);
        let from_center = ray.ray.at(at.t) - center;
        let inside = from_center.length_squared().le(F::splat(self.radius * self.radius));
        LaneHit::within(inside & at.is_hit(), at.t, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        flat::placed(Vec3::splat(self.center), ray.at(at.t), Vec3::splat(self.normal))
    }

    /// The extent along each axis is r·sqrt(1 - n²).
    fn bounds(&self) -> Option<Aabb> {
        let n = self.normal;
        let sines = (DVec3::ONE - n * n).max(DVec3::ZERO).map(f64::sqrt);
        // 1 - n² cancels near 1: its rounding is absolute, so the square root is off by up to √u.
        let reach = (sines + DVec3::splat(gamma(8).sqrt())) * self.radius;
        let rounding = (self.center.abs() + reach) * gamma(4);
        Some(Aabb { min: self.center - reach, max: self.center + reach }.padded(rounding))
    }

    fn support(&self, direction: DVec3) -> Option<f64> {
        Some(self.center.dot(direction) + self.radius * circle_support(self.normal, direction))
    }

    /// Only translation is supported. Other maps move the rays.
    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let moved = affine.matrix3 == glam::DMat3::IDENTITY;
        moved.then(|| Self { center: self.center + affine.translation, ..*self })
    }

    /// Coordinates in the square around the disk, along `flat::axes`: (0.5, 0.5) is the centre.
    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, _: F::U32) -> [F; 2] {
        let (right, up) = flat::axes(self.normal);
        let from_center = (point - Vec3::splat(self.center)) / F::splat(2.0 * self.radius);
        let half = F::splat(0.5);
        [from_center.dot(Vec3::splat(right)) + half, from_center.dot(Vec3::splat(up)) + half]
    }

    fn area(&self) -> Option<f64> {
        Some(std::f64::consts::PI * self.radius * self.radius)
    }

    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        let (right, up) = flat::axes(self.normal);
        let (cosine, sine) = cos_sin_of_turns(v);
        let (center, length) = (Vec3::splat(self.center), F::splat(self.radius) * u.sqrt());
        let point = center + Vec3::splat(right) * (cosine * length) + Vec3::splat(up) * (sine * length);
        (flat::placed(center, point, Vec3::splat(self.normal)), F::U32::splat(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Ray;
    use crate::geometry::bvh::TraversalRay;
    use crate::geometry::shape::OneRay;

    #[test]
    fn ends_at_its_rim() {
        let disk = Disk { center: DVec3::Y, normal: DVec3::Y, radius: 2.0 };
        let down = |x: f64| {
            let ray = Ray { origin: DVec3::new(x, 5.0, 0.0), direction: DVec3::NEG_Y };
            disk.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY).map(|hit| hit.t)
        };
        assert_eq!([0.0, 2.0, -2.0].map(down), [Some(4.0); 3]);
        assert_eq!(down(2.0_f64.next_up()), None);
    }

    #[test]
    fn bounds_hold_a_tilted_rim() {
        let normal = DVec3::new(0.2, 0.9, -0.4).normalize();
        let disk = Disk { center: DVec3::new(3.0, -2.0, 1e3), normal, radius: 5.0 };
        let bounds = disk.bounds().expect("finite");
        let (u, v) = normal.any_orthonormal_pair();
        for k in 0..360 {
            let turn = crate::base::math::Angle(f64::from(k)).cos_sin();
            let p = disk.center + (u * turn.x + v * turn.y) * disk.radius;
            assert!(bounds.min.cmple(p).all() && p.cmple(bounds.max).all());
        }
    }
}
