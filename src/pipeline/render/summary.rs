//! Results of a run, and what was expected of it.

use crate::base::stats::Counts;
use crate::encode::Report;
use crate::film::Noise;
use crate::pipeline::plan::{Plan, Range, RayEstimate, RunForecast};
use crate::pipeline::schedule::{FrameStage, Stats};
use std::path::PathBuf;
use std::time::Duration;

/// Results of a run.
#[derive(Clone, Debug, Default)]
#[warn(missing_docs)]
pub struct Summary {
    /// Requested frames.
    pub frames: u32,
    /// Frames that existed, were valid, and were kept.
    pub kept: u32,
    /// Frames that reused the film of another frame.
    pub reused: u32,
    /// Rays and other work.
    pub counts: Counts,
    /// Number of times that the top-level tree was built, and that it was refitted instead.
    pub bvh_builds: u64,
    /// Number of times that the top-level tree was refitted.
    pub bvh_refits: u64,
    /// The forecast, if there was a plan.
    pub expected: Option<Forecast>,
    /// Error of each frame that was sampled towards a target error.
    pub noise: Vec<(u32, Noise)>,
    /// Processor time of tracing in seconds, over all threads. None if the system does not measure it.
    pub cpu: Option<f64>,
    /// Wall time of each stage, in order. Encoding runs in parallel with the others.
    pub stages: Vec<(&'static str, Duration)>,
    /// Wall time of the whole run.
    pub elapsed: Duration,
    /// Written files: a pattern or a file for each output.
    pub files: Vec<PathBuf>,
    /// Notes for the user.
    pub notes: Vec<String>,
}

/// Forecast of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    pub reused: u32,
    pub camera_rays: u64,
    /// Whether `camera_rays` is exact. It is a lower bound if frames are sampled towards a target error or share samples of
    /// views.
    pub exact: bool,
    /// Whether films may share paths. Then `camera_rays` is an upper bound, or an estimate if a pilot was traced.
    pub shares_paths: bool,
    /// Rays of all kinds, if a pilot was traced.
    pub rays: Option<u64>,
    /// Number of times that the top-level tree is built or refitted.
    pub bvh_updates: u64,
    /// Wall time and processor time of tracing in seconds, and the error of the worst film as a share of the mean
    /// brightness. None without a pilot.
    pub wall: Option<Range>,
    pub cpu: Option<Range>,
    /// Processor time of the pilot in seconds.
    pub pilot: f64,
    pub error: Option<Range>,
}

impl Forecast {
    /// The forecast without a pilot.
    pub(super) fn of(plan: &Plan, known: &RayEstimate) -> Self {
        Self {
            reused: plan.reused() as u32,
            camera_rays: known.camera,
            exact: known.exact,
            shares_paths: known.shares_paths,
            rays: None,
            bvh_updates: plan.bvh_updates(),
            wall: None,
            cpu: None,
            pilot: 0.0,
            error: None,
        }
    }

    pub(super) fn with(self, run: &RunForecast) -> Self {
        Self {
            camera_rays: if self.exact && !self.shares_paths { self.camera_rays } else { run.camera as u64 },
            rays: Some(run.rays as u64),
            wall: Some(run.wall),
            cpu: run.cpu,
            error: run.error,
            ..self
        }
    }
}

/// Summarises a run.
pub(crate) fn summary(stats: &Stats, report: Report, frames: u32, elapsed: Duration) -> Summary {
    // The frame loop only waits for the encoder, so the encoder's own time counts.
    let time = |stage| if stage == FrameStage::Encode { report.busy } else { stats.stages[stage as usize] };
    Summary {
        frames,
        kept: report.kept,
        reused: stats.reused,
        expected: None,
        counts: stats.counts,
        bvh_builds: stats.bvh_builds,
        bvh_refits: stats.bvh_refits,
        noise: report.noise,
        cpu: None,
        stages: FrameStage::ALL.map(|stage| (stage.name(), time(stage))).to_vec(),
        elapsed,
        files: report.files,
        notes: report.notes,
    }
}
