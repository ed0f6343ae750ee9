//! `kinora plan --workers`: how long a farm would take for a sequence.

use super::failure::Failure;
use crate::base::clock::ElapsedTime;
use crate::base::units::{self, counted};
use crate::farm::{JobForecast, Scaling, UnitCosts};
use crate::sequence::Sequence;
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::time::Duration;

/// Says where the times come from, and in which direction they are known to be wrong.
const ESTIMATE: &str = "an estimate from a few small pictures traced now: jobs of a few seconds take less";

/// The workers to predict for.
pub struct FarmSetup<'a> {
    pub workers: &'a [NonZeroUsize],
    pub chunks: Option<NonZeroUsize>,
    /// Threads of each worker.
    pub threads: Option<NonZeroUsize>,
}

/// A job, and its makespan for each number of workers.
pub struct FarmForecast {
    job: JobForecast,
    scalings: Vec<Scaling>,
}

impl FarmForecast {
    /// Predicts the job that an export would write. `load` is the time that reading the sequence took.
    pub fn measure(
        sequence: &Sequence,
        frames: &[u32],
        setup: &FarmSetup,
        load: ElapsedTime,
    ) -> Result<Self, Failure> {
        let job = JobForecast::of(sequence, frames, setup.chunks, setup.threads, load)?;
        let scalings = setup.workers.iter().map(|&workers| job.scaling(workers)).collect();
        Ok(Self { job, scalings })
    }

    pub fn lines(&self) -> Vec<String> {
        let JobForecast { costs, tasks, alone } = &self.job;
        let shortest = tasks.iter().min().copied().unwrap_or_default();
        let longest = tasks.iter().max().copied().unwrap_or_default();
        let mut lines = vec![
            format!(
                "{} of {} to {}, {} of each to start; one process for everything takes {}",
                counted(tasks.len() as u64, "task"),
                units::time(shortest),
                units::time(longest),
                units::time(Duration::from_secs_f64(costs.task)),
                units::time(*alone),
            ),
            format!("{:>7}  {:>12}  {:>8}  {:>10}", "workers", "makespan", "speed-up", "efficiency"),
        ];
        lines.extend(self.scalings.iter().map(|scaling| {
            format!(
                "{:>7}  {:>12}  {:>8.2}  {:>8.1} %",
                units::count(scaling.workers.get() as u64),
                units::time(scaling.makespan),
                scaling.speedup,
                100.0 * scaling.efficiency
            )
        }));
        lines.push(ESTIMATE.to_owned());
        lines
    }

    pub fn json(&self) -> Value {
        let JobForecast { costs, tasks, alone } = &self.job;
        let UnitCosts { task, evaluate, film, ray, write } = costs;
        let scaling = |scaling: &Scaling| {
            json!({
                "workers": scaling.workers,
                "makespan_s": scaling.makespan.as_secs_f64(),
                "speedup": scaling.speedup,
                "efficiency": scaling.efficiency,
            })
        };
        json!({
            "tasks": tasks.len(),
            "longest_task_s": tasks.iter().max().map(Duration::as_secs_f64),
            "alone_s": alone.as_secs_f64(),
            "price_s": { "task": task, "look": evaluate, "film": film, "ray": ray, "write": write },
            "workers": self.scalings.iter().map(scaling).collect::<Vec<_>>(),
        })
    }
}
