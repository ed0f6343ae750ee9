//! Particles as a shape.

use super::Particles;
use crate::base::lanes::{Mask, Real, Row, Vec3, out_of_line};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay, max};
use crate::geometry::bvh::{Stack, TraversalRay};
use crate::geometry::shape::part_search::{any_part_on, nearest_part_on};
use crate::geometry::shape::{
    Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, Sphere, SphereLanes, StoredRays,
    store_lanes,
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

    /// The results of a search along the ray of each lane that may hit something.
    #[inline(always)]
    fn per_ray<F: Real>(
        ray: &PreparedRay<F>,
        within: RayInterval<F>,
        mut search: impl FnMut(usize, &TraversalRay, RayInterval<f64>),
    ) {
        let (rays, wanted) = (StoredRays::of(&ray.ray), within.min.lt(within.max).bits());
        let [min, max] = [store_lanes(within.min), store_lanes(within.max)];
        for lane in crate::base::lanes::lanes(wanted) {
            let span = RayInterval { min: min[lane], max: max[lane] };
            search(lane, &TraversalRay::new(rays.one(lane)), span);
        }
    }
}

impl Geometric for Particles {
    const NAME: &'static str = "Particles";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        parameters.particles()
    }

    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        let (mut t, mut parts) = (F::splat(f64::INFINITY).to_array(), F::U32::splat(0).to_array());
        let (mut coincident, mut stack) = (0, Stack::default());
        Self::per_ray(ray, within, |lane, ray, span| {
            if let Some(at) = nearest_part_on::<F::Level>(self, ray, span, Some(&mut stack)) {
                (t[lane], parts[lane]) = (at.t, at.part);
                coincident |= u32::from(at.coincident) << lane;
            }
        });
        LaneHit {
            t: F::from_array(t),
            part: F::U32::from_array(parts),
            coincident: F::Mask::from_bits(coincident),
        }
    }

    #[inline(always)]
    fn occludes<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> F::Mask {
        let (mut found, mut stack) = (0, Stack::default());
        Self::per_ray(ray, within, |lane, ray, span| {
            found |= u32::from(any_part_on::<F::Level>(self, ray, span, Some(&mut stack))) << lane;
        });
        F::Mask::from_bits(found)
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
