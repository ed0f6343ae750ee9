//! The wavefront: all paths of a wave go from one surface to the next together, stage by stage.
//!
//! generate → intersect → segments → escape, emitters, shade by queue → shadow rays → sums, again and again until no path
//! goes on. What a sample gets is added in an order that depends on the sample alone: by surface along the path, by stage,
//! by queue. So its sum has the same bytes whichever samples are followed with it.

#[cfg(test)]
mod tests;

use super::accumulate::Accumulator;
use super::aov::Record;
use super::coincident::Events;
use super::context::{Queue, TraceContext};
use super::emitter::Emitter;
use super::escape::Escape;
use super::generate::{Generate, PixelSamples};
use super::intersect::Hits;
use super::materials::LobeTable;
use super::medium::MediaLists;
use super::segment::Segments;
use super::shade::{Shade, Stage};
use super::shadow::Cast;
use super::shadow_stream::ShadowStream;
use super::stream::PathStream;
use crate::appearance::material::Lobes;
use crate::base::lanes::dispatch;
use crate::base::stats::Counts;
use crate::scene::top_level::Coherence;

/// Samples that are followed at once, at most: their paths fit into a core's cache.
pub const WAVE: usize = 1024;

/// Paths that go on together, at most. Branching paths become many: with so many at each depth, memory grows with the
/// depth, not with the number of branches.
const MOST: usize = 8 * WAVE;

/// What a thread traces with: kept from wave to wave.
pub struct ScratchBuffer {
    /// Streams that are not in use.
    free: Vec<PathStream>,
    hits: Hits,
    events: Events,
    media: MediaLists,
    shadows: Vec<ShadowStream>,
    rows: LobeTable,
    samples: PixelSamples,
    places: Vec<u32>,
    pub sums: Accumulator,
    pub counts: Counts,
    /// Paths that go on together, at most.
    most: usize,
    /// How many paths there were at once, at most.
    #[cfg(test)]
    peak: usize,
}

impl ScratchBuffer {
    pub fn new(context: &TraceContext) -> Self {
        let rows = [Lobes::default(); 8];
        let requests = context.lights.requests().iter();
        Self {
            free: Vec::new(),
            hits: Hits::new(context.classes.len()),
            events: Events::default(),
            media: MediaLists::default(),
            shadows: requests.map(|_| ShadowStream::new(context.clear, context.media)).collect(),
            rows: LobeTable::new(rows.iter()),
            samples: PixelSamples::with_capacity(WAVE),
            places: Vec::with_capacity(WAVE),
            sums: Accumulator::new(context.layers),
            counts: Counts::default(),
            most: MOST,
            #[cfg(test)]
            peak: 0,
        }
    }

    /// Room for the samples of a wave, and for their pixels' places: empty.
    pub fn take_samples(&mut self) -> (PixelSamples, Vec<u32>) {
        (std::mem::take(&mut self.samples), std::mem::take(&mut self.places))
    }

    /// Keeps that room for later.
    pub fn give_back(&mut self, samples: PixelSamples, places: Vec<u32>) {
        (self.samples, self.places) = (samples, places);
    }

    /// Follows the paths of samples, [`WAVE`] at most, to their ends. What they gather is in the sums then, sample by sample.
    pub fn follow(&mut self, context: &TraceContext, samples: &PixelSamples, grid: Option<u32>) {
        self.sums.reset(samples.len());
        self.events.clear();
        self.media.trim();
        let mut paths = self.stream(context);
        let counts = &mut self.counts;
        dispatch(Generate { context, samples, grid, paths: &mut paths, counts });
        let mut waiting = vec![paths];
        while let Some(mut paths) = waiting.pop() {
            // A sample that has more paths than that is always alone here: how it is split depends on nothing else.
            if paths.len() > self.most {
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

    fn stream(&mut self, context: &TraceContext) -> PathStream {
        self.free.pop().unwrap_or_else(|| PathStream::new(context.columns))
    }

    /// Takes paths to what they meet next, for those that go on from there.
    fn step(&mut self, context: &TraceContext, samples: &PixelSamples, paths: &mut PathStream) -> PathStream {
        let coherence = if paths.depth() == 0 { Coherence::Together } else { Coherence::Apart };
        let mut next = self.stream(context);
        next.clear();
        next.set_depth(paths.depth() + 1);
        let Self { hits, events, media, shadows, rows, sums, counts, .. } = self;
        hits.find(context, paths, coherence, (events, media));
        if context.fog.is_some() || context.media {
            dispatch(Segments { context, paths, hits, media, sums, counts });
        }
        shadows.iter_mut().for_each(ShadowStream::clear);
        let next_paths = &mut next;
        let mut stage = Stage {
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
        stage.shade();
        for (request, shadows) in context.lights.requests().iter().zip(&*shadows) {
            if !shadows.is_empty() {
                let layer = request.layer;
                dispatch(Cast { context, shadows, layer, coherence, events, media, rows, sums, counts });
            }
        }
        next
    }
}

impl Stage<'_> {
    /// Works off all queues.
    fn shade(&mut self) {
        let surfaces = (0..self.context.classes.len() as u32).map(Queue::Surface);
        for queue in [Queue::Escaped, Queue::Light].into_iter().chain(surfaces) {
            let paths = self.hits.queue(queue);
            if paths.is_empty() {
                continue;
            }
            if let Some(first) = self.context.aovs {
                dispatch(Record { stage: self, queue, first });
            }
            match queue {
                Queue::Escaped => dispatch(Escape { stage: self, queue: paths }),
                Queue::Light => dispatch(Emitter { stage: self, queue: paths }),
                Queue::Surface(class) => {
                    let lobes = self.context.classes[class as usize];
                    dispatch(Shade { stage: self, queue: paths, lobes });
                }
            }
        }
    }
}
