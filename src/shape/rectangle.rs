//! Rectangles, and parallelograms, as two watertight triangles.

use super::{Probe, Surface, flat, triangle::covers};
use crate::camera::Ray;
use crate::math::{Aabb, DAffine3, DVec3};

/// The parallelogram `corner` + a·`u` + b·`v` for a and b in 0..=1; `u` and `v` are not parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    pub corner: DVec3,
    pub u: DVec3,
    pub v: DVec3,
}

impl Rectangle {
    pub fn hit(&self, probe: &Probe, t_max: f64) -> Option<f64> {
        let [a, b, c, d] = self.corners();
        if !covers([a, b, c], probe) && !covers([a, c, d], probe) {
            return None;
        }
        flat::crossing(self.corner, self.u.cross(self.v), probe, t_max)
    }

    pub fn surface(&self, ray: &Ray, t: f64) -> Surface {
        flat::surface(self.corner, self.u.cross(self.v).normalize_or(DVec3::Y), ray, t)
    }

    pub fn bounds(&self) -> Option<Aabb> {
        Some(Aabb::around(self.corners()))
    }

    pub fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let vector = |v| affine.transform_vector3(v);
        Some(Self { corner: affine.transform_point3(self.corner), u: vector(self.u), v: vector(self.v) })
    }

    fn corners(&self) -> [DVec3; 4] {
        let (b, d) = (self.corner + self.u, self.corner + self.v);
        [self.corner, b, b + self.v, d]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covers_its_corners_and_nothing_beyond() {
        let rectangle = Rectangle { corner: DVec3::ZERO, u: DVec3::X * 3.0, v: DVec3::Z * 2.0 };
        let below = |x: f64, z: f64| {
            let ray = Ray { origin: DVec3::new(x, 1.0, z), direction: DVec3::NEG_Y };
            rectangle.hit(&Probe::new(ray), f64::INFINITY)
        };
        for (x, z) in [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0), (1.5, 1.0)] {
            assert_eq!(below(x, z), Some(1.0), "({x}, {z})");
        }
        for (x, z) in [(-1e-12, 1.0), (3.000_000_1, 1.0), (1.0, 2.000_000_1), (1.0, -1e-12)] {
            assert_eq!(below(x, z), None, "({x}, {z})");
        }
    }
}
