//! How long a job takes, told before any of it is started.

use super::chunk::{Films, classes};
use super::makespan::Scaling;
use super::price::Price;
use crate::accuracy::Took;
use crate::encode::Output;
use crate::pipeline::render::{RenderError, extras, pool};
use crate::sequence::Sequence;
use std::num::NonZeroUsize;
use std::time::Duration;

/// A job at a machine's prices.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    pub price: Price,
    /// What its tasks take.
    pub tasks: Vec<Duration>,
    /// What one process takes that renders everything.
    pub alone: Duration,
}

impl Forecast {
    /// Of the job that an export would write, in about so many chunks or as many as are worth one, for workers of so many
    /// threads. A few frames are rendered to find out; `load` is what reading the sequence took.
    ///
    /// # Errors
    /// Those of [`crate::pipeline::render::render`].
    pub fn of(
        sequence: &Sequence,
        frames: &[u32],
        chunks: Option<NonZeroUsize>,
        threads: Option<NonZeroUsize>,
        load: Took,
    ) -> Result<Self, RenderError> {
        let mut stills = sequence.output.files.clone();
        stills.retain(|file| !file.is_animation());
        if stills.is_empty() {
            stills.extend(Output::parse("frame_####.png"));
        }
        let films = pool(threads)?.install(|| Films::of(sequence, frames, extras(sequence, &stills)));
        let price = Price::measure(sequence, frames, &stills, threads, load)?;
        let (width, height) = sequence.output.size;
        let pixels = u64::from(width) * u64::from(height);
        let chunks = classes(&films, chunks.map(NonZeroUsize::get));
        let tasks: Vec<Duration> =
            chunks.iter().flat_map(|class| &class.chunks).map(|chunk| price.of(chunk, pixels)).collect();
        // Started once instead of for every task.
        let starts = Duration::from_secs_f64(price.task) * tasks.len().saturating_sub(1) as u32;
        let alone = tasks.iter().sum::<Duration>().saturating_sub(starts);
        Ok(Self { price, tasks, alone })
    }

    /// What so many workers make of it.
    pub fn scaling(&self, workers: NonZeroUsize) -> Scaling {
        Scaling::of(&self.tasks, self.alone, workers)
    }
}
