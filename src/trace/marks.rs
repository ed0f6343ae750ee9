//! Marks samples that are shared by several frames: in which frames could their paths differ?
//!
//! In: segments of paths and shadow rays, as they are traced without the primitives that differ between the frames.
//! Out: for each sample, the set of frames in which one of its segments meets such a primitive. In all other frames the
//! sample has the same paths, and so the same light.

use super::context::TraceContext;
use super::intersect::HitStream;
use super::light::ShadowRay;
use super::stream::PathStream;
use crate::base::lanes::{Level, Lookup, Mask, Row, SimdKernel, lanes};
use crate::base::math::{DVec3, Ray};
use crate::geometry::bvh::TraversalRay;
use crate::geometry::ray_kinds::RayKind;
use crate::geometry::shape::{PreparedRay, RayInterval, StoredRays};
use crate::scene::movers::{FrameMask, LaneSegments, MoverStacks, MoverTest, Movers};
use crate::scene::top_level::NOTHING;

/// The marks of the samples of a wave.
#[derive(Default)]
pub struct Marks {
    /// The frames of each sample.
    pub frames: Vec<FrameMask>,
    /// The moment of each sample, if frames have several.
    pub moments: Vec<u32>,
    /// All frames.
    pub all: FrameMask,
    /// The number of segments that hit nothing.
    pub misses: u64,
    /// The number of searches of movers with many parts.
    pub tests: u64,
    stacks: MoverStacks,
}

impl Marks {
    /// Clears the marks for samples of these moments.
    pub fn reset(&mut self, all: FrameMask, moments: impl Iterator<Item = u32>) {
        self.all = all;
        self.moments.clear();
        self.moments.extend(moments);
        self.frames.clear();
        self.frames.resize(self.moments.len(), 0);
    }

    /// Whether a sample differs in all frames already.
    #[inline(always)]
    fn is_full(&self, slot: u32) -> bool {
        self.frames[slot as usize] == self.all
    }

    /// Marks a sample by one of its segments.
    #[inline(always)]
    fn mark<L: Level>(
        &mut self,
        movers: &Movers,
        (slot, ray): (u32, &TraversalRay),
        within: RayInterval<f64>,
        test: (MoverTest, RayKind),
    ) {
        let slot = slot as usize;
        let state = (self.frames[slot], self.moments[slot]);
        let met = movers.frames_met::<L>(ray, within, test, state, &mut self.stacks.single);
        self.frames[slot] = met.frames;
        self.tests += u64::from(met.tests);
    }

    /// Marks samples by eight of their segments, of which those count whose bits are set.
    #[inline(always)]
    fn mark_lanes<L: Level>(
        &mut self,
        movers: &Movers,
        (ray, within): (&PreparedRay<L::F64>, RayInterval<L::F64>),
        (slots, active): (&[u32; 8], u32),
        (test, kinds): (MoverTest, &[RayKind; 8]),
    ) {
        let mut known = [0; 8];
        let mut wanted = 0;
        for lane in lanes(active) {
            known[lane] = self.frames[slots[lane] as usize];
            wanted |= u32::from(known[lane] != self.all) << lane;
        }
        if wanted == 0 {
            return;
        }
        let segments = LaneSegments::<L> { ray, within, test, kinds, wanted, all: self.all };
        self.tests += u64::from(movers.frames_met_in_lanes(segments, &mut known, &mut self.stacks));
        // Several paths may be of one sample.
        lanes(wanted).for_each(|lane| self.frames[slots[lane] as usize] |= known[lane]);
    }

    /// Marks samples by their shadow rays in the lanes of two masks: rays that nothing blocks, and rays that pass
    /// surfaces. A ray that something blocks is blocked in all frames.
    #[inline(always)]
    pub fn mark_shadows<L: Level>(
        &mut self,
        movers: &Movers,
        shadow: &ShadowRay<L::F64>,
        slots: L::U32,
        (open, dimmed): (L::Mask, L::Mask),
    ) {
        let (slots, t_max) = (slots.to_array(), shadow.t_max.to_array());
        let mut alone = open | dimmed;
        if movers.are_always() {
            let (ray, within) = (PreparedRay::new(shadow.ray), RayInterval::up_to(shadow.t_max));
            let test = (MoverTest::Block, &[RayKind::Shadow; 8]);
            self.mark_lanes::<L>(movers, (&ray, within), (&slots, (open & !dimmed).bits()), test);
            alone = dimmed;
        }
        if !alone.any() {
            return;
        }
        let rays = StoredRays::of(&shadow.ray);
        for lane in lanes(alone.bits()) {
            if !self.is_full(slots[lane]) {
                let passes = dimmed.bits() >> lane & 1 == 1;
                let test = if passes { MoverTest::Bounds } else { MoverTest::Block };
                let (ray, within) = (TraversalRay::new(rays.one(lane)), RayInterval::up_to(t_max[lane]));
                self.mark::<L::Narrow>(movers, (slots[lane], &ray), within, (test, RayKind::Shadow));
            }
        }
    }
}

/// Marks samples by the segments of their paths.
pub struct MarkSegments<'a> {
    pub context: &'a TraceContext<'a>,
    pub movers: &'a Movers<'a>,
    pub paths: &'a PathStream,
    pub hits: &'a HitStream,
    pub marks: &'a mut Marks,
}

impl SimdKernel for MarkSegments<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(mut self) {
        let missed = self.hits.primitive[..self.paths.len()].iter().filter(|hit| **hit == NOTHING);
        self.marks.misses += missed.count() as u64;
        if self.movers.are_always() {
            (0..self.paths.len()).step_by(8).for_each(|first| self.mark_eight::<L>(first));
        } else {
            for index in 0..self.paths.len() as u32 {
                let (primitive, t) = (self.hits.primitive[index as usize], self.hits.t[index as usize]);
                self.mark::<L>(index, (primitive != NOTHING).then_some(t), MoverTest::Hit);
            }
        }
        // Where surfaces may coincide, other hits along the ray count too.
        for &index in self.hits.close() {
            self.mark::<L>(index, None, MoverTest::Bounds);
        }
    }
}

impl MarkSegments<'_> {
    /// Marks the samples of the paths from `first` on, at most eight, by their segments.
    #[inline(always)]
    fn mark_eight<L: Level>(&mut self, first: usize) {
        let Self { context, movers, paths, hits, .. } = *self;
        let count = (paths.len() - first).min(8);
        let at = Lookup::run(first as u32, count);
        let ray = PreparedRay::new(paths.ray::<L::F64>(&at));
        let (mut t, mut slots, mut kinds) = ([0.0; 8], [0; 8], [RayKind::Camera; 8]);
        for lane in 0..count {
            let index = first + lane;
            (t[lane], slots[lane], kinds[lane]) =
                (hits.t[index], paths.slot(index as u32), paths.ray_kind(index));
        }
        // A mover behind the hit counts if it may coincide with it.
        let range = ray.coincidence_range(context.bvh.reach());
        let mut max = range.end(L::F64::from_array(t)).to_array().map(f64::next_up);
        for (max, hit) in max.iter_mut().zip(&hits.primitive[first..first + count]) {
            if *hit == NOTHING {
                *max = f64::INFINITY;
            }
        }
        let within = RayInterval { min: paths.t_start::<L::F64>(&at), max: L::F64::from_array(max) };
        let (active, test) = (0xff >> (8 - count), (MoverTest::Hit, &kinds));
        self.marks.mark_lanes::<L>(movers, (&ray, within), (&slots, active), test);
    }

    /// Marks the sample of a path by the segment up to its hit, if it has one.
    #[inline(always)]
    fn mark<L: Level>(&mut self, index: u32, hit: Option<f64>, test: MoverTest) {
        let (slot, at) = (self.paths.slot(index), Lookup::run(index, 1));
        if self.marks.is_full(slot) {
            return;
        }
        let ray = self.paths.ray::<f64>(&at);
        let ray = Ray { origin: DVec3::from(ray.origin), direction: DVec3::from(ray.direction) };
        let ray = TraversalRay::new(ray);
        // A mover behind the hit counts if it may coincide with it.
        let range = self.context.bvh.coincidence_range(&ray);
        let max = hit.map_or(f64::INFINITY, |t| range.end(t).next_up());
        let within = RayInterval { min: self.paths.t_start::<f64>(&at), max };
        let kind = self.paths.ray_kind(index as usize);
        self.marks.mark::<L::Narrow>(self.movers, (slot, &ray), within, (test, kind));
    }
}
