//! Triangle meshes: many triangles with a tree of their own.

mod bundle;
mod search;
mod surface;
#[cfg(test)]
mod tests;

use super::triangle::{TriangleLanes, uniform_weights};
use super::{Crossing, Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayRows, Span, eight};
use crate::base::color::Rgb;
use crate::base::digest::{Content, Digester};
use crate::base::lanes::{Level, Mask, Real, Row, Vec3, out_of_line};
use crate::base::math::{Aabb, DAffine3, DVec2, DVec3, LaneRay};
use crate::geometry::bvh::Probe;
use crate::geometry::mesh::{self, Normals};
use bundle::BundleSearch;
use std::sync::Arc;

/// A mesh, and how it is shaded. Meshes are large and never change, so they are shared, and compared by where
/// they are. A hit's part is the index of its triangle.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub mesh: Arc<mesh::Mesh>,
    pub normals: Normals,
}

out_of_line! {
    fn sample_area<'k, F>(mesh: &'k Mesh, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        let sums = mesh.mesh.summed_areas();
        let whole = sums.last().copied().unwrap_or_default();
        let (mut rest, mut parts) = (u.to_array(), F::U32::splat(0).to_array());
        for lane in 0..F::LANES {
            let wanted = rest[lane] * whole;
            let index = sums.partition_point(|&sum| sum <= wanted).min(sums.len() - 1);
            let before = index.checked_sub(1).map_or(0.0, |before| sums[before]);
            rest[lane] = ((wanted - before) / (sums[index] - before)).clamp(0.0, 1.0);
            parts[lane] = index as u32;
        }
        let part = F::U32::from_array(parts);
        (mesh.surface_with_weights(uniform_weights(F::from_array(rest), v), part), part)
    }
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh) && self.normals == other.normals
    }
}

/// That of the first lane.
#[inline(always)]
fn first([min, max]: &[[f64; 8]; 2]) -> Span<f64> {
    Span { min: min[0], max: max[0] }
}

impl Mesh {
    /// Whether it is shaded with normals of its vertices.
    pub fn is_smooth(&self) -> bool {
        match self.normals {
            Normals::File => self.mesh.has_normals(),
            Normals::Smooth => true,
            Normals::Flat => false,
        }
    }

    /// The weights of a triangle's second and third corner at a point of it.
    fn weights(&self, point: DVec3, part: u32) -> DVec2 {
        let triangle = TriangleLanes::<f64>::splat(self.mesh.corners(part));
        DVec2::from_array(triangle.weights(point.into()))
    }
}

impl Content for Mesh {
    fn feed(&self, into: &mut Digester) {
        let Self { mesh, normals } = self;
        mesh.digest().feed(into);
        normals.feed(into);
    }
}

impl Geometric for Mesh {
    const NAME: &'static str = "Mesh";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        parameters.mesh()
    }

    /// Of equally near triangles the one with the lowest index.
    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: Span<F>) -> LaneHit<F> {
        let (rays, span) = (RayRows::of(&ray.ray), [eight(within.min), eight(within.max)]);
        if F::LANES == 1 {
            return LaneHit::splat(self.intersect_one(&Probe::new(rays.one(0)), first(&span)));
        }
        let wanted = within.min.lt(within.max).bits();
        let search = BundleSearch::<false> { mesh: self, rays: &rays, wanted, span: &span };
        let found = F::Level::call(search);
        LaneHit {
            t: F::load(&found.t, 0),
            part: F::U32::load(&found.parts, 0),
            crowded: F::Mask::from_bits(found.crowded),
        }
    }

    #[inline(always)]
    fn occludes<F: Real>(&self, ray: &PreparedRay<F>, within: Span<F>) -> F::Mask {
        let (rays, span) = (RayRows::of(&ray.ray), [eight(within.min), eight(within.max)]);
        if F::LANES == 1 {
            return F::Mask::splat(self.occludes_one(&Probe::new(rays.one(0)), first(&span)));
        }
        let wanted = within.min.lt(within.max).bits();
        let search = BundleSearch::<true> { mesh: self, rays: &rays, wanted, span: &span };
        let found = F::Level::call(search);
        F::load(&found.t, 0).lt(F::splat(f64::INFINITY))
    }

    fn intersect_one(&self, probe: &Probe, within: Span<f64>) -> Option<Crossing> {
        self.nearest(probe, within)
    }

    fn occludes_one(&self, probe: &Probe, within: Span<f64>) -> bool {
        self.any(probe, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        surface::surface_at(self, ray, at)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.mesh.bounds())
    }

    /// Moving a mesh would mean a copy of it, and another tree: rays are moved instead.
    fn transformed(&self, _: &DAffine3) -> Option<Self> {
        None
    }

    /// What the corners' coordinates come to. Without them, the weights of the second and the third corner.
    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, part: F::U32) -> [F; 2] {
        let parts = part.to_array();
        let (x, y, z) = (point.x.to_array(), point.y.to_array(), point.z.to_array());
        let (mut u, mut v) = (x, x);
        for lane in 0..F::LANES {
            let weights = self.weights(DVec3::new(x[lane], y[lane], z[lane]), parts[lane]);
            let uv = match self.mesh.corner_uvs(parts[lane]) {
                Some([a, b, c]) => a + (b - a) * weights.x + (c - a) * weights.y,
                None => weights,
            };
            (u[lane], v[lane]) = (uv.x, uv.y);
        }
        [F::from_array(u), F::from_array(v)]
    }

    /// Coordinates of a file lie anywhere.
    fn uv_ends(&self, part: u32) -> [bool; 2] {
        [self.mesh.corner_uvs(part).is_none(); 2]
    }

    fn color(&self, point: DVec3, part: u32) -> Rgb {
        let Some([a, b, c]) = self.mesh.corner_colors(part) else { return Rgb::ONE };
        let weights = self.weights(point, part).as_vec2();
        // At an edge a weight may be below zero by its rounding.
        (a + (b - a) * weights.x + (c - a) * weights.y).max(Rgb::ZERO)
    }

    fn area(&self) -> Option<f64> {
        self.mesh.summed_areas().last().copied()
    }

    /// A triangle by its area, then a point of it.
    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        sample_area(self, u, v)
    }
}
