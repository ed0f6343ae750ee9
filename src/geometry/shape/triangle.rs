//! Flat triangles, watertight at shared edges.

use super::geometric::largest_product;
use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, flat};
use crate::base::digest::Content;
use crate::base::lanes::{Mask, Real, Row, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay};

/// The flat triangle between three corners that are not collinear.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub struct Triangle {
    pub corners: [DVec3; 3],
}

impl Geometric for Triangle {
    const NAME: &'static str = "Triangle";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let [a, b, c] = ["a", "b", "c"].map(|name| parameters.vector(name, None));
        let (a, b, c) = (a?, b?, c?);
        if !flat::spans_a_plane(b - a, c - a) {
            let label = "its corners are in one line, or two of them coincide";
            parameters.refuse("", "this triangle has no area".to_owned(), label.to_owned());
            return None;
        }
        Some(Self { corners: [a, b, c] })
    }

    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        TriangleLanes::splat(self.corners).intersect(ray, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        let [anchor, ..] = self.corners;
        flat::placed(Vec3::splat(anchor), ray.at(at.t), Vec3::splat(unit_normal(self.corners)))
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(Aabb::around(self.corners))
    }

    fn support(&self, direction: DVec3) -> Option<f64> {
        Some(largest_product(self.corners, direction))
    }

    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let [a, b, c] = self.corners.map(|corner| affine.transform_point3(corner));
        let mirrored = affine.matrix3.determinant() < 0.0;
        Some(Self { corners: if mirrored { [a, c, b] } else { [a, b, c] } })
    }

    /// The weights of the second and the third corner.
    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, _: F::U32) -> [F; 2] {
        let [a, b, c] = self.corners;
        flat::shares(point - Vec3::splat(a), Vec3::splat(b - a), Vec3::splat(c - a))
    }

    fn area(&self) -> Option<f64> {
        let [a, b, c] = self.corners;
        Some(0.5 * (b - a).cross(c - a).length())
    }

    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        let (corners, weights) = (self.corners, uniform_weights(u, v));
        let point = TriangleLanes::splat(corners).at(weights);
        let surface = flat::placed(Vec3::splat(corners[0]), point, Vec3::splat(unit_normal(corners)));
        (surface, F::U32::splat(0))
    }
}

impl Triangle {
    /// The unit normal on the side from which the corners are counter-clockwise.
    pub fn normal(&self) -> DVec3 {
        unit_normal(self.corners)
    }
}

/// Weights of the second and the third corner, uniform over a triangle's area (Osada et al. 2002).
#[inline(always)]
pub(super) fn uniform_weights<F: Real>(u: F, v: F) -> [F; 2] {
    let root = u.sqrt();
    [root * (F::splat(1.0) - v), root * v]
}

/// The unit normal on the side from which the corners are counter-clockwise.
pub(super) fn unit_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or(DVec3::Y)
}

/// A triangle in each lane.
#[derive(Clone, Copy, Debug)]
pub struct TriangleLanes<F> {
    pub corners: [Vec3<F>; 3],
}

impl<F: Real> TriangleLanes<F> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat([a, b, c]: [DVec3; 3]) -> Self {
        Self { corners: [Vec3::splat(a), Vec3::splat(b), Vec3::splat(c)] }
    }

    /// [`Geometric::intersect`].
    #[inline(always)]
    pub fn intersect(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        let sheared = self.sheared(ray);
        let covered = covers(&sheared);
        if !covered.any() {
            return LaneHit::none();
        }
        self.crossing(ray, &sheared, covered, within)
    }

    /// The corners, by [`PreparedRay::sheared`].
    #[inline(always)]
    pub(super) fn sheared(&self, ray: &PreparedRay<F>) -> [[F; 3]; 3] {
        let [a, b, c] = self.corners;
        [ray.sheared(a), ray.sheared(b), ray.sheared(c)]
    }

    /// Where lines cross the triangle's plane, in the lanes in which they pass through the triangle. The corners come
    /// from [`PreparedRay::sheared`].
    ///
    /// A plane seen edge-on is crossed anywhere within rounding. So t is clamped between the nearest and the farthest
    /// corner.
    #[inline(always)]
    pub(super) fn crossing(
        &self,
        ray: &PreparedRay<F>,
        [[.., a], [.., b], [.., c]]: &[[F; 3]; 3],
        covered: F::Mask,
        within: RayInterval<F>,
    ) -> LaneHit<F> {
        let normal = self.perpendicular();
        let along = normal.dot(ray.ray.direction);
        let t = normal.dot(self.corners[0] - ray.ray.origin) / along;
        let (first, last) = (a.min(*b).min(*c), a.max(*b).max(*c));
        LaneHit::within(covered & !along.eq(F::splat(0.0)), t.max(first).min(last), within)
    }

    /// Perpendicular to the triangle, on the side from which its corners are counter-clockwise. Its length is twice
    /// the area.
    #[inline(always)]
    pub fn perpendicular(&self) -> Vec3<F> {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    /// The weights of the second and the third corner at a point of the triangle.
    #[inline(always)]
    pub fn weights(&self, point: Vec3<F>) -> [F; 2] {
        let [a, b, c] = self.corners;
        flat::shares(point - a, b - a, c - a)
    }

    /// Moves points of flat triangles away from the edges, as far as rounding may move rays that start there. The
    /// distance covers the points' errors, the ray's offset and the error of the next test, with a neighbour at any
    /// angle that is not sharp. In triangles too small for that, the points move to the centre.
    #[inline(always)]
    pub fn clear_of_edges(&self, surface: LaneSurface<F>) -> LaneSurface<F> {
        let [a, b, c] = self.corners;
        let [x, y] = self.weights(surface.point);
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let clear = F::splat(8.0) * surface.error.length() / self.perpendicular().length();
        // A weight is the distance from the opposite edge over the height above it, and the height is the doubled area
        // over the edge.
        let lack = (clear * (c - b).length() - (one - x - y))
            .max(clear * (a - c).length() - x)
            .max(clear * (b - a).length() - y);
        let lack = lack.max(zero).min(F::splat(1.0 / 3.0));
        let to_middle = (a - surface.point) + (b - surface.point) + (c - surface.point);
        LaneSurface { point: surface.point + to_middle * lack, ..surface }
    }

    /// The point at the given weights of the second and the third corner.
    #[inline(always)]
    pub fn at(&self, [x, y]: [F; 2]) -> Vec3<F> {
        let [a, b, c] = self.corners;
        a + (b - a) * x + (c - a) * y
    }
}

/// Whether the line of a ray passes through a convex flat shape or its boundary. The corners, in order, come from
/// [`PreparedRay::sheared`].
///
/// Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection* (2013): the corners are sheared so that the ray runs
/// along an axis, and each edge is tested in the plane across it. Two shapes that share an edge compute the same value
/// for it with opposite signs. Zero counts as inside, so no ray slips between.
///
/// The products of an edge function are rounded relative to the ray's distance from the shape. That is meaningless for
/// shapes smaller than this rounding. So the box around the sheared corners must contain the ray too. It does if the
/// shape does, so still no ray slips between.
#[inline(always)]
pub(super) fn covers<F: Real, const N: usize>(corners: &[[F; 3]; N]) -> F::Mask {
    let zero = F::splat(0.0);
    let [first_x, first_y, _] = corners[0];
    let (mut left, mut right, mut low, mut high) = (first_x, first_x, first_y, first_y);
    for [x, y, _] in corners {
        (left, right) = (left.min(*x), right.max(*x));
        (low, high) = (low.min(*y), high.max(*y));
    }
    let around = left.le(zero) & zero.le(right) & low.le(zero) & zero.le(high);
    // Most rays miss.
    if !around.any() {
        return around;
    }
    let [last_x, last_y, _] = corners[N - 1];
    // An edge function is the doubled area of the edge's triangle with the ray.
    let closing = last_x * first_y - last_y * first_x;
    let (mut least, mut most, mut sum) = (closing, closing, closing);
    for corner in 1..N {
        let ([ax, ay, _], [bx, by, _]) = (corners[corner - 1], corners[corner]);
        let edge = ax * by - ay * bx;
        (least, most, sum) = (least.min(edge), most.max(edge), sum + edge);
    }
    let inside = zero.le(least) | most.le(zero);
    // The sum is zero if the shape is seen edge-on or has no area.
    inside & around & !sum.eq(zero)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::{Ray, UNIT_ROUNDOFF};
    use crate::geometry::bvh::TraversalRay;
    use crate::geometry::shape::OneRay;
    use crate::testing::Random;

    fn hit(corners: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
        let triangle = Triangle { corners };
        triangle
            .intersect_up_to(&TraversalRay::new(Ray { origin, direction }), f64::INFINITY)
            .map(|hit| hit.t)
    }

    /// Edge tests that compute different numbers for both triangles leak along the edge: Möller and Trumbore's loses
    /// 11 % of f64 rays.
    #[test]
    fn int_13_the_diagonal_of_a_quad_does_not_leak() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let (a, b, c, d) = (p(-5.0, -5.0), p(5.0, -5.0), p(5.0, 5.0), p(-5.0, 5.0));
        let eye = DVec3::new(0.0, 0.0, 10.0);
        let nearest = |direction| match (hit([a, b, c], eye, direction), hit([a, c, d], eye, direction)) {
            (Some(s), Some(t)) => Some(s.min(t)),
            (s, t) => s.or(t),
        };
        let t = nearest(DVec3::new(0.304_584_47, 0.304_584_47, -0.902_472_5)).expect("a hit");
        assert!((t - 10.0 / 0.902_472_5).abs() <= 8.0 * UNIT_ROUNDOFF * t);
        for k in 1..100_000 {
            let s = -5.0 + 1e-4 * f64::from(k);
            assert!(nearest((p(s, s) - eye).normalize()).is_some(), "at {s}");
        }
    }

    /// Triangles as small as the rounding of their distance: the signs of their edge functions are arbitrary.
    #[test]
    fn specks_are_not_hit_by_rays_that_pass_them() {
        let mut random = Random(15);
        for _ in 0..200_000 {
            let origin = random.point(2.0);
            let size = libm::pow(10.0, -13.0 - 4.0 * random.unit());
            let corners = [random.point(size), random.point(size), random.point(size)];
            let direction = random.direction();
            let beside = origin.cross(direction).length();
            if beside > 1e-3 {
                assert_eq!(hit(corners, origin, direction), None, "{corners:?} {beside} beside");
            }
        }
    }

    #[test]
    fn int_15_edge_on_and_degenerate_triangles_are_not_hit() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(hit(flat, DVec3::new(-1.0, 0.5, 0.0), DVec3::X), None);
        assert_eq!(hit([DVec3::ONE; 3], DVec3::ZERO, DVec3::ONE), None);
        assert_eq!(
            hit([DVec3::X, DVec3::X * 2.0, DVec3::X * 3.0], DVec3::Y, DVec3::new(2.0, -1.0, 0.0)),
            None
        );
    }
}
