//! The intersect stage: finds the hits of a wave's paths and sorts the paths into queues.

use super::coincident::{Events, ISOLATED, NO_EVENT};
use super::context::{Queue, TraceContext};
use super::medium::MediaLists;
use super::path_queue::{PathQueue, Ranks};
use super::stream::PathStream;
use crate::base::lanes::{Level, Lookup, Mask, Real, Row, SimdKernel, dispatch, lanes};
use crate::base::math::{DVec3, Ray};
use crate::geometry::ray_kinds::RayKind;
use crate::geometry::shape::{LaneHit, RayInterval};
use crate::scene::top_level::{Coherence, Hit, LaneHits, NOTHING, Stacks};
use std::mem::take;

/// The hit of each path of a stream, and the queues.
#[derive(Default)]
pub struct HitStream {
    pub t: Vec<f64>,
    pub primitive: Vec<u32>,
    pub part: Vec<u32>,
    /// The index of the material or light.
    pub material: Vec<u32>,
    /// The event, if surfaces coincide; [`ISOLATED`] or [`NO_EVENT`] otherwise.
    pub event: Vec<u32>,
    /// Paths with other hits close to theirs.
    close: Vec<u32>,
    escaped: PathQueue,
    lights: PathQueue,
    surfaces: Vec<PathQueue>,
    ranks: Ranks,
    /// What the searches of one stage leave to the next one.
    stacks: Stacks,
}

impl HitStream {
    pub fn new(classes: usize, refracts: bool) -> Self {
        let mut stream = Self::default();
        stream.fit(classes, refracts);
        stream
    }

    /// Prepares for scenes with this number of sets of lobes. Only refraction needs to know which hits are isolated.
    pub fn fit(&mut self, classes: usize, refracts: bool) {
        self.surfaces.resize(classes, PathQueue::default());
        self.stacks.find_isolated(refracts);
    }

    fn reset(&mut self, count: usize) {
        let size = count.next_multiple_of(8);
        self.t.resize(size, 0.0);
        [&mut self.primitive, &mut self.part, &mut self.material].into_iter().for_each(|column| {
            column.resize(size, 0);
        });
        self.event.clear();
        self.event.resize(size, NO_EVENT);
        self.close.clear();
        self.escaped.clear();
        self.lights.clear();
        self.surfaces.iter_mut().for_each(PathQueue::clear);
    }

    /// The paths of a queue.
    pub fn queue(&self, queue: Queue) -> &PathQueue {
        match queue {
            Queue::Escaped => &self.escaped,
            Queue::Light => &self.lights,
            Queue::Surface(class) => &self.surfaces[class as usize],
        }
    }

    /// Finds the hits of paths, and puts each path into its queue.
    pub fn find(
        &mut self,
        context: &TraceContext,
        paths: &PathStream,
        coherence: Coherence,
        (events, media): (&mut Events, &MediaLists),
    ) {
        self.reset(paths.len());
        dispatch(Intersect { context, paths, coherence, events, media, hits: self });
        self.resolve(context, paths, (events, media));
        let Self { primitive, part, material, escaped, lights, surfaces, ranks, .. } = self;
        let hits = primitive.iter().zip(part).zip(material).take(paths.len());
        for (number, ((primitive, part), material)) in (0..).zip(hits) {
            if *primitive == NOTHING {
                escaped.push(number);
                continue;
            }
            let (queue, index) = context.route(*primitive, *part);
            *material = index;
            match queue {
                Queue::Surface(class) => surfaces[class as usize].push(number),
                Queue::Light => lights.push(number),
                Queue::Escaped => escaped.push(number),
            }
        }
        if context.branches && paths.depth() > 0 {
            let queues = surfaces.iter_mut().chain([lights, escaped]);
            queues.for_each(|queue| queue.separate(paths.slots(), ranks));
        }
    }

    /// Resolves hits that are close to others.
    #[inline(never)]
    fn resolve(
        &mut self,
        context: &TraceContext,
        paths: &PathStream,
        (events, media): (&mut Events, &MediaLists),
    ) {
        let materials = &context.scene.shading.materials;
        let close = take(&mut self.close);
        for &index in &close {
            let at = Lookup::run(index, 1);
            let ray = paths.ray::<f64>(&at);
            let ray = Ray { origin: DVec3::from(ray.origin), direction: DVec3::from(ray.direction) };
            let index = index as usize;
            let kind = paths.ray_kind(index);
            let number = context.resolve((&ray, kind), (self.t[index], f64::INFINITY), events);
            if let Some(hit) = events.hit(number, (media, paths.medium(index)), materials) {
                self.meet(index, number, hit);
            }
        }
        self.close = close;
    }

    /// The paths with other hits close to theirs.
    pub fn close(&self) -> &[u32] {
        &self.close
    }

    /// Replaces the hit of a path by that of an event.
    fn meet(&mut self, index: usize, number: u32, Hit { at, primitive }: Hit) {
        (self.t[index], self.part[index], self.primitive[index]) = (at.t, at.part, primitive);
        self.event[index] = number;
    }

    /// Notes which hits of some of the paths from `first` on are close to others, and which ones are isolated.
    #[inline(always)]
    fn note<L: Level>(&mut self, first: usize, wanted: u32, found: &LaneHits<L::F64>) {
        for lane in lanes(found.at.coincident.bits() & wanted) {
            self.close.push((first + lane) as u32);
        }
        for lane in lanes(found.at.isolated & wanted) {
            self.event[first + lane] = ISOLATED;
        }
    }

    /// Takes the hits of some of the paths from `first` on.
    #[inline(always)]
    fn take<L: Level>(&mut self, first: usize, wanted: u32, found: &LaneHits<L::F64>) {
        self.note::<L>(first, wanted, found);
        let (t, part) = (found.at.t.to_array(), found.at.part.to_array());
        let primitive = found.primitive.to_array();
        for lane in lanes(wanted) {
            self.t[first + lane] = t[lane];
            self.part[first + lane] = part[lane];
            self.primitive[first + lane] = primitive[lane];
        }
    }

    /// The hits of the paths of these indices.
    #[inline(always)]
    pub fn at<F: Real>(&self, at: &Lookup) -> LaneHit<F> {
        LaneHit { t: F::gather(&self.t, at), part: F::U32::gather(&self.part, at), ..LaneHit::none() }
    }
}

struct Intersect<'a> {
    context: &'a TraceContext<'a>,
    paths: &'a PathStream,
    coherence: Coherence,
    events: &'a Events,
    media: &'a MediaLists,
    hits: &'a mut HitStream,
}

impl SimdKernel for Intersect<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { context, paths, coherence, events, media, hits } = self;
        let geometry = context.scene.geometry;
        // If both see the same, this is one tree.
        let (first_tree, other_tree) = (context.bvh.of(RayKind::Camera), context.bvh.of(RayKind::Scattered));
        let (mut stacks, materials) = (take(&mut hits.stacks), &context.scene.shading.materials);
        for first in (0..paths.len()).step_by(8) {
            let count = (paths.len() - first).min(8);
            let at = Lookup::run(first as u32, count);
            let mut wanted = 0xff >> (8 - count);
            if context.columns.media {
                for lane in lanes(wanted) {
                    let pending = paths.pending(first + lane);
                    let inside = (media, paths.medium(first + lane));
                    if let Some(hit) = events.hit(pending, inside, materials) {
                        hits.meet(first + lane, pending, hit);
                        wanted &= !(1 << lane);
                    }
                }
            }
            let ray = paths.ray::<L::F64>(&at);
            let within = RayInterval { min: paths.t_start::<L::F64>(&at), max: L::F64::splat(f64::INFINITY) };
            let mask = L::Mask::from_bits(wanted);
            let mut kind = wanted;
            if context.parts_rays {
                kind &= paths.primary(first);
                let others = wanted & !kind;
                if others != 0 {
                    let mask = L::Mask::from_bits(others);
                    let found =
                        other_tree.intersect::<L>(geometry, &ray, within, mask, coherence, &mut stacks);
                    hits.take::<L>(first, others, &found);
                }
            }
            let mask = if kind == wanted { mask } else { L::Mask::from_bits(kind) };
            let wanted = kind;
            let found = first_tree.intersect::<L>(geometry, &ray, within, mask, coherence, &mut stacks);
            if wanted == 0xff >> (8 - count) {
                hits.note::<L>(first, wanted, &found);
                found.at.t.store(&mut hits.t, first);
                found.at.part.store(&mut hits.part, first);
                found.primitive.store(&mut hits.primitive, first);
                continue;
            }
            hits.take::<L>(first, wanted, &found);
        }
        hits.stacks = stacks;
    }
}
