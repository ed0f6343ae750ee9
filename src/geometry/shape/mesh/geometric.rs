//! Meshes as shapes.

use super::Mesh;
use super::bundle::BundleSearch;
use super::surface;
use crate::base::color::Rgb;
use crate::base::lanes::{Level, Mask, Real, Row, Vec3, out_of_line};
use crate::base::math::{Aabb, DAffine3, DVec2, DVec3, LaneRay};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::mesh::ArrayKey;
use crate::geometry::shape::geometric::largest_product;
use crate::geometry::shape::part_search::{any_part, nearest_part};
use crate::geometry::shape::triangle::{TriangleLanes, uniform_weights};
use crate::geometry::shape::{
    Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, ShapeHit, StoredRays, store_lanes,
};

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

/// The interval of the first lane.
#[inline(always)]
fn first([min, max]: &[[f64; 8]; 2]) -> RayInterval<f64> {
    RayInterval { min: min[0], max: max[0] }
}

impl Mesh {
    /// A number of the mesh's data at a point of a triangle.
    pub fn array_at(&self, key: &ArrayKey, point: DVec3, part: u32) -> Option<f64> {
        self.mesh.array_at(key, part, self.weights(point, part))
    }

    /// The weights of a triangle's second and third corner at a point.
    fn weights(&self, point: DVec3, part: u32) -> DVec2 {
        let triangle = TriangleLanes::<f64>::splat(self.mesh.corners(part));
        DVec2::from_array(triangle.weights(point.into()))
    }
}

impl Geometric for Mesh {
    const NAME: &'static str = "Mesh";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        parameters.mesh()
    }

    /// Of equally near triangles, the one with the lowest index.
    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        let (rays, span) = (StoredRays::of(&ray.ray), [store_lanes(within.min), store_lanes(within.max)]);
        if F::LANES == 1 {
            return LaneHit::splat(self.intersect_one(&TraversalRay::new(rays.one(0)), first(&span)));
        }
        let wanted = within.min.lt(within.max).bits();
        let search = BundleSearch::<false> { mesh: self, rays: &rays, wanted, span: &span };
        let found = F::Level::call(search);
        LaneHit {
            t: F::load(&found.t, 0),
            part: F::U32::load(&found.parts, 0),
            coincident: F::Mask::from_bits(found.coincident),
            isolated: 0,
        }
    }

    #[inline(always)]
    fn occludes<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> F::Mask {
        let (rays, span) = (StoredRays::of(&ray.ray), [store_lanes(within.min), store_lanes(within.max)]);
        if F::LANES == 1 {
            return F::Mask::splat(self.occludes_one(&TraversalRay::new(rays.one(0)), first(&span)));
        }
        let wanted = within.min.lt(within.max).bits();
        let search = BundleSearch::<true> { mesh: self, rays: &rays, wanted, span: &span };
        let found = F::Level::call(search);
        F::load(&found.t, 0).lt(F::splat(f64::INFINITY))
    }

    /// Of equally near triangles, the one with the lowest index.
    fn intersect_one(&self, ray: &TraversalRay, within: RayInterval<f64>) -> Option<ShapeHit> {
        nearest_part(self, ray, within)
    }

    fn occludes_one(&self, ray: &TraversalRay, within: RayInterval<f64>) -> bool {
        any_part(self, ray, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        surface::surface_at(self, ray, at)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.step.map_or_else(|| self.mesh.bounds(), |step| step.bounds))
    }

    fn support(&self, direction: DVec3) -> Option<f64> {
        Some(largest_product(self.mesh.outline().iter().copied(), direction))
    }

    /// Rays are moved instead, because a moved mesh would need a copy and another tree.
    fn transformed(&self, _: &DAffine3) -> Option<Self> {
        None
    }

    /// The interpolated coordinates of the corners. Without these, the weights of the second and the third corner.
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

    /// Coordinates from a file have no fixed range.
    fn uv_ends(&self, part: u32) -> [bool; 2] {
        [self.mesh.corner_uvs(part).is_none(); 2]
    }

    fn color(&self, point: DVec3, part: u32) -> Rgb {
        let Some([a, b, c]) = self.mesh.corner_colors(part) else { return Rgb::ONE };
        let weights = self.weights(point, part).as_vec2();
        // At an edge, rounding may make a weight negative.
        (a + (b - a) * weights.x + (c - a) * weights.y).max(Rgb::ZERO)
    }

    fn area(&self) -> Option<f64> {
        self.mesh.summed_areas().last().copied()
    }

    /// Selects a triangle by area, then a point of it.
    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        sample_area(self, u, v)
    }
}
