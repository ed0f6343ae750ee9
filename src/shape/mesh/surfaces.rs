//! Surfaces where eight rays cross a mesh: those of single rays, lane by lane, with the same operations in the same order.

use super::{Mesh, NO_DIRECTION};
use crate::math::DVec3;
use crate::shape::bundle::placed;
use crate::shape::{Rays, Surfaces};
use crate::simd::{Choice, Lanes, Octo, Quad, Rows, Vector};

impl Mesh {
    /// [`Geometric::surface`](super::Geometric::surface) where each of eight rays crosses a triangle at its t, and the ways
    /// from there to the smooth surface; none if only some of the triangles have normals at their corners.
    #[inline(always)]
    pub fn surfaces_of<L: Lanes>(
        &self,
        rays: &Rays,
        t: &[f64; 8],
        parts: &[u32; 8],
    ) -> Option<(Surfaces, Rows)> {
        let (mut corners, mut normals, mut smooth) = ([Rows::ZERO; 3], [Rows::ZERO; 3], 0);
        for (lane, &part) in parts.iter().enumerate() {
            for (rows, corner) in corners.iter_mut().zip(self.mesh.corners(part)) {
                rows.set(lane, corner);
            }
            if let Some(at_corners) = self.mesh.corner_normals(part, self.normals) {
                for (rows, normal) in normals.iter_mut().zip(at_corners) {
                    rows.set(lane, normal.as_dvec3());
                }
                smooth += 1;
            }
        }
        let (origin, direction) = rays.load::<L>();
        let [a, b, c] = &corners;
        let triangles = Triangles { corners: [Vector::load(a), Vector::load(b), Vector::load(c)] };
        let flat = triangles.surfaces(origin + direction * Octo::load(t));
        match smooth {
            0 => Some((flat, Rows::ZERO)),
            8 => {
                let [p, q, r] = &normals;
                let normals = [Vector::load(p), Vector::load(q), Vector::load(r)];
                Some(triangles.smooth(flat, &normals, direction))
            }
            _ => None,
        }
    }
}

struct Triangles<Q> {
    corners: [Vector<Q>; 3],
}

impl<Q: Quad> Triangles<Q> {
    /// The flat surfaces near points.
    #[inline(always)]
    fn surfaces(&self, near: Vector<Q>) -> Surfaces {
        let [a, b, c] = self.corners;
        let normal = (b - a).cross(c - a).normalized_or(Vector::splat(DVec3::Y));
        placed(a, near, normal)
    }

    /// `shaded` and `lifted`: with normals that come of those at the corners, seen along directions.
    #[inline(always)]
    fn smooth(&self, flat: Surfaces, normals: &[Vector<Q>; 3], direction: Vector<Q>) -> (Surfaces, Rows) {
        let zero = Octo::splat(0.0);
        let ([a, b, c], [p, q, r]) = (self.corners, *normals);
        let (point, normal) = (Vector::load(&flat.point), Vector::load(&flat.normal));
        let (x, y) = shares(point - a, b - a, c - a);
        let mean = p + (q - p) * x + (r - p) * y;
        let length = mean.length();
        let unit = mean / length;
        let unit = (-unit).pick(unit.dot(normal).below(zero), unit);
        let directed = !length.at_most(Octo::splat(NO_DIRECTION)).bits();
        let flat_ones = unit.equals(normal).bits() | !directed;
        if flat_ones & 0xff == 0xff {
            return (flat, Rows::ZERO);
        }
        let shading = normal.pick(Choice::of(flat_ones), unit);
        let seen = (-normal).pick(zero.below(normal.dot(direction)), normal);
        let lift = above(a - point, p, seen, Octo::splat(1.0) - x - y)
            + above(b - point, q, seen, x)
            + above(c - point, r, seen, y);
        let lift = Vector::splat(DVec3::ZERO).pick(Choice::of(flat_ones), lift);
        (Surfaces { shading: shading.store(), ..flat }, lift.store())
    }
}

/// The way to the plane across a corner's normal, as far as the corner weighs.
#[inline(always)]
fn above<Q: Quad>(to_corner: Vector<Q>, normal: Vector<Q>, seen: Vector<Q>, weight: Octo<Q>) -> Vector<Q> {
    let zero = Octo::splat(0.0);
    let normal = (-normal).pick(normal.dot(seen).below(zero), normal);
    normal * (to_corner.dot(normal).larger(zero) * weight.larger(zero))
}

/// [`crate::shape::flat::shares`].
#[inline(always)]
fn shares<Q: Quad>(offset: Vector<Q>, u: Vector<Q>, v: Vector<Q>) -> (Octo<Q>, Octo<Q>) {
    let n = u.cross(v);
    let square = n.dot(n);
    (offset.cross(v).dot(n) / square, u.cross(offset).dot(n) / square)
}
