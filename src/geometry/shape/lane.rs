//! Rays, hits and surfaces in lanes: what every formula of a shape takes and gives.

use super::{Crossing, Surface, TriangleLanes, Vicinity};
use crate::base::lanes::{Level, Mask, Real, Row, Select, Vec3};
use crate::base::math::{DVec3, LaneRay, Ray};
use crate::geometry::bvh::Probe;

/// The axes of [`PreparedRay`] of those lanes whose bits are set, if they are the same, given those of lanes that are
/// longest along x, and along y.
#[inline(always)]
fn common_axes(along_x: u32, along_y: u32, wanted: u32) -> Option<[usize; 3]> {
    match (along_x & wanted, along_y & wanted) {
        (x, _) if x == wanted => Some([1, 2, 0]),
        (_, y) if y == wanted => Some([2, 0, 1]),
        (0, 0) => Some([0, 1, 2]),
        _ => None,
    }
}

/// Rays with what tests along them share, computed once.
#[derive(Clone, Copy)]
pub struct PreparedRay<F: Real> {
    pub ray: LaneRay<F>,
    /// The axis along which the direction is longest, x before y before z of equal ones, behind the two others in cyclic
    /// order, where that is the same in all lanes.
    axes: Option<[usize; 3]>,
    /// Lanes in which it is along x, and along y.
    along_x: F::Mask,
    along_y: F::Mask,
    /// The origin in the order of [`PreparedRay::turned`].
    origin: [F; 3],
    /// 1 / direction along its longest axis.
    pub per_longest: F,
    /// 1 / the square of the direction's length.
    pub per_square: F,
    /// Direction along the two other axes, in cyclic order, over that along the longest: it shears the ray onto that
    /// axis.
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
    pub fn splat(probe: &Probe) -> Self {
        let [x, y, longest] = probe.axes;
        let origin = probe.ray.origin.to_array();
        Self {
            ray: LaneRay::splat(&probe.ray),
            axes: Some(probe.axes),
            along_x: F::Mask::splat(longest == 0),
            along_y: F::Mask::splat(longest == 1),
            origin: [F::splat(origin[x]), F::splat(origin[y]), F::splat(origin[longest])],
            per_longest: F::splat(probe.inverse.to_array()[longest]),
            per_square: F::splat(1.0 / probe.ray.direction.length_squared()),
            shear: [F::splat(probe.shear[0]), F::splat(probe.shear[1])],
        }
    }

    /// The axes of those lanes whose bits are set, if they are the same, the one along which the rays are longest last; and
    /// the direction along the two others over that along the last.
    #[inline(always)]
    pub fn shear(&self, wanted: u32) -> Option<([usize; 3], [F; 2])> {
        Some((common_axes(self.along_x.bits(), self.along_y.bits(), wanted)?, self.shear))
    }

    /// How near to each other hits have to be for their surfaces to be compared, of what lies between coordinates up to
    /// `reach`.
    #[inline(always)]
    pub fn vicinity(&self, reach: f64) -> Vicinity<F> {
        Vicinity::new(self.ray.origin, self.per_longest, reach)
    }

    /// Coordinates in an order in which that of the longest axis is the last.
    #[inline(always)]
    fn turned(&self, v: Vec3<F>) -> [F; 3] {
        match self.axes {
            // By a table: of single rays, a branch could not be predicted.
            Some([x, y, z]) if F::LANES == 1 => {
                let all = [v.x, v.y, v.z];
                [all[x], all[y], all[z]]
            }
            Some([.., 0]) => [v.y, v.z, v.x],
            Some([.., 1]) => [v.z, v.x, v.y],
            Some(_) => [v.x, v.y, v.z],
            None => [self.pick(v.y, v.z, v.x), self.pick(v.z, v.x, v.y), self.pick(v.x, v.y, v.z)],
        }
    }

    /// The number for the longest axis.
    #[inline(always)]
    fn pick(&self, x: F, y: F, z: F) -> F {
        F::select(self.along_x, x, F::select(self.along_y, y, z))
    }

    /// A point seen along the ray, which runs through 0; and its depth, as a t of the ray.
    #[inline(always)]
    pub fn sheared(&self, point: Vec3<F>) -> [F; 3] {
        let ([x, y, z], [from_x, from_y, from_z]) = (self.turned(point), self.origin);
        let (x, y, z) = (x - from_x, y - from_y, z - from_z);
        [x - self.shear[0] * z, y - self.shear[1] * z, z * self.per_longest]
    }
}

/// The part of rays that is looked at: `min` < t < `max`.
#[derive(Clone, Copy, Debug)]
pub struct Span<F> {
    /// At least 0.
    pub min: F,
    pub max: F,
}

impl<F: Real> Span<F> {
    /// From the start on.
    #[inline(always)]
    pub fn up_to(max: F) -> Self {
        Self { min: F::splat(0.0), max }
    }
}

/// Where rays leave a convex solid: if they enter it ahead, then behind that, also where they only touch the solid.
#[inline(always)]
pub fn exit<F: Real>(enter: F, leave: F, within: Span<F>) -> F {
    let zero = F::splat(0.0);
    if !zero.lt(within.min).any() {
        return leave;
    }
    F::select(zero.lt(enter), leave.max(enter.next_away(F::splat(1.0))), leave)
}

/// Where rays meet a shape.
#[derive(Clone, Copy)]
pub struct LaneHit<F: Real> {
    /// Infinite where a ray misses.
    pub t: F,
    /// Which part of the shape is met, in the shape's own numbering: a triangle of a mesh, a cap.
    pub part: F::U32,
    /// Lanes in which something else is met so near that it is not certain which comes first.
    pub crowded: F::Mask,
}

impl From<Crossing> for LaneHit<f64> {
    fn from(Crossing { t, part, crowded }: Crossing) -> Self {
        Self { t, part, crowded }
    }
}

impl<F: Real> LaneHit<F> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat(at: Option<Crossing>) -> Self {
        match at {
            Some(Crossing { t, part, crowded }) => {
                Self { t: F::splat(t), part: F::U32::splat(part), crowded: F::Mask::splat(crowded) }
            }
            None => Self::none(),
        }
    }

    #[inline(always)]
    pub fn none() -> Self {
        Self { t: F::splat(f64::INFINITY), part: F::U32::splat(0), crowded: F::Mask::splat(false) }
    }

    /// Hits at t in the lanes of a mask, as far as they are within bounds.
    #[inline(always)]
    pub fn within(mask: F::Mask, t: F, within: Span<F>) -> Self {
        let hit = mask & within.min.lt(t) & t.lt(within.max);
        Self { t: F::select(hit, t, F::splat(f64::INFINITY)), ..Self::none() }
    }

    /// The hit of one lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Option<Crossing> {
        let t = self.t.to_array()[lane];
        let (part, crowded) = (self.part.to_array()[lane], self.crowded.bits() >> lane & 1 == 1);
        (t < f64::INFINITY).then_some(Crossing { t, part, crowded })
    }

    /// Lanes in which something is met.
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
            crowded: yes.crowded & mask | no.crowded & !mask,
        }
    }
}

impl LaneHit<f64> {
    /// The only lane.
    #[inline(always)]
    pub fn one(self) -> Option<Crossing> {
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

    /// A point where there is nothing.
    #[inline(always)]
    pub fn nowhere() -> Self {
        Self::new(Vec3::zero(), Vec3::zero(), Vec3::splat(DVec3::Y))
    }

    /// The surfaces of eight lanes; those that there are not repeat the last one.
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

    /// Both normals turned to the other side in the lanes of a mask.
    #[inline(always)]
    pub fn flipped(self, mask: F::Mask) -> Self {
        Self { normal: self.normal.negate_where(mask), shading: self.shading.negate_where(mask), ..self }
    }

    /// Lanes in which light from this direction, which may lie below the surface's own horizon, falls on the smooth
    /// surface that it stands for.
    #[inline(always)]
    pub fn smoothly_faces(&self, direction: Vec3<F>) -> F::Mask {
        self.lift.is_not_zero() & F::splat(0.0).lt(direction.dot(self.shading))
    }

    /// The surface with its points as far from the edges of the flat triangles that they lie in as rounding may move rays
    /// that start there: by their errors, their way off the surface and the error of the test from there, with a
    /// neighbour at any angle but a sharp one. In triangles too small for that, the middle.
    #[inline(always)]
    pub fn clear_of_edges(self, triangle: &TriangleLanes<F>) -> Self {
        let [a, b, c] = triangle.corners;
        let [x, y] = triangle.weights(self.point);
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let clear = F::splat(8.0) * self.error.length() / triangle.perpendicular().length();
        // A weight is the distance from the opposite edge over the height above it, which is the doubled area over the
        // edge.
        let lack = (clear * (c - b).length() - (one - x - y))
            .max(clear * (a - c).length() - x)
            .max(clear * (b - a).length() - y);
        let lack = lack.max(zero).min(F::splat(1.0 / 3.0));
        let to_middle = (a - self.point) + (b - self.point) + (c - self.point);
        Self { point: self.point + to_middle * lack, ..self }
    }

    /// A density per area at the point as one per solid angle, as seen `from` elsewhere; 0 where the surface is seen
    /// from its edge.
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

/// Eight rays in memory.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct RayRows {
    origin: [[f64; 8]; 3],
    direction: [[f64; 8]; 3],
}

impl RayRows {
    /// Of as many rays as there are lanes, eight at most.
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

/// The coordinates of vectors, a row each.
#[inline(always)]
fn rows<F: Real>(v: Vec3<F>) -> [[f64; 8]; 3] {
    [eight(v.x), eight(v.y), eight(v.z)]
}

/// The numbers of all lanes; 0 in places that have none.
#[inline(always)]
pub fn eight<F: Real>(row: F) -> [f64; 8] {
    let (lanes, mut all) = (row.to_array(), [0.0; 8]);
    for (lane, value) in all.iter_mut().enumerate().take(F::LANES) {
        *value = lanes[lane];
    }
    all
}
