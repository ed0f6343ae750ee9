//! `kinora plan`: which films a render would trace, and how long that takes. Traces nothing except a pilot of a few
//! small patches of pixels.
//!
//! In: a sequence file. Out: the report as text or JSON. Uses the siblings of `cli/` and the rooms above it.

mod changes;
mod films;
mod json;
mod report;
mod text;

use super::failure::Failure;
use super::farm_forecast::{FarmForecast, FarmSetup};
use super::frame_selection::selected_frames;
use super::loading::LoadingReporter;
use super::options::RenderOptions;
use super::{check, load, overrides, terminal, values};
use crate::base::clock::timed;
use crate::base::frame_set::FrameSet;
use crate::pipeline::memory;
use crate::pipeline::render::{self, Reuse, pool, requested_aovs};
use clap::Args;
use report::PlanReport;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Predict what a render would trace, how long it would take, and which frames share a film.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron or .json)
    file: PathBuf,

    /// Frames to plan for, written as for `render` [default: all]
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    #[command(flatten)]
    options: RenderOptions,

    /// Memory for films that later frames reuse: 2GB, or 0 [default: a quarter of free memory]
    #[arg(long, value_name = "SIZE", value_parser = values::cache_size)]
    film_cache: Option<u64>,

    /// Predict the time on this many workers with -t threads each: 1,2,50; up to 10000
    ///
    /// Renders a few frames to measure what rays, trees, files and the start of a task cost on
    /// this machine. The tasks are those that `kinora farm export` would write.
    #[arg(
        long, value_name = "N", value_parser = values::workers, value_delimiter = ',',
        allow_hyphen_values = true, verbatim_doc_comment
    )]
    workers: Vec<NonZeroUsize>,

    /// Approximate number of tasks for --workers, as in `farm export` [default: by their work]
    #[arg(long, value_name = "N", requires = "workers")]
    chunks: Option<NonZeroUsize>,

    /// Trace nothing: print counts only, without times and errors
    #[arg(long, conflicts_with = "workers")]
    no_pilot: bool,

    /// Print one JSON object, for programs
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  kinora plan show.ron                      time, error, films, effects, layers, rays and memory
  kinora plan show.ron --no-pilot           the same without time and error, at once
  kinora plan show.ron --film-cache 200MB   the same with less memory for films
  kinora plan show.ron --workers 1,8,100    how long a farm takes, and how well it is used
  kinora plan show.ron --json               for programs

Counts of films and trees and the memory are exact. Camera rays are exact if the number of samples
is fixed and no frames share paths. Time and error come from a pilot of one or two seconds: it
traces patches of 8x8 pixels of up to six films at full resolution. The time is that of tracing
with -t threads, without loading and writing. It is accurate to about 10 % for a fixed number of
samples and to about 20 % for a target error; if the pilot is less certain, a range is printed.
Where a few bright pixels make most of the error, it may be twice as long.";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = &arguments.options;
    let reporter = LoadingReporter::new(options.progress, options.quiet);
    let (sequence, load) = timed(|| load::sequence(&arguments.file, options.allow_outside, reporter));
    let sequence = sequence?;
    let sequence = overrides::apply(sequence, &options.overrides()).map_err(Failure::Bad)?;
    let frames = selected_frames(arguments.frames.as_ref(), &sequence)?;
    // A sequence that `render` would refuse needs no plan.
    render::check(&sequence, &check::request(&sequence))?;
    let aovs = requested_aovs(&sequence, &sequence.output.files);
    let cache_budget = arguments.film_cache.map_or(Reuse::Share, Reuse::Within).budget(&sequence, aovs);
    let pending_bytes = memory::needed(&sequence, aovs);
    let setup = FarmSetup { workers: &arguments.workers, chunks: arguments.chunks, threads: options.threads };
    let farm = || FarmForecast::measure(&sequence, &frames, &setup, load);
    let farm = (!arguments.workers.is_empty()).then(farm).transpose()?;
    let pilot = !arguments.no_pilot;
    let report = pool(options.threads)?
        .install(|| PlanReport::new(&sequence, &frames, aovs, cache_budget, pilot))
        .with_farm(farm, pending_bytes);
    terminal::print_line(&if arguments.json { json::json(&report) } else { text::text(&report) })
}
