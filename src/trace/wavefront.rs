//! The wavefront integrator: all paths of a wave advance from surface to surface together, stage by stage.
//!
//! generate → intersect → segments → escape, emitters, shade by queue → shadow rays → sums
//!
//! The stages repeat until no path continues. The order in which light is added to a sample depends on the sample
//! alone: by surface along the path, by stage, by queue. So its sum has the same bytes whichever samples share its
//! wave.

#[cfg(test)]
mod tests;

use super::accumulate::Accumulator;
use super::aov::{RecordAovs, RecordedSurface};
use super::camera_rays::{GenerateRays, PixelSamples, Placement};
use super::coincident::Events;
use super::context::{Queue, TraceContext};
use super::emitter::HandleEmitters;
use super::escape::HandleEscaped;
use super::intersect::HitStream;
use super::marks::{MarkSegments, Marks};
use super::materials::LobeTable;
use super::medium::MediaLists;
use super::segment::AttenuateSegments;
use super::shade::WaveState;
use super::shade_queue::ShadeQueue;
use super::shadow::TraceShadowRays;
use super::shadow_stream::ShadowStream;
use super::stream::PathStream;
use crate::appearance::material::Lobes;
use crate::base::lanes::dispatch;
use crate::base::stats::Counts;
use crate::scene::top_level::{Coherence, Stacks};

/// The most samples of a wave. Their paths fit into a core's cache.
pub const WAVE: usize = 1024;

/// The most paths that advance together. Branching paths become many. With this limit, memory grows with the depth of
/// paths, not with the number of branches.
const MAX_PATHS: usize = 8 * WAVE;

/// The buffers of a thread, kept from wave to wave.
pub struct ScratchBuffer {
    /// Streams that are not in use.
    free: Vec<PathStream>,
    hits: HitStream,
    events: Events,
    media: MediaLists,
    shadows: Vec<ShadowStream>,
    /// What the searches along shadow rays leave to the next ones.
    shadow_stacks: Stacks,
    rows: LobeTable,
    samples: PixelSamples,
    places: Vec<u32>,
    pub sums: Accumulator,
    pub marks: Marks,
    pub counts: Counts,
    /// The most paths that advance together.
    max_paths: usize,
    /// The most paths at one time.
    #[cfg(test)]
    peak: usize,
}

impl ScratchBuffer {
    pub fn new(context: &TraceContext) -> Self {
        let rows = [Lobes::default(); 8];
        let requests = context.lights.requests().iter();
        let mut shadow_stacks = Stacks::default();
        shadow_stacks.find_isolated(context.media && context.refractive_shadows);
        Self {
            free: Vec::new(),
            hits: HitStream::new(context.classes.len(), context.media),
            events: Events::default(),
            media: MediaLists::default(),
            shadows: requests.map(|_| ShadowStream::new(context.has_transparency(), context.media)).collect(),
            shadow_stacks,
            rows: LobeTable::new(rows.iter()),
            samples: PixelSamples::with_capacity(WAVE),
            places: Vec::with_capacity(WAVE),
            sums: Accumulator::new(context.layers),
            marks: Marks::default(),
            counts: Counts::default(),
            max_paths: MAX_PATHS,
            #[cfg(test)]
            peak: 0,
        }
    }

    /// Prepares the buffer for another context. It keeps its memory, and nothing that depends on the context before.
    pub fn fit(&mut self, context: &TraceContext) {
        let shadows = || ShadowStream::new(context.has_transparency(), context.media);
        self.free.retain(|paths| paths.columns() == context.columns);
        self.hits.fit(context.classes.len(), context.media);
        self.shadow_stacks.find_isolated(context.media && context.refractive_shadows);
        self.media.clear();
        self.shadows.retain(|stream| stream.is_like(&shadows()));
        self.shadows.resize_with(context.lights.requests().len(), shadows);
        self.sums.fit(context.layers);
    }

    /// Empty buffers for the samples of a wave and the places of their pixels.
    pub fn take_samples(&mut self) -> (PixelSamples, Vec<u32>) {
        (std::mem::take(&mut self.samples), std::mem::take(&mut self.places))
    }

    /// Returns these buffers.
    pub fn give_back(&mut self, samples: PixelSamples, places: Vec<u32>) {
        (self.samples, self.places) = (samples, places);
    }

    /// Traces the paths of samples, at most [`WAVE`], to their ends. Then the sums hold the light of each sample.
    pub fn follow(&mut self, context: &TraceContext, samples: &PixelSamples, placement: Placement) {
        self.sums.reset(samples.len());
        self.events.clear();
        self.media.trim();
        let mut paths = self.stream(context);
        let counts = &mut self.counts;
        dispatch(GenerateRays { context, samples, placement, paths: &mut paths, counts });
        let mut waiting = vec![paths];
        while let Some(mut paths) = waiting.pop() {
            // A sample with more paths than the limit is always alone here. So its split depends on nothing else.
            if paths.len() > self.max_paths {
                let mut later = self.stream(context);
                paths.split(&mut later);
                waiting.extend([later, paths]);
                continue;
            }
            let next = self.step(context, samples, &mut paths);
            #[cfg(test)]
            {
                let waiting: usize = waiting.iter().map(PathStream::len).sum();
                self.peak = self.peak.max(waiting + paths.len() + next.len());
            }
            self.free.push(paths);
            if next.is_empty() { self.free.push(next) } else { waiting.push(next) }
        }
    }

    /// The first hits of samples, at most [`WAVE`], in their order. Nothing is shaded.
    pub fn first_hits(
        &mut self,
        context: &TraceContext,
        samples: &PixelSamples,
        placement: Placement,
    ) -> &HitStream {
        self.events.clear();
        self.media.trim();
        let mut paths = self.stream(context);
        let counts = &mut self.counts;
        dispatch(GenerateRays { context, samples, placement, paths: &mut paths, counts });
        self.hits.find(context, &paths, Coherence::Coherent, (&mut self.events, &self.media));
        self.free.push(paths);
        &self.hits
    }

    fn stream(&mut self, context: &TraceContext) -> PathStream {
        self.free.pop().unwrap_or_else(|| PathStream::new(context.columns))
    }

    /// Advances paths to their next hits. Returns the paths that continue.
    fn step(&mut self, context: &TraceContext, samples: &PixelSamples, paths: &mut PathStream) -> PathStream {
        let coherence = if paths.depth() == 0 { Coherence::Coherent } else { Coherence::Incoherent };
        let mut next = self.stream(context);
        next.clear();
        next.set_depth(paths.depth() + 1);
        let Self { hits, events, media, shadows, shadow_stacks: stacks, rows, sums, marks, counts, .. } =
            self;
        hits.find(context, paths, coherence, (events, media));
        if let Some(movers) = context.movers {
            dispatch(MarkSegments { context, movers, paths, hits, marks });
        }
        if context.fog.is_some() || context.absorbs {
            dispatch(AttenuateSegments { context, paths, hits, media, sums, counts });
        }
        shadows.iter_mut().for_each(ShadowStream::clear);
        let next_paths = &mut next;
        let mut wave = WaveState {
            context,
            samples,
            paths,
            hits,
            events,
            next: next_paths,
            shadows,
            sums,
            counts,
            media,
            rows,
        };
        wave.shade();
        for (request, shadows) in context.lights.requests().iter().zip(&*shadows) {
            if !shadows.is_empty() {
                let layer = request.layer;
                dispatch(TraceShadowRays {
                    context,
                    shadows,
                    layer,
                    coherence,
                    stacks,
                    events,
                    media,
                    rows,
                    sums,
                    marks,
                    counts,
                });
            }
        }
        next
    }
}

impl WaveState<'_> {
    /// Processes all queues.
    fn shade(&mut self) {
        let surfaces = (0..self.context.classes.len() as u32).map(Queue::Surface);
        for queue in [Queue::Escaped, Queue::Light].into_iter().chain(surfaces) {
            let paths = self.hits.queue(queue);
            if paths.is_empty() {
                continue;
            }
            if let Some(first) = self.context.aovs {
                let surface = RecordedSurface::Visible;
                dispatch(RecordAovs { wave: self, queue, first, scale: 1.0, surface });
            }
            if let Some(guides) = self.context.guides {
                let (first, scale, surface) = (guides.layer, guides.scale, RecordedSurface::Scattering);
                dispatch(RecordAovs { wave: self, queue, first, scale, surface });
            }
            match queue {
                Queue::Escaped => dispatch(HandleEscaped { wave: self, queue: paths }),
                Queue::Light => dispatch(HandleEmitters { wave: self, queue: paths }),
                Queue::Surface(class) => {
                    let lobes = self.context.classes[class as usize];
                    dispatch(ShadeQueue { wave: self, queue: paths, lobes });
                }
            }
        }
    }
}
