//! Eight rays at once: each meets what it would alone.

use super::{Bvh, Hit};
use crate::scene::Geometry;
use crate::shape::{Crossings, Rays, lanes};
use crate::simd::{Choice, Lanes, Octo, Work, dispatch};
use crate::tree::{Branch, BundleLeaves, BundleSlabs, Probe, Slabs, Tree, Vicinities, Vicinity};

/// What eight rays meet first.
#[derive(Clone, Copy, Debug)]
pub struct Hits {
    pub at: Crossings,
    /// Indices of the primitives.
    pub primitives: [u32; 8],
}

impl Hits {
    const NONE: Self = Self { at: Crossings::NONE, primitives: [u32::MAX; 8] };

    /// Takes a primitive's crossings where they are nearer, or as near and the primitive is the earlier one.
    #[inline(always)]
    fn test<L: Lanes>(&mut self, near: &Near, rays: &Rays, index: u32, wanted: u32) {
        let Self { at, primitives } = self;
        let t = Octo::<L::Quad>::load(&at.t);
        // A little behind the best, so that it is known what else is near it.
        let limit = near.vicinities.ends(t).store();
        let found = near.geometry.primitives[index as usize].hit_together::<L>(rays, wanted, &limit);
        if found.met == 0 {
            return;
        }
        let found_t = Octo::load(&found.t);
        let mut better = found.met & found_t.below(t).bits();
        for lane in lanes(found.met & !better) {
            let tie = found.t[lane] == at.t[lane] && index < primitives[lane];
            better |= u32::from(tie) << lane;
        }
        let crowded = found.crowded | t.below(near.vicinities.ends(found_t)).bits();
        at.met |= better;
        at.crowded = at.crowded & !better | found.met & !better | crowded & better;
        at.t = found_t.pick(Choice::of(better), t).store();
        for lane in lanes(better) {
            (primitives[lane], at.parts[lane]) = (index, found.parts[lane]);
        }
    }

    /// Takes what of all that stands in no tree is nearer.
    #[inline(always)]
    fn test_untreed<L: Lanes>(&mut self, bvh: &Bvh, near: &Near, rays: &Rays, wanted: u32) {
        for &(index, _) in &bvh.planes {
            self.test::<L>(near, rays, index, wanted);
        }
        for &index in &bvh.untreed {
            self.test::<L>(near, rays, index, wanted);
        }
    }

    /// One of the rays meets this first.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, hit: Hit) {
        self.at.set(lane, hit.at);
        self.primitives[lane] = hit.primitive;
    }

    /// What one of the rays meets.
    pub fn one(&self, lane: usize) -> Option<Hit> {
        let met = self.at.met >> lane & 1 == 1;
        met.then(|| Hit { at: self.at.one(lane), primitive: self.primitives[lane] })
    }
}

/// What is searched, and how near to each other hits along each ray are looked at again.
struct Near<'a> {
    geometry: &'a Geometry,
    vicinities: Vicinities,
}

impl Bvh {
    /// [`Bvh::closest_together`] on the widest lanes that there are.
    pub fn closest_of(&self, geometry: &Geometry, rays: &Rays, wanted: u32) -> Hits {
        dispatch(Closest { bvh: self, geometry, rays, wanted })
    }

    /// [`Bvh::occluded_together`] on the widest lanes that there are, each ray with a limit of its own.
    pub fn occluded_of(&self, geometry: &Geometry, rays: &Rays, wanted: u32, t_max: &[f64; 8]) -> u32 {
        dispatch(Occluded { bvh: self, geometry, rays, wanted, t_max })
    }

    /// [`Bvh::closest`] of those of eight rays whose bits are set.
    #[inline(always)]
    pub fn closest_together<L: Lanes>(&self, geometry: &Geometry, rays: &Rays, wanted: u32) -> Hits {
        L::apart(Closest { bvh: self, geometry, rays, wanted })
    }

    /// [`Bvh::occluded`] of those of eight rays whose bits are set, a bit each.
    #[inline(always)]
    pub fn occluded_together<L: Lanes>(
        &self,
        geometry: &Geometry,
        rays: &Rays,
        wanted: u32,
        t_max: f64,
    ) -> u32 {
        L::apart(Occluded { bvh: self, geometry, rays, wanted, t_max: &[t_max; 8] })
    }
}

struct Closest<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    rays: &'a Rays,
    wanted: u32,
}

impl Work for Closest<'_> {
    type Output = Hits;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Hits {
        if self.bvh.tree.is_small() { self.search::<L, 0>() } else { self.search::<L, 8>() }
    }
}

impl Closest<'_> {
    /// Searches with room for so many rays that go on alone.
    #[inline(always)]
    fn search<L: Lanes, const ALONE: usize>(self) -> Hits {
        let Self { bvh, geometry, rays, wanted } = self;
        let (origin, direction) = rays.load::<L>();
        let near = Near { geometry, vicinities: Vicinity::of_each(origin, direction, bvh.reach) };
        if bvh.tree.is_empty() {
            let mut hits = Hits::NONE;
            hits.test_untreed::<L>(bvh, &near, rays, wanted);
            return hits;
        }
        let all = &near;
        let (slabs, near, afar) = BundleSlabs::<L>::new(&bvh.tree, origin, direction, wanted);
        let (hits, limit, alone) = (Hits::NONE, L::splat(0.0), [None; ALONE]);
        let mut nearest = Nearest { bvh, all, rays, slabs: &slabs, limit, hits, alone };
        nearest.hits.test_untreed::<L>(bvh, all, rays, wanted);
        nearest.limit = nearest.limits();
        if near != 0 {
            bvh.tree.walk_together(&slabs, near, &mut nearest);
        }
        let mut hits = nearest.hits;
        if afar != 0 {
            self.one_by_one(afar, &mut hits);
        }
        hits
    }

    #[inline(never)]
    fn one_by_one(&self, rays: u32, hits: &mut Hits) {
        for lane in lanes(rays) {
            if let Some(hit) = self.bvh.closest(self.geometry, &Probe::new(self.rays.one(lane))) {
                hits.set(lane, hit);
            }
        }
    }
}

/// The search for what is nearest.
struct Nearest<'a, L: Lanes, const ALONE: usize> {
    bvh: &'a Bvh,
    all: &'a Near<'a>,
    rays: &'a Rays,
    slabs: &'a BundleSlabs<L>,
    limit: L,
    hits: Hits,
    alone: [Option<Alone>; ALONE],
}

impl<L: Lanes, const ALONE: usize> Nearest<'_, L, ALONE> {
    /// Beyond which nothing is of interest.
    #[inline(always)]
    fn limits(&self) -> L {
        self.slabs.limit(self.all.vicinities.ends(Octo::load(&self.hits.at.t)))
    }
}

/// A ray of a bundle by itself.
#[derive(Clone, Copy)]
struct Alone {
    probe: Probe,
    slabs: Slabs,
}

impl Alone {
    /// A ray that is near the tree.
    #[inline(always)]
    fn new<L: Lanes>(tree: &Tree, rays: &Rays, ray: usize) -> Option<Self> {
        let probe = Probe::new(rays.one(ray));
        Some(Self { probe, slabs: Slabs::new::<L>(tree, &probe, (0.0, f64::INFINITY))? })
    }
}

/// A ray of a bundle by itself, made when it is first asked for; none where there is no room for it.
#[inline(always)]
fn alone<'a, L: Lanes>(
    all: &'a mut [Option<Alone>],
    bvh: &Bvh,
    rays: &Rays,
    ray: usize,
) -> Option<&'a Alone> {
    let alone = all.get_mut(ray)?;
    if alone.is_none() {
        *alone = Alone::new::<L>(&bvh.tree, rays, ray);
    }
    alone.as_ref()
}

impl<L: Lanes, const ALONE: usize> BundleLeaves<L> for Nearest<'_, L, ALONE> {
    const ALONE: bool = ALONE > 0;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        let Self { bvh, all, .. } = *self;
        for &index in bvh.leaves.leaf(leaf) {
            self.hits.test::<L>(all, self.rays, index, rays);
        }
        self.limit = self.limits();
    }

    #[inline(always)]
    fn part(&mut self, ray: usize, below: Branch) {
        let Self { bvh, all, .. } = *self;
        let Some(Alone { probe, slabs }) = alone::<L>(&mut self.alone, bvh, self.rays, ray) else { return };
        let mut single = super::Nearest::new(bvh, all.geometry, probe, self.hits.one(ray));
        bvh.tree.walk_below::<L>(below, slabs, slabs.limit(single.limit()), &mut single);
        if let Some(hit) = single.hit {
            self.hits.set(ray, hit);
        }
        self.limit = self.limits();
    }

    #[inline(always)]
    fn limit(&self) -> L {
        self.limit
    }
}

struct Occluded<'a> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    rays: &'a Rays,
    wanted: u32,
    t_max: &'a [f64; 8],
}

impl Work for Occluded<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u32 {
        if self.bvh.tree.is_small() { self.search::<L, 0>() } else { self.search::<L, 8>() }
    }
}

impl Occluded<'_> {
    #[inline(always)]
    fn search<L: Lanes, const ALONE: usize>(self) -> u32 {
        let Self { bvh, geometry, rays, wanted, t_max } = self;
        let mut hidden = 0;
        for index in bvh.planes.iter().map(|(index, _)| index).chain(&bvh.untreed) {
            hidden |= hidden_by::<L>(geometry, rays, *index, wanted & !hidden, t_max);
        }
        let wanted = wanted & !hidden;
        if bvh.tree.is_empty() || wanted == 0 {
            return hidden;
        }
        let (origin, direction) = rays.load::<L>();
        let (slabs, near, afar) = BundleSlabs::<L>::new(&bvh.tree, origin, direction, wanted);
        let limit = L::splat(-1.0).pick(hidden, slabs.limit(Octo::load(t_max)));
        let mut any = Any { bvh, geometry, rays, t_max, limit, hidden, alone: [None; ALONE] };
        if near != 0 {
            bvh.tree.walk_together(&slabs, near, &mut any);
        }
        let hidden = any.hidden;
        if afar == 0 { hidden } else { hidden | self.one_by_one(afar) }
    }

    #[inline(never)]
    fn one_by_one(&self, rays: u32) -> u32 {
        let hidden = |lane: usize| {
            self.bvh.occluded(self.geometry, &Probe::new(self.rays.one(lane)), self.t_max[lane])
        };
        lanes(rays).filter(|&lane| hidden(lane)).map(|lane| 1 << lane).sum()
    }
}

/// Those of eight rays whose bits are set that a primitive stands in the way of.
#[inline(always)]
fn hidden_by<L: Lanes>(geometry: &Geometry, rays: &Rays, index: u32, wanted: u32, t_max: &[f64; 8]) -> u32 {
    if wanted == 0 {
        0
    } else {
        geometry.primitives[index as usize].blocks_together::<L>(rays, wanted, t_max)
    }
}

struct Any<'a, L: Lanes, const ALONE: usize> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    rays: &'a Rays,
    t_max: &'a [f64; 8],
    limit: L,
    hidden: u32,
    alone: [Option<Alone>; ALONE],
}

impl<L: Lanes, const ALONE: usize> Any<'_, L, ALONE> {
    #[inline(always)]
    fn test(&mut self, index: u32, wanted: u32) {
        let wanted = wanted & !self.hidden;
        self.hidden |= hidden_by::<L>(self.geometry, self.rays, index, wanted, self.t_max);
        self.limit = L::splat(-1.0).pick(self.hidden, self.limit);
    }
}

impl<L: Lanes, const ALONE: usize> BundleLeaves<L> for Any<'_, L, ALONE> {
    const ALONE: bool = ALONE > 0;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        for &index in self.bvh.leaves.leaf(leaf) {
            self.test(index, rays);
        }
    }

    #[inline(always)]
    fn part(&mut self, ray: usize, below: Branch) {
        let Self { bvh, geometry, .. } = *self;
        if self.hidden >> ray & 1 == 1 {
            return;
        }
        let Some(Alone { probe, slabs }) = alone::<L>(&mut self.alone, bvh, self.rays, ray) else { return };
        let t_max = self.t_max[ray];
        let mut single = super::Any { bvh, geometry, probe, t_max, found: false };
        bvh.tree.walk_below::<L>(below, slabs, slabs.limit(t_max), &mut single);
        if single.found {
            self.hidden |= 1 << ray;
            self.limit = L::splat(-1.0).pick(self.hidden, self.limit);
        }
    }

    #[inline(always)]
    fn limit(&self) -> L {
        self.limit
    }
}
