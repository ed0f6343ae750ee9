//! The predicted duration of a job.

use super::chunk::{FilmCosts, cost_classes};
use super::makespan::Scaling;
use super::unit_costs::UnitCosts;
use crate::base::clock::ElapsedTime;
use crate::encode::Output;
use crate::pipeline::render::{RenderError, pool, requested_aovs};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::time::Duration;

/// The predicted durations of a job's tasks on this machine.
#[derive(Clone, Debug, PartialEq)]
pub struct JobForecast {
    pub costs: UnitCosts,
    /// The duration of each task.
    pub tasks: Vec<Duration>,
    /// The duration of one process that renders everything.
    pub alone: Duration,
}

impl JobForecast {
    /// Predicts the job that an export with about `chunks` tasks would write, for workers of `threads` threads. Renders
    /// a few frames to measure their cost. `load` is the time that reading the sequence took.
    ///
    /// # Errors
    /// Those of [`crate::pipeline::render::render`].
    pub fn of(
        sequence: &Sequence,
        frames: &[u32],
        chunks: Option<NonZeroUsize>,
        threads: Option<NonZeroUsize>,
        load: ElapsedTime,
    ) -> Result<Self, RenderError> {
        let mut stills = sequence.output.files.clone();
        stills.retain(|file| !file.is_animation());
        if stills.is_empty() {
            stills.extend(Output::parse("frame_####.png"));
        }
        let films =
            pool(threads)?.install(|| FilmCosts::of(sequence, frames, requested_aovs(sequence, &stills)));
        let costs = UnitCosts::measure(sequence, frames, &stills, threads, load)?;
        let (width, height) = sequence.output.size;
        let pixels = u64::from(width) * u64::from(height);
        let chunks = cost_classes(&films, chunks.map(NonZeroUsize::get));
        let tasks: Vec<Duration> = chunks
            .iter()
            .flat_map(|class| &class.chunks)
            .map(|chunk| costs.task_time(chunk, pixels))
            .collect();
        // One process starts once, not once per task.
        let starts = Duration::from_secs_f64(costs.task) * tasks.len().saturating_sub(1) as u32;
        let alone = tasks.iter().sum::<Duration>().saturating_sub(starts);
        Ok(Self { costs, tasks, alone })
    }

    /// The job on this many workers.
    pub fn scaling(&self, workers: NonZeroUsize) -> Scaling {
        Scaling::of(&self.tasks, self.alone, workers)
    }
}
