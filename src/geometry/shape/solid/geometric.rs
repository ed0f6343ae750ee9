//! Solids made of solids as shapes. Rare, so lanes search one ray at a time.

use super::{Operation, Solid};
use crate::base::color::Rgb;
use crate::base::lanes::{Mask, Real, Row, Vec3};
use crate::base::math::{self, Aabb, DAffine3, DVec3, LaneRay, Ray, gamma};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::shape::lane_search::first_hits;
use crate::geometry::shape::{
    Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, ShapeHit, StoredRays, Surface,
};

impl Solid {
    /// The first hit within bounds.
    fn first(&self, ray: &TraversalRay, within: RayInterval<f64>) -> Option<ShapeHit> {
        if !self.may_meet(&ray.ray, within) {
            return None;
        }
        self.with_hits(ray, |hits| hits.iter().find(|at| within.min < at.t && at.t < within.max).copied())
    }

    /// Whether a ray meets the bounds within an interval, but for rounding.
    fn may_meet(&self, ray: &Ray, within: RayInterval<f64>) -> bool {
        let Some(Aabb { min, max }) = self.0.bounds else { return true };
        let (mut from, mut to) = (within.min, within.max);
        for axis in 0..3 {
            let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
            if direction == 0.0 {
                if origin < min[axis] || max[axis] < origin {
                    return false;
                }
                continue;
            }
            let (a, b) = ((min[axis] - origin) / direction, (max[axis] - origin) / direction);
            let (near, far) = if a <= b { (a, b) } else { (b, a) };
            from = math::max(from, near - near.abs() * gamma(3));
            to = math::min(to, far + far.abs() * gamma(3));
        }
        from <= to
    }

    /// Passes all hits within bounds to `take`.
    pub fn each_hit(&self, ray: &TraversalRay, within: RayInterval<f64>, take: &mut dyn FnMut(ShapeHit)) {
        self.with_hits(ray, |hits| {
            hits.iter().filter(|at| within.min < at.t && at.t < within.max).copied().for_each(take);
        });
    }

    /// The surface at a hit.
    #[inline(never)]
    fn surface_of(&self, ray: &LaneRay<f64>, at: LaneHit<f64>, origin_error: f64) -> Surface {
        if !at.t.is_finite() {
            return LaneSurface::<f64>::nowhere().into();
        }
        let (index, part) = self.of(at.part);
        let surface = self.parts()[index].surface(ray, LaneHit { part, ..at }, origin_error);
        surface.flipped(self.is_turned(index)).into()
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
        first_hits(ray, within, |ray, span| self.first(ray, span))
    }

    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, origin_error: f64) -> LaneSurface<F> {
        let (rays, t, parts) = (StoredRays::of(ray), at.t.to_array(), at.part.to_array());
        let mut surfaces = [Surface::new(DVec3::ZERO, DVec3::ZERO, DVec3::Y); 8];
        for lane in 0..F::LANES {
            let at = LaneHit { t: t[lane], part: parts[lane], coincident: false };
            surfaces[lane] = self.surface_of(&LaneRay::from(&rays.one(lane)), at, origin_error);
        }
        LaneSurface {
            point: gathered(&surfaces, |surface| surface.point),
            error: gathered(&surfaces, |surface| surface.error),
            normal: gathered(&surfaces, |surface| surface.normal),
            shading: gathered(&surfaces, |surface| surface.shading),
            lift: gathered(&surfaces, |surface| surface.lift),
        }
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
