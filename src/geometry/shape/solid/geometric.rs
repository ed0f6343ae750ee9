//! Solids made of solids as shapes.

use super::solid_rays::SolidRays;
use super::{Operation, Solid};
use crate::base::color::Rgb;
use crate::base::lanes::{Mask, Real, Row, Select, Vec3, lanes, out_of_line};
use crate::base::math::{self, Aabb, DAffine3, DVec3, LaneRay};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::{
    Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, ShapeHit, store_lanes,
};

impl Solid {
    /// Passes all hits of one ray within bounds to `take`.
    #[inline(never)]
    pub fn each_hit(&self, ray: &TraversalRay, within: RayInterval<f64>, take: &mut dyn FnMut(ShapeHit)) {
        let found = self.hits(&SolidRays::<f64>::new(&PreparedRay::splat(ray)), true);
        found.of(0).iter().filter(|at| within.min < at.t && at.t < within.max).copied().for_each(take);
    }
}

out_of_line! {
    fn intersect<'k, F>(
        solid: &'k Solid,
        ray: &'k PreparedRay<F>,
        within: RayInterval<F>,
    ) -> LaneHit<F> {
        let (rays, mut wanted) = (SolidRays::new(ray), within.min.lt(within.max));
        if let Some(bounds) = &solid.0.surroundings {
            wanted = wanted & rays.may_meet(bounds, within);
        }
        if !wanted.any() {
            return LaneHit::none();
        }
        let (found, [min, max]) = (solid.hits(&rays, wanted), [within.min, within.max].map(store_lanes));
        let mut hits = [None; 8];
        for lane in lanes(wanted.bits()) {
            let mut inside = found.of(lane).iter().filter(|at| min[lane] < at.t && at.t < max[lane]);
            hits[lane] = inside.next().copied();
        }
        LaneHit::from_lanes(&hits)
    }
}

out_of_line! {
    fn surfaces<'k, F>(
        solid: &'k Solid,
        ray: &'k LaneRay<F>,
        at: LaneHit<F>,
        origin_error: f64,
    ) -> LaneSurface<F> {
        let (numbers, mut parts) = (at.part.to_array(), F::U32::splat(0).to_array());
        let (mut indices, mut rest) = ([0; 8], at.is_hit().bits());
        for lane in lanes(rest) {
            (indices[lane], parts[lane]) = solid.of(numbers[lane]);
        }
        let (parts, mut surface) = (F::U32::from_array(parts), LaneSurface::nowhere());
        while rest != 0 {
            let index = indices[rest.trailing_zeros() as usize];
            let mut same = 0;
            for lane in lanes(rest) {
                same |= u32::from(indices[lane] == index) << lane;
            }
            rest &= !same;
            let same = F::Mask::from_bits(same);
            // Parts of other shapes may not exist in this one. Every shape has a part 0.
            let part = F::U32::select(same, parts, F::U32::splat(0));
            let mut found = solid.parts()[index].surface(ray, LaneHit { part, ..at }, origin_error);
            found.flip(F::Mask::splat(solid.is_turned(index)));
            surface = LaneSurface::select(same, found, surface);
        }
        surface
    }
}

/// Vectors of lanes.
#[inline(always)]
fn gathered<F: Real, T>(all: &[T; 8], of: impl Fn(&T) -> DVec3) -> Vec3<F> {
    let mut rows = [F::splat(0.0).to_array(); 3];
    for lane in 0..F::LANES {
        let v = of(&all[lane]);
        (rows[0][lane], rows[1][lane], rows[2][lane]) = (v.x, v.y, v.z);
    }
    let [x, y, z] = rows.map(F::from_array);
    Vec3::new(x, y, z)
}

impl Solid {
    /// The corners of parts, and which of these are triangles of meshes.
    #[inline(always)]
    pub fn triangles<F: Real>(&self, parts: F::U32) -> ([Vec3<F>; 3], F::Mask) {
        let parts = parts.to_array();
        let (mut corners, mut known) = ([[DVec3::ZERO; 8]; 3], 0);
        for lane in 0..F::LANES {
            if let Some([a, b, c]) = self.triangle_of(parts[lane]) {
                (corners[0][lane], corners[1][lane], corners[2][lane]) = (a, b, c);
                known |= 1 << lane;
            }
        }
        (corners.map(|corners| gathered(&corners, |corner| *corner)), F::Mask::from_bits(known))
    }
}

impl Geometric for Solid {
    const NAME: &'static str = "Difference";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        parameters.solid(Operation::Difference)
    }

    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        intersect(self, ray, within)
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, origin_error: f64) -> LaneSurface<F> {
        surfaces(self, ray, at, origin_error)
    }

    fn bounds(&self) -> Option<Aabb> {
        self.0.bounds
    }

    /// An upper bound: what is taken away may have been the farthest point.
    fn support(&self, direction: DVec3) -> Option<f64> {
        let mut all = self.parts().iter().map(|part| part.support(direction));
        match self.0.operation {
            Operation::Difference => all.next().flatten(),
            Operation::Union => all.try_fold(f64::NEG_INFINITY, |most, one| Some(math::max(most, one?))),
            Operation::Intersection => all.flatten().reduce(math::min),
        }
    }

    /// A solid stays one if all parts stay in their classes.
    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let parts = self.parts().iter().map(|part| part.transformed(affine)).collect::<Option<_>>()?;
        Some(Self::made(self.0.operation, parts, self.0.cuts, self.0.is_open))
    }

    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, part: F::U32) -> [F; 2] {
        let (x, y, z, parts) = (point.x.to_array(), point.y.to_array(), point.z.to_array(), part.to_array());
        let (mut u, mut v) = (x, x);
        for lane in 0..F::LANES {
            [u[lane], v[lane]] = self.uv_of(DVec3::new(x[lane], y[lane], z[lane]), parts[lane]);
        }
        [F::from_array(u), F::from_array(v)]
    }

    fn uv_ends(&self, part: u32) -> [bool; 2] {
        let (index, part) = self.of(part);
        self.parts()[index].uv_ends(part)
    }

    fn color(&self, point: DVec3, part: u32) -> Rgb {
        let (index, part) = self.of(part);
        self.parts()[index].color(point, part)
    }
}

impl Solid {
    #[inline(never)]
    fn uv_of(&self, point: DVec3, part: u32) -> [f64; 2] {
        let (index, part) = self.of(part);
        self.parts()[index].uv::<f64>(point.into(), part)
    }
}
