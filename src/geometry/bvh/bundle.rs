//! Traversal along a bundle of eight rays, which pays if they go the same way.

use super::Slabs;
use super::slabs::{AFAR, ROUNDOFF, SLACK, SPREAD, STEEPEST, WideSlabs};
use super::traversal::{LeafVisitor, Stack, Traversal};
use super::tree::{Child, Node, Tree};
use super::tree_space::ROUNDING;
use crate::base::lanes::{LaneKernel, Level, Mask, Real, Row, Select, Single, Vec3};
use crate::base::math::{gamma, max, min};

/// Visits the leaves of a tree that a bundle of rays may hit.
pub trait BundleVisitor<L: Level> {
    /// Whether single rays may leave the bundle. If not, their data need not be stored, and a bundle starts sooner.
    const ALONE: bool;

    /// Tests the primitives of a leaf for the rays whose bits are set. Implementations are `#[inline(always)]`.
    fn visit(&mut self, leaf: u32, rays: u32);

    /// The search limit of each ray, in the filter's units; below 0 for rays that have ended.
    fn limit(&self) -> L::F32;

    /// Continues the search of one ray on its own with [`Tree::walk_below`].
    fn continue_alone(&mut self, ray: usize, below: NodeRef);
}

/// A reference to a node of a tree, for [`Tree::walk_below`].
#[derive(Clone, Copy, Debug)]
pub struct NodeRef(Child);

/// Up to this number of rays, each continues on its own.
const FEW: u32 = 1;

/// Eight rays in the form that the tree's box filters use, like [`Slabs`](super::Slabs).
pub struct BundleSlabs<L: Level> {
    /// Along each axis 1 / direction and -origin / direction, for the near and for the far planes of boxes.
    enter: [[L::F32; 2]; 3],
    leave: [[L::F32; 2]; 3],
    /// Along each axis, the bits of rays that enter boxes by their upper planes.
    backwards: [u32; 3],
    unit: L::F64,
    origin: [L::F32; 3],
    error: L::F32,
    /// The hull of all rays, if they go the same way along every axis.
    hull: Option<WideSlabs<L::F32>>,
}

/// The rays along one axis, as in [`Slabs`](super::Slabs).
struct Along<L: Level> {
    enter: [L::F32; 2],
    leave: [L::F32; 2],
    /// Bits of the rays with a negative direction.
    backwards: u32,
    steepness: L::F64,
}

/// In trees of at most this many nodes, computing a hull takes longer than it saves, and so does preparing single
/// rays.
const SMALL: usize = 8;

impl<L: Level> BundleSlabs<L> {
    /// Moves the rays into the tree's space. Also returns two bit sets: the rays that may be traversed as a bundle,
    /// and those whose origins are too far away and must start nearer. The remaining rays miss the whole tree.
    #[inline(always)]
    pub fn new(tree: &Tree, from: Vec3<L::F64>, direction: Vec3<L::F64>, rays: u32) -> (Self, u32, u32) {
        let space = &tree.space;
        let per_world = L::F64::splat(space.scale);
        let origin = (from - Vec3::splat(space.origin)) * per_world;
        let near = origin.abs().max_element().le(L::F64::splat(AFAR)).bits() & rays;
        let scale = direction.abs().max_element().power_of_two();
        let error = from.abs().max_element().max(L::F64::splat(space.farthest))
            * L::F64::splat(space.scale * ROUNDING);
        let error = error + L::F64::splat(SLACK);
        let x = Self::along(origin.x, direction.x, scale, error);
        let y = Self::along(origin.y, direction.y, scale, error);
        let z = Self::along(origin.z, direction.z, scale, error);
        let backwards = [x.backwards & near, y.backwards & near, z.backwards & near];
        let mut hull = None;
        if !tree.is_small()
            && (backwards[0] == 0 || backwards[0] == near)
            && (backwards[1] == 0 || backwards[1] == near)
            && (backwards[2] == 0 || backwards[2] == near)
        {
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
            });
        }
        let slabs = Self {
            enter: [x.enter, y.enter, z.enter],
            leave: [x.leave, y.leave, z.leave],
            backwards,
            unit: scale * per_world,
            origin: [origin.x.to_f32(), origin.y.to_f32(), origin.z.to_f32()],
            error: error.to_f32(),
            hull,
        };
        let afar = match rays & !near {
            0 => 0,
            afar => afar & tree.crossed_by_bundle(origin, direction, error),
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
    fn farthest(&self, limit: L::F32) -> f32 {
        if self.hull.is_some() { largest(limit) } else { f32::INFINITY }
    }

    /// The rays that may hit a node's child before their limits, and where they enter it.
    #[inline(always)]
    fn test(&self, node: &Node, slot: usize, limit: L::F32) -> (u32, L::F32) {
        let (x, y, z) = (self.planes(node, 0, slot), self.planes(node, 1, slot), self.planes(node, 2, slot));
        let enter = x.0.max(L::F32::splat(0.0)).max(y.0.max(z.0));
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

/// A postponed child: where its first ray enters it, a lower bound of that for all rays, the child, and the bits of
/// its rays.
type Waiting = (f32, f32, Child, u32);

/// Capacity of the stack. Where a deeper tree needs more, the subtree is traversed by recursion.
const STACK: usize = 64;

/// Memory for the postponed children of a walk. Its content before and after a walk has no meaning.
pub struct BundleStack([Waiting; STACK]);

impl Default for BundleStack {
    fn default() -> Self {
        Self([(0.0, 0.0, Child::NONE, 0); STACK])
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

impl Tree {
    /// Whether the tree is too small for a hull of the rays and for single rays.
    #[inline(always)]
    pub fn is_small(&self) -> bool {
        self.nodes.len() <= SMALL
    }

    /// The rays that may hit the bounds of the tree: `Tree::crossed` for eight rays.
    #[inline(always)]
    fn crossed_by_bundle<F: Real>(&self, origin: Vec3<F>, direction: Vec3<F>, error: F) -> u32 {
        let (x, y, z) = (
            self.between(0, origin.x, direction.x, error),
            self.between(1, origin.y, direction.y, error),
            self.between(2, origin.z, direction.z, error),
        );
        let enter = x.0.max(y.0.max(z.0.max(F::splat(0.0))));
        let leave = x.1.min(y.1.min(z.1.min(F::splat(f64::INFINITY))));
        enter.le(leave * F::splat(1.0 + 4.0 * gamma(3))).bits()
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

    /// Visits every leaf that the rays may hit.
    #[inline(always)]
    pub fn walk_bundle<L: Level>(
        &self,
        slabs: &BundleSlabs<L>,
        rays: u32,
        leaves: &mut impl BundleVisitor<L>,
        stack: &mut BundleStack,
    ) {
        if self.root != Child::NONE {
            self.walk_bundle_from(self.root, slabs, rays, leaves, stack);
        }
    }

    #[inline(always)]
    fn walk_bundle_from<L: Level, T: BundleVisitor<L>>(
        &self,
        from: Child,
        slabs: &BundleSlabs<L>,
        mut rays: u32,
        leaves: &mut T,
        BundleStack(stack): &mut BundleStack,
    ) {
        let (mut top, mut at) = (0, from);
        let few = if T::ALONE { FEW } else { 0 };
        let mut farthest = slabs.farthest(leaves.limit());
        loop {
            if let Some(leaf) = at.as_leaf() {
                leaves.visit(leaf, rays);
                farthest = slabs.farthest(leaves.limit());
            } else if rays.count_ones() <= few {
                while rays != 0 {
                    leaves.continue_alone(rays.trailing_zeros() as usize & 7, NodeRef(at));
                    rays &= rays - 1;
                }
                farthest = slabs.farthest(leaves.limit());
            } else {
                let (node, limit, bottom) = (&self.nodes[at.0 as usize], leaves.limit(), top);
                let (mut candidates, mut least) = (0xff, [0.0; 8]);
                if let Some(hull) = &slabs.hull {
                    (candidates, least) = hull.test(node, farthest);
                }
                while candidates != 0 {
                    let slot = candidates.trailing_zeros() as usize & 7;
                    candidates &= candidates - 1;
                    let child = node.children[slot];
                    if child == Child::NONE {
                        continue;
                    }
                    let (met, enter) = slabs.test(node, slot, limit);
                    let met = met & rays;
                    if met == 0 {
                        continue;
                    }
                    if top == STACK {
                        L::call_with(Below { tree: self, from: child, slabs, rays: met, leaves });
                        continue;
                    }
                    let first = enter.to_array()[met.trailing_zeros() as usize & 7];
                    let waiting = (first, least[slot], child, met);
                    let mut place = top;
                    while place > bottom && stack[place - 1].0 < waiting.0 {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = waiting;
                    top += 1;
                }
            }
            // Skips children that the hull enters beyond all limits.
            loop {
                let Some(next) = top.checked_sub(1) else { return };
                top = next;
                let (_, least, child, met) = stack[top];
                if least <= farthest {
                    (at, rays) = (child, met);
                    break;
                }
            }
        }
    }

    /// Traverses the subtree below a node along a single ray up to `limit`. Returns the remaining limit, or none if a
    /// leaf ended the walk.
    #[inline(always)]
    pub fn walk_below<L: Level>(
        &self,
        below: NodeRef,
        slabs: &Slabs,
        limit: f32,
        leaves: &mut impl LeafVisitor,
    ) -> Option<f32> {
        L::Narrow::call(Traversal {
            tree: self,
            slabs,
            leaves,
            limit,
            from: below.0,
            stack: &mut Stack::default(),
        })
    }
}

/// A walk from another child on, out of line.
struct Below<'a, L: Level, T> {
    tree: &'a Tree,
    from: Child,
    slabs: &'a BundleSlabs<L>,
    rays: u32,
    leaves: &'a mut T,
}

impl<L: Level, T: BundleVisitor<L>> LaneKernel<L> for Below<'_, L, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { tree, from, slabs, rays, leaves } = self;
        tree.walk_bundle_from(from, slabs, rays, leaves, &mut BundleStack::default());
    }
}
