//! What `kinora plan --workers` tells: how long a farm would take for a sequence.

use super::failure::Failure;
use super::json::Object;
use crate::accuracy::Took;
use crate::encode::Output;
use crate::farm::{Films, Price, Scaling, classes};
use crate::humane::{self, counted};
use crate::render::{extras, pool};
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
    price: Price,
    tasks: Vec<Duration>,
    /// One process that renders everything.
    alone: Duration,
    scalings: Vec<Scaling>,
}

impl Farm {
    /// The job that an export would write, at this machine's prices; `load` is what reading the sequence took.
    pub fn of(sequence: &Sequence, frames: &[u32], share: &Share, load: Took) -> Result<Self, Failure> {
        let mut stills = sequence.output.files.clone();
        stills.retain(|file| !file.is_animation());
        if stills.is_empty() {
            stills.extend(Output::parse("frame_####.png"));
        }
        let films = || Films::of(sequence, frames, extras(sequence, &stills));
        let films = pool(share.threads)?.install(films);
        let price = Price::measure(sequence, frames, &stills, share.threads, load)?;
        let (width, height) = sequence.output.size;
        let pixels = u64::from(width) * u64::from(height);
        let chunks = classes(&films, share.chunks.map(NonZeroUsize::get));
        let tasks: Vec<Duration> =
            chunks.iter().flat_map(|class| &class.chunks).map(|chunk| price.of(chunk, pixels)).collect();
        // Started once instead of for every task.
        let starts = Duration::from_secs_f64(price.task) * tasks.len().saturating_sub(1) as u32;
        let alone = tasks.iter().sum::<Duration>().saturating_sub(starts);
        let scalings = share.workers.iter().map(|&workers| Scaling::of(&tasks, alone, workers)).collect();
        Ok(Self { price, tasks, alone, scalings })
    }

    pub fn lines(&self) -> Vec<String> {
        let shortest = self.tasks.iter().min().copied().unwrap_or_default();
        let longest = self.tasks.iter().max().copied().unwrap_or_default();
        let mut lines = vec![
            format!(
                "{}, {} to {} each, {} of it to start; in one process {}",
                counted(self.tasks.len() as u64, "task"),
                humane::time(shortest),
                humane::time(longest),
                humane::time(Duration::from_secs_f64(self.price.task)),
                humane::time(self.alone),
            ),
            format!("{:>7}  {:>12}  {:>8}  {:>10}", "workers", "makespan", "speed-up", "efficiency"),
        ];
        lines.extend(self.scalings.iter().map(|scaling| {
            format!(
                "{:>7}  {:>12}  {:>8.2}  {:>8.1} %",
                humane::count(scaling.workers.get() as u64),
                humane::time(scaling.makespan),
                scaling.speedup,
                100.0 * scaling.efficiency
            )
        }));
        lines.push(ESTIMATE.to_owned());
        lines
    }

    pub fn json(&self) -> Object {
        let Price { task, look, film, ray, write } = self.price;
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
            .whole("tasks", self.tasks.len() as u64)
            .exact("longest_task_s", self.tasks.iter().max().copied().and_then(seconds))
            .exact("alone_s", seconds(self.alone))
            .object("price_s", price)
            .objects("workers", self.scalings.iter().map(scaling))
    }
}
