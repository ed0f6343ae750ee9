//! Eight rays at once: each meets what it would alone.

use super::balls::Lines;
use super::{Bvh, Hit};
use crate::scene::Geometry;
use crate::shape::{Crossings, Rays, lanes};
use crate::simd::{Choice, Lanes, Octo, Work, dispatch};
use crate::tree::{Branch, BundleLeaves, BundleSlabs, Probe, Slabs, Tree};

/// What eight rays meet first.
#[derive(Clone, Copy, Debug)]
pub struct Hits {
    pub at: Crossings,
    /// Indices of the primitives.
    pub primitives: [u32; 8],
}

impl Hits {
    /// What one of the rays meets.
    pub fn one(&self, lane: usize) -> Option<Hit> {
        let met = self.at.met >> lane & 1 == 1;
        met.then(|| Hit { at: self.at.one(lane), primitive: self.primitives[lane] })
    }
}

impl Bvh {
    /// Whether [`Bvh::closest_of`] is for the geometry.
    pub fn takes_bundles(&self) -> bool {
        !self.lights
    }

    /// [`Bvh::closest_together`] on the widest lanes that there are.
    pub fn closest_of(&self, geometry: &Geometry, rays: &Rays, wanted: u32) -> Hits {
        dispatch(Closest { bvh: self, geometry, rays, wanted })
    }

    /// [`Bvh::occluded_together`] on the widest lanes that there are, each ray with a limit of its own.
    pub fn occluded_of(&self, geometry: &Geometry, rays: &Rays, wanted: u32, t_max: &[f64; 8]) -> u32 {
        dispatch(Occluded { bvh: self, geometry, rays, wanted, t_max })
    }

    /// [`Bvh::closest`] of those of eight rays whose bits are set. Only where no lights are among the primitives.
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
        let (slabs, near, afar) = BundleSlabs::<L>::new(&bvh.tree, origin, direction, wanted);
        let hits = Hits { at: Crossings::NONE, primitives: [u32::MAX; 8] };
        let (limit, alone) = (L::splat(0.0), [None; ALONE]);
        let lines = (!bvh.packs.is_empty()).then(|| Lines::new(&slabs, direction));
        let mut nearest =
            Nearest { bvh, geometry, rays, slabs: &slabs, lines: lines.as_ref(), limit, hits, alone };
        for &(index, _) in &bvh.planes {
            nearest.test(index, wanted);
        }
        for &index in &bvh.unbounded {
            nearest.test(index, wanted);
        }
        nearest.limit = slabs.limit(Octo::load(&nearest.hits.at.t));
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
                hits.at.met |= 1 << lane;
                (hits.at.t[lane], hits.at.parts[lane]) = (hit.at.t, hit.at.part);
                hits.primitives[lane] = hit.primitive;
            }
        }
    }
}

/// The search for what is nearest.
struct Nearest<'a, L: Lanes, const ALONE: usize> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    rays: &'a Rays,
    slabs: &'a BundleSlabs<L>,
    lines: Option<&'a Lines<L>>,
    limit: L,
    hits: Hits,
    alone: [Option<Alone>; ALONE],
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
        Some(Self { probe, slabs: Slabs::new::<L>(tree, &probe, f64::INFINITY)? })
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

impl<L: Lanes, const ALONE: usize> Nearest<'_, L, ALONE> {
    /// Takes a primitive's crossings where they are nearer, or as near and the primitive is the earlier one.
    #[inline(always)]
    fn test(&mut self, index: u32, wanted: u32) {
        let Hits { at, primitives } = &mut self.hits;
        let t = Octo::<L::Quad>::load(&at.t);
        // The next number, so that an equally near one is found. There is none after infinity.
        let limit = t.next_away(t).smaller(Octo::splat(f64::INFINITY)).store();
        let primitive = &self.geometry.primitives[index as usize];
        let found = primitive.hit_together::<L>(self.rays, wanted, &limit);
        if found.met == 0 {
            return;
        }
        let found_t = Octo::load(&found.t);
        let mut better = found.met & found_t.below(t).bits();
        for lane in lanes(found.met & !better) {
            better |= u32::from(index < primitives[lane]) << lane;
        }
        at.met |= better;
        at.t = found_t.pick(Choice::of(better), t).store();
        for lane in lanes(better) {
            (primitives[lane], at.parts[lane]) = (index, found.parts[lane]);
        }
    }
}

impl<L: Lanes, const ALONE: usize> BundleLeaves<L> for Nearest<'_, L, ALONE> {
    const ALONE: bool = ALONE > 0;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        if let (Some(balls), Some(lines)) = (self.bvh.packs.of(leaf), self.lines) {
            for lane in 0..balls.count() {
                let met = rays & lines.meeting(balls, lane, self.limit);
                if met != 0 {
                    self.test(balls.primitive(lane), met);
                    self.limit = self.slabs.limit(Octo::load(&self.hits.at.t));
                }
            }
            return;
        }
        for &index in self.bvh.leaves.leaf(leaf) {
            self.test(index, rays);
        }
        self.limit = self.slabs.limit(Octo::load(&self.hits.at.t));
    }

    #[inline(always)]
    fn part(&mut self, ray: usize, below: Branch) {
        let Self { bvh, geometry, .. } = *self;
        let Some(Alone { probe, slabs }) = alone::<L>(&mut self.alone, bvh, self.rays, ray) else { return };
        let hit = self.hits.one(ray);
        let mut single =
            super::Nearest { bvh, geometry, probe, t_max: f64::INFINITY, but: &[], afar: 0.0, hit };
        let limit = slabs.limit(self.hits.at.t[ray]);
        bvh.tree.walk_below::<L>(below, slabs, limit, &mut single);
        if let Some(Hit { at, primitive }) = single.hit {
            let hits = &mut self.hits;
            hits.at.met |= 1 << ray;
            (hits.at.t[ray], hits.at.parts[ray], hits.primitives[ray]) = (at.t, at.part, primitive);
        }
        self.limit = self.slabs.limit(Octo::load(&self.hits.at.t));
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
        let (origin, direction) = rays.load::<L>();
        let (slabs, near, afar) = BundleSlabs::<L>::new(&bvh.tree, origin, direction, wanted);
        let limit = slabs.limit(Octo::load(t_max));
        let lines = (!bvh.packs.is_empty()).then(|| Lines::new(&slabs, direction));
        let mut any =
            Any { bvh, geometry, rays, t_max, lines: lines.as_ref(), limit, hidden: 0, alone: [None; ALONE] };
        for &(index, _) in &bvh.planes {
            any.test(index, wanted);
        }
        for &index in &bvh.unbounded {
            any.test(index, wanted);
        }
        let (near, afar) = (near & !any.hidden, afar & !any.hidden);
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

struct Any<'a, L: Lanes, const ALONE: usize> {
    bvh: &'a Bvh,
    geometry: &'a Geometry,
    rays: &'a Rays,
    t_max: &'a [f64; 8],
    lines: Option<&'a Lines<L>>,
    limit: L,
    hidden: u32,
    alone: [Option<Alone>; ALONE],
}

impl<L: Lanes, const ALONE: usize> Any<'_, L, ALONE> {
    #[inline(always)]
    fn test(&mut self, index: u32, wanted: u32) {
        let wanted = wanted & !self.hidden;
        if wanted == 0 {
            return;
        }
        let primitive = &self.geometry.primitives[index as usize];
        self.hidden |= primitive.blocks_together::<L>(self.rays, wanted, self.t_max);
        self.limit = L::splat(-1.0).pick(self.hidden, self.limit);
    }
}

impl<L: Lanes, const ALONE: usize> BundleLeaves<L> for Any<'_, L, ALONE> {
    const ALONE: bool = ALONE > 0;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        if let (Some(balls), Some(lines)) = (self.bvh.packs.of(leaf), self.lines) {
            for lane in 0..balls.count() {
                let met = rays & lines.meeting(balls, lane, self.limit);
                if met != 0 {
                    self.test(balls.primitive(lane), met);
                }
            }
            return;
        }
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
