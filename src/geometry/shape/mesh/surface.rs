//! Surfaces of meshes.

use super::Mesh;
use crate::base::lanes::{Mask, Real, Row, Select, Vec3, out_of_line};
use crate::base::math::{DVec3, LaneRay};
use crate::geometry::shape::triangle::TriangleLanes;
use crate::geometry::shape::{LaneHit, LaneSurface, flat};

/// An interpolated unit normal not longer than this has no direction. Corner normals are f32, each off by less than √3
/// · 2^-25 (the rounding of three coordinates below 1), and so is any mean of them.
const NO_DIRECTION: f64 = f32::EPSILON as f64;

out_of_line! {
    /// The surface at hits of triangles.
    pub(super) fn surface_at<'k, F>(mesh: &'k Mesh, ray: &'k LaneRay<F>, at: LaneHit<F>) -> LaneSurface<F> {
        let (triangle, normals, has_normals) = mesh.triangles(at.part);
        let flat = triangle.surface(ray.at(at.t));
        if !has_normals.any() {
            return flat;
        }
        let smooth = triangle.shaded(flat, &normals);
        let seen = flat.normal.negate_where(F::splat(0.0).lt(flat.normal.dot(ray.direction)));
        let lifted = LaneSurface { lift: triangle.lift(&smooth, &normals, seen), ..smooth };
        let is_curved = has_normals & !smooth.shading.eq(flat.normal);
        LaneSurface::select(is_curved, lifted, flat)
    }
}

impl Mesh {
    /// The surface at the given weights of the second and the third corners.
    #[inline(always)]
    pub(super) fn surface_with_weights<F: Real>(&self, weights: [F; 2], part: F::U32) -> LaneSurface<F> {
        let (triangle, normals, has_normals) = self.triangles(part);
        let flat = triangle.surface(triangle.at(weights));
        LaneSurface::select(has_normals, triangle.shaded(flat, &normals), flat)
    }

    /// The triangles with the indices `part`.
    #[inline(always)]
    pub fn triangle<F: Real>(&self, part: F::U32) -> TriangleLanes<F> {
        let (parts, mut corners) = (part.to_array(), [[F::splat(0.0).to_array(); 3]; 3]);
        for lane in 0..F::LANES {
            for (rows, corner) in corners.iter_mut().zip(self.mesh.corners(parts[lane])) {
                set::<F>(rows, lane, corner);
            }
        }
        let [a, b, c] = corners;
        TriangleLanes { corners: [vector(a), vector(b), vector(c)] }
    }

    /// The triangles, the normals at their corners, and the lanes that have normals.
    #[inline(always)]
    fn triangles<F: Real>(&self, part: F::U32) -> (TriangleLanes<F>, [Vec3<F>; 3], F::Mask) {
        let parts = part.to_array();
        let (mut normals, mut smooth) = ([[F::splat(0.0).to_array(); 3]; 3], 0);
        for lane in 0..F::LANES {
            if let Some(at_corners) = self.mesh.corner_normals(parts[lane], self.normals) {
                for (rows, normal) in normals.iter_mut().zip(at_corners) {
                    set::<F>(rows, lane, normal.as_dvec3());
                }
                smooth |= 1 << lane;
            }
        }
        let [p, q, r] = normals;
        (self.triangle(part), [vector(p), vector(q), vector(r)], F::Mask::from_bits(smooth))
    }
}

#[inline(always)]
fn set<F: Real>(rows: &mut [F::Array; 3], lane: usize, v: DVec3) {
    (rows[0][lane], rows[1][lane], rows[2][lane]) = (v.x, v.y, v.z);
}

#[inline(always)]
fn vector<F: Real>([x, y, z]: [F::Array; 3]) -> Vec3<F> {
    Vec3::new(F::from_array(x), F::from_array(y), F::from_array(z))
}

impl<F: Real> TriangleLanes<F> {
    /// The flat surface next to a point.
    #[inline(always)]
    fn surface(&self, near: Vec3<F>) -> LaneSurface<F> {
        flat::placed(self.corners[0], near, self.normal())
    }

    /// The unit normal.
    #[inline(always)]
    pub fn normal(&self) -> Vec3<F> {
        self.perpendicular().normalize_or(Vec3::splat(DVec3::Y))
    }

    /// The surface with the interpolated normal.
    #[inline(always)]
    fn shaded(&self, surface: LaneSurface<F>, [p, q, r]: &[Vec3<F>; 3]) -> LaneSurface<F> {
        let [x, y] = self.weights(surface.point);
        let mean = *p + (*q - *p) * x + (*r - *p) * y;
        let length = mean.length();
        let unit = mean / length;
        let unit = unit.negate_where(unit.dot(surface.normal).lt(F::splat(0.0)));
        let directed = !length.le(F::splat(NO_DIRECTION));
        LaneSurface { shading: Vec3::select(directed, unit, surface.normal), ..surface }
    }

    /// The offset to the smooth surface on the side that is `seen`. The point is projected onto those planes across
    /// the corners' normals that lie above it. The projections are interpolated with the weights of the corners.
    #[inline(always)]
    fn lift(&self, surface: &LaneSurface<F>, [p, q, r]: &[Vec3<F>; 3], seen: Vec3<F>) -> Vec3<F> {
        let [a, b, c] = self.corners;
        let point = surface.point;
        let [x, y] = self.weights(point);
        above(a - point, *p, seen, F::splat(1.0) - x - y)
            + above(b - point, *q, seen, x)
            + above(c - point, *r, seen, y)
    }
}

/// The offset to the plane across a corner's normal, times the weight of the corner.
#[inline(always)]
fn above<F: Real>(to_corner: Vec3<F>, normal: Vec3<F>, seen: Vec3<F>, weight: F) -> Vec3<F> {
    let zero = F::splat(0.0);
    let normal = normal.negate_where(normal.dot(seen).lt(zero));
    normal * (to_corner.dot(normal).max(zero) * weight.max(zero))
}
