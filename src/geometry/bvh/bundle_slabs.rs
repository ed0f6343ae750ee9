//! Box tests of bundles of eight rays.

use super::bundle_rows::Rows;
use super::slabs::{AFAR, ROUNDOFF, SLACK, SPREAD, STEEPEST, WideSlabs};
use super::tree::{Node, Tree};
use super::tree_space::ROUNDING;
use crate::base::lanes::{Level, Mask, Real, Row, Select, Single, Vec3};
use crate::base::math::{LaneRay, gamma, max, min};

/// In trees of at most this many nodes, bundles take less time than single rays, whichever way the rays go, and a hull of
/// them takes longer than it saves.
const SMALL: usize = 8;

/// Eight rays in the form that the tree's box filters use, like [`Slabs`](super::Slabs).
pub struct BundleSlabs<L: Level> {
    /// Along each axis 1 / direction and -origin / direction, for the near and for the far planes of boxes.
    enter: [[L::F32; 2]; 3],
    leave: [[L::F32; 2]; 3],
    /// Along each axis, the bits of rays that enter boxes by their upper planes.
    backwards: [u32; 3],
    /// Whether the rays have the same sign along every axis.
    same_way: bool,
    unit: L::F64,
    /// Where the searches begin, in the filter's units, rounded down.
    from: L::F32,
    origin: [L::F32; 3],
    error: L::F32,
    /// The hull of all rays, if they go the same way along every axis and the tree is not small.
    pub(super) hull: Option<WideSlabs<L::F32>>,
    /// The rays one by one, if they do not and the tree is too large for a [sweep](Tree::sweep).
    pub(super) rows: Option<Rows>,
}

/// The rays along one axis, as in [`Slabs`](super::Slabs).
struct Along<L: Level> {
    enter: [L::F32; 2],
    leave: [L::F32; 2],
    /// Bits of the rays with a negative direction.
    backwards: u32,
    steepness: L::F64,
}

impl<L: Level> BundleSlabs<L> {
    /// Moves the rays into the tree's space, for hits beyond `after`. Also returns two bit sets: the rays that may be
    /// traversed as a bundle, and those whose origins are too far away and must start nearer. The remaining rays miss
    /// the whole tree.
    #[inline(always)]
    pub fn new(tree: &Tree, ray: &LaneRay<L::F64>, after: L::F64, rays: u32) -> (Self, u32, u32) {
        let direction = ray.direction;
        let per_world = L::F64::splat(tree.space.scale);
        let (origin, error) = tree.in_own_space(ray.origin);
        let near = origin.abs().max_element().le(L::F64::splat(AFAR)).bits() & rays;
        let scale = direction.abs().max_element().power_of_two();
        let x = Self::along(origin.x, direction.x, scale, error);
        let y = Self::along(origin.y, direction.y, scale, error);
        let z = Self::along(origin.z, direction.z, scale, error);
        let backwards = [x.backwards & near, y.backwards & near, z.backwards & near];
        let same_way = (backwards[0] == 0 || backwards[0] == near)
            && (backwards[1] == 0 || backwards[1] == near)
            && (backwards[2] == 0 || backwards[2] == near);
        let mut hull = None;
        if same_way && !tree.is_small() {
            let x = Self::hull(origin.x, x.steepness, error, backwards[0] == 0, near);
            let y = Self::hull(origin.y, y.steepness, error, backwards[1] == 0, near);
            let z = Self::hull(origin.z, z.steepness, error, backwards[2] == 0, near);
            hull = Some(WideSlabs {
                enter: [x[0], y[0], z[0]],
                leave: [x[1], y[1], z[1]],
                near: [
                    usize::from(backwards[0] != 0),
                    usize::from(backwards[1] != 0),
                    usize::from(backwards[2] != 0),
                ],
                from: L::F32::splat(0.0),
            });
        }
        let from = (after * scale * per_world * L::F64::splat(1.0 - 4.0 * ROUNDOFF)).to_f32();
        let (enter, leave) = ([x.enter, y.enter, z.enter], [x.leave, y.leave, z.leave]);
        let slabs = Self {
            rows: if same_way || tree.is_swept() {
                None
            } else {
                Some(Rows::new(enter, leave, backwards, from))
            },
            enter,
            leave,
            backwards,
            same_way,
            unit: scale * per_world,
            from,
            origin: [origin.x.to_f32(), origin.y.to_f32(), origin.z.to_f32()],
            error: error.to_f32(),
            hull,
        };
        let afar = match rays & !near {
            0 => 0,
            afar => {
                let (enter, leave) = tree.crossed_by_bundle(origin, direction, error);
                afar & enter.le(leave).bits()
            }
        };
        (slabs, near, afar)
    }

    /// One axis, with the error bounds of [`Slabs::new`](super::Slabs::new).
    #[inline(always)]
    fn along(origin: L::F64, direction: L::F64, scale: L::F64, error: L::F64) -> Along<L> {
        let inverse = L::F64::splat(1.0) / direction * scale;
        let steepness = inverse.abs().min(L::F64::splat(STEEPEST));
        let inverse = steepness.copysign(inverse);
        let offset = -origin * inverse;
        let off = offset.abs() * L::F64::splat(4.0 * ROUNDOFF) + error * steepness;
        let spread = L::F64::splat(SPREAD);
        let enter = [inverse.to_f32(), (offset - off).to_f32()];
        let leave = [(inverse * spread).to_f32(), ((offset + off) * spread).to_f32()];
        let backwards = inverse.is_negative().bits();
        Along { enter, leave, backwards, steepness }
    }

    /// The hull along one axis of the rays whose bits are set, which all have the same sign there. A box ahead of the
    /// foremost origin is entered no earlier than by the least steep ray from that origin. It is left no later than by
    /// the steepest ray from the hindmost origin. Both are ordinary rays with the same rounding bounds. Boxes behind
    /// the start count as boxes at the start.
    #[inline(always)]
    fn hull(
        origin: L::F64,
        steepness: L::F64,
        error: L::F64,
        forwards: bool,
        wanted: u32,
    ) -> [[L::F32; 2]; 2] {
        let (origin, steepness, error) = (origin.to_array(), steepness.to_array(), error.to_array());
        let sign = if forwards { 1.0 } else { -1.0 };
        let (mut least, mut most) = (f64::INFINITY, 0.0);
        let (mut first, mut last) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut farthest_off = 0.0;
        for lane in 0..8 {
            if wanted >> lane & 1 == 1 {
                least = min(steepness[lane], least);
                most = max(steepness[lane], most);
                first = max(sign * origin[lane], first);
                last = min(sign * origin[lane], last);
                farthest_off = max(error[lane], farthest_off);
            }
        }
        let pad = |offset: f64, steepness: f64| offset.abs() * (4.0 * ROUNDOFF) + farthest_off * steepness;
        let (enter, leave) = (-first * least, -last * most);
        let (enter, leave) = (enter - pad(enter, least), leave + pad(leave, most));
        [
            [L::F32::splat((sign * least) as f32), L::F32::splat(enter as f32)],
            [L::F32::splat((sign * most * SPREAD) as f32), L::F32::splat((leave * SPREAD) as f32)],
        ]
    }

    /// Whether these rays [sweep](Tree::sweep) a tree. Where rays go the same way, most of them meet the same few boxes, so
    /// the branches of a walk can be predicted.
    #[inline(always)]
    pub(super) fn sweeps(&self, tree: &Tree) -> bool {
        !self.same_way && tree.is_swept()
    }

    /// The origins in the tree's space, in f32.
    #[inline(always)]
    pub fn origin(&self) -> [L::F32; 3] {
        self.origin
    }

    /// Error of the origins along each axis, before they are rounded to f32.
    #[inline(always)]
    pub fn error(&self) -> L::F32 {
        self.error
    }

    /// 1 / direction along an axis.
    #[inline(always)]
    pub fn inverse_along(&self, axis: usize) -> L::F32 {
        self.enter[axis % 3][0]
    }

    /// Limits t in the filter's units, rounded up.
    #[inline(always)]
    pub fn limit(&self, t: L::F64) -> L::F32 {
        let limit = t * self.unit;
        (limit + limit.abs() * L::F64::splat(4.0 * ROUNDOFF)).to_f32()
    }

    /// The largest limit of all rays if there is a hull to compare it with. Otherwise infinite, because finding the
    /// largest takes longer than it saves.
    #[inline(always)]
    pub(super) fn farthest(&self, limit: L::F32) -> f32 {
        if self.hull.is_some() { largest(limit) } else { f32::INFINITY }
    }

    /// The rays that may hit a node's child before their limits, and where they enter it.
    #[inline(always)]
    pub(super) fn test(&self, node: &Node, slot: usize, limit: L::F32) -> (u32, L::F32) {
        let (x, y, z) = (self.planes(node, 0, slot), self.planes(node, 1, slot), self.planes(node, 2, slot));
        let enter = x.0.max(self.from).max(y.0.max(z.0));
        let leave = x.1.min(limit * L::F32::splat(SPREAD as f32)).min(y.1.min(z.1));
        (enter.le_bits(leave), enter)
    }

    #[inline(always)]
    fn planes(&self, node: &Node, axis: usize, slot: usize) -> (L::F32, L::F32) {
        let [lower, upper] = &node.planes[axis];
        let (lower, upper) = (L::F32::splat(lower[slot]), L::F32::splat(upper[slot]));
        let backwards = self.backwards[axis];
        let (near, far) = match backwards {
            0 => (lower, upper),
            _ => {
                let backwards = L::Mask::from_bits(backwards);
                (L::F32::select(backwards, upper, lower), L::F32::select(backwards, lower, upper))
            }
        };
        let ([a, b], [c, d]) = (self.enter[axis], self.leave[axis]);
        (near.mul_add(a, b), far.mul_add(c, d))
    }
}

impl Tree {
    /// Whether bundles are faster than single rays in any case, and need no hull.
    #[inline(always)]
    pub fn is_small(&self) -> bool {
        self.nodes.len() <= SMALL
    }

    /// The origins of rays in the tree's space, and their error along each axis, with [`SLACK`].
    #[inline(always)]
    fn in_own_space<F: Real>(&self, from: Vec3<F>) -> (Vec3<F>, F) {
        let space = &self.space;
        let origin = (from - Vec3::splat(space.origin)) * F::splat(space.scale);
        let farthest = from.abs().max_element().max(F::splat(space.farthest));
        (origin, farthest * F::splat(space.scale * ROUNDING) + F::splat(SLACK))
    }

    /// The rays that may hit the tree's primitives before these limits of t, by its bounds.
    #[inline(always)]
    pub fn may_hit<F: Real>(&self, ray: &LaneRay<F>, limit: F) -> F::Mask {
        let (origin, error) = self.in_own_space(ray.origin);
        let (enter, leave) = self.crossed_by_bundle(origin, ray.direction, error);
        let limit = limit * F::splat(self.space.scale);
        enter.le(leave) & enter.le(limit + limit.abs() * F::splat(4.0 * ROUNDOFF))
    }

    /// Where rays enter and leave the bounds of the tree: `Tree::crossed` for eight rays.
    #[inline(always)]
    fn crossed_by_bundle<F: Real>(&self, origin: Vec3<F>, direction: Vec3<F>, error: F) -> (F, F) {
        let (x, y, z) = (
            self.between(0, origin.x, direction.x, error),
            self.between(1, origin.y, direction.y, error),
            self.between(2, origin.z, direction.z, error),
        );
        let enter = x.0.max(y.0.max(z.0.max(F::splat(0.0))));
        let leave = x.1.min(y.1.min(z.1.min(F::splat(f64::INFINITY))));
        (enter, leave * F::splat(1.0 + 4.0 * gamma(3)))
    }

    /// Where rays enter and leave the bounds along an axis. NaN, from rays within a plane, does not limit the
    /// interval.
    #[inline(always)]
    fn between<F: Real>(&self, axis: usize, origin: F, direction: F, error: F) -> (F, F) {
        let inverse = F::splat(1.0) / direction;
        let low = (F::splat(self.bounds[0][axis]) - error - origin) * inverse;
        let high = (F::splat(self.bounds[1][axis]) + error - origin) * inverse;
        let backwards = inverse.lt(F::splat(0.0));
        (F::select(backwards, high, low), F::select(backwards, low, high))
    }
}

/// The largest of all lanes; infinite if one is NaN.
#[inline(always)]
fn largest<S: Single<Array = [f32; 8]>>(row: S) -> f32 {
    let infinite = S::splat(f32::INFINITY);
    let [a, b, c, d, e, f, g, h] = S::select(row.le(infinite), row, infinite).to_array();
    let (a, b, c, d) = (Single::max(a, e), Single::max(b, f), Single::max(c, g), Single::max(d, h));
    Single::max(Single::max(a, c), Single::max(b, d))
}
