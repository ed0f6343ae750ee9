//! Particles as a shape.

use super::Particles;
use crate::base::lanes::{Real, Row, Vec3, out_of_line};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay, max};
use crate::geometry::bvh::Stack;
use crate::geometry::shape::part_search::{any_part_of_each, nearest_part_of_each};
use crate::geometry::shape::{
    Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, Sphere, SphereLanes,
};

out_of_line! {
    fn surface_at<'k, F>(particles: &'k Particles, ray: &'k LaneRay<F>, at: LaneHit<F>) -> LaneSurface<F> {
        particles.gathered(at.part).surface(ray, at.t)
    }
}

impl Particles {
    /// The spheres with the indices `part`.
    #[inline(always)]
    fn gathered<F: Real>(&self, part: F::U32) -> SphereLanes<F> {
        let parts = part.to_array();
        let mut rows = [F::splat(0.0).to_array(); 4];
        for lane in 0..F::LANES {
            let Sphere { center, radius } = self.0.spheres()[parts[lane] as usize];
            (rows[0][lane], rows[1][lane], rows[2][lane]) = (center.x, center.y, center.z);
            rows[3][lane] = radius;
        }
        let [x, y, z, radius] = rows.map(F::from_array);
        SphereLanes { center: Vec3::new(x, y, z), radius }
    }
}

impl Geometric for Particles {
    const NAME: &'static str = "Particles";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        parameters.particles()
    }

    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        nearest_part_of_each(self, &ray.ray, within, &mut Stack::default())
    }

    #[inline(always)]
    fn occludes<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> F::Mask {
        any_part_of_each(self, &ray.ray, within, &mut Stack::default())
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, _: f64) -> LaneSurface<F> {
        surface_at(self, ray, at)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.0.bounds()).filter(|bounds| !bounds.is_empty())
    }

    fn support(&self, direction: DVec3) -> Option<f64> {
        let supports = self.0.spheres().iter().filter_map(|sphere| sphere.support(direction));
        supports.reduce(max)
    }

    /// Rays are moved instead, because moved particles would need another tree.
    fn transformed(&self, _: &DAffine3) -> Option<Self> {
        None
    }

    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, part: F::U32) -> [F; 2] {
        self.gathered(part).uv(point)
    }

    fn uv_ends(&self, part: u32) -> [bool; 2] {
        self.0.spheres()[part as usize].uv_ends(0)
    }
}
