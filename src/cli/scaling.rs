//! What `kinora plan --workers` tells: how long a farm would take for a sequence.

use super::failure::Failure;
use super::json::Object;
use crate::accuracy::Took;
use crate::base::units::{self, counted};
use crate::farm::{Forecast, Price, Scaling};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::time::Duration;

/// What the times are, and which way they are known to be wrong.
const ESTIMATE: &str = "an estimate, by what a few small pictures took just now: jobs of seconds take less";

/// How the work is shared.
pub struct Share<'a> {
    pub workers: &'a [NonZeroUsize],
    pub chunks: Option<NonZeroUsize>,
    /// Of every worker.
    pub threads: Option<NonZeroUsize>,
}

/// A job, and what workers make of it.
pub struct Farm {
    job: Forecast,
    scalings: Vec<Scaling>,
}

impl Farm {
    /// The job that an export would write, at this machine's prices; `load` is what reading the sequence took.
    pub fn of(sequence: &Sequence, frames: &[u32], share: &Share, load: Took) -> Result<Self, Failure> {
        let job = Forecast::of(sequence, frames, share.chunks, share.threads, load)?;
        let scalings = share.workers.iter().map(|&workers| job.scaling(workers)).collect();
        Ok(Self { job, scalings })
    }

    pub fn lines(&self) -> Vec<String> {
        let Forecast { price, tasks, alone } = &self.job;
        let shortest = tasks.iter().min().copied().unwrap_or_default();
        let longest = tasks.iter().max().copied().unwrap_or_default();
        let mut lines = vec![
            format!(
                "{}, {} to {} each, {} of it to start; in one process {}",
                counted(tasks.len() as u64, "task"),
                units::time(shortest),
                units::time(longest),
                units::time(Duration::from_secs_f64(price.task)),
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

    pub fn json(&self) -> Object {
        let Forecast { price, tasks, alone } = &self.job;
        let Price { task, look, film, ray, write } = *price;
        let price = [("task", task), ("look", look), ("film", film), ("ray", ray), ("write", write)];
        let price =
            price.iter().fold(Object::new(), |object, (name, value)| object.exact(name, Some(*value)));
        let seconds = |time: Duration| Some(time.as_secs_f64());
        let scaling = |scaling: &Scaling| {
            Object::new()
                .whole("workers", scaling.workers.get() as u64)
                .exact("makespan_s", seconds(scaling.makespan))
                .exact("speedup", Some(scaling.speedup))
                .exact("efficiency", Some(scaling.efficiency))
        };
        Object::new()
            .whole("tasks", tasks.len() as u64)
            .exact("longest_task_s", tasks.iter().max().copied().and_then(seconds))
            .exact("alone_s", seconds(*alone))
            .object("price_s", price)
            .objects("workers", self.scalings.iter().map(scaling))
    }
}
