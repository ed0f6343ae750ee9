//! Walks along single rays.

use super::nearest::Found;
use super::{Bvh, Hit, Passing, lets_pass};
use crate::base::lanes::{Level, SimdKernel, dispatch_narrow};
use crate::geometry::bvh::{Leaves, Probe, Slabs, Stack};
use crate::geometry::shape::{PreparedRay, Span, Vicinity};
use crate::scene::Geometry;

impl Bvh {
    /// The nearest hit along a ray; of equally near ones that of the first primitive in the file.
    pub fn closest(&self, geometry: &Geometry, probe: &Probe) -> Option<Hit> {
        self.closest_within(geometry, probe, Span::up_to(f64::INFINITY))
    }

    /// Whether a ray meets anything before `t_max`.
    pub fn occluded(&self, geometry: &Geometry, probe: &Probe, t_max: f64) -> bool {
        dispatch_narrow(Occluded { bvh: self, geometry, probe, within: Span::up_to(t_max) })
    }

    /// The nearest hit along a ray within bounds.
    pub fn closest_within(&self, geometry: &Geometry, probe: &Probe, within: Span<f64>) -> Option<Hit> {
        dispatch_narrow(Closest { bvh: self, geometry, probe, within })
    }

    /// What is nearer of all that stands beside the tree or in it than what has been found already.
    #[inline(always)]
    pub(super) fn closest_on<L: Level>(
        &self,
        geometry: &Geometry,
        probe: &Probe,
        within: Span<f64>,
        found: Option<Hit>,
        stack: &mut Stack,
    ) -> Option<Hit> {
        L::call(ClosestOn { bvh: self, geometry, probe, within, found, stack })
    }

    /// Whether a ray is blocked by all that stands beside the tree or in it, and whether it meets what lets light pass.
    #[inline(always)]
    pub(super) fn occluded_on<L: Level>(
        &self,
        geometry: &Geometry,
        probe: &Probe,
        within: Span<f64>,
        passing: Option<Passing>,
        stack: &mut Stack,
    ) -> [bool; 2] {
        L::call(OccludedOn { bvh: self, geometry, probe, within, passing, stack })
    }

    /// How near to each other hits along a ray have to be for their surfaces to be compared.
    #[inline(always)]
    pub fn vicinity(&self, probe: &Probe) -> Vicinity<f64> {
        PreparedRay::<f64>::splat(probe).vicinity(self.reach)
    }

    /// Gives every hit of every primitive along a ray within bounds to `take`, in no order.
    pub fn each_hit(&self, geometry: &Geometry, probe: &Probe, within: Span<f64>, take: &mut dyn FnMut(Hit)) {
        dispatch_narrow(Each { bvh: self, geometry, probe, within, take });
    }
}

struct ClosestOn<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    within: Span<f64>,
    found: Option<Hit>,
    stack: &'a mut Stack,
}

impl SimdKernel for ClosestOn<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<L: Level>(self) -> Option<Hit> {
        let Self { bvh, geometry, probe, within, found, stack } = self;
        let mut nearest = NearestOne::new(bvh, geometry, probe, within, found);
        nearest.test::<L>(&bvh.meshes, Some(stack));
        bvh.tree.walk_on::<L>(probe, nearest.limit(), &mut nearest, stack);
        nearest.found.hit
    }
}

struct OccludedOn<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    within: Span<f64>,
    passing: Option<Passing<'a>>,
    stack: &'a mut Stack,
}

impl SimdKernel for OccludedOn<'_> {
    type Output = [bool; 2];

    #[inline(always)]
    fn run<L: Level>(self) -> [bool; 2] {
        let Self { bvh, geometry, probe, within, passing, stack } = self;
        let mut any = Any { bvh, geometry, probe, within, passing, blocked: false, dimmed: false };
        any.test::<L>(&bvh.meshes, Some(stack));
        if !any.blocked {
            bvh.tree.walk_on::<L>(probe, within.max, &mut any, stack);
        }
        [any.blocked, any.dimmed]
    }
}

struct Closest<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    within: Span<f64>,
}

impl SimdKernel for Closest<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<L: Level>(self) -> Option<Hit> {
        let Self { bvh, geometry, probe, within } = self;
        let mut stack = Stack::default();
        let mut direct = NearestOne::new(bvh, geometry, probe, within, None);
        direct.test::<L>(&bvh.direct, Some(&mut stack));
        bvh.closest_on::<L>(geometry, probe, within, direct.found.hit, &mut stack)
    }
}

struct Occluded<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    within: Span<f64>,
}

impl SimdKernel for Occluded<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(self) -> bool {
        let Self { bvh, geometry, probe, within } = self;
        let mut stack = Stack::default();
        let direct = bvh.direct.iter().map(|index| &geometry.primitives[*index as usize]);
        for primitive in direct {
            if primitive.blocks_one::<L>(probe, within, Some(&mut stack)) {
                return true;
            }
        }
        let [blocked, _] = bvh.occluded_on::<L>(geometry, probe, within, None, &mut stack);
        blocked
    }
}

/// The search for the nearest hit along a ray.
pub(super) struct NearestOne<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    within: Span<f64>,
    pub found: Found,
}

impl<'a> NearestOne<'a> {
    #[inline(always)]
    pub fn new(
        bvh: &'a Bvh,
        geometry: &'a Geometry,
        probe: &'a Probe,
        within: Span<f64>,
        hit: Option<Hit>,
    ) -> Self {
        Self { bvh, geometry, probe, within, found: Found { hit, vicinity: bvh.vicinity(probe) } }
    }

    #[inline(always)]
    pub fn limit(&self) -> f64 {
        self.found.limit(self.within.max)
    }

    /// Tests primitives of these indices.
    #[inline(always)]
    fn test<L: Level>(&mut self, indices: &[u32], stack: Option<&mut Stack>) {
        L::call(Test { leaves: self, indices, stack });
    }
}

impl Leaves for NearestOne<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, slabs: &Slabs, _: f32) -> Option<f32> {
        self.test::<L>(self.bvh.leaves.leaf(leaf), None);
        Some(slabs.limit(self.limit()))
    }
}

/// Anything on a ray within bounds.
pub(super) struct Any<'a> {
    pub bvh: &'a Bvh,
    pub geometry: &'a Geometry,
    pub probe: &'a Probe,
    pub within: Span<f64>,
    pub passing: Option<Passing<'a>>,
    pub blocked: bool,
    pub dimmed: bool,
}

impl Any<'_> {
    /// Tests primitives of these indices, until one blocks the ray.
    #[inline(always)]
    fn test<L: Level>(&mut self, indices: &[u32], stack: Option<&mut Stack>) {
        L::call(Test { leaves: self, indices, stack });
    }
}

/// Tests of primitives along a ray. Without a stack, meshes make their own: few leaves hold any.
struct Test<'a, V> {
    leaves: &'a mut V,
    indices: &'a [u32],
    stack: Option<&'a mut Stack>,
}

impl SimdKernel for Test<'_, NearestOne<'_>> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { leaves: nearest, indices, mut stack } = self;
        for &index in indices {
            let within = Span { min: nearest.within.min, max: nearest.limit() };
            let primitive = &nearest.geometry.primitives[index as usize];
            if let Some(at) = primitive.hit_one::<L>(nearest.probe, within, stack.as_deref_mut()) {
                nearest.found.consider(at, index);
            }
        }
    }
}

impl SimdKernel for Test<'_, Any<'_>> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { leaves: any, indices, mut stack } = self;
        for &index in indices {
            let passes = lets_pass(any.passing, index);
            if passes && any.dimmed {
                continue;
            }
            let primitive = &any.geometry.primitives[index as usize];
            if primitive.blocks_one::<L>(any.probe, any.within, stack.as_deref_mut()) {
                match passes {
                    true => any.dimmed = true,
                    false => return any.blocked = true,
                }
            }
        }
    }
}

impl Leaves for Any<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        self.test::<L>(self.bvh.leaves.leaf(leaf), None);
        (!self.blocked).then_some(limit)
    }
}

struct Each<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    probe: &'a Probe,
    within: Span<f64>,
    take: &'a mut dyn FnMut(Hit),
}

impl Each<'_> {
    #[inline(never)]
    fn test<L: Level>(&mut self, index: u32) {
        let Self { geometry, probe, within, take, .. } = self;
        geometry.primitives[index as usize].each_crossing::<L>(probe, *within, &mut |at| {
            take(Hit { at, primitive: index });
        });
    }
}

impl Leaves for Each<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        for &index in self.bvh.leaves.leaf(leaf) {
            self.test::<L>(index);
        }
        Some(limit)
    }
}

impl SimdKernel for Each<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(mut self) {
        let (bvh, probe, within) = (self.bvh, self.probe, self.within);
        for &index in bvh.direct.iter().chain(&bvh.meshes) {
            self.test::<L>(index);
        }
        bvh.tree.walk_on::<L>(probe, within.max, &mut self, &mut Stack::default());
    }
}
