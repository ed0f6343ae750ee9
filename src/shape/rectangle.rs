//! Rectangles, and parallelograms, as two watertight triangles.

use super::{Crossing, Geometric, Parameters, Surface, flat, triangle::covers};
use crate::camera::Ray;
use crate::digest::content;
use crate::math::{Aabb, DAffine3, DVec2, DVec3};
use crate::tree::Probe;

/// The parallelogram `corner` + a·`u` + b·`v` for a and b in 0..=1; `u` and `v` are not parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    pub corner: DVec3,
    pub u: DVec3,
    pub v: DVec3,
}

content!(struct Rectangle { corner, u, v });

impl Geometric for Rectangle {
    const NAME: &'static str = "Rectangle";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let corner = parameters.vector("corner", None);
        let (u, v) = (parameters.vector("u", None), parameters.vector("v", None));
        let (corner, u, v) = (corner?, u?, v?);
        if !flat::spans_a_plane(u, v) {
            let label = "`u` and `v` are parallel, or one of them has no length";
            parameters.refuse("v", "this rectangle has no area".to_owned(), label.to_owned());
            return None;
        }
        Some(Self { corner, u, v })
    }

    fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        let [a, b, c, d] = self.corners();
        if !covers([a, b, c], probe) && !covers([a, c, d], probe) {
            return None;
        }
        flat::crossing(self.corner, self.u.cross(self.v), probe, after, t_max).map(Crossing::at)
    }

    fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        flat::surface(self.corner, self.normal(), ray, at.t)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(Aabb::around(self.corners()))
    }

    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let vector = |v| affine.transform_vector3(v);
        let (u, v) = (vector(self.u), vector(self.v));
        let (u, v) = if affine.matrix3.determinant() < 0.0 { (v, u) } else { (u, v) };
        Some(Self { corner: affine.transform_point3(self.corner), u, v })
    }

    /// The shares of `u` and `v`: 0..=1.
    fn uv(&self, point: DVec3, _: u32) -> DVec2 {
        flat::shares(point - self.corner, self.u, self.v)
    }

    fn area(&self) -> Option<f64> {
        Some(self.u.cross(self.v).length())
    }

    fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        let point = self.corner + self.u * u.x + self.v * u.y;
        Some((flat::placed(self.corner, point, self.normal()), 0))
    }
}

impl Rectangle {
    fn normal(&self) -> DVec3 {
        self.u.cross(self.v).normalize_or(DVec3::Y)
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
            rectangle.hit(&Probe::new(ray), f64::INFINITY).map(|crossing| crossing.t)
        };
        for (x, z) in [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0), (1.5, 1.0)] {
            assert_eq!(below(x, z), Some(1.0), "({x}, {z})");
        }
        for (x, z) in [(-1e-12, 1.0), (3.000_000_1, 1.0), (1.0, 2.000_000_1), (1.0, -1e-12)] {
            assert_eq!(below(x, z), None, "({x}, {z})");
        }
    }
}
