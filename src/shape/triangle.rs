//! Flat triangles, watertight at the edges they share.

use super::{Crossing, Geometric, Parameters, Surface, flat};
use crate::camera::Ray;
use crate::digest::content;
use crate::math::{Aabb, DAffine3, DVec2, DVec3, larger, smaller};
use crate::tree::Probe;

/// The flat triangle between three corners that are not in one line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    pub corners: [DVec3; 3],
}

content!(struct Triangle { corners });

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

    fn hit_after(&self, probe: &Probe, after: f64, t_max: f64) -> Option<Crossing> {
        let t = if covers(self.corners, probe) { depth(self.corners, probe)? } else { return None };
        (t > after && t < t_max).then_some(Crossing::at(t))
    }

    fn surface(&self, ray: &Ray, at: Crossing) -> Surface {
        flat::surface(self.corners[0], unit_normal(self.corners), ray, at.t)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(Aabb::around(self.corners))
    }

    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let [a, b, c] = self.corners.map(|corner| affine.transform_point3(corner));
        let mirrored = affine.matrix3.determinant() < 0.0;
        Some(Self { corners: if mirrored { [a, c, b] } else { [a, b, c] } })
    }

    /// The weights of the second and the third corner.
    fn uv(&self, point: DVec3, _: u32) -> DVec2 {
        let [a, b, c] = self.corners;
        flat::shares(point - a, b - a, c - a)
    }

    fn area(&self) -> Option<f64> {
        Some(0.5 * perpendicular(self.corners).length())
    }

    fn sample_area(&self, u: DVec2) -> Option<(Surface, u32)> {
        let [a, b, c] = self.corners;
        let weights = uniform_weights(u);
        let point = a + (b - a) * weights.x + (c - a) * weights.y;
        Some((flat::placed(a, point, unit_normal(self.corners)), 0))
    }
}

/// Weights of the second and the third corner, uniform over a triangle's area (Osada et al. 2002).
pub(super) fn uniform_weights(u: DVec2) -> DVec2 {
    let root = u.x.sqrt();
    DVec2::new(root * (1.0 - u.y), root * u.y)
}

/// Perpendicular to a triangle, on the side from which its corners run counter-clockwise; twice its area long.
#[inline]
pub(super) fn perpendicular([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// The direction of [`perpendicular`].
pub(super) fn unit_normal(corners: [DVec3; 3]) -> DVec3 {
    perpendicular(corners).normalize_or(DVec3::Y)
}

/// Whether the line of the ray passes through the triangle or its boundary.
///
/// Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection* (2013): the corners are sheared so that the
/// ray runs along an axis, and each edge is tested in the plane across it. Two triangles that share an edge
/// compute the same number for it with opposite signs, and zero counts as inside, so no ray slips between.
///
/// The products of an edge's number are rounded by the ray's distance from the triangle, which says nothing of triangles
/// that are smaller than that: of these, the box around the sheared corners must hold the ray as well. It does if the
/// triangle does, so that still no ray slips between.
#[inline]
pub(super) fn covers(corners: [DVec3; 3], probe: &Probe) -> bool {
    let [(ax, ay), (bx, by), (cx, cy)] =
        [sheared(corners[0], probe), sheared(corners[1], probe), sheared(corners[2], probe)];
    let u = cx * by - cy * bx;
    let v = ax * cy - ay * cx;
    let w = bx * ay - by * ax;
    let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
    // A sum of zero is a triangle seen from its edge, or one without an area.
    inside && u + v + w != 0.0 && spans_zero([ax, bx, cx]) && spans_zero([ay, by, cy])
}

/// Whether zero lies between the smallest and the largest of three numbers, or is one of them.
#[inline(always)]
fn spans_zero([a, b, c]: [f64; 3]) -> bool {
    smaller(smaller(a, b), c) <= 0.0 && larger(larger(a, b), c) >= 0.0
}

/// A corner seen along the ray, which runs through 0.
#[inline(always)]
fn sheared(corner: DVec3, probe: &Probe) -> (f64, f64) {
    let [x, y, z] = probe.axes;
    let p = (corner - probe.ray.origin).to_array();
    (p[x] - probe.shear[0] * p[z], p[y] - probe.shear[1] * p[z])
}

/// Where the line of the ray crosses the triangle's plane, given that it [`covers`] the triangle. Seen from its edge a
/// plane is crossed anywhere within rounding: never before the nearest or beyond the farthest corner.
#[inline]
pub(super) fn depth(corners: [DVec3; 3], probe: &Probe) -> Option<f64> {
    let Probe { ray, inverse, axes: [.., z], .. } = probe;
    let normal = perpendicular(corners);
    let along = normal.dot(ray.direction);
    let t = normal.dot(corners[0] - ray.origin) / along;
    let (origin, inverse) = (ray.origin[*z], inverse[*z]);
    let [a, b, c] = [corners[0][*z], corners[1][*z], corners[2][*z]];
    let [a, b, c] = [(a - origin) * inverse, (b - origin) * inverse, (c - origin) * inverse];
    let (first, last) = (smaller(smaller(a, b), c), larger(larger(a, b), c));
    (along != 0.0).then(|| smaller(larger(t, first), last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::UNIT_ROUNDOFF;
    use crate::testing::Random;

    fn hit(corners: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
        let triangle = Triangle { corners };
        triangle.hit(&Probe::new(Ray { origin, direction }), f64::INFINITY).map(|crossing| crossing.t)
    }

    /// Tests of edges that are not the same number for both triangles leak along them: Möller and Trumbore's loses 11 %
    /// of f64 rays.
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

    /// Triangles of the size of their distance's rounding: the signs of their edges' numbers are anything.
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
