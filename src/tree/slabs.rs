//! A ray in a tree's space, and the test of eight boxes at a time.

use super::space::{power_of_two, reciprocal};
use super::{Node, Probe, Tree};
use crate::math::{DVec3, gamma};
use crate::simd::Lanes;

/// A ray as a tree's f32 filters see it: its direction scaled by a power of two, so that the longest component is of
/// 1..2, and begun near the tree if it comes from afar.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// 1 / direction along each axis, and which of a box's planes come first: 0 for the lower ones.
    inverse: [f32; 3],
    near: [usize; 3],
    /// origin / direction with all that rounding may do added, for planes that come first, and taken off, for those
    /// that come last.
    enter: [f32; 3],
    leave: [f32; 3],
    pub origin: DVec3,
    pub direction: DVec3,
    /// How far off `origin` may be along each axis, in f64.
    pub error: f64,
    /// The ray's t at `origin`, and lengths of t here for one there.
    begin: f64,
    unit: f64,
}

/// Farther from the tree than this, rays begin near it instead.
const AFAR: f64 = 4.0;

/// Ways through a tree's space are shorter than this.
const LONGEST: f64 = 32.0;

/// What is steeper than this along an axis runs along the others: it stays within LONGEST / STEEPEST of a plane.
const STEEPEST: f64 = (1u64 << 40) as f64;

/// Half the distance from 1 to the next f32.
const ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// Relative error of where a ray enters and leaves boxes, on both sides of a comparison.
const SPREAD: f32 = 1.0 + 16.0 * ROUNDOFF as f32;

impl Slabs {
    /// The ray in the tree's space; none if it passes by the whole tree, or meets it beyond `t_max`.
    #[inline(always)]
    pub fn new(tree: &Tree, probe: &Probe, t_max: f64) -> Option<Self> {
        let length = probe.ray.direction.abs().max_element();
        let scale = power_of_two(length);
        let per_scale = reciprocal(scale);
        let direction = probe.ray.direction * per_scale;
        let unit = scale * tree.space.per;
        let mut origin = tree.space.point(probe.ray.origin);
        let mut error = tree.space.error(probe.ray.origin);
        let enter = tree.crossed(origin, probe.inverse * scale, error)?;
        // Comparisons are false for what is not a number: then the tree is walked.
        if enter > t_max * unit * (1.0 + f64::EPSILON) {
            return None;
        }
        let mut begin = 0.0;
        if origin.abs().max_element() > AFAR {
            begin = (enter - 0.5).max(0.0);
            error += (origin.abs().max_element() + 2.0 * begin) * (4.0 * f64::EPSILON);
            origin += direction * begin;
        }
        let mut slabs = Self {
            inverse: [0.0; 3],
            near: [0; 3],
            enter: [0.0; 3],
            leave: [0.0; 3],
            origin,
            direction,
            error,
            begin: begin * per_scale * tree.space.size,
            unit,
        };
        for axis in 0..3 {
            slabs.prepare(axis, probe.inverse[axis] * scale);
        }
        Some(slabs)
    }

    /// The distance to a plane p along an axis is p·i - o·i. Of it, rounding i to f32 takes u of |p·i|, which is at
    /// most |t| + |o·i|; rounding o·i takes u of that; and the product and the difference take u of p·i and t, where
    /// they are rounded apart. That is 3u of |o·i| and 3u of |t|.
    #[inline(always)]
    fn prepare(&mut self, axis: usize, inverse: f64) {
        let forward = inverse.is_sign_positive();
        let steep = inverse.abs() > STEEPEST || inverse.is_nan();
        // Along such an axis the ray is within the slab or not, wherever it is.
        let inverse = if steep { STEEPEST.copysign(inverse) } else { inverse };
        let offset = self.origin[axis] * inverse;
        let off = offset.abs() * (4.0 * ROUNDOFF)
            + self.error * inverse.abs()
            + if steep { 4.0 * LONGEST } else { 0.0 };
        self.inverse[axis] = inverse as f32;
        self.near[axis] = usize::from(!forward);
        self.enter[axis] = (offset + off) as f32;
        self.leave[axis] = (offset - off) as f32;
    }

    /// 1 / direction along the axis where that is longest.
    #[inline]
    pub fn inverse_along(&self, longest: usize) -> f32 {
        self.inverse[longest]
    }

    /// A limit of the ray's t in the filters' units, rounded up: nothing that is met before `t` lies beyond it.
    #[inline]
    pub fn limit(&self, t: f64) -> f32 {
        let limit = (t - self.begin) * self.unit;
        (limit + limit.abs() * (4.0 * ROUNDOFF)) as f32
    }

    /// The ray's t = 0 in the filters' units, rounded down.
    #[inline]
    pub fn start(&self) -> f32 {
        -(self.begin * self.unit * (1.0 + 4.0 * ROUNDOFF)) as f32
    }
}

/// [`Slabs`] in lanes.
#[derive(Clone, Copy)]
pub(super) struct Wide<L> {
    inverse: [L; 3],
    near: [usize; 3],
    enter: [L; 3],
    leave: [L; 3],
}

// No closures here: they would be compiled for less than the lanes need.
impl<L: Lanes> Wide<L> {
    #[inline(always)]
    pub fn new(slabs: &Slabs) -> Self {
        let ([ix, iy, iz], [ex, ey, ez], [lx, ly, lz]) = (slabs.inverse, slabs.enter, slabs.leave);
        Self {
            inverse: [L::splat(ix), L::splat(iy), L::splat(iz)],
            near: slabs.near,
            enter: [L::splat(ex), L::splat(ey), L::splat(ez)],
            leave: [L::splat(lx), L::splat(ly), L::splat(lz)],
        }
    }

    /// Which of a node's boxes the ray may meet before `limit`, a bit each, and where it enters them at the earliest.
    #[inline(always)]
    pub fn test(&self, node: &Node, limit: f32) -> (u32, [f32; 8]) {
        let enter = self.enter(node, 0).larger(L::splat(0.0));
        let enter = enter.larger(self.enter(node, 1)).larger(self.enter(node, 2));
        let leave = self.leave(node, 0).smaller(L::splat(limit));
        let leave = leave.smaller(self.leave(node, 1)).smaller(self.leave(node, 2));
        (enter.at_most(leave.times(L::splat(SPREAD))), enter.store())
    }

    #[inline(always)]
    fn enter(&self, node: &Node, axis: usize) -> L {
        let planes = &node.planes[axis][self.near[axis] & 1];
        L::load(planes).times_minus(self.inverse[axis], self.enter[axis])
    }

    #[inline(always)]
    fn leave(&self, node: &Node, axis: usize) -> L {
        let planes = &node.planes[axis][!self.near[axis] & 1];
        L::load(planes).times_minus(self.inverse[axis], self.leave[axis])
    }
}

impl Tree {
    /// Where a ray enters the tree's box in its space; none if it passes by. In f64, with the rounding of
    /// the distances (gamma(3), Ize 2013) and of the origin.
    #[inline(always)]
    fn crossed(&self, origin: DVec3, inverse: DVec3, error: f64) -> Option<f64> {
        let (mut enter, mut leave) = (0.0, f64::INFINITY);
        for axis in 0..3 {
            let a = (self.bounds[0][axis] - error - origin[axis]) * inverse[axis];
            let b = (self.bounds[1][axis] + error - origin[axis]) * inverse[axis];
            let (near, far) = if inverse[axis].is_sign_positive() { (a, b) } else { (b, a) };
            // A ray within a plane gives 0·∞: the comparisons keep the value before it.
            if near > enter {
                enter = near;
            }
            if far < leave {
                leave = far;
            }
        }
        let (enter, leave) = (enter * (1.0 - 2.0 * gamma(3)), leave * (1.0 + 2.0 * gamma(3)));
        (enter <= leave).then_some(enter)
    }
}
