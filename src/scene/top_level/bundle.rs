//! Walks along eight rays at once: each meets what it would alone.

use super::nearest::Nearest;
use super::single::{Any, NearestOne};
use super::{Bvh, Occlusion, Passing, lets_pass};
use crate::base::lanes::{LaneKernel, Level, Mask, Real, Row, Select};
use crate::geometry::bvh::{Branch, BundleLeaves, BundleSlabs, BundleStack, Probe, Slabs, Tree};
use crate::geometry::shape::{PreparedRay, Span, eight};
use crate::scene::{Geometry, Primitive};

impl Bvh {
    /// Searches the tree along eight rays.
    #[inline(always)]
    pub(super) fn closest_together<L: Level>(
        &self,
        geometry: &Geometry,
        nearest: &mut Nearest<L::F64>,
        stack: &mut BundleStack,
    ) {
        if self.tree.is_small() {
            L::call_with(Closest::<L, 0> { bvh: self, geometry, nearest, stack });
        } else {
            L::call_with(Closest::<L, 8> { bvh: self, geometry, nearest, stack });
        }
    }

    /// Looks in the tree for what stands in the way of eight rays.
    #[inline(always)]
    pub(super) fn occluded_together<L: Level>(
        &self,
        geometry: &Geometry,
        shadow: &mut Shadow<L>,
        stack: &mut BundleStack,
    ) {
        if self.tree.is_small() {
            L::call_with(Occluded::<L, 0> { bvh: self, geometry, shadow, stack });
        } else {
            L::call_with(Occluded::<L, 8> { bvh: self, geometry, shadow, stack });
        }
    }
}

/// A ray of a bundle by itself.
#[derive(Clone, Copy)]
struct Alone {
    probe: Probe,
    slabs: Slabs,
}

/// The rays of a bundle by themselves, each made when it is first asked for.
struct Singles<const ALONE: usize>([Option<Alone>; ALONE]);

impl<const ALONE: usize> Singles<ALONE> {
    #[inline(always)]
    fn new() -> Self {
        Self([None; ALONE])
    }

    /// A ray that is near the tree; none where there is no room for it.
    #[inline(always)]
    fn get<L: Level>(&mut self, tree: &Tree, rays: &PreparedRay<L::F64>, ray: usize) -> Option<&Alone> {
        let alone = self.0.get_mut(ray)?;
        if alone.is_none() {
            let probe = Probe::new(rays.ray.lane(ray));
            *alone = Slabs::new::<L::Narrow>(tree, &probe, f64::INFINITY).map(|slabs| Alone { probe, slabs });
        }
        alone.as_ref()
    }
}

/// The search for what is nearest, with room for so many rays that go on alone.
struct Closest<'a, 'r, L: Level, const ALONE: usize> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    nearest: &'a mut Nearest<'r, L::F64>,
    stack: &'a mut BundleStack,
}

impl<L: Level, const ALONE: usize> LaneKernel<L> for Closest<'_, '_, L, ALONE> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { bvh, geometry, nearest, stack } = self;
        let ray = &nearest.ray.ray;
        let wanted = L::F64::splat(0.0).le(nearest.limit).bits();
        let (slabs, near, afar) = BundleSlabs::<L>::new(&bvh.tree, ray.origin, ray.direction, wanted);
        let singles = Singles::<ALONE>::new();
        let limit = slabs.limit(nearest.limit);
        let mut walk = NearestWalk { bvh, geometry, slabs: &slabs, nearest, limit, singles };
        if near != 0 {
            bvh.tree.walk_together(&slabs, near, &mut walk, stack);
        }
        for lane in crate::base::lanes::lanes(afar) {
            let probe = Probe::new(walk.nearest.ray.ray.lane(lane));
            walk.alone(lane, &probe, |one| bvh.tree.walk(&probe, one.limit(), one));
        }
    }
}

struct NearestWalk<'a, 'r, L: Level, const ALONE: usize> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    slabs: &'a BundleSlabs<L>,
    nearest: &'a mut Nearest<'r, L::F64>,
    limit: L::F32,
    singles: Singles<ALONE>,
}

impl<L: Level, const ALONE: usize> NearestWalk<'_, '_, L, ALONE> {
    /// Goes on with the search along one ray.
    #[inline(always)]
    fn alone(&mut self, ray: usize, probe: &Probe, walk: impl FnOnce(&mut NearestOne)) {
        let [min, max] = self.nearest.bounds();
        let within = Span { min: min[ray], max: max[ray] };
        let mut rows = self.nearest.hits.store();
        let mut one = NearestOne::new(self.bvh, self.geometry, probe, within, rows.lane(ray));
        walk(&mut one);
        let hit = one.found.hit;
        let mut limits = eight(self.nearest.limit);
        limits[ray] = one.limit();
        rows.set_lane(ray, hit);
        self.nearest.hits = rows.load();
        self.nearest.limit = L::F64::load(&limits, 0);
        self.limit = self.slabs.limit(self.nearest.limit);
    }
}

impl<L: Level, const ALONE: usize> BundleLeaves<L> for NearestWalk<'_, '_, L, ALONE> {
    const ALONE: bool = ALONE > 0;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        let all = self.nearest.limit;
        // Other rays have nothing in the leaf.
        self.nearest.limit = L::F64::select(L::Mask::from_bits(rays), all, L::F64::splat(-1.0));
        self.nearest.test(self.geometry, self.bvh.leaves.leaf(leaf));
        self.nearest.limit = L::F64::select(L::Mask::from_bits(rays), self.nearest.limit, all);
        self.limit = self.slabs.limit(self.nearest.limit);
    }

    #[inline(always)]
    fn part(&mut self, ray: usize, below: Branch) {
        let tree = &self.bvh.tree;
        let Some(&Alone { probe, slabs }) = self.singles.get::<L>(tree, self.nearest.ray, ray) else {
            return;
        };
        self.alone(ray, &probe, |one| {
            tree.walk_below::<L>(below, &slabs, slabs.limit(one.limit()), one);
        });
    }

    #[inline(always)]
    fn limit(&self) -> L::F32 {
        self.limit
    }
}

/// The search for anything in the way of eight shadow rays.
pub struct Shadow<'a, L: Level> {
    ray: &'a PreparedRay<L::F64>,
    within: Span<L::F64>,
    passing: Option<Passing<'a>>,
    /// Rays that are still to be looked along.
    open: L::Mask,
    blocked: L::Mask,
    dimmed: L::Mask,
}

impl<'a, L: Level> Shadow<'a, L> {
    #[inline(always)]
    pub fn new(
        ray: &'a PreparedRay<L::F64>,
        within: Span<L::F64>,
        wanted: L::Mask,
        passing: Option<Passing<'a>>,
    ) -> Self {
        let none = L::Mask::splat(false);
        Self { ray, within, passing, open: wanted, blocked: none, dimmed: none }
    }

    #[inline(always)]
    pub fn open(&self) -> L::Mask {
        self.open
    }

    /// Tests primitives of these indices for some of the rays.
    #[inline(always)]
    pub fn test(&mut self, geometry: &Geometry, indices: &[u32], rays: L::Mask) {
        L::call_with(Test { shadow: self, geometry, indices, rays });
    }

    #[inline(always)]
    fn test_one(&mut self, rays: L::Mask, index: u32, primitive: &Primitive) {
        let passes = lets_pass(self.passing, index);
        let rays = if passes { rays & !self.dimmed } else { rays };
        if !rays.any() {
            return;
        }
        let max = L::F64::select(rays, self.within.max, L::F64::splat(-1.0));
        let met = primitive.occludes(self.ray, Span { min: self.within.min, max });
        if passes {
            self.dimmed = self.dimmed | met;
        } else {
            self.blocked = self.blocked | met;
            self.open = self.open & !met;
        }
    }

    #[inline(always)]
    pub fn occlusion(&self) -> Occlusion<L::Mask> {
        Occlusion { blocked: self.blocked, dimmed: self.dimmed & !self.blocked }
    }

    #[inline(always)]
    pub fn bounds(&self) -> [[f64; 8]; 2] {
        [eight(self.within.min), eight(self.within.max)]
    }

    /// A bit for each ray that is blocked, and that is dimmed.
    #[inline(always)]
    pub fn bits(&self) -> [u32; 2] {
        [self.blocked.bits(), self.dimmed.bits()]
    }
}

struct Test<'a, 'r, L: Level> {
    shadow: &'a mut Shadow<'r, L>,
    geometry: &'a Geometry,
    indices: &'a [u32],
    rays: L::Mask,
}

impl<L: Level> LaneKernel<L> for Test<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { shadow, geometry, indices, rays } = self;
        for &index in indices {
            shadow.test_one(rays & shadow.open, index, &geometry.primitives[index as usize]);
        }
    }
}

/// The search with room for so many rays that go on alone.
struct Occluded<'a, 'r, L: Level, const ALONE: usize> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    shadow: &'a mut Shadow<'r, L>,
    stack: &'a mut BundleStack,
}

impl<L: Level, const ALONE: usize> LaneKernel<L> for Occluded<'_, '_, L, ALONE> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { bvh, geometry, shadow, stack } = self;
        let ray = &shadow.ray.ray;
        let wanted = shadow.open.bits();
        let (slabs, near, afar) = BundleSlabs::<L>::new(&bvh.tree, ray.origin, ray.direction, wanted);
        let singles = Singles::<ALONE>::new();
        let limit = slabs.limit(L::F64::select(shadow.open, shadow.within.max, L::F64::splat(-1.0)));
        let mut walk = AnyWalk { bvh, geometry, shadow, limit, singles };
        if near != 0 {
            bvh.tree.walk_together(&slabs, near, &mut walk, stack);
        }
        for lane in crate::base::lanes::lanes(afar) {
            let probe = Probe::new(walk.shadow.ray.ray.lane(lane));
            walk.alone(lane, &probe, |any| bvh.tree.walk(&probe, any.within.max, any));
        }
    }
}

struct AnyWalk<'a, 'r, L: Level, const ALONE: usize> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    shadow: &'a mut Shadow<'r, L>,
    limit: L::F32,
    singles: Singles<ALONE>,
}

impl<L: Level, const ALONE: usize> AnyWalk<'_, '_, L, ALONE> {
    /// Goes on with the search along one ray.
    #[inline(always)]
    fn alone(&mut self, ray: usize, probe: &Probe, walk: impl FnOnce(&mut Any)) {
        let Self { bvh, geometry, .. } = *self;
        let [min, max] = self.shadow.bounds();
        let within = Span { min: min[ray], max: max[ray] };
        let dimmed = self.shadow.dimmed.bits() >> ray & 1 == 1;
        let passing = self.shadow.passing;
        let mut any = Any { bvh, geometry, probe, within, passing, blocked: false, dimmed };
        walk(&mut any);
        let bit = 1 << ray;
        if any.dimmed {
            self.shadow.dimmed = self.shadow.dimmed | L::Mask::from_bits(bit);
        }
        if any.blocked {
            self.shadow.blocked = self.shadow.blocked | L::Mask::from_bits(bit);
            self.close();
        }
    }

    /// Ends the search of rays that are blocked.
    #[inline(always)]
    fn close(&mut self) {
        self.shadow.open = self.shadow.open & !self.shadow.blocked;
        self.limit = L::F32::select(self.shadow.blocked, L::F32::splat(-1.0), self.limit);
    }
}

impl<L: Level, const ALONE: usize> BundleLeaves<L> for AnyWalk<'_, '_, L, ALONE> {
    const ALONE: bool = ALONE > 0;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        self.shadow.test(self.geometry, self.bvh.leaves.leaf(leaf), L::Mask::from_bits(rays));
        self.close();
    }

    #[inline(always)]
    fn part(&mut self, ray: usize, below: Branch) {
        if self.shadow.blocked.bits() >> ray & 1 == 1 {
            return;
        }
        let tree = &self.bvh.tree;
        let Some(&Alone { probe, slabs }) = self.singles.get::<L>(tree, self.shadow.ray, ray) else { return };
        self.alone(ray, &probe, |any| {
            tree.walk_below::<L>(below, &slabs, slabs.limit(any.within.max), any);
        });
    }

    #[inline(always)]
    fn limit(&self) -> L::F32 {
        self.limit
    }
}
