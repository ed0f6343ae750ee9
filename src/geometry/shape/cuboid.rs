//! Axis-aligned boxes.

use super::{Geometric, LaneHit, LaneSurface, Parameters, PreparedRay, RayInterval, exit};
use crate::base::digest::Content;
use crate::base::lanes::{Mask, Real, Row, Vec3};
use crate::base::math::{Aabb, DAffine3, DVec3, LaneRay, gamma, next_away};

/// The surface of the axis-aligned box from `min` to `max`. Each side is longer than 0.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct Cuboid {
    /// The corner of the smallest coordinates.
    pub min: DVec3,
    /// The corner of the largest coordinates.
    pub max: DVec3,
}

impl Geometric for Cuboid {
    const NAME: &'static str = "Box";

    fn read(parameters: &mut impl Parameters) -> Option<Self> {
        let (min, max) = (parameters.vector("min", None), parameters.vector("max", None));
        let (min, max) = (min?, max?);
        let flat: Vec<_> = ["x", "y", "z"]
            .into_iter()
            .zip((max - min).to_array())
            .filter_map(|(axis, side)| (side <= 0.0).then_some(axis))
            .collect();
        if !flat.is_empty() {
            let label = format!("not above `min` in {}", flat.join(" and "));
            parameters.refuse("max", "`max` must be above `min` along every axis".to_owned(), label);
            return None;
        }
        Some(Self { min, max })
    }

    /// Slab test: a line is inside the box from the last entry to the first exit. The distance to each plane is a
    /// difference of two coordinates, so its sign is exact, and so is which planes are ahead.
    #[inline(always)]
    fn intersect<F: Real>(&self, ray: &PreparedRay<F>, within: RayInterval<F>) -> LaneHit<F> {
        let Crossings { enter, leave, .. } = self.crossings(&ray.ray);
        let t = F::select(within.min.lt(enter), enter, exit(enter, leave, within));
        LaneHit::within(enter.le(leave), t, within)
    }

    /// The face that the ray enters by, or else leaves by. On an edge this is never the face around the edge, which
    /// the ray may not see. The point lies exactly in the plane of the face and off all edges. So a ray that continues
    /// inside is between all faces and leaves the box once.
    #[inline(always)]
    fn surface<F: Real>(&self, ray: &LaneRay<F>, at: LaneHit<F>, origin_error: f64) -> LaneSurface<F> {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let crossings = self.crossings(ray);
        let enters = crossings.enter.eq(at.t);
        let across = crossings.across(enters);
        let (min, max) = self.clear_of_edges(origin_error);
        let point = ray.at(at.t).max(Vec3::splat(min)).min(Vec3::splat(max));
        // Outwards: against the ray where it enters.
        let side = F::select(enters, -one, one);
        let along = Vec3::new(
            one.copysign(ray.direction.x) * side,
            one.copysign(ray.direction.y) * side,
            one.copysign(ray.direction.z) * side,
        );
        let (low, high) = (Vec3::<F>::splat(self.min), Vec3::<F>::splat(self.max));
        let point = Vec3::new(
            F::select(across[0], F::select(zero.lt(along.x), high.x, low.x), point.x),
            F::select(across[1], F::select(zero.lt(along.y), high.y, low.y), point.y),
            F::select(across[2], F::select(zero.lt(along.z), high.z, low.z), point.z),
        );
        let normal = Vec3::new(
            F::select(across[0], along.x, zero),
            F::select(across[1], along.y, zero),
            F::select(across[2], along.z, zero),
        );
        LaneSurface::new(point, point.abs() * F::splat(gamma(1)), normal)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(Aabb { min: self.min, max: self.max })
    }

    /// A box stays a box under translation and scaling along its axes.
    fn transformed(&self, affine: &DAffine3) -> Option<Self> {
        let m = affine.matrix3;
        let scale = DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z);
        let (a, b) = (affine.transform_point3(self.min), affine.transform_point3(self.max));
        (m == glam::DMat3::from_diagonal(scale)).then(|| Self { min: a.min(b), max: a.max(b) })
    }

    /// 0..=1 over each face, upright when seen from outside with +y up. The top and the bottom are seen with -z and +z
    /// up.
    #[inline(always)]
    fn uv<F: Real>(&self, point: Vec3<F>, _: F::U32) -> [F; 2] {
        let (half, one, side) = (F::splat(0.5), F::splat(1.0), self.max - self.min);
        let from_min = point - Vec3::splat(self.min);
        let (x, y, z) =
            (from_min.x / F::splat(side.x), from_min.y / F::splat(side.y), from_min.z / F::splat(side.z));
        let off = Vec3::new(x - half, y - half, z - half).abs();
        let across_x = off.y.le(off.x) & off.z.le(off.x);
        let across_y = !across_x & off.z.le(off.y);
        let turned_z_by_x = F::select(half.lt(x), one - z, z);
        let turned_z_by_y = F::select(half.lt(y), one - z, z);
        let turned_x = F::select(half.lt(z), x, one - x);
        [
            F::select(across_x, turned_z_by_x, F::select(across_y, x, turned_x)),
            F::select(across_y, turned_z_by_y, y),
        ]
    }

    fn area(&self) -> Option<f64> {
        Some(2.0 * self.faces().element_sum())
    }

    /// Selects a pair of faces by area, then one of the two.
    #[inline(always)]
    fn sample_area<F: Real>(&self, u: F, v: F) -> (LaneSurface<F>, F::U32) {
        let (zero, one, two) = (F::splat(0.0), F::splat(1.0), F::splat(2.0));
        let faces = self.faces();
        let (x, y, z) = (F::splat(faces.x), F::splat(faces.y), F::splat(faces.z));
        let rest = u * F::splat(faces.element_sum());
        let across_x = rest.lt(x);
        let across_y = !across_x & rest.lt(x + y);
        let rest = F::select(across_x, rest, F::select(across_y, rest - x, rest - (x + y)));
        let face = F::select(across_x, x, F::select(across_y, y, z));
        let across = (two * rest / face).max(zero).min(two);
        let upper = one.le(across);
        let (fraction, end) = (across - across.floor(), F::select(upper, one, zero));
        let share = Vec3::new(
            F::select(across_x, end, F::select(across_y, v, fraction)),
            F::select(across_x, fraction, F::select(across_y, end, v)),
            F::select(across_x, v, F::select(across_y, fraction, end)),
        );
        let outwards = F::select(upper, one, -one);
        let normal = Vec3::new(
            F::select(across_x, outwards, zero),
            F::select(across_y, outwards, zero),
            F::select(across_x | across_y, zero, outwards),
        );
        let (min, max) = (Vec3::splat(self.min), Vec3::splat(self.max));
        let point = (min + Vec3::splat(self.max - self.min).mul_each(share)).max(min).min(max);
        (LaneSurface::new(point, point.abs() * F::splat(gamma(1)), normal), F::U32::splat(0))
    }
}

/// Where lines enter and leave a box. If a line misses, `enter` is after `leave`.
struct Crossings<F: Real> {
    enter: F,
    leave: F,
    /// The axes of the planes at entry and at exit.
    enter_across: [F::Mask; 3],
    leave_across: [F::Mask; 3],
}

impl<F: Real> Crossings<F> {
    /// Intersects with the slab of an axis, in which the line is inside from `near` to `far`. If several axes have the
    /// same t, the first one counts.
    #[inline(always)]
    fn cut(&mut self, axis: usize, near: F, far: F) {
        let later = self.enter.lt(near);
        let sooner = far.lt(self.leave);
        self.enter = F::select(later, near, self.enter);
        self.leave = F::select(sooner, far, self.leave);
        for before in 0..axis {
            self.enter_across[before] = self.enter_across[before] & !later;
            self.leave_across[before] = self.leave_across[before] & !sooner;
        }
        self.enter_across[axis] = later;
        self.leave_across[axis] = sooner;
    }

    /// The axes of the entry in the lanes of a mask, and of the exit elsewhere.
    #[inline(always)]
    fn across(&self, enters: F::Mask) -> [F::Mask; 3] {
        let [a, b, c] = self.enter_across;
        let [d, e, f] = self.leave_across;
        [a & enters | d & !enters, b & enters | e & !enters, c & enters | f & !enters]
    }
}

impl Cuboid {
    #[inline(always)]
    fn crossings<F: Real>(&self, ray: &LaneRay<F>) -> Crossings<F> {
        let no = F::Mask::splat(false);
        let (enter, leave) = (F::splat(f64::NEG_INFINITY), F::splat(f64::INFINITY));
        let mut crossings = Crossings { enter, leave, enter_across: [no; 3], leave_across: [no; 3] };
        let LaneRay { origin: o, direction: d } = ray;
        let (x, y, z) = (self.slab(0, o.x, d.x), self.slab(1, o.y, d.y), self.slab(2, o.z, d.z));
        crossings.cut(0, x.0, x.1);
        crossings.cut(1, y.0, y.1);
        crossings.cut(2, z.0, z.1);
        crossings
    }

    /// The t at which a line enters and leaves the slab of an axis. A parallel line is inside everywhere or nowhere.
    #[inline(always)]
    fn slab<F: Real>(&self, axis: usize, origin: F, direction: F) -> (F, F) {
        let (low, high) = (F::splat(self.min[axis]), F::splat(self.max[axis]));
        let (a, b) = ((low - origin) / direction, (high - origin) / direction);
        let along = direction.eq(F::splat(0.0));
        let between = low.le(origin) & origin.le(high);
        let (never, always) = (F::splat(f64::INFINITY), F::splat(f64::NEG_INFINITY));
        let (near, far) = (F::select(between, always, never), F::select(between, never, always));
        (F::select(along, near, a.min(b)), F::select(along, far, a.max(b)))
    }

    /// The corners of the region that is off all edges by at least `origin_error` and one float. If that region is
    /// empty, the centre twice.
    fn clear_of_edges(&self, origin_error: f64) -> (DVec3, DVec3) {
        let min = (self.min + origin_error).map(|v| next_away(v, 1.0));
        let max = (self.max - origin_error).map(|v| next_away(v, -1.0));
        let middle = self.min * 0.5 + self.max * 0.5;
        (min.min(middle), max.max(middle))
    }

    /// The area of one face across each axis.
    fn faces(&self) -> DVec3 {
        let side = self.max - self.min;
        DVec3::new(side.y * side.z, side.z * side.x, side.x * side.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::Ray;
    use crate::geometry::bvh::TraversalRay;
    use crate::geometry::shape::{OneRay, ShapeHit};

    const UNIT: Cuboid = Cuboid { min: DVec3::ZERO, max: DVec3::ONE };

    fn hit(origin: DVec3, direction: DVec3) -> Option<f64> {
        UNIT.intersect_up_to(&TraversalRay::new(Ray { origin, direction }), f64::INFINITY).map(|hit| hit.t)
    }

    #[test]
    fn bvh_01_rays_in_its_faces_enter() {
        for x in [0.0, 0.5, 1.0] {
            for y in [0.0, 0.5, 1.0] {
                for (dx, dy) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)] {
                    assert_eq!(hit(DVec3::new(x, y, -1.0), DVec3::new(dx, dy, 1.0)), Some(1.0));
                }
            }
        }
    }

    #[test]
    fn from_inside_and_past() {
        assert_eq!(hit(DVec3::splat(0.5), DVec3::X), Some(0.5));
        assert_eq!(hit(DVec3::new(2.0, 0.5, 0.5), DVec3::X), None);
        assert_eq!(hit(DVec3::new(2.0, 0.5, 0.5), DVec3::NEG_X), Some(1.0));
        assert_eq!(hit(DVec3::new(2.0, 2.0, 0.5), DVec3::new(-1.0, 0.5, 0.0)), None);
    }

    #[test]
    fn the_surface_is_on_the_face_that_is_crossed() {
        let surface = |origin, direction| {
            let t = hit(origin, direction).expect("a hit");
            let surface = UNIT.surface_at(&Ray { origin, direction }, ShapeHit::at(t));
            (surface.point, surface.normal)
        };
        let top = surface(DVec3::new(0.2, 3.0, 0.7), DVec3::NEG_Y);
        assert_eq!(top, (DVec3::new(0.2, 1.0, 0.7), DVec3::Y));
        // Along an edge of the top: the ray does not see the sides.
        assert_eq!(surface(DVec3::new(1.0, 3.0, 0.7), DVec3::NEG_Y).1, DVec3::Y);
        let inside = surface(DVec3::new(0.1, 0.4, 0.7), DVec3::new(-1.0, 0.5, 0.25));
        assert_eq!((inside.0.x, inside.1), (0.0, DVec3::NEG_X));
    }
}
