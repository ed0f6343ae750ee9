//! Rays in lanes, prepared for intersection tests.

use super::CoincidenceRange;
use crate::base::lanes::{Mask, Real, Vec3};
use crate::base::math::LaneRay;
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
    /// The direction's component along its longest axis, without sign.
    pub longest: F,
    /// 1 / that component, with its sign.
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
        let longest = length.max_element();
        let mut prepared =
            Self { ray, axes, along_x, along_y, origin, longest, per_longest, per_square, shear };
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
            longest: F::splat(ray.longest),
            per_longest: F::splat(ray.inverse.to_array()[longest]),
            per_square: F::splat(ray.per_square),
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
