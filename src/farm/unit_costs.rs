//! The cost of each kind of work on this machine, measured by rendering a few frames as a task renders them.

use super::chunk::{Chunk, RAYS_PER_WRITTEN_PIXEL};
use crate::base::clock::{ElapsedTime, timed};
use crate::base::stats::ProgressMeter;
use crate::encode::{EncodeError, Existing, Output};
use crate::pipeline::filmstrip::spread;
use crate::pipeline::plan::{NullSink, Plan, downscaled};
use crate::pipeline::render::{RenderError, Request, Reuse, Summary, pool, render, requested_aovs};
use crate::pipeline::schedule::{FrameLoop, FrameStage};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Seconds that a worker needs for one unit of each kind of work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UnitCosts {
    /// The start of a task: reads the sequence and its files, and makes its world.
    pub task: f64,
    /// A frame: evaluates it for the plan.
    pub evaluate: f64,
    /// A film: places objects and builds trees.
    pub film: f64,
    pub ray: f64,
    /// A frame: develops, compresses and writes it.
    pub write: f64,
}

/// The largest number of frames to measure, and of samples of each.
const PILOT_FRAMES: u32 = 5;
const PILOT_SAMPLES: u64 = 1 << 18;

impl UnitCosts {
    /// Renders a few frames on as many threads as a task has. `load` is the time that reading the sequence took, and
    /// `stills` are the files of each frame.
    pub fn measure(
        sequence: &Sequence,
        frames: &[u32],
        stills: &[Output],
        threads: Option<NonZeroUsize>,
        load: ElapsedTime,
    ) -> Result<Self, RenderError> {
        let pool = pool(threads)?;
        let (plan, planned) = pool
            .install(|| timed(|| Plan::new(sequence, frames, requested_aovs(sequence, stills), u64::MAX)));
        let (_, world) =
            pool.install(|| timed(|| FrameLoop::new(sequence, NullSink, Arc::new(ProgressMeter::default()))));
        let frame_states: Vec<_> = spread(plan.films.len() as u32, PILOT_FRAMES)
            .into_iter()
            .filter_map(|film| plan.states.frames.get(plan.films.get(film as usize)?.frames[0]))
            .collect();
        // All frames get the size that suits the one with the most moments.
        let Some(most) = frame_states.iter().max_by_key(|state| state.moments) else {
            return Ok(Self::default());
        };
        let small = downscaled(sequence, most, PILOT_SAMPLES, 1);
        let chosen: Vec<u32> = frame_states.iter().map(|state| state.frame).collect();
        let (done, took) = rendered(&small, chosen, stills, threads)?;
        let pixels = |sequence: &Sequence| {
            let (width, height) = sequence.output.size;
            f64::from(width) * f64::from(height)
        };
        let stage =
            |stage: FrameStage| done.stages.get(stage as usize).map_or(0.0, |(_, time)| time.as_secs_f64());
        let all: f64 = FrameStage::ALL.iter().map(|&of| stage(of)).sum();
        // The processor time does not depend on what else the machine does. It is divided in proportion to the wall
        // times of the stages.
        let work = (took - world).on_threads(pool.current_num_threads());
        let share = |stages: &[FrameStage]| stages.iter().map(|&of| stage(of)).sum::<f64>() / all * work;
        let (count, rays) = (frame_states.len() as f64, done.counts.rays.total() as f64);
        Ok(Self {
            task: load.on_one_thread() + world.on_one_thread(),
            // A render evaluates its frames twice: to find those that are done, and to plan the rest.
            evaluate: 2.0 * planned.on_one_thread() / frames.len() as f64,
            film: share(&[FrameStage::Animate, FrameStage::Extract, FrameStage::Accelerate]) / count,
            ray: share(&[FrameStage::Trace]) / rays.max(1.0),
            write: share(&[FrameStage::Encode]) / count * pixels(sequence) / pixels(&small),
        })
    }

    /// The duration of a task that renders a chunk of frames with `pixels` pixels each.
    pub fn task_time(&self, chunk: &Chunk, pixels: u64) -> Duration {
        let (films, frames) = (chunk.first_frames.len() as f64, chunk.frames.len() as f64);
        let rays = chunk.work - frames * pixels as f64 * RAYS_PER_WRITTEN_PIXEL;
        let render = self.film * films + self.ray * rays + (self.evaluate + self.write) * frames;
        Duration::from_secs_f64(self.task + render)
    }
}

/// Renders frames into a temporary folder.
fn rendered(
    sequence: &Sequence,
    frames: Vec<u32>,
    stills: &[Output],
    threads: Option<NonZeroUsize>,
) -> Result<(Summary, ElapsedTime), RenderError> {
    let folder =
        tempfile::tempdir().map_err(|reason| EncodeError::Write { path: std::env::temp_dir(), reason })?;
    let outputs = stills.iter().enumerate().filter_map(|(place, still)| {
        let name = still.path(0);
        let extension = Path::new(&name).extension()?.to_str()?;
        Output::parse(folder.path().join(format!("{place}_####.{extension}"))).ok()
    });
    let outputs = outputs.collect();
    let request = Request {
        frames,
        outputs,
        confined: false,
        existing: Existing::Replace,
        threads,
        reuse: Reuse::Off,
        time_limit: None,
    };
    let (done, took) = timed(|| render(sequence, &request, &Arc::new(ProgressMeter::default())));
    Ok((done?, took))
}
