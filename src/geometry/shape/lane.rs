//! Rays, hits and surfaces in lanes: the arguments and results of shapes.

use super::{CoincidenceRange, ShapeHit, Surface};
use crate::base::lanes::{Level, Mask, Real, Row, Select, Vec3};
use crate::base::math::{DVec3, LaneRay, Ray};
use crate::geometry::bvh::TraversalRay;

/// The axes of [`PreparedRay`] for the lanes whose bits are set; none if these lanes differ. `along_x` and `along_y`
/// are the lanes whose direction is longest along x and along y.
#[inline(always)]
fn common_axes(along_x: u32, along_y: u32, wanted: u32) -> Option<[usize; 3]> {
    match (along_x & wanted, along_y & wanted) {
        (x, _) if x == wanted => Some([1, 2, 0]),
        (_, y) if y == wanted => Some([2, 0, 1]),
        (0, 0) => Some([0, 1, 2]),
        _ => None,
    }
}

/// Rays prepared for intersection tests.
#[derive(Clone, Copy)]
pub struct PreparedRay<F: Real> {
    pub ray: LaneRay<F>,
    /// The other two axes in cyclic order, then the axis along which the direction is longest; among equals, x before
    /// y before z. None if the lanes differ.
    axes: Option<[usize; 3]>,
    /// The lanes whose direction is longest along x, and along y.
    along_x: F::Mask,
    along_y: F::Mask,
    /// The origin in the order of [`PreparedRay::turned`].
    origin: [F; 3],
    /// 1 / the direction's component along its longest axis.
    pub per_longest: F,
    /// 1 / the square of the direction's length.
    pub per_square: F,
    /// Direction along the two other axes over direction along the longest: shears the ray onto that axis.
    shear: [F; 2],
}

impl<F: Real> PreparedRay<F> {
    #[inline(always)]
    pub fn new(ray: LaneRay<F>) -> Self {
        let length = ray.direction.abs();
        let along_x = length.y.le(length.x) & length.z.le(length.x);
        let along_y = !along_x & length.z.le(length.y);
        let axes = common_axes(along_x.bits(), along_y.bits(), (1 << F::LANES) - 1);
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let per_square = one / ray.direction.length_squared();
        let (per_longest, origin, shear) = (one, [zero; 3], [zero; 2]);
        let mut prepared = Self { ray, axes, along_x, along_y, origin, per_longest, per_square, shear };
        let [x, y, z] = prepared.turned(ray.direction);
        prepared.per_longest = one / z;
        prepared.shear = [x * prepared.per_longest, y * prepared.per_longest];
        prepared.origin = prepared.turned(ray.origin);
        prepared
    }

    /// The same ray in all lanes.
    #[inline(always)]
    pub fn splat(ray: &TraversalRay) -> Self {
        let [x, y, longest] = ray.axes;
        let origin = ray.ray.origin.to_array();
        Self {
            ray: LaneRay::splat(&ray.ray),
            axes: Some(ray.axes),
            along_x: F::Mask::splat(longest == 0),
            along_y: F::Mask::splat(longest == 1),
            origin: [F::splat(origin[x]), F::splat(origin[y]), F::splat(origin[longest])],
            per_longest: F::splat(ray.inverse.to_array()[longest]),
            per_square: F::splat(1.0 / ray.ray.direction.length_squared()),
            shear: [F::splat(ray.shear[0]), F::splat(ray.shear[1])],
        }
    }

    /// The axes of the lanes whose bits are set, the longest last, and the shear onto the last axis. None if these
    /// lanes differ.
    #[inline(always)]
    pub fn shear(&self, wanted: u32) -> Option<([usize; 3], [F; 2])> {
        Some((common_axes(self.along_x.bits(), self.along_y.bits(), wanted)?, self.shear))
    }

    /// The range within which hits may coincide, in a scene whose coordinates are up to `reach`.
    #[inline(always)]
    pub fn coincidence_range(&self, reach: f64) -> CoincidenceRange<F> {
        CoincidenceRange::new(self.ray.origin, self.per_longest, reach)
    }

    /// The coordinates, permuted so that the longest axis is last.
    #[inline(always)]
    fn turned(&self, v: Vec3<F>) -> [F; 3] {
        match self.axes {
            // By a table: for single rays, the processor could not predict a branch.
            Some([x, y, z]) if F::LANES == 1 => {
                let all = [v.x, v.y, v.z];
                [all[x], all[y], all[z]]
            }
            Some([.., 0]) => [v.y, v.z, v.x],
            Some([.., 1]) => [v.z, v.x, v.y],
            Some(_) => [v.x, v.y, v.z],
            None => [
                self.select_by_axis(v.y, v.z, v.x),
                self.select_by_axis(v.z, v.x, v.y),
                self.select_by_axis(v.x, v.y, v.z),
            ],
        }
    }

    /// The value for the longest axis.
    #[inline(always)]
    fn select_by_axis(&self, x: F, y: F, z: F) -> F {
        F::select(self.along_x, x, F::select(self.along_y, y, z))
    }

    /// A point relative to the ray, sheared so that the ray runs along an axis through 0; and its depth as t of the
    /// ray.
    #[inline(always)]
    pub fn sheared(&self, point: Vec3<F>) -> [F; 3] {
        let ([x, y, z], [from_x, from_y, from_z]) = (self.turned(point), self.origin);
        let (x, y, z) = (x - from_x, y - from_y, z - from_z);
        [x - self.shear[0] * z, y - self.shear[1] * z, z * self.per_longest]
    }
}

/// The interval of t in which hits count: `min` < t < `max`.
#[derive(Clone, Copy, Debug)]
pub struct RayInterval<F> {
    /// At least 0.
    pub min: F,
    pub max: F,
}

impl<F: Real> RayInterval<F> {
    /// From the ray's origin on.
    #[inline(always)]
    pub fn up_to(max: F) -> Self {
        Self { min: F::splat(0.0), max }
    }
}

/// Where rays leave a convex solid. If a ray enters ahead of its origin, the exit is beyond the entry, even if the ray
/// only touches the solid.
#[inline(always)]
pub fn exit<F: Real>(enter: F, leave: F, within: RayInterval<F>) -> F {
    let zero = F::splat(0.0);
    if !zero.lt(within.min).any() {
        return leave;
    }
    F::select(zero.lt(enter), leave.max(enter.next_away(F::splat(1.0))), leave)
}

/// Hits of rays with a shape.
#[derive(Clone, Copy)]
pub struct LaneHit<F: Real> {
    /// Infinite if a ray misses.
    pub t: F,
    /// The part of the shape, in the shape's own numbering: a triangle of a mesh, a cap.
    pub part: F::U32,
    /// Lanes in which another hit is so near that the order is uncertain.
    pub coincident: F::Mask,
}

impl From<ShapeHit> for LaneHit<f64> {
    fn from(ShapeHit { t, part, coincident }: ShapeHit) -> Self {
        Self { t, part, coincident }
    }
}

impl<F: Real> LaneHit<F> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat(at: Option<ShapeHit>) -> Self {
        match at {
            Some(ShapeHit { t, part, coincident }) => {
                Self { t: F::splat(t), part: F::U32::splat(part), coincident: F::Mask::splat(coincident) }
            }
            None => Self::none(),
        }
    }

    #[inline(always)]
    pub fn none() -> Self {
        Self { t: F::splat(f64::INFINITY), part: F::U32::splat(0), coincident: F::Mask::splat(false) }
    }

    /// Hits at t in the lanes of a mask, if they are within bounds.
    #[inline(always)]
    pub fn within(mask: F::Mask, t: F, within: RayInterval<F>) -> Self {
        let hit = mask & within.min.lt(t) & t.lt(within.max);
        Self { t: F::select(hit, t, F::splat(f64::INFINITY)), ..Self::none() }
    }

    /// The hit of one lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Option<ShapeHit> {
        let t = self.t.to_array()[lane];
        let (part, coincident) = (self.part.to_array()[lane], self.coincident.bits() >> lane & 1 == 1);
        (t < f64::INFINITY).then_some(ShapeHit { t, part, coincident })
    }

    /// The lanes with a hit.
    #[inline(always)]
    pub fn is_hit(&self) -> F::Mask {
        self.t.lt(F::splat(f64::INFINITY))
    }
}

impl<F: Real> Select<F::Mask> for LaneHit<F> {
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            t: F::select(mask, yes.t, no.t),
            part: F::U32::select(mask, yes.part, no.part),
            coincident: yes.coincident & mask | no.coincident & !mask,
        }
    }
}

impl LaneHit<f64> {
    /// The only lane.
    #[inline(always)]
    pub fn one(self) -> Option<ShapeHit> {
        self.lane(0)
    }
}

/// A point on a surface in each lane; see [`Surface`].
#[derive(Clone, Copy, Debug)]
pub struct LaneSurface<F> {
    pub point: Vec3<F>,
    pub error: Vec3<F>,
    pub normal: Vec3<F>,
    pub shading: Vec3<F>,
    pub lift: Vec3<F>,
}

impl<F: Real> LaneSurface<F> {
    #[inline(always)]
    pub fn new(point: Vec3<F>, error: Vec3<F>, normal: Vec3<F>) -> Self {
        Self { point, error, normal, shading: normal, lift: Vec3::zero() }
    }

    /// A placeholder for lanes without a surface.
    #[inline(always)]
    pub fn nowhere() -> Self {
        Self::new(Vec3::zero(), Vec3::zero(), Vec3::splat(DVec3::Y))
    }

    /// The surfaces of eight lanes. Lanes that do not exist repeat the last one.
    #[inline(always)]
    pub fn store(&self) -> [Surface; 8] {
        let (points, errors, normals) = (self.point.store(), self.error.store(), self.normal.store());
        let (shading, lifts) = (self.shading.store(), self.lift.store());
        std::array::from_fn(|lane| Surface {
            point: points[lane],
            error: errors[lane],
            normal: normals[lane],
            shading: shading[lane],
            lift: lifts[lane],
        })
    }

    /// Flips both normals in the lanes of a mask.
    #[inline(always)]
    pub fn flipped(self, mask: F::Mask) -> Self {
        Self { normal: self.normal.negate_where(mask), shading: self.shading.negate_where(mask), ..self }
    }

    /// Lanes in which light from `direction` reaches the smooth surface that a mesh approximates. The direction may be
    /// below the horizon of the flat triangle.
    #[inline(always)]
    pub fn smoothly_faces(&self, direction: Vec3<F>) -> F::Mask {
        self.lift.is_not_zero() & F::splat(0.0).lt(direction.dot(self.shading))
    }

    /// Converts a density per area at the point to one per steradian, as seen `from` elsewhere. 0 if the surface is
    /// seen edge-on.
    #[inline(always)]
    pub fn pdf_from(&self, from: Vec3<F>, per_area: F) -> F {
        let zero = F::splat(0.0);
        let way = self.point - from;
        let distance_squared = way.length_squared();
        let facing = way.dot(self.normal).abs();
        let pdf = per_area * distance_squared * distance_squared.sqrt() / facing;
        F::select(zero.lt(facing) & zero.lt(pdf) & pdf.lt(F::splat(f64::INFINITY)), pdf, zero)
    }
}

impl<F: Real> Select<F::Mask> for LaneSurface<F> {
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            point: Vec3::select(mask, yes.point, no.point),
            error: Vec3::select(mask, yes.error, no.error),
            normal: Vec3::select(mask, yes.normal, no.normal),
            shading: Vec3::select(mask, yes.shading, no.shading),
            lift: Vec3::select(mask, yes.lift, no.lift),
        }
    }
}

impl From<LaneSurface<f64>> for Surface {
    fn from(surface: LaneSurface<f64>) -> Self {
        Self {
            point: surface.point.into(),
            error: surface.error.into(),
            normal: surface.normal.into(),
            shading: surface.shading.into(),
            lift: surface.lift.into(),
        }
    }
}

impl From<&Surface> for LaneSurface<f64> {
    fn from(surface: &Surface) -> Self {
        Self {
            point: surface.point.into(),
            error: surface.error.into(),
            normal: surface.normal.into(),
            shading: surface.shading.into(),
            lift: surface.lift.into(),
        }
    }
}

/// Eight rays in memory, as structure of arrays.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct StoredRays {
    origin: [[f64; 8]; 3],
    direction: [[f64; 8]; 3],
}

impl StoredRays {
    /// Stores the rays of all lanes, at most eight.
    #[inline(always)]
    pub fn of<F: Real>(ray: &LaneRay<F>) -> Self {
        Self { origin: rows(ray.origin), direction: rows(ray.direction) }
    }

    #[inline(always)]
    pub fn load<L: Level>(&self) -> LaneRay<L::F64> {
        let ([x, y, z], [dx, dy, dz]) = (self.origin, self.direction);
        let row = L::F64::from_array;
        LaneRay { origin: Vec3::new(row(x), row(y), row(z)), direction: Vec3::new(row(dx), row(dy), row(dz)) }
    }

    pub fn one(&self, lane: usize) -> Ray {
        let [x, y, z] = &self.origin;
        let [dx, dy, dz] = &self.direction;
        Ray {
            origin: DVec3::new(x[lane], y[lane], z[lane]),
            direction: DVec3::new(dx[lane], dy[lane], dz[lane]),
        }
    }
}

/// The coordinates of vectors, one array each.
#[inline(always)]
fn rows<F: Real>(v: Vec3<F>) -> [[f64; 8]; 3] {
    [store_lanes(v.x), store_lanes(v.y), store_lanes(v.z)]
}

/// The values of all lanes, padded with 0.
#[inline(always)]
pub fn store_lanes<F: Real>(row: F) -> [f64; 8] {
    let (lanes, mut all) = (row.to_array(), [0.0; 8]);
    for (lane, value) in all.iter_mut().enumerate().take(F::LANES) {
        *value = lanes[lane];
    }
    all
}
