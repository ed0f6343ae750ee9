//! A ray in a tree's space, and the slab test of eight boxes at a time.

use super::TraversalRay;
use super::tree::{Node, Tree};
use super::tree_space::{power_of_two, reciprocal};
use crate::base::lanes::{Level, Mask, Real, Row, Single};
use crate::base::math::{DVec3, gamma, max};

/// A ray in the form that the tree's f32 filters use. Its direction is scaled by a power of two, so that the longest
/// component is in 1..2. If its origin is far away, the ray starts near the tree instead.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// For the near and for the far planes of boxes: 1 / direction and -origin / direction along each axis. The
    /// rounding error is subtracted from the near values and added to the far ones.
    enter: [[f32; 4]; 2],
    leave: [[f32; 4]; 2],
    /// A bit for each axis along which the ray enters boxes by their upper planes.
    octant: u32,
    pub origin: DVec3,
    /// Error of `origin` along each axis, in f64.
    pub error: f64,
    /// The ray's t at `origin`, and the factor from the ray's t to the filter's units.
    begin: f64,
    unit: f64,
    /// Where the search begins, in the filter's units, rounded down: no hit is before it.
    from: f32,
}

/// Rays whose origin is farther from the tree than this start near the tree instead. Segments in the tree's space are
/// then shorter than 32.
pub(super) const AFAR: f64 = 4.0;

/// Steeper inverse directions are clamped to this. Such a ray stays within [`SLACK`] of a plane inside the tree's
/// space.
pub(super) const STEEPEST: f64 = (1u64 << 40) as f64;

/// Added to the error of the origin, which hardly changes it. It is four times as far as a ray steeper than
/// [`STEEPEST`] moves along an axis. So such a ray enters any box around it before 0 and leaves it after 32.
pub(super) const SLACK: f64 = 128.0 / STEEPEST;

/// A search along a ray visits every box that is nearer than this to a point of the ray, in the tree's space. `SLACK` is
/// four times what rays steeper than `STEEPEST` need. This is a small part of the rest.
pub const CLEARANCE: f64 = SLACK / 256.0;

/// Half the distance from 1 to the next f32.
pub(super) const ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// Relative error of entry and exit distances, for both sides of a comparison.
pub(super) const SPREAD: f64 = 1.0 + 16.0 * ROUNDOFF;

/// Where a ray starts in a tree's space.
struct Start {
    origin: DVec3,
    error: f64,
    begin: f64,
}

impl Start {
    /// A start near the tree for a ray whose origin is far away. None if the ray misses the tree or hits it beyond
    /// `t_max`.
    #[cold]
    #[inline(never)]
    fn approach(tree: &Tree, ray: &TraversalRay, t_max: f64) -> Option<Self> {
        let scale = power_of_two(ray.ray.direction.abs().max_element());
        let (origin, error) = (tree.space.point(ray.ray.origin), tree.space.error(longest(ray.ray.origin)));
        let enter = tree.crossed(origin, ray.inverse * scale, error)?;
        // Comparisons with NaN are false: then the tree is traversed.
        if enter > t_max * scale * tree.space.scale * (1.0 + f64::EPSILON) {
            return None;
        }
        let begin = (enter - 0.5).max(0.0);
        let per_scale = reciprocal(scale);
        Some(Self {
            origin: origin + ray.ray.direction * per_scale * begin,
            error: error + (origin.abs().max_element() + 2.0 * begin) * (4.0 * f64::EPSILON),
            begin: begin * per_scale * tree.space.size,
        })
    }
}

#[inline(always)]
fn longest(v: DVec3) -> f64 {
    let v = v.abs();
    max(max(v.x, v.y), v.z)
}

impl Slabs {
    /// The ray in the tree's space, for hits beyond `after`. None if its origin is far away and it misses the tree, or
    /// hits it beyond `t_max`.
    #[inline(always)]
    pub fn new<L: Level>(tree: &Tree, ray: &TraversalRay, [after, t_max]: [f64; 2]) -> Option<Self> {
        let scale = power_of_two(ray.longest);
        let origin = tree.space.point(ray.ray.origin);
        let Start { origin, error, begin } = match longest(origin) <= AFAR {
            true => Start { origin, error: tree.space.error(longest(ray.ray.origin)), begin: 0.0 },
            false => Start::approach(tree, ray, t_max)?,
        };
        // The distance to a plane p along an axis is p·i - o·i. Rounding i to f32 costs u of |p·i|, which is at most
        // |t| + |o·i|. Rounding o·i costs u of that. The product and the difference cost u of p·i and of t if they are
        // rounded separately. The sum is 3u of |o·i| and 3u of |t|.
        let inverse = row::<L::F64>(ray.inverse) * L::F64::splat(scale);
        // `min` returns its second argument if the first is NaN.
        let steepness = inverse.abs().min(L::F64::splat(STEEPEST));
        let inverse = steepness.copysign(inverse);
        let offset = row::<L::F64>(-origin) * inverse;
        let off = offset.abs() * L::F64::splat(4.0 * ROUNDOFF) + steepness * L::F64::splat(error + SLACK);
        let spread = L::F64::splat(SPREAD);
        let unit = scale * tree.space.scale;
        // Rays that start near the tree lose digits of t there.
        let from = if begin == 0.0 { after * unit * (1.0 - 4.0 * ROUNDOFF) } else { 0.0 };
        Some(Self {
            enter: [along_axes::<L>(inverse), along_axes::<L>(offset - off)],
            leave: [along_axes::<L>(inverse * spread), along_axes::<L>((offset + off) * spread)],
            octant: inverse.is_negative().bits() & 7,
            origin,
            error,
            begin,
            unit,
            from: from as f32,
        })
    }

    /// 1 / direction along the axis where the direction is longest.
    #[inline]
    pub fn inverse_along(&self, longest: usize) -> f32 {
        self.enter[0][longest]
    }

    /// A limit t in the filter's units, rounded up: no hit before `t` is beyond it.
    #[inline]
    pub fn limit(&self, t: f64) -> f32 {
        let limit = (t - self.begin) * self.unit;
        (limit + limit.abs() * (4.0 * ROUNDOFF)) as f32
    }

    /// The ray's t = 0 in the filter's units, rounded down.
    #[inline]
    pub fn start(&self) -> f32 {
        -(self.begin * self.unit * (1.0 + 4.0 * ROUNDOFF)) as f32
    }
}

/// A vector in the first lanes, with harmless numbers in the others.
#[inline(always)]
fn row<F: Real<Array = [f64; 8]>>(v: DVec3) -> F {
    F::from_array([v.x, v.y, v.z, 1.0, 1.0, 1.0, 1.0, 1.0])
}

/// The first three lanes.
#[inline(always)]
fn along_axes<L: Level>(row: L::F64) -> [f32; 4] {
    let [x, y, z, ..] = row.to_f32().to_array();
    [x, y, z, 1.0]
}

/// [`Slabs`] splat to lanes.
#[derive(Clone, Copy)]
pub(super) struct WideSlabs<S> {
    pub enter: [[S; 2]; 3],
    pub leave: [[S; 2]; 3],
    /// Along each axis, the index of the near plane: 1 if the ray enters boxes by their upper planes.
    pub near: [usize; 3],
    /// Where the search begins. Boxes behind it are left out.
    pub from: S,
}

// No closures here: they would be compiled without the level's instructions.
impl<S: Single<Array = [f32; 8]>> WideSlabs<S> {
    #[inline(always)]
    pub fn new(slabs: &Slabs) -> Self {
        let nothing = [[S::splat(0.0); 2]; 3];
        let mut wide = Self { enter: nothing, leave: nothing, near: [0; 3], from: S::splat(slabs.from) };
        for axis in 0..3 {
            for part in 0..2 {
                wide.enter[axis][part] = S::splat(slabs.enter[part][axis]);
                wide.leave[axis][part] = S::splat(slabs.leave[part][axis]);
            }
            wide.near[axis] = (slabs.octant >> axis & 1) as usize;
        }
        wide
    }

    /// The boxes of a node that the ray may hit before `limit`, a bit each, and a lower bound of where it enters them.
    #[inline(always)]
    pub fn test(&self, node: &Node, limit: f32) -> (u32, [f32; 8]) {
        let (enter, leave) = self.crossings(node, limit * SPREAD as f32);
        (enter.le_bits(leave), enter.to_array())
    }

    /// Lower bounds of where the ray enters the boxes of a node, and upper bounds of where it leaves them or reaches
    /// `limit`.
    #[inline(always)]
    pub fn crossings(&self, node: &Node, limit: f32) -> (S, S) {
        // In pairs, because the next node waits for the last of these operations.
        let enter = self.enter(node, 0).max(self.from);
        let enter = enter.max(self.enter(node, 1).max(self.enter(node, 2)));
        let leave = self.leave(node, 0).min(S::splat(limit));
        let leave = leave.min(self.leave(node, 1).min(self.leave(node, 2)));
        (enter, leave)
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
    /// Where a ray enters the bounds of the tree in its space; none if it misses them. In f64, with the rounding of
    /// the distances (gamma(3), Ize 2013) and of the origin.
    #[inline(always)]
    fn crossed(&self, origin: DVec3, inverse: DVec3, error: f64) -> Option<f64> {
        let (mut enter, mut leave) = (0.0, f64::INFINITY);
        for axis in 0..3 {
            let a = (self.bounds[0][axis] - error - origin[axis]) * inverse[axis];
            let b = (self.bounds[1][axis] + error - origin[axis]) * inverse[axis];
            let (near, far) = if inverse[axis].is_sign_positive() { (a, b) } else { (b, a) };
            // A ray within a plane gives 0·∞ = NaN: the comparisons keep the previous value.
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
