//! Walking a tree along eight rays at once, which pays where they go the same way.

use super::slabs::{AFAR, ROUNDOFF, SLACK, SPREAD, STEEPEST, Wide};
use super::space::ROUNDING;
use super::walk::{Leaves, Stack, Walk};
use super::{Child, Node, Slabs, Tree};
use crate::math::{gamma, larger, smaller};
use crate::simd::{Lanes, Octo, Quad, Vector};

/// What a tree's leaves hold, while eight rays walk the tree.
pub trait BundleLeaves<L> {
    /// Whether a ray may go on alone. Not having what it needs for that, a bundle is begun sooner.
    const ALONE: bool;

    /// Tests what is in a leaf for the rays whose bits are set. Implementations are `#[inline(always)]`.
    fn visit(&mut self, leaf: u32, rays: u32);

    /// The limits beyond which nothing is of interest any more; below 0 for rays that have ended.
    fn limit(&self) -> L;

    /// Goes on along one of the rays alone, by [`Tree::walk_below`].
    fn part(&mut self, ray: usize, below: Branch);
}

/// What is below a node of a tree.
#[derive(Clone, Copy, Debug)]
pub struct Branch(Child);

/// So many rays go on alone.
const FEW: u32 = 1;

/// Eight rays as a tree's filters see them, like [`Slabs`](super::Slabs).
pub struct BundleSlabs<L: Lanes> {
    /// Along each axis 1 / direction and -origin / direction, for the planes of boxes that come first and last.
    enter: [[L; 2]; 3],
    leave: [[L; 2]; 3],
    /// Rays for which upper planes come first.
    backwards: [u32; 3],
    unit: Octo<L::Quad>,
    origin: [L; 3],
    error: L,
    /// What holds all rays, where they go the same way along every axis.
    hull: Option<Wide<L>>,
}

/// Rays along one axis: those of [`Slabs`](super::Slabs).
struct Along<L: Lanes> {
    enter: [L; 2],
    leave: [L; 2],
    /// Bits of rays that go backwards.
    backwards: u32,
    steepness: Octo<L::Quad>,
}

/// In trees of no more nodes, to find what holds all rays takes longer than to do without, and so does what a ray by itself
/// needs.
const SMALL: usize = 8;

impl<L: Lanes> BundleSlabs<L> {
    /// The rays in the tree's space, and a bit for each that may be walked along together with the others, and for each
    /// that comes from so far that it has to begin elsewhere. The others pass by the whole tree.
    #[inline(always)]
    pub fn new(
        tree: &Tree,
        from: Vector<L::Quad>,
        direction: Vector<L::Quad>,
        rays: u32,
    ) -> (Self, u32, u32) {
        let space = &tree.space;
        let per = Octo::splat(space.per);
        let origin = (from - Vector::splat(space.origin)) * per;
        let near = origin.longest().at_most(Octo::splat(AFAR)).bits() & rays;
        let scale = direction.longest().power_of_two();
        let error = from.longest().larger(Octo::splat(space.farthest)) * Octo::splat(space.per * ROUNDING);
        let error = error + Octo::splat(SLACK);
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
            hull = Some(Wide {
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
            unit: scale * per,
            origin: [L::load(&origin.x.narrow()), L::load(&origin.y.narrow()), L::load(&origin.z.narrow())],
            error: L::load(&error.narrow()),
            hull,
        };
        let afar = match rays & !near {
            0 => 0,
            afar => afar & tree.crossed_together(origin, direction, error),
        };
        (slabs, near, afar)
    }

    /// Along one axis, with the bounds of [`Slabs::new`](super::Slabs::new).
    #[inline(always)]
    fn along(
        origin: Octo<L::Quad>,
        direction: Octo<L::Quad>,
        scale: Octo<L::Quad>,
        error: Octo<L::Quad>,
    ) -> Along<L> {
        let inverse = Octo::splat(1.0) / direction * scale;
        let steepness = inverse.absolute().smaller(Octo::splat(STEEPEST));
        let inverse = steepness.signed_like(inverse);
        let offset = -origin * inverse;
        let off = offset.absolute() * Octo::splat(4.0 * ROUNDOFF) + error * steepness;
        let spread = Octo::splat(SPREAD);
        let enter = [L::load(&inverse.narrow()), L::load(&(offset - off).narrow())];
        let leave = [L::load(&(inverse * spread).narrow()), L::load(&((offset + off) * spread).narrow())];
        let backwards = inverse.signs();
        Along { enter, leave, backwards, steepness }
    }

    /// What holds the rays whose bits are set, along an axis along which all of them go backwards, or none: a box that
    /// lies ahead of the foremost origin is entered no earlier than by the least steep ray from there, and left no later
    /// than by the steepest from the hindmost origin. Both are rays like others, with the same bounds of their rounding;
    /// what is entered or left before the start is not told from what is so at the start.
    #[inline(always)]
    fn hull(
        origin: Octo<L::Quad>,
        steepness: Octo<L::Quad>,
        error: Octo<L::Quad>,
        forwards: bool,
        wanted: u32,
    ) -> [[L; 2]; 2] {
        let (origin, steepness, error) = (origin.store(), steepness.store(), error.store());
        let sign = if forwards { 1.0 } else { -1.0 };
        let (mut least, mut most) = (f64::INFINITY, 0.0);
        let (mut first, mut last) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut farthest_off = 0.0;
        for lane in 0..8 {
            if wanted >> lane & 1 == 1 {
                least = smaller(steepness[lane], least);
                most = larger(steepness[lane], most);
                first = larger(sign * origin[lane], first);
                last = smaller(sign * origin[lane], last);
                farthest_off = larger(error[lane], farthest_off);
            }
        }
        let pad = |offset: f64, steepness: f64| offset.abs() * (4.0 * ROUNDOFF) + farthest_off * steepness;
        let (enter, leave) = (-first * least, -last * most);
        let (enter, leave) = (enter - pad(enter, least), leave + pad(leave, most));
        [
            [L::splat((sign * least) as f32), L::splat(enter as f32)],
            [L::splat((sign * most * SPREAD) as f32), L::splat((leave * SPREAD) as f32)],
        ]
    }

    /// Where the rays start in the tree's space, in f32.
    #[inline(always)]
    pub fn origin(&self) -> [L; 3] {
        self.origin
    }

    /// How far off the rays' origins may be along each axis, before they are rounded to f32.
    #[inline(always)]
    pub fn error(&self) -> L {
        self.error
    }

    /// 1 / direction along an axis.
    #[inline(always)]
    pub fn inverse_along(&self, axis: usize) -> L {
        self.enter[axis % 3][0]
    }

    /// Limits of the rays' t in the filters' units, rounded up.
    #[inline(always)]
    pub fn limit(&self, t: Octo<L::Quad>) -> L {
        let limit = t * self.unit;
        L::load(&(limit + limit.absolute() * Octo::splat(4.0 * ROUNDOFF)).narrow())
    }

    /// The rays that may meet a node's child before their limits, and where they enter it.
    #[inline(always)]
    fn test(&self, node: &Node, slot: usize, limit: L) -> (u32, L) {
        let (x, y, z) = (self.planes(node, 0, slot), self.planes(node, 1, slot), self.planes(node, 2, slot));
        let enter = x.0.larger(L::splat(0.0)).larger(y.0.larger(z.0));
        let leave = x.1.smaller(limit.times(L::splat(SPREAD as f32))).smaller(y.1.smaller(z.1));
        (enter.at_most(leave), enter)
    }

    #[inline(always)]
    fn planes(&self, node: &Node, axis: usize, slot: usize) -> (L, L) {
        let [lower, upper] = &node.planes[axis];
        let (lower, upper) = (L::splat(lower[slot]), L::splat(upper[slot]));
        let backwards = self.backwards[axis];
        let (near, far) = match backwards {
            0 => (lower, upper),
            _ => (upper.pick(backwards, lower), lower.pick(backwards, upper)),
        };
        let ([a, b], [c, d]) = (self.enter[axis], self.leave[axis]);
        (near.times_plus(a, b), far.times_plus(c, d))
    }
}

/// A child that is put off, with where the first of its rays enters it, and the rays.
type Waiting = (f32, Child, u32);

/// Children put off at once. Where a deeper tree needs more, what is below a node is walked by recursion.
const STACK: usize = 64;

impl Tree {
    /// Whether the tree is too small for a hull of the rays, and for rays that go on alone.
    #[inline(always)]
    pub fn is_small(&self) -> bool {
        self.nodes.len() <= SMALL
    }

    /// The rays that may meet the tree's box, as `Tree::crossed` has it for one.
    #[inline(always)]
    fn crossed_together<Q: Quad>(&self, origin: Vector<Q>, direction: Vector<Q>, error: Octo<Q>) -> u32 {
        let (x, y, z) = (
            self.between(0, origin.x, direction.x, error),
            self.between(1, origin.y, direction.y, error),
            self.between(2, origin.z, direction.z, error),
        );
        let enter = x.0.larger(y.0.larger(z.0.larger(Octo::splat(0.0))));
        let leave = x.1.smaller(y.1.smaller(z.1.smaller(Octo::splat(f64::INFINITY))));
        let spread = Octo::splat(1.0 + 4.0 * gamma(3));
        enter.at_most(leave * spread).bits()
    }

    /// Where rays enter and leave the box along an axis. What is no number, for rays within a plane, bounds nothing.
    #[inline(always)]
    fn between<Q: Quad>(
        &self,
        axis: usize,
        origin: Octo<Q>,
        direction: Octo<Q>,
        error: Octo<Q>,
    ) -> (Octo<Q>, Octo<Q>) {
        let inverse = Octo::splat(1.0) / direction;
        let low = (Octo::splat(self.bounds[0][axis]) - error - origin) * inverse;
        let high = (Octo::splat(self.bounds[1][axis]) + error - origin) * inverse;
        let backwards = inverse.below(Octo::splat(0.0));
        (high.pick(backwards, low), low.pick(backwards, high))
    }

    /// Visits every leaf that the rays may meet.
    #[inline(always)]
    pub fn walk_together<L: Lanes>(
        &self,
        slabs: &BundleSlabs<L>,
        rays: u32,
        leaves: &mut impl BundleLeaves<L>,
    ) {
        if self.root != Child::NONE {
            self.walk_together_from(self.root, slabs, rays, leaves);
        }
    }

    #[inline(always)]
    fn walk_together_from<L: Lanes, T: BundleLeaves<L>>(
        &self,
        from: Child,
        slabs: &BundleSlabs<L>,
        mut rays: u32,
        leaves: &mut T,
    ) {
        let mut stack: [Waiting; STACK] = [(0.0, Child::NONE, 0); STACK];
        let (mut top, mut at) = (0, from);
        let few = if T::ALONE { FEW } else { 0 };
        loop {
            if let Some(leaf) = at.as_leaf() {
                leaves.visit(leaf, rays);
            } else if rays.count_ones() <= few {
                while rays != 0 {
                    leaves.part(rays.trailing_zeros() as usize & 7, Branch(at));
                    rays &= rays - 1;
                }
            } else {
                let (node, limit, bottom) = (&self.nodes[at.0 as usize], leaves.limit(), top);
                let mut candidates = 0xff;
                if let Some(hull) = &slabs.hull {
                    (candidates, _) = hull.test(node, f32::INFINITY);
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
                        self.walk_apart_together(child, slabs, met, leaves);
                        continue;
                    }
                    let waiting = (enter.store()[met.trailing_zeros() as usize & 7], child, met);
                    let mut place = top;
                    while place > bottom && stack[place - 1].0 < waiting.0 {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = waiting;
                    top += 1;
                }
            }
            let Some(next) = top.checked_sub(1) else { return };
            top = next;
            (_, at, rays) = stack[top];
        }
    }

    /// Walks what is below a node along a single ray, of which nothing beyond `limit` is of interest. Gives what is left of
    /// the limit, or none if a leaf has ended the walk.
    #[inline(always)]
    pub fn walk_below<L: Lanes>(
        &self,
        below: Branch,
        slabs: &Slabs,
        limit: f32,
        leaves: &mut impl Leaves,
    ) -> Option<f32> {
        L::apart(Walk { tree: self, slabs, leaves, limit, from: below.0, stack: &mut Stack::default() })
    }

    /// The same from another child on, out of line.
    #[cold]
    #[inline(never)]
    fn walk_apart_together<L: Lanes>(
        &self,
        from: Child,
        slabs: &BundleSlabs<L>,
        rays: u32,
        leaves: &mut impl BundleLeaves<L>,
    ) {
        self.walk_together_from(from, slabs, rays, leaves);
    }
}
