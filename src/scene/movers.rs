//! Primitives that differ between poses of a scene, and which poses differ for a ray.
//!
//! In: scenes that differ in some of their primitives and materials only. Out: for a segment of a ray, the set of poses
//! in which it meets one of these primitives.

use super::{Finish, Geometry, Primitive, Scene, Shading};
use crate::base::color::Rgb;
use crate::base::lanes::{LaneKernel, Level, Mask, Row, Select, SimdKernel, lanes};
use crate::geometry::bvh::{
    BundleSlabs, BundleStack, BundleVisitor, LeafPrimitives, LeafVisitor, Slabs, Stack, TraversalRay, Tree,
};
use crate::geometry::ray_kinds::RayKind;
use crate::geometry::shape::{PreparedRay, RayInterval, Shape};

/// A set of up to 64 frames, one bit each.
pub type FrameMask = u64;

/// A scene at one moment of one of several frames.
#[derive(Clone, Copy, Debug)]
pub struct MoverPose<'a> {
    pub scene: Scene<'a>,
    /// The frame, as a set of one.
    pub frame: FrameMask,
    /// The moment of the shutter; none if the frame has only one.
    pub moment: Option<u32>,
}

/// The slots whose primitives, or the materials of these, differ between scenes. All must have the same number of
/// slots and materials.
pub fn moving_slots(scenes: &[Scene]) -> Vec<u32> {
    let Some((first, others)) = scenes.split_first() else { return Vec::new() };
    let changed = changed_materials(first.shading, others);
    let slots = 0..first.geometry.primitives.len();
    let moving = slots.filter(|slot| Slot::of(first, *slot).moves(others, &changed, *slot));
    moving.map(|slot| slot as u32).collect()
}

/// For each material, whether it differs between scenes.
fn changed_materials(first: &Shading, others: &[Scene]) -> Vec<bool> {
    let differs =
        |index: usize| others.iter().any(|scene| scene.shading.materials[index] != first.materials[index]);
    (0..first.materials.len()).map(differs).collect()
}

/// What a ray may meet in a slot. Only textures read the shape's own space.
#[derive(PartialEq)]
struct Slot<'a> {
    primitive: &'a Primitive,
    origin: Option<&'a super::geometry::Origin>,
}

impl<'a> Slot<'a> {
    fn of(scene: &Scene<'a>, slot: usize) -> Self {
        let primitive = &scene.geometry.primitives[slot];
        let textured = |material: u32| !scene.shading.materials[material as usize].textures.is_empty();
        let origin = primitive.materials().any(textured).then(|| scene.geometry.origin(slot));
        Self { primitive, origin }
    }

    /// Whether this slot shows one of the `changed` materials, or differs from that of any other scene.
    fn moves(&self, others: &[Scene], changed: &[bool], slot: usize) -> bool {
        let shows = self.primitive.materials().any(|material| changed[material as usize]);
        shows || others.iter().any(|scene| Slot::of(scene, slot) != *self)
    }
}

/// A primitive that moves, as it is in some frames.
#[derive(Debug)]
struct Mover<'a> {
    primitive: &'a Primitive,
    frames: FrameMask,
}

/// The frames in which a segment may meet a mover.
#[derive(Clone, Copy, Debug)]
pub struct FramesMet {
    pub frames: FrameMask,
    /// The number of searches of movers with many parts.
    pub tests: u32,
}

/// The primitives that differ between poses, each where it is in each of them.
#[derive(Debug)]
pub struct Movers<'a> {
    /// Those of frames with one moment.
    always: MoverTree<'a>,
    /// Those of frames with several moments, by the moment.
    moments: Vec<MoverTree<'a>>,
}

impl<'a> Movers<'a> {
    /// The primitives in these slots, in all poses.
    pub fn new(poses: &[MoverPose<'a>], slots: &[u32]) -> Self {
        let at = |moment| MoverTree::new(poses.iter().filter(|pose| pose.moment == moment), slots);
        let count = poses.iter().filter_map(|pose| pose.moment).max().map_or(0, |last| last + 1);
        Self { always: at(None), moments: (0..count).map(|moment| at(Some(moment))).collect() }
    }

    /// The frames in which a ray may meet a mover within bounds, besides those that are `known`. Of frames with several
    /// moments, only `moment` counts.
    #[inline(always)]
    pub fn frames_met<L: Level>(
        &self,
        ray: &TraversalRay,
        within: RayInterval<f64>,
        test: (MoverTest, RayKind),
        (known, moment): (FrameMask, u32),
        stack: &mut Stack,
    ) -> FramesMet {
        let segment = Segment { ray, within, test };
        let known = FramesMet { frames: known, tests: 0 };
        let known = self.always.frames_met::<L>(segment, known, stack);
        match self.moments.get(moment as usize) {
            Some(movers) => movers.frames_met::<L>(segment, known, stack),
            None => known,
        }
    }
}

/// Up to eight segments, which are tested alike.
#[derive(Clone, Copy)]
pub struct LaneSegments<'a, L: Level> {
    pub ray: &'a PreparedRay<L::F64>,
    pub within: RayInterval<L::F64>,
    pub test: MoverTest,
    /// What sees a mover, for each ray.
    pub kinds: &'a [RayKind; 8],
    /// The rays that count, one bit each.
    pub wanted: u32,
    /// All frames: a ray that meets a mover in each of them needs no further tests.
    pub all: FrameMask,
}

/// The stacks of searches for movers.
#[derive(Default)]
pub struct MoverStacks {
    pub single: Stack,
    bundle: BundleStack,
}

impl Movers<'_> {
    /// Whether no frame has several moments, so that segments of all samples meet the same movers.
    pub fn are_always(&self) -> bool {
        self.moments.is_empty()
    }

    /// [`Movers::frames_met`] of eight segments, if [all movers are always there](Movers::are_always). Adds the frames to
    /// those that are known. Returns the number of searches of movers with many parts.
    #[inline(always)]
    pub fn frames_met_in_lanes<L: Level>(
        &self,
        segments: LaneSegments<L>,
        known: &mut [FrameMask; 8],
        stacks: &mut MoverStacks,
    ) -> u32 {
        let movers = &self.always;
        L::call_with(LaneTreeSearch::<L> { movers, segments, known, stacks })
    }
}

/// A search of a whole tree along eight segments.
struct LaneTreeSearch<'a, 's, L: Level> {
    movers: &'a MoverTree<'a>,
    segments: LaneSegments<'a, L>,
    known: &'s mut [FrameMask; 8],
    stacks: &'s mut MoverStacks,
}

impl<L: Level> LaneKernel<L> for LaneTreeSearch<'_, '_, L> {
    type Output = u32;

    #[inline(always)]
    fn run(self) -> u32 {
        let Self { movers, segments, known, stacks } = self;
        let LaneSegments { ray, within, test, kinds, wanted, .. } = segments;
        let (slabs, near, afar) = BundleSlabs::<L>::new(&movers.tree, &ray.ray, L::F64::splat(0.0), wanted);
        let open = L::F64::select(L::Mask::from_bits(wanted), within.max, L::F64::splat(-1.0));
        let mut search = LaneSearch { movers, segments, met: *known, limit: slabs.limit(open), tests: 0 };
        for index in movers.bounded..movers.all.len() {
            search.test(&[index as u32], wanted & !afar);
        }
        if near != 0 {
            movers.tree.walk_bundle(&slabs, near, &mut search, &mut stacks.bundle);
        }
        let LaneSearch { mut met, mut tests, .. } = search;
        let [min, max] = [within.min.to_array(), within.max.to_array()];
        for lane in lanes(afar) {
            let single = TraversalRay::new(ray.ray.lane(lane));
            let within = RayInterval { min: min[lane], max: max[lane] };
            let segment = Segment { ray: &single, within, test: (test, kinds[lane]) };
            let known = FramesMet { frames: met[lane], tests: 0 };
            let found = movers.frames_met::<L::Narrow>(segment, known, &mut stacks.single);
            met[lane] = found.frames;
            tests += found.tests;
        }
        *known = met;
        tests
    }
}

/// The frames in which eight segments meet movers.
struct LaneSearch<'a, L: Level> {
    movers: &'a MoverTree<'a>,
    segments: LaneSegments<'a, L>,
    met: [FrameMask; 8],
    /// Below 0 for rays that meet movers in all frames.
    limit: L::F32,
    tests: u32,
}

impl<L: Level> LaneSearch<'_, L> {
    #[inline(always)]
    fn test(&mut self, indices: &[u32], rays: u32) {
        if !indices.is_empty() {
            L::call_with(LaneTest { search: self, indices, rays });
        }
    }

    #[inline(always)]
    fn test_one(&mut self, index: u32, rays: u32) {
        let Mover { primitive, frames } = &self.movers.all[index as usize];
        let LaneSegments { ray, within, test, kinds, all, .. } = self.segments;
        let mut wanted = 0;
        for lane in lanes(rays) {
            let is_open = frames & !self.met[lane] != 0 && primitive.rays.has(kinds[lane]);
            wanted |= u32::from(is_open) << lane;
        }
        if wanted == 0 {
            return;
        }
        let mask = L::Mask::from_bits(wanted);
        let within =
            RayInterval { min: within.min, max: L::F64::select(mask, within.max, L::F64::splat(-1.0)) };
        let met = match test {
            MoverTest::Hit => primitive.intersect(ray, within).is_hit(),
            MoverTest::Block => primitive.occludes(ray, within),
            MoverTest::Bounds => mask,
        };
        self.tests += wanted.count_ones() * searches(primitive, test);
        let mut full = 0;
        for lane in lanes((met & mask).bits()) {
            self.met[lane] |= frames;
            full |= u32::from(self.met[lane] == all) << lane;
        }
        if full != 0 {
            self.limit = L::F32::select(L::Mask::from_bits(full), L::F32::splat(-1.0), self.limit);
        }
    }
}

impl<L: Level> BundleVisitor<L> for LaneSearch<'_, L> {
    const IN_ORDER: bool = false;

    #[inline(always)]
    fn visit(&mut self, leaf: u32, rays: u32) {
        self.test(self.movers.leaves.leaf(leaf), rays);
    }

    #[inline(always)]
    fn limit(&self) -> L::F32 {
        self.limit
    }
}

/// Tests of some movers. Like those of single rays, they are a function of their own.
struct LaneTest<'s, 'a, L: Level> {
    search: &'s mut LaneSearch<'a, L>,
    indices: &'s [u32],
    rays: u32,
}

impl<L: Level> LaneKernel<L> for LaneTest<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.indices.iter().for_each(|&index| self.search.test_one(index, self.rays));
    }
}

/// The movers of poses, in a tree.
#[derive(Debug)]
struct MoverTree<'a> {
    /// Over the bounded ones, which come first.
    tree: Tree,
    leaves: LeafPrimitives,
    all: Vec<Mover<'a>>,
    bounded: usize,
}

impl<'a> MoverTree<'a> {
    fn new<'p>(poses: impl Iterator<Item = &'p MoverPose<'a>> + Clone, slots: &[u32]) -> Self
    where
        'a: 'p,
    {
        let mut all: Vec<Mover> = Vec::new();
        for &slot in slots {
            // While a primitive rests, it is one mover.
            let mut last: Option<usize> = None;
            for pose in poses.clone() {
                let primitive = &pose.scene.geometry.primitives[slot as usize];
                match last {
                    _ if primitive.is_empty() => {}
                    Some(at) if all[at].primitive == primitive => all[at].frames |= pose.frame,
                    _ => {
                        last = Some(all.len());
                        all.push(Mover { primitive, frames: pose.frame });
                    }
                }
            }
        }
        all.sort_by_key(|mover| mover.primitive.bounds().is_none());
        let boxes: Vec<_> = all.iter().map_while(|mover| mover.primitive.bounds()).collect();
        let (tree, leaves) = Tree::of_boxes(&boxes);
        Self { tree, leaves, all, bounded: boxes.len() }
    }

    #[inline(always)]
    fn frames_met<L: Level>(&self, segment: Segment, known: FramesMet, stack: &mut Stack) -> FramesMet {
        L::call(TreeSearch { search: Search { movers: self, segment, met: known }, stack })
    }
}

/// Which movers a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoverTest {
    /// Those that it hits. The test is that of the tracer, so a ray that hits none of them has the same hits without
    /// them.
    Hit,
    /// Those that block it, by the test of shadow rays.
    Block,
    /// Those whose bounds it may touch.
    Bounds,
}

/// How many searches of a shape with many parts a test takes, as the work of one for each part of a solid. Tests of other
/// shapes take next to nothing.
fn searches(primitive: &Primitive, test: MoverTest) -> u32 {
    match (&primitive.shape, test) {
        (_, MoverTest::Bounds) => 0,
        (Shape::Solid(solid), _) => solid.parts().len() as u32,
        (shape, _) => u32::from(shape.has_tree()),
    }
}

/// A ray within bounds, and the test by which movers count.
#[derive(Clone, Copy)]
struct Segment<'a> {
    ray: &'a TraversalRay,
    within: RayInterval<f64>,
    test: (MoverTest, RayKind),
}

/// The frames in which a segment meets a mover.
struct Search<'a> {
    movers: &'a MoverTree<'a>,
    segment: Segment<'a>,
    met: FramesMet,
}

/// A search of a whole tree. It is a function of its own, as is each test of a mover: many loops search, and the tests
/// of all shapes are long.
struct TreeSearch<'a, 's> {
    search: Search<'a>,
    stack: &'s mut Stack,
}

impl SimdKernel for TreeSearch<'_, '_> {
    type Output = FramesMet;

    #[inline(always)]
    fn run<L: Level>(self) -> FramesMet {
        let Self { mut search, stack } = self;
        let MoverTree { tree, bounded, all, .. } = search.movers;
        for index in *bounded..all.len() {
            search.test::<L>(index);
        }
        let Segment { ray, within, .. } = search.segment;
        tree.walk_on::<L>(ray, [0.0, within.max], &mut search, stack);
        search.met
    }
}

impl Search<'_> {
    #[inline(always)]
    fn test<L: Level>(&mut self, index: usize) {
        let mover = &self.movers.all[index];
        let (test, kind) = self.segment.test;
        if mover.frames & !self.met.frames == 0 || !mover.primitive.rays.has(kind) {
            return;
        }
        self.met.tests += searches(mover.primitive, test);
        if L::call(Meets { mover, segment: self.segment }) {
            self.met.frames |= mover.frames;
        }
    }
}

/// Whether a segment meets a mover that its rays see.
struct Meets<'a> {
    mover: &'a Mover<'a>,
    segment: Segment<'a>,
}

impl SimdKernel for Meets<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Level>(self) -> bool {
        let primitive = self.mover.primitive;
        let Segment { ray, within, test: (test, _) } = self.segment;
        match test {
            MoverTest::Hit => primitive.intersect_on::<L>(ray, within, None).is_some(),
            MoverTest::Block => primitive.occludes_on::<L>(ray, within, None),
            MoverTest::Bounds => true,
        }
    }
}

impl LeafVisitor for Search<'_> {
    #[inline(always)]
    fn prefetch<L: Level>(&self, _: u32) {}

    #[inline(always)]
    fn visit<L: Level>(&mut self, leaf: u32, _: &Slabs, limit: f32) -> Option<f32> {
        for &index in self.movers.leaves.leaf(leaf) {
            self.test::<L>(index as usize);
        }
        Some(limit)
    }
}

/// Whether something that differs between two scenes is a light or, with `emitters`, emits light itself. Then sampled
/// light depends on where it is.
pub fn has_moving_source(scenes: [Scene; 2], emitters: bool) -> bool {
    let [first, other] = &scenes;
    let emits = |scene: &Scene, slot: usize| {
        let finish = scene.geometry.finishes()[slot];
        let lit = |material: u32| scene.shading.materials[material as usize].lobes.emission != Rgb::ZERO;
        matches!(finish, Finish::Light(_)) || emitters && finish.materials().any(lit)
    };
    let slots = 0..first.geometry.primitives.len();
    let mut sources = slots.filter(|slot| emits(first, *slot) || emits(other, *slot)).peekable();
    if sources.peek().is_none() {
        return false;
    }
    let changed = changed_materials(first.shading, &[*other]);
    sources.any(|slot| Slot::of(first, slot).moves(&[*other], &changed, slot))
}

/// The geometry without the primitives in some slots.
pub fn without(geometry: &Geometry, slots: &[u32]) -> Geometry {
    let mut still = geometry.clone();
    for &slot in slots {
        still.set(slot as usize, None);
    }
    still
}
