//! Traces the films of several frames together, which differ in objects and their materials only.

use super::frame_loop::FrameLoop;
use super::frame_state::FrameState;
use super::stages::{FilmSink, FrameError, RenderSettings, RunProgress};
use crate::appearance::light::Light;
use crate::appearance::material::{Material, TextureSlot};
use crate::appearance::texture::Texture;
use crate::base::clock::{ElapsedTime, TimeSource, timed};
use crate::base::color::Rgb;
use crate::base::stats::{Counts, ProgressMeter};
use crate::camera::Camera;
use crate::film::{Film, LayerId};
use crate::scene::top_level::Bvh;
use crate::scene::{Geometry, Scene, Shading, Weights};
use crate::sequence::Sequence;
use crate::trace::{
    BYTES_PER_POSE, FramePose, MAX_FRAMES, Moment, PathObstacle, SharedFrames, TraceSettings, sharing_pays,
};
use crate::world::Current;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Instant;

/// Copies of what the tracer reads of a frame's moment.
struct Snapshot {
    frame: usize,
    moment: Moment,
    geometry: Geometry,
    shading: Shading,
    camera: Camera,
    bvh: Bvh,
}

impl Snapshot {
    /// Bytes that the snapshot and what traces it add to those of the one before, and bytes of the data of shapes that it
    /// adds. Copies share these data, and the first holds no more than the world does.
    fn bytes_besides(&self, before: Option<&Self>) -> [u64; 2] {
        let primitives = &self.geometry.primitives;
        let others = before.map_or(primitives, |before| &before.geometry.primitives);
        let pairs = primitives.iter().zip(others);
        let data: u64 = pairs.map(|(own, other)| own.shape.bytes_besides(&other.shape)).sum();
        let textures: usize = self.shading.materials.iter().map(|material| material.textures.len()).sum();
        let shading = self.shading.materials.len() * BYTES_PER_MATERIAL
            + textures * BYTES_PER_TEXTURE
            + self.shading.lights.len() * BYTES_PER_LIGHT;
        let own = size_of::<Self>() + BYTES_PER_POSE + primitives.len() * BYTES_PER_PRIMITIVE + shading;
        [own as u64, data]
    }

    fn pose<'a>(&'a self, weights: &'a Weights) -> FramePose<'a> {
        let Self { frame, moment, geometry, shading, camera, bvh } = self;
        FramePose { frame: *frame, moment: *moment, scene: Scene { geometry, shading, weights, camera }, bvh }
    }
}

/// Maximum bytes of meshes and particles that change from frame to frame: a run holds a few steps of a series at a time.
const MAX_SHAPE_DATA: u64 = 1 << 28;

/// Bytes per primitive of a snapshot: its place in the geometry, in the tree and in their tables.
const BYTES_PER_PRIMITIVE: usize = 1 << 10;

/// Bytes per material, texture and light: the copy, and the tables that tracers make of it.
const BYTES_PER_MATERIAL: usize = size_of::<Material>() + (1 << 8);
const BYTES_PER_TEXTURE: usize = size_of::<(Vec<TextureSlot>, Texture)>() + (1 << 5);
const BYTES_PER_LIGHT: usize = size_of::<Light>() + (1 << 8);

/// A receiver of films that are traced together, in their order.
pub type TakeFilm<'t, S> = dyn FnMut(&mut FrameLoop<S>, Film) -> Result<(), FrameError> + 't;

/// What came of frames that were traced together, from the first one of those that were asked for on.
#[derive(Default)]
pub struct PathGroup {
    /// The number of their films.
    pub films: usize,
    /// Why the next frame was not traced with them. None if there is no next frame.
    pub end: Option<PathObstacle>,
    /// Whether they were less work than each alone.
    pub pays: bool,
}

/// Frames that can share paths, found without tracing.
pub struct FittingFrames {
    /// Their number, from the first one of those that were asked for on: two or more, or none.
    pub frames: usize,
    /// Why the next frame cannot. None if there is no next frame.
    pub end: Option<PathObstacle>,
    /// Bytes of the copy of a scene, as a mean.
    pub bytes: u64,
}

/// Frames that were traced together and alone, to measure what sharing paths saves.
#[derive(Clone, Copy)]
pub struct SharingTrial {
    pub counts: Counts,
    pub counts_alone: Counts,
    pub took: ElapsedTime,
    pub took_alone: ElapsedTime,
}

/// Where among the frames of a trial those are that it traces alone: from 0, the first one, to 1, the last one.
const ALONE: [f64; 2] = [0.25, 0.75];

/// Weights that light these layers.
pub fn weights_of(state: &FrameState, lit: &[LayerId]) -> Weights {
    let mut weights = Weights(vec![Rgb::ZERO; state.weights.len()]);
    lit.iter().for_each(|layer| weights.0[layer.index()] = Rgb::ONE);
    weights
}

#[warn(missing_docs)]
impl<S: FilmSink> FrameLoop<S> {
    /// Traces films of these frames together, with the layers `lit`: as many from the first on as can share paths within
    /// `budget` bytes for copies of their scenes: two or more, or none. The frames must have the same
    /// [surroundings](FrameState::surroundings). Each film is passed to `take` as soon as it is complete, so that it can be
    /// encoded while others are traced. If the run is stopped, further films are left out.
    pub fn trace_together(
        &mut self,
        states: &[&FrameState],
        lit: &[LayerId],
        budget: u64,
        take: &mut TakeFilm<'_, S>,
    ) -> Result<PathGroup, FrameError> {
        let Some(first) = states.first() else { return Ok(PathGroup::default()) };
        self.faded.clear();
        let weights = weights_of(first, lit);
        let (snapshots, end) = self.without_tracing(|frames| frames.snapshots(states, &weights, budget))?;
        if snapshots.last().is_none_or(|last| last.frame == 0) {
            return Ok(PathGroup { films: 0, end, pays: false });
        }
        let _span = tracing::info_span!("trace together", first = first.frame).entered();
        let settings = self.settings();
        let poses: Vec<FramePose> = snapshots.iter().map(|snapshot| snapshot.pose(&weights)).collect();
        let meter = Arc::clone(&self.world.resource::<RunProgress>().0);
        let (mut start, mut films) = (Instant::now(), 0);
        let traced = SharedFrames::new(&poses, &settings).trace(&meter, &mut |film, counts| {
            self.record(1, counts, start);
            films += 1;
            let taken = take(self, film);
            start = Instant::now();
            taken
        })?;
        Ok(PathGroup { films, end, pays: traced.is_some_and(|counts| sharing_pays(&counts)) })
    }

    /// How many of these frames, from the first on, [`FrameLoop::trace_together`] would trace together.
    pub fn fitting(
        &mut self,
        states: &[&FrameState],
        lit: &[LayerId],
        budget: u64,
    ) -> Result<FittingFrames, FrameError> {
        let Some(first) = states.first() else { return Ok(FittingFrames { frames: 0, end: None, bytes: 0 }) };
        let weights = weights_of(first, lit);
        let (snapshots, end) = self.without_tracing(|frames| frames.snapshots(states, &weights, budget))?;
        let frames = snapshots.last().map_or(0, |last| last.frame + 1);
        let before = std::iter::once(None).chain(snapshots.iter().map(Some));
        let bytes_of = |(own, before): (&Snapshot, Option<&Snapshot>)| own.bytes_besides(before);
        let bytes: u64 = snapshots.iter().zip(before).flat_map(bytes_of).sum();
        let bytes = bytes / frames.max(1) as u64;
        Ok(FittingFrames { frames: if frames > 1 { frames } else { 0 }, end, bytes })
    }

    /// Traces frames together, each of which stands for so many, and two of them alone, in pictures of the sizes
    /// and samples of one sequence after the other. `next` gives these, by the trials so far. None are traced if the frames
    /// cannot share paths.
    pub fn try_together(
        &mut self,
        (states, times): (&[&FrameState], f64),
        lit: &[LayerId],
        (budget, clock): (u64, TimeSource),
        next: &mut dyn FnMut(&[SharingTrial]) -> Option<Sequence>,
    ) -> Result<Vec<SharingTrial>, FrameError> {
        let Some(first) = states.first() else { return Ok(Vec::new()) };
        let weights = weights_of(first, lit);
        let (snapshots, _) = self.without_tracing(|frames| frames.snapshots(states, &weights, budget))?;
        let last = states.len() - 1;
        if last == 0 || snapshots.last().is_none_or(|snapshot| snapshot.frame < last) {
            return Ok(Vec::new());
        }
        let poses: Vec<FramePose> = snapshots.iter().map(|snapshot| snapshot.pose(&weights)).collect();
        let mut trials = Vec::new();
        while let Some(sequence) = next(&trials) {
            let quality = sequence.quality.of_frame(first.frame);
            let settings = TraceSettings { size: sequence.output.size, quality, ..self.settings() };
            let frames = SharedFrames::new(&poses, &settings).for_more(times);
            let some = ALONE.map(|at| (at * last as f64).round() as usize);
            let (counts_alone, alone) = timed(|| frames.trace_alone(&some));
            let drop = &mut |_, _| Ok::<_, Infallible>(());
            let (Ok(counts), took) = timed(|| frames.trace(&ProgressMeter::default(), drop));
            let Some(counts) = counts else { break };
            let [took, took_alone] = [(took, counts.rays), (alone, counts_alone.rays)]
                .map(|(took, rays)| clock.elapsed(took, rays.total()));
            trials.push(SharingTrial { counts, counts_alone, took, took_alone });
        }
        Ok(trials)
    }

    fn settings(&self) -> TraceSettings {
        self.world.resource::<RenderSettings>().0.clone()
    }

    /// Snapshots of all moments of the first frames that can share paths, and why the next frame cannot.
    fn snapshots(
        &mut self,
        states: &[&FrameState],
        weights: &Weights,
        budget: u64,
    ) -> Result<(Vec<Snapshot>, Option<PathObstacle>), FrameError> {
        let mut all: Vec<Snapshot> = Vec::new();
        let (mut bytes, mut data) = (0, 0);
        for (frame, state) in states.iter().take(MAX_FRAMES).enumerate() {
            let before = all.len();
            for (clock, moment) in self.moments(state.frame, state.moments == 1) {
                self.run_moment(clock, moment)?;
                let Some(snapshot) = self.snapshot(frame, moment) else { return Ok((Vec::new(), None)) };
                let [own, of_shapes] = snapshot.bytes_besides(all.last());
                (bytes, data) = (bytes + own + of_shapes, data + of_shapes);
                let settings = &self.world.resource::<RenderSettings>().0;
                let pose = snapshot.pose(weights);
                let others = [all.first(), all.iter().find(|other| other.moment.of > 1)];
                let apart = |other: &&Snapshot| pose.obstacle(&other.pose(weights), settings);
                let obstacle = others.iter().flatten().find_map(apart);
                let too_large = (bytes > budget).then_some(PathObstacle::Memory);
                let too_much_data = (data > MAX_SHAPE_DATA).then_some(PathObstacle::ShapeData);
                if let Some(end) = obstacle.or(too_large).or(too_much_data) {
                    all.truncate(before);
                    return Ok((all, Some(end)));
                }
                all.push(snapshot);
            }
        }
        Ok((all, None))
    }

    /// Copies of what the tracer reads now.
    fn snapshot(&self, frame: usize, moment: Moment) -> Option<Snapshot> {
        let world = &self.world;
        Some(Snapshot {
            frame,
            moment,
            geometry: world.resource::<Current<Geometry>>().0.clone(),
            shading: world.resource::<Current<Shading>>().0.clone(),
            camera: world.resource::<Current<Option<Camera>>>().0?,
            bvh: world.resource::<Current<Bvh>>().0.clone(),
        })
    }
}
