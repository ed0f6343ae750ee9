//! Flat disks.

use super::{Crossing, Geometric, Parameters, Surface, flat};
use crate::camera::Ray;
use crate::digest::content;
use crate::math::{Aabb, Angle, DAffine3, DVec2, DVec3, gamma};
use crate::tree::Probe;

/// The flat disk of `radius` (above 0) around `center`, across the unit vector `normal`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    pub center: DVec3,
    pub normal: DVec3,
    pub radius: f64,
}

content!(struct Disk { center, normal, radius });

impl Geometric for Disk {
    const NAME: &'static str = "Disk";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let center = parameters.vector("center", Some(DVec3::ZERO));
        let normal = parameters.unit_vector("normal", Some(DVec3::Y));
        let radius = parameters.positive("radius", Some(1.0));
        Some(Self { center: center?, normal: normal?, radius: radius? })
    }

    fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        let t = flat::crossing(self.center, self.normal, probe, after, t_max)?;
        let from_center = probe.ray.at(t) - self.center;
        (from_center.length_squared() <= self.radius * self.radius).then_some(Crossing::at(t))
    }

    fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        flat::surface(self.center, self.normal, ray, at.t)
    }

    /// A disk reaches r·sqrt(1 - n²) along each axis.
    fn bounds(&self) -> Option<Aabb> {
        let n = self.normal;
        let sines = (DVec3::ONE - n * n).max(DVec3::ZERO).map(f64::sqrt);
        // 1 - n² cancels near 1: its rounding is an absolute one, so the square root's is that of √u.
        let reach = (sines + DVec3::splat(gamma(8).sqrt())) * self.radius;
        let rounding = (self.center.abs() + reach) * gamma(4);
        Some(Aabb { min: self.center - reach, max: self.center + reach }.padded(rounding))
    }

    /// A disk is only moved here, not turned or scaled.
    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let moved = affine.matrix3 == glam::DMat3::IDENTITY;
        moved.then(|| Self { center: self.center + affine.translation, ..*self })
    }

    /// The square around the disk, as `flat::axes` lies in its plane: (0.5, 0.5) is the centre.
    fn uv(&self, point: DVec3, _: u32) -> DVec2 {
        let (right, up) = flat::axes(self.normal);
        let from_center = (point - self.center) / (2.0 * self.radius);
        DVec2::new(from_center.dot(right), from_center.dot(up)) + DVec2::splat(0.5)
    }

    fn area(&self) -> Option<f64> {
        Some(std::f64::consts::PI * self.radius * self.radius)
    }

    fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        let (right, up) = flat::axes(self.normal);
        let turn = Angle(360.0 * u.y).cos_sin() * (self.radius * u.x.sqrt());
        Some((flat::placed(self.center, self.center + right * turn.x + up * turn.y, self.normal), 0))
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
            disk.hit(&Probe::new(ray), f64::INFINITY).map(|crossing| crossing.t)
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
