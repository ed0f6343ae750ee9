//! Flat disks.

use super::{Probe, Surface, flat};
use crate::camera::Ray;
use crate::math::{Aabb, DAffine3, DVec3, gamma};

/// The flat disk of `radius` (above 0) around `center`, across the unit vector `normal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    pub center: DVec3,
    pub normal: DVec3,
    pub radius: f64,
}

impl Disk {
    pub fn hit(&self, probe: &Probe, t_max: f64) -> Option<f64> {
        let t = flat::crossing(self.center, self.normal, probe, t_max)?;
        let from_center = probe.ray.at(t) - self.center;
        (from_center.length_squared() <= self.radius * self.radius).then_some(t)
    }

    pub fn surface(&self, ray: &Ray, t: f64) -> Surface {
        flat::surface(self.center, self.normal, ray, t)
    }

    /// A disk reaches r·sqrt(1 - n²) along each axis.
    pub fn bounds(&self) -> Option<Aabb> {
        let n = self.normal;
        let sines = (DVec3::ONE - n * n).max(DVec3::ZERO).map(f64::sqrt);
        // 1 - n² cancels near 1: its rounding is an absolute one, so the square root's is that of √u.
        let reach = (sines + DVec3::splat(gamma(8).sqrt())) * self.radius;
        let rounding = (self.center.abs() + reach) * gamma(4);
        Some(Aabb { min: self.center - reach, max: self.center + reach }.padded(rounding))
    }

    /// A disk is only moved here, not turned or scaled.
    pub fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let moved = affine.matrix3 == glam::DMat3::IDENTITY;
        moved.then(|| Self { center: self.center + affine.translation, ..*self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_at_its_rim() {
        let disk = Disk { center: DVec3::Y, normal: DVec3::Y, radius: 2.0 };
        let down = |x: f64| {
            let ray = Ray { origin: DVec3::new(x, 5.0, 0.0), direction: DVec3::NEG_Y };
            disk.hit(&Probe::new(ray), f64::INFINITY)
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
            let turn = crate::math::Angle(f64::from(k)).cos_sin();
            let p = disk.center + (u * turn.x + v * turn.y) * disk.radius;
            assert!(bounds.min.cmple(p).all() && p.cmple(bounds.max).all());
        }
    }
}
