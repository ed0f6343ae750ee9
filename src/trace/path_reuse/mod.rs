//! Traces several frames together whose scenes differ only in some primitives: the movers.
//!
//! Each sample is traced once in the scene without movers, and marked with the frames in which a mover meets one of its
//! segments ([`super::marks`]). Only in these frames is the sample traced again, in the whole scene. In all others it
//! has the same light, bit by bit. Every frame sums the light of its samples in the order in which it would sum them if
//! it were traced alone.
//!
//! Where movers are seen or cast shadows in most frames, that is more work than tracing each frame alone. So each tile of the
//! picture is traced together only as far as it pays there.
//!
//! In: the scenes of the frames, one for each moment of a shutter. Out: the films of all frames.

mod gain;
mod samples;
#[cfg(test)]
mod tests;
mod tile;

pub use gain::{sharing_pays, sharing_would_pay};

use super::pixels::PixelTracer;
use super::scratch_pool::ScratchPool;
use super::settings::{Moment, TraceSettings};
use super::{ONE_EACH, TILE, Tile, is_random};
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::base::stats::{Counts, ProgressMeter};
use crate::film::Film;
use crate::scene::Scene;
use crate::scene::movers::{FrameMask, MoverPose, Movers, has_moving_source, moving_slots, without};
use crate::scene::top_level::Bvh;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use tile::{Limits, SharedTile, TileTracer, in_order};

/// The most frames that are traced together.
pub const MAX_FRAMES: usize = FrameMask::BITS as usize;

/// Tiles that are traced before films take their results and the gain over the whole picture is measured again: this many, or
/// one of so many parts of a large picture.
const AT_ONCE: usize = 64;
const PARTS: usize = 8;

/// Why the paths of two frames are not shared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathObstacle {
    /// What moves or changes is a light, or emits light that surfaces sample.
    MovingSource,
    /// Error bounds differ, because the extents of the scenes do.
    Extent,
    /// Samples differ in kind, or in the number of their moments.
    Sampling,
    /// Copies of the scenes do not fit into memory.
    Memory,
    /// Meshes or particles that change take too much memory.
    ShapeData,
    /// Most paths change.
    Changes,
}

/// Bytes of a pose besides its scene: its tracer, and its place in lists.
pub const BYTES_PER_POSE: usize = size_of::<PixelTracer>() + size_of::<FramePose>();

/// The scene of a frame at one of its moments.
#[derive(Clone, Copy, Debug)]
pub struct FramePose<'a> {
    /// Index of the frame among those that are traced together.
    pub frame: usize,
    pub moment: Moment,
    pub scene: Scene<'a>,
    pub bvh: &'a Bvh,
}

impl<'a> FramePose<'a> {
    fn pose(&self) -> MoverPose<'a> {
        let moment = (self.moment != Moment::ONLY).then_some(self.moment.index);
        MoverPose { scene: self.scene, frame: 1 << self.frame, moment }
    }

    /// Adds the sums of some pixels at this moment to those of the frame.
    fn add(&self, sums: &[DVec3], film: &mut [DVec3]) {
        match self.moment {
            Moment::ONLY => film.copy_from_slice(sums),
            _ => film.iter_mut().zip(sums).for_each(|(all, sum)| *all += *sum),
        }
    }

    /// Whether samples are random.
    fn is_random(&self, settings: &TraceSettings) -> bool {
        is_random(&self.scene, settings.quality.integrator)
    }

    /// What keeps the frames of two poses from being traced together, if anything. Light samples, error bounds, the kind of
    /// samples and the number of moments must be the same. No mover may be a source of light that surfaces sample, because
    /// then all light depends on it. Cameras, lights, skies and fog must be the same anyway.
    pub fn obstacle(&self, other: &Self, settings: &TraceSettings) -> Option<PathObstacle> {
        let moments = [self.moment.of, other.moment.of];
        let random = [self, other].map(|pose| pose.is_random(settings));
        let drawn = [moments[0] > 1 || random[0], moments[1] > 1 || random[1]];
        let is_alike = (moments[0] == moments[1] || moments.contains(&1))
            && random[0] == random[1]
            && drawn[0] == drawn[1];
        let samples_lights = settings.quality.integrator.samples_lights();
        if !is_alike {
            Some(PathObstacle::Sampling)
        } else if self.bvh.reach() != other.bvh.reach() {
            Some(PathObstacle::Extent)
        } else {
            has_moving_source([self.scene, other.scene], samples_lights).then_some(PathObstacle::MovingSource)
        }
    }
}

/// Frames that share paths.
pub struct SharedFrames<'a> {
    poses: &'a [FramePose<'a>],
    settings: &'a TraceSettings,
    count: usize,
    /// The tree without movers.
    still: Bvh,
    movers: Movers<'a>,
    limits: Limits,
}

impl<'a> SharedFrames<'a> {
    /// Prepares poses in the order of their frames and moments. No [obstacle](FramePose::obstacle) may be between each and
    /// the first one and those with several moments, and all must have the same layers.
    pub fn new(poses: &'a [FramePose<'a>], settings: &'a TraceSettings) -> Self {
        let scenes: Vec<Scene> = poses.iter().map(|pose| pose.scene).collect();
        let slots = moving_slots(&scenes);
        let still = poses
            .first()
            .map_or_else(Bvh::default, |first| first.bvh.of_part(&without(first.scene.geometry, &slots)));
        let all: Vec<MoverPose> = poses.iter().map(FramePose::pose).collect();
        let count = poses.last().map_or(0, |last| last.frame + 1);
        Self { poses, settings, count, still, movers: Movers::new(&all, &slots), limits: Limits::default() }
    }

    /// The same frames, but each stands for so many: paths are shared where that would pay for all of them.
    pub fn for_more(self, times: f64) -> Self {
        Self { limits: Limits { times, ..self.limits }, ..self }
    }

    /// Traces all frames, and passes each film to `take` as soon as it is complete, in order, with the counts since the one
    /// before. Returns all counts; none if there are no frames, or if the run is stopped.
    ///
    /// # Errors
    /// The first error of `take`. No more frames are traced then.
    pub fn trace<E>(
        &self,
        meter: &ProgressMeter,
        take: &mut dyn FnMut(Film, Counts) -> Result<(), E>,
    ) -> Result<Option<Counts>, E> {
        let Self { settings, count, .. } = *self;
        let Some(FramePose { scene: first, .. }) = self.poses.first() else { return Ok(None) };
        let (width, height) = settings.size;
        let film = || Film::with_aovs(width, height, first.weights.0.clone(), settings.aovs);
        let mut films: Vec<Film> = (0..count).map(|_| film()).collect();
        let tracer = self.tracer();
        let (pilot, rest) = tiles(settings.size);
        let (frames, finished) = (count as u64, AtomicU64::new(0));
        let total = frames * (pilot.len() + rest.len()) as u64;
        let advance = |traced: &Counts, of: u64| {
            meter.rays.fetch_add(traced.rays.total(), Relaxed);
            let before = finished.fetch_add(of, Relaxed);
            meter.advance(before, before + of, total, frames);
        };
        let at_once = AT_ONCE.max(rest.len() / PARTS);
        let mut counts = Counts::default();
        // The pixels that are traced frame by frame, of each tile.
        let mut whole: Vec<(&Tile, Vec<(u32, u32)>)> = Vec::new();
        for tiles in [&pilot[..]].into_iter().chain(rest.chunks(at_once)) {
            if meter.is_stopped() {
                return Ok(None);
            }
            if !self.limits.allow(&counts) {
                whole.extend(tiles.iter().map(|tile| (tile, in_order(tile))));
                continue;
            }
            let shared = tiles.par_iter().with_max_len(ONE_EACH).map(|tile| {
                let (x, y) = (tile.columns.start, tile.rows.start);
                let _span = tracing::trace_span!("tile", x, y, films = count).entered();
                let shared = tracer.share_tile(tile);
                advance(&shared.counts, if shared.rest.is_empty() { frames } else { 0 });
                shared
            });
            let shared: Vec<SharedTile> = shared.collect();
            for (tile, SharedTile { pixels, data, rest, counts: more }) in tiles.iter().zip(shared) {
                films.iter_mut().zip(&data).for_each(|(film, data)| store(film, &pixels, data));
                counts += more;
                if !rest.is_empty() {
                    whole.push((tile, rest));
                }
            }
        }
        // Frame by frame, so that what a frame's rays read stays in caches.
        let mut since = counts;
        for (frame, mut film) in films.into_iter().enumerate() {
            if meter.is_stopped() {
                return Ok(None);
            }
            let alone = whole.par_iter().with_max_len(ONE_EACH).map(|(tile, pixels)| {
                let (x, y) = (tile.columns.start, tile.rows.start);
                let _span = tracing::trace_span!("tile", x, y).entered();
                let traced = tracer.trace_whole(pixels, frame);
                advance(&traced.1, 1);
                traced
            });
            let alone: Vec<(Vec<Rgb>, Counts)> = alone.collect();
            for ((_, pixels), (data, more)) in whole.iter().zip(alone) {
                store(&mut film, pixels, &data);
                counts += more;
                since += more;
            }
            take(film, std::mem::take(&mut since))?;
        }
        Ok(Some(counts))
    }

    /// Traces some of the frames alone, to measure what they would have been. Returns their counts.
    pub fn trace_alone(&self, frames: &[usize]) -> Counts {
        let tracer = self.tracer();
        let (pilot, rest) = tiles(self.settings.size);
        let tiles: Vec<Vec<(u32, u32)>> = pilot.iter().chain(&rest).map(in_order).collect();
        let mut counts = Counts::default();
        for &frame in frames {
            let alone = tiles.par_iter().with_max_len(ONE_EACH);
            let alone: Vec<Counts> = alone.map(|pixels| tracer.trace_whole(pixels, frame).1).collect();
            alone.into_iter().for_each(|more| counts += more);
        }
        counts
    }

    fn tracer(&self) -> TileTracer<'_> {
        let Self { poses, settings, still, movers, .. } = self;
        let pool = Arc::new(ScratchPool::default());
        let whole = |(number, pose): (u32, &'a FramePose<'a>)| {
            let tracer = PixelTracer::new(&pose.scene, pose.bvh, settings, pose.moment);
            tracer.with_pool(&pool, number)
        };
        let whole: Vec<PixelTracer> = (1..).zip(*poses).map(whole).collect();
        let shared = PixelTracer::new(&poses[0].scene, poses[0].bvh, settings, Moment::ONLY);
        let mut shared = shared.with_pool(&pool, 0);
        shared.random = whole[0].random;
        let context = &mut shared.context;
        context.bvh = still;
        context.movers = Some(movers);
        // Paths must be as long as in any of the frames, so that they meet movers.
        context.emits = whole.iter().any(|pose| pose.context.emits);
        context.unsampled_light = whole.iter().any(|pose| pose.context.unsampled_light);
        context.branches = whole.iter().any(|pose| pose.context.branches);
        // Movers may be hidden from rays in other frames than the first.
        context.parts_rays = whole.iter().any(|pose| pose.context.parts_rays);
        context.columns.flags |= context.parts_rays;
        TileTracer::new(poses, shared, whole, self.limits)
    }
}

/// All tiles of a picture: first some that are spread over it, then the others.
fn tiles((width, height): (u32, u32)) -> (Vec<Tile>, Vec<Tile>) {
    let tops = (0..height).step_by(TILE as usize);
    let tile = |top: u32, left: u32| Tile {
        columns: left..width.min(left + TILE),
        rows: top..height.min(top + TILE),
    };
    let all = tops.flat_map(|top| (0..width).step_by(TILE as usize).map(move |left| tile(top, left)));
    // A multiplicative hash spreads them, and the first of them, too.
    let hash = |number: usize| (number as u32).wrapping_mul(0x9e37_79b9);
    let (mut pilot, rest): (Vec<_>, Vec<_>) =
        all.enumerate().partition(|(number, _)| hash(*number) >> 28 == 0);
    pilot.sort_by_key(|(number, _)| hash(*number));
    let unnumbered = |tiles: Vec<(usize, Tile)>| tiles.into_iter().map(|(_, tile)| tile).collect();
    (unnumbered(pilot), unnumbered(rest))
}

/// Stores the layers of some pixels.
fn store(film: &mut Film, pixels: &[(u32, u32)], data: &[Rgb]) {
    let (layers, width) = (film.layers(), film.width);
    let all = film.data_mut();
    for (&(x, y), pixel) in pixels.iter().zip(data.chunks(layers.max(1))) {
        let at = (y * width + x) as usize * layers;
        all[at..at + layers].copy_from_slice(pixel);
    }
}
