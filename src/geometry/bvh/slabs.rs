//! A ray in a tree's space, and the test of eight boxes at a time.

use super::space::{power_of_two, reciprocal};
use super::{Node, Probe, Tree};
use crate::base::lanes::{Level, Mask, Real, Row, Single};
use crate::base::math::{DVec3, gamma, larger};

/// A ray as a tree's f32 filters see it: its direction scaled by a power of two, so that the longest component is of
/// 1..2, and begun near the tree if it comes from afar.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// Along each axis, for the planes of boxes that come first and for those that come last: 1 / direction and
    /// -origin / direction, with all that rounding may do taken off for the first and added for the others.
    enter: [[f32; 4]; 2],
    leave: [[f32; 4]; 2],
    /// A bit for each axis along which upper planes come first.
    octant: u32,
    pub origin: DVec3,
    /// How far off `origin` may be along each axis, in f64.
    pub error: f64,
    /// The ray's t at `origin`, and lengths of t here for one there.
    begin: f64,
    unit: f64,
}

/// Farther from the tree than this, rays begin near it instead. Ways through a tree's space are then shorter than 32.
pub(super) const AFAR: f64 = 4.0;

/// What is steeper than this along an axis is taken for as steep as this: within the tree's space it stays as close to a
/// plane as [`SLACK`] says.
pub(super) const STEEPEST: f64 = (1u64 << 40) as f64;

/// Added to the error of the origin, which it hardly changes: four times as far as rays that are steeper than
/// [`STEEPEST`] may go along an axis, so that they enter before 0 and leave after 32 whatever they are within.
pub(super) const SLACK: f64 = 128.0 / STEEPEST;

/// Half the distance from 1 to the next f32.
pub(super) const ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// Relative error of where a ray enters and leaves boxes, on both sides of a comparison.
pub(super) const SPREAD: f64 = 1.0 + 16.0 * ROUNDOFF;

/// Where a ray begins in a tree's space.
struct Start {
    origin: DVec3,
    error: f64,
    begin: f64,
}

impl Start {
    /// Near the tree, if the ray comes from afar; none if it passes by, or meets the tree beyond `t_max`.
    #[cold]
    #[inline(never)]
    fn approach(tree: &Tree, probe: &Probe, t_max: f64) -> Option<Self> {
        let scale = power_of_two(probe.ray.direction.abs().max_element());
        let (origin, error) =
            (tree.space.point(probe.ray.origin), tree.space.error(longest(probe.ray.origin)));
        let enter = tree.crossed(origin, probe.inverse * scale, error)?;
        // Comparisons are false for what is not a number: then the tree is walked.
        if enter > t_max * scale * tree.space.per * (1.0 + f64::EPSILON) {
            return None;
        }
        let begin = (enter - 0.5).max(0.0);
        let per_scale = reciprocal(scale);
        Some(Self {
            origin: origin + probe.ray.direction * per_scale * begin,
            error: error + (origin.abs().max_element() + 2.0 * begin) * (4.0 * f64::EPSILON),
            begin: begin * per_scale * tree.space.size,
        })
    }
}

#[inline(always)]
fn longest(v: DVec3) -> f64 {
    let v = v.abs();
    larger(larger(v.x, v.y), v.z)
}

impl Slabs {
    /// The ray in the tree's space; none if it comes from afar and passes by the whole tree, or meets it beyond `t_max`.
    #[inline(always)]
    pub fn new<L: Level>(tree: &Tree, probe: &Probe, t_max: f64) -> Option<Self> {
        let scale = power_of_two(probe.longest);
        let origin = tree.space.point(probe.ray.origin);
        let Start { origin, error, begin } = match longest(origin) <= AFAR {
            true => Start { origin, error: tree.space.error(longest(probe.ray.origin)), begin: 0.0 },
            false => Start::approach(tree, probe, t_max)?,
        };
        // The distance to a plane p along an axis is p·i - o·i. Of it, rounding i to f32 takes u of |p·i|, which is at
        // most |t| + |o·i|; rounding o·i takes u of that; and the product and the difference take u of p·i and t, where
        // they are rounded apart. That is 3u of |o·i| and 3u of |t|.
        let inverse = row::<L::F64>(probe.inverse) * L::F64::splat(scale);
        // The second for what is not a number.
        let steepness = inverse.abs().min(L::F64::splat(STEEPEST));
        let inverse = steepness.copysign(inverse);
        let offset = row::<L::F64>(-origin) * inverse;
        let off = offset.abs() * L::F64::splat(4.0 * ROUNDOFF) + steepness * L::F64::splat(error + SLACK);
        let spread = L::F64::splat(SPREAD);
        Some(Self {
            enter: [along_axes::<L>(inverse), along_axes::<L>(offset - off)],
            leave: [along_axes::<L>(inverse * spread), along_axes::<L>((offset + off) * spread)],
            octant: inverse.is_negative().bits() & 7,
            origin,
            error,
            begin,
            unit: scale * tree.space.per,
        })
    }

    /// 1 / direction along the axis where that is longest.
    #[inline]
    pub fn inverse_along(&self, longest: usize) -> f32 {
        self.enter[0][longest]
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

/// A vector in the first lanes, with numbers behind it that harm nobody.
#[inline(always)]
fn row<F: Real<Array = [f64; 8]>>(v: DVec3) -> F {
    F::from_array([v.x, v.y, v.z, 1.0, 1.0, 1.0, 1.0, 1.0])
}

/// The first lanes.
#[inline(always)]
fn along_axes<L: Level>(row: L::F64) -> [f32; 4] {
    let [x, y, z, ..] = row.to_f32().to_array();
    [x, y, z, 1.0]
}

/// [`Slabs`] in lanes.
#[derive(Clone, Copy)]
pub(super) struct Wide<S> {
    pub enter: [[S; 2]; 3],
    pub leave: [[S; 2]; 3],
    /// Along each axis whether upper planes come first.
    pub near: [usize; 3],
}

// No closures here: they would be compiled for less than the lanes need.
impl<S: Single<Array = [f32; 8]>> Wide<S> {
    #[inline(always)]
    pub fn new(slabs: &Slabs) -> Self {
        let nothing = [[S::splat(0.0); 2]; 3];
        let mut wide = Self { enter: nothing, leave: nothing, near: [0; 3] };
        for axis in 0..3 {
            for part in 0..2 {
                wide.enter[axis][part] = S::splat(slabs.enter[part][axis]);
                wide.leave[axis][part] = S::splat(slabs.leave[part][axis]);
            }
            wide.near[axis] = (slabs.octant >> axis & 1) as usize;
        }
        wide
    }

    /// Which of a node's boxes the ray may meet before `limit`, a bit each, and where it enters them at the earliest.
    #[inline(always)]
    pub fn test(&self, node: &Node, limit: f32) -> (u32, [f32; 8]) {
        // In pairs, as the next node has to wait for the last of these.
        let enter = self.enter(node, 0).max(S::splat(0.0));
        let enter = enter.max(self.enter(node, 1).max(self.enter(node, 2)));
        let leave = self.leave(node, 0).min(S::splat(limit * SPREAD as f32));
        let leave = leave.min(self.leave(node, 1).min(self.leave(node, 2)));
        (enter.le_bits(leave), enter.to_array())
    }

    #[inline(always)]
    fn enter(&self, node: &Node, axis: usize) -> S {
        let [inverse, offset] = self.enter[axis];
        S::from_array(node.planes[axis][self.near[axis] & 1]).mul_add(inverse, offset)
    }

    #[inline(always)]
    fn leave(&self, node: &Node, axis: usize) -> S {
        let [inverse, offset] = self.leave[axis];
        S::from_array(node.planes[axis][!self.near[axis] & 1]).mul_add(inverse, offset)
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
