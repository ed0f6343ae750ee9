//! Rectangles and parallelograms, watertight at their edges.

use super::geometric::largest_product;
use super::side_filter::SideFilter;
use super::triangle::covers;
use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, flat};
use crate::base::digest::Content;
use crate::base::lanes::{Mask, Real, Row, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay};

/// The parallelogram `corner` + a·`u` + b·`v` for a and b in 0..=1. `u` and `v` are not parallel.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct Rectangle {
    /// A corner.
    pub corner: DVec3,
    /// One of the sides at the corner.
    pub u: DVec3,
    /// The other side at the corner.
    pub v: DVec3,
}

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

    /// Rays close to an edge are tested with the edge functions of [`covers`]. So rectangles and triangles that share an
    /// edge have no gap between them.
    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        let normal = Vec3::splat(self.u.cross(self.v));
        let at = flat::crossing(Vec3::splat(self.corner), normal, &ray.ray, within);
        if !at.is_hit().any() {
            return LaneHit::none();
        }
        let sides = SideFilter::new(ray, self.corner, [self.u, self.v]);
        let mut inside = sides.inside;
        if (at.is_hit() & !(inside | sides.outside)).any() {
            inside = covers(&self.corners().map(|corner| ray.sheared(Vec3::splat(corner))));
        }
        LaneHit::within(inside & at.is_hit(), at.t, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        flat::placed(Vec3::splat(self.corner), ray.at(at.t), Vec3::splat(self.normal()))
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(Aabb::around(self.corners()))
    }

    fn support(&self, direction: DVec3) -> Option<f64> {
        Some(largest_product(self.corners(), direction))
    }

    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let vector = |v| affine.transform_vector3(v);
        let (u, v) = (vector(self.u), vector(self.v));
        let (u, v) = if affine.matrix3.determinant() < 0.0 { (v, u) } else { (u, v) };
        Some(Self { corner: affine.transform_point3(self.corner), u, v })
    }

    /// The coordinates along `u` and `v`: 0..=1.
    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, _: F::U32) -> [F; 2] {
        flat::shares(point - Vec3::splat(self.corner), Vec3::splat(self.u), Vec3::splat(self.v))
    }

    fn area(&self) -> Option<f64> {
        Some(self.u.cross(self.v).length())
    }

    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        (RectangleLanes::splat(self).sample_area(u, v), F::U32::splat(0))
    }
}

#[warn(missing_docs)]
impl Rectangle {
    /// The unit normal, in the direction of `u` × `v`.
    pub fn normal(&self) -> DVec3 {
        self.u.cross(self.v).normalize_or(DVec3::Y)
    }

    fn corners(&self) -> [DVec3; 4] {
        let (b, d) = (self.corner + self.u, self.corner + self.v);
        [self.corner, b, b + self.v, d]
    }
}

/// A rectangle in each lane, with its unit normal.
#[derive(Clone, Copy, Debug)]
pub struct RectangleLanes<F> {
    pub corner: Vec3<F>,
    pub u: Vec3<F>,
    pub v: Vec3<F>,
    pub normal: Vec3<F>,
}

impl<F: Real> RectangleLanes<F> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat(rectangle: &Rectangle) -> Self {
        Self::with_normal(rectangle, rectangle.normal())
    }

    /// The same in all lanes, if its unit normal is known.
    #[inline(always)]
    pub fn with_normal(rectangle: &Rectangle, normal: DVec3) -> Self {
        let Rectangle { corner, u, v } = *rectangle;
        Self {
            corner: Vec3::splat(corner),
            u: Vec3::splat(u),
            v: Vec3::splat(v),
            normal: Vec3::splat(normal),
        }
    }

    /// [`Geometric::sample_area`].
    #[inline(always)]
    pub fn sample_area(&self, u: F, v: F) -> LaneSurface<F> {
        flat::placed(self.corner, self.corner + self.u * u + self.v * v, self.normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Ray;
    use crate::geometry::bvh::TraversalRay;
    use crate::geometry::shape::OneRay;

    #[test]
    fn covers_its_corners_and_nothing_beyond() {
        let rectangle = Rectangle { corner: DVec3::ZERO, u: DVec3::X * 3.0, v: DVec3::Z * 2.0 };
        let below = |x: f64, z: f64| {
            let ray = Ray { origin: DVec3::new(x, 1.0, z), direction: DVec3::NEG_Y };
            rectangle.intersect_up_to(&TraversalRay::new(ray), f64::INFINITY).map(|hit| hit.t)
        };
        for (x, z) in [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0), (1.5, 1.0)] {
            assert_eq!(below(x, z), Some(1.0), "({x}, {z})");
        }
        for (x, z) in [(-1e-12, 1.0), (3.000_000_1, 1.0), (1.0, 2.000_000_1), (1.0, -1e-12)] {
            assert_eq!(below(x, z), None, "({x}, {z})");
        }
    }
}
