//! What a job takes on this machine: a few of its frames are rendered as tasks render them, and timed.

use super::chunk::{Chunk, WRITE};
use crate::accuracy::{Took, timed};
use crate::base::stats::Meter;
use crate::encode::{EncodeError, Existing, Output};
use crate::pipeline::filmstrip::spread;
use crate::pipeline::plan::{Nowhere, Plan, shrunk};
use crate::pipeline::render::{RenderError, Request, Reuse, Summary, extras, pool, render};
use crate::pipeline::schedule::{FrameLoop, Stage};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Seconds that a worker spends on each of these.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Price {
    /// A task: reading the sequence with all that it names, making its world.
    pub task: f64,
    /// A frame of a task: finding out what it shows.
    pub look: f64,
    /// A film: putting things into their places, building trees.
    pub film: f64,
    pub ray: f64,
    /// A frame: developing, compressing and writing it.
    pub write: f64,
}

/// Frames that are rendered to find out, and the samples of each, at most.
const PILOTS: u32 = 5;
const SAMPLES: u64 = 1 << 18;

impl Price {
    /// Measures it with as many threads as tasks have; `load` is what reading the sequence took. `stills` are the files of
    /// each frame.
    pub fn measure(
        sequence: &Sequence,
        frames: &[u32],
        stills: &[Output],
        threads: Option<NonZeroUsize>,
        load: Took,
    ) -> Result<Self, RenderError> {
        let pool = pool(threads)?;
        let (plan, planned) =
            pool.install(|| timed(|| Plan::new(sequence, frames, extras(sequence, stills), u64::MAX)));
        let (_, world) =
            pool.install(|| timed(|| FrameLoop::new(sequence, Nowhere, Arc::new(Meter::default()))));
        let looks: Vec<_> = spread(plan.takes.len() as u32, PILOTS)
            .into_iter()
            .filter_map(|film| plan.survey.frames.get(plan.takes.get(film as usize)?.frames[0]))
            .collect();
        // All are made as small as the one that is traced at the most moments.
        let Some(most) = looks.iter().max_by_key(|look| look.moments) else { return Ok(Self::default()) };
        let small = shrunk(sequence, most, SAMPLES);
        let chosen: Vec<u32> = looks.iter().map(|look| look.frame).collect();
        let (done, took) = rendered(&small, chosen, stills, threads)?;
        let pixels = |sequence: &Sequence| {
            let (width, height) = sequence.output.size;
            f64::from(width) * f64::from(height)
        };
        let stage =
            |stage: Stage| done.stages.get(stage as usize).map_or(0.0, |(_, time)| time.as_secs_f64());
        let all: f64 = Stage::ALL.iter().map(|&of| stage(of)).sum();
        // Stages tell how long they were at it, however busy the machine is; the processors' time is divided as they say.
        let work = (took - world).on(pool.current_num_threads());
        let share = |stages: &[Stage]| stages.iter().map(|&of| stage(of)).sum::<f64>() / all * work;
        let (count, rays) = (looks.len() as f64, done.counts.rays.total() as f64);
        Ok(Self {
            task: load.alone() + world.alone(),
            // A render looks at its frames to see which of them are there, and once more to plan them.
            look: 2.0 * planned.alone() / frames.len() as f64,
            film: share(&[Stage::Animate, Stage::Extract, Stage::Accelerate]) / count,
            ray: share(&[Stage::Trace]) / rays.max(1.0),
            write: share(&[Stage::Encode]) / count * pixels(sequence) / pixels(&small),
        })
    }

    /// Of one task that renders a chunk of frames with so many pixels each.
    pub fn of(&self, chunk: &Chunk, pixels: u64) -> Duration {
        let (films, frames) = (chunk.leads.len() as f64, chunk.frames.len() as f64);
        let rays = chunk.work - frames * pixels as f64 * WRITE;
        let each = self.film * films + self.ray * rays + (self.look + self.write) * frames;
        Duration::from_secs_f64(self.task + each)
    }
}

/// Renders frames into a folder that is removed afterwards.
fn rendered(
    sequence: &Sequence,
    frames: Vec<u32>,
    stills: &[Output],
    threads: Option<NonZeroUsize>,
) -> Result<(Summary, Took), RenderError> {
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
    let (done, took) = timed(|| render(sequence, &request, &Arc::new(Meter::default())));
    Ok((done?, took))
}
