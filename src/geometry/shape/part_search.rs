//! Searches through the trees of shapes of many parts, along single rays.

use super::lane_search::{first_hits, search_each};
use super::nearest_part::NearestPart;
use super::{LaneHit, PreparedRay, RayInterval, ShapeHit};
use crate::base::lanes::{Level, Mask, Real, SimdKernel};
use crate::base::math::LaneRay;
use crate::geometry::bvh::{LeafVisitor, Slabs, Stack, TraversalRay, Tree};

/// A shape of many parts in the leaves of a tree.
///
/// Its functions test the parts of one leaf, and are `#[inline(always)]`.
pub trait PartedShape: Sized {
    /// The parts of a leaf.
    type Packet;
    /// What all leaves need of the ray. It is computed at the first one.
    type Prepared;

    fn tree(&self) -> &Tree;
    /// The parts of each of the tree's leaves.
    fn packets(&self) -> &[Self::Packet];

    /// Considers the parts that are hit before `limit`. Returns the new limit.
    fn nearest_in<L: Level>(
        search: &mut PartSearch<Self, NearestPart>,
        leaf: u32,
        slabs: &Slabs,
        limit: f32,
    ) -> f32;
    /// Whether any part is hit before `limit`.
    fn any_in<L: Level>(search: &mut PartSearch<Self, AnyPart>, leaf: u32, slabs: &Slabs, limit: f32)
    -> bool;
    /// Passes all hits within its bounds on. None of them is beyond `limit`.
    fn every_in<L: Level>(search: &mut PartSearch<Self, EveryPart>, leaf: u32, slabs: &Slabs, limit: f32);
}

/// A search of a shape along a ray, for the nearest part, any part or every part.
pub struct PartSearch<'a, S: PartedShape, K> {
    pub shape: &'a S,
    pub ray: &'a TraversalRay,
    pub prepared: Option<S::Prepared>,
    pub kept: K,
}

/// Whether there is a part within an interval of t.
pub struct AnyPart {
    pub within: RayInterval<f64>,
    pub found: bool,
}

/// All hits within an interval of t, in no particular order.
pub struct EveryPart<'a> {
    pub within: RayInterval<f64>,
    pub take: &'a mut dyn FnMut(ShapeHit),
}

impl<'a, S: PartedShape> PartSearch<'a, S, NearestPart> {
    #[inline(always)]
    pub fn nearest(shape: &'a S, ray: &'a TraversalRay, within: RayInterval<f64>) -> Self {
        let range = PreparedRay::splat(ray).coincidence_range(shape.tree().space().reach());
        Self { shape, ray, prepared: None, kept: NearestPart::new(within, range) }
    }
}

impl<'a, S: PartedShape> PartSearch<'a, S, AnyPart> {
    #[inline(always)]
    pub fn any(shape: &'a S, ray: &'a TraversalRay, within: RayInterval<f64>) -> Self {
        Self { shape, ray, prepared: None, kept: AnyPart { within, found: false } }
    }
}

/// The closest part within bounds; of equally near ones, the one with the lowest index.
pub fn nearest_part(
    shape: &impl PartedShape,
    ray: &TraversalRay,
    within: RayInterval<f64>,
) -> Option<ShapeHit> {
    let mut search = PartSearch::nearest(shape, ray, within);
    shape.tree().walk(ray, [within.min, within.max], &mut search);
    search.kept.hit
}

/// `nearest_part` within a kernel that already runs on a level, with the caller's stack if it has one.
#[inline(always)]
pub fn nearest_part_on<L: Level>(
    shape: &impl PartedShape,
    ray: &TraversalRay,
    within: RayInterval<f64>,
    stack: Option<&mut Stack>,
) -> Option<ShapeHit> {
    let (mut search, mut own) = (PartSearch::nearest(shape, ray, within), None);
    let stack = stack.unwrap_or_else(|| own.insert(Stack::default()));
    search.kept.isolates = stack.isolates;
    L::Narrow::call(Walk { search, span: [within.min, within.max], stack }).hit
}

/// Whether there is a part within bounds.
pub fn any_part(shape: &impl PartedShape, ray: &TraversalRay, within: RayInterval<f64>) -> bool {
    let mut search = PartSearch::any(shape, ray, within);
    shape.tree().walk(ray, [within.min, within.max], &mut search);
    search.kept.found
}

/// `any_part` within a kernel that already runs on a level, with the caller's stack if it has one.
#[inline(always)]
pub fn any_part_on<L: Level>(
    shape: &impl PartedShape,
    ray: &TraversalRay,
    within: RayInterval<f64>,
    stack: Option<&mut Stack>,
) -> bool {
    let (search, mut own) = (PartSearch::any(shape, ray, within), None);
    let stack = stack.unwrap_or_else(|| own.insert(Stack::default()));
    L::Narrow::call(Walk { search, span: [within.min, within.max], stack }).found
}

/// The intervals of rays that may hit the box around a shape; empty for the others.
#[inline(always)]
fn within_box<F: Real>(shape: &impl PartedShape, ray: &LaneRay<F>, within: RayInterval<F>) -> RayInterval<F> {
    let near = shape.tree().may_hit(ray, within.max);
    RayInterval { min: within.min, max: F::select(near, within.max, F::splat(-1.0)) }
}

/// [`nearest_part`] of each ray, one after the other: for rays that go different ways.
#[inline(always)]
pub fn nearest_part_of_each<F: Real>(
    shape: &impl PartedShape,
    ray: &LaneRay<F>,
    within: RayInterval<F>,
    stack: &mut Stack,
) -> LaneHit<F> {
    let within = within_box(shape, ray, within);
    first_hits(ray, within, |ray, span| nearest_part_on::<F::Level>(shape, ray, span, Some(stack)))
}

/// [`any_part`] of each ray, one after the other: for rays that go different ways.
#[inline(always)]
pub fn any_part_of_each<F: Real>(
    shape: &impl PartedShape,
    ray: &LaneRay<F>,
    within: RayInterval<F>,
    stack: &mut Stack,
) -> F::Mask {
    let mut found = 0;
    search_each(ray, within_box(shape, ray, within), |lane, ray, span| {
        found |= u32::from(any_part_on::<F::Level>(shape, ray, span, Some(stack))) << lane;
    });
    F::Mask::from_bits(found)
}

/// Passes all hits within bounds to `take`, in no particular order.
pub fn every_part(
    shape: &impl PartedShape,
    ray: &TraversalRay,
    within: RayInterval<f64>,
    take: &mut dyn FnMut(ShapeHit),
) {
    let mut search = PartSearch { shape, ray, prepared: None, kept: EveryPart { within, take } };
    shape.tree().walk(ray, [within.min, within.max], &mut search);
}

/// A search from the root.
struct Walk<'a, 's, S: PartedShape, K> {
    search: PartSearch<'a, S, K>,
    span: [f64; 2],
    stack: &'s mut Stack,
}

impl<'a, S: PartedShape, K> SimdKernel for Walk<'a, '_, S, K>
where
    PartSearch<'a, S, K>: LeafVisitor,
{
    type Output = K;

    #[inline(always)]
    fn run<L: Level>(self) -> K {
        let Self { mut search, span, stack } = self;
        let (shape, ray) = (search.shape, search.ray);
        shape.tree().walk_on::<L>(ray, span, &mut search, stack);
        search.kept
    }
}

/// The visit of a leaf.
struct Visit<'v, 'a, S: PartedShape, K> {
    search: &'v mut PartSearch<'a, S, K>,
    leaf: u32,
    slabs: &'v Slabs,
    limit: f32,
}

impl<S: PartedShape> SimdKernel for Visit<'_, '_, S, NearestPart> {
    type Output = f32;

    #[inline(always)]
    fn run<L: Level>(self) -> f32 {
        S::nearest_in::<L>(self.search, self.leaf, self.slabs, self.limit)
    }
}

impl<S: PartedShape> SimdKernel for Visit<'_, '_, S, AnyPart> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(self) -> bool {
        S::any_in::<L>(self.search, self.leaf, self.slabs, self.limit)
    }
}

impl<S: PartedShape> SimdKernel for Visit<'_, '_, S, EveryPart<'_>> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        S::every_in::<L>(self.search, self.leaf, self.slabs, self.limit);
    }
}

impl<S: PartedShape> LeafVisitor for PartSearch<'_, S, NearestPart> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, leaf: u32) {
        L::prefetch(self.shape.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32> {
        Some(L::call(Visit { search: self, leaf, slabs, limit }))
    }
}

impl<S: PartedShape> LeafVisitor for PartSearch<'_, S, AnyPart> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, leaf: u32) {
        L::prefetch(self.shape.packets(), leaf as usize);
    }

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32> {
        self.kept.found = L::call(Visit { search: self, leaf, slabs, limit });
        (!self.kept.found).then_some(limit)
    }
}

impl<S: PartedShape> LeafVisitor for PartSearch<'_, S, EveryPart<'_>> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, limit: f32) -> Option<f32> {
        L::call(Visit { search: self, leaf, slabs, limit });
        Some(limit)
    }
}
