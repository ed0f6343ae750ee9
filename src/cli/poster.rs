//! `kinora poster`: renders one frame.

use super::check::decimal;
use super::failure::Failure;
use super::filmstrip::default_output;
use super::image_options::ImageOptions;
use super::loading::LoadingReporter;
use super::observe::{Observation, ObserveOptions, observed};
use super::options::RenderOptions;
use super::progress::{self, ProgressMode, ProgressReporter};
use super::time_limit::{self, TimeLimitOption};
use super::{forecast_text, load, overrides, summary, terminal, values};
use crate::base::cancel::Stop;
use crate::base::stats::ProgressMeter;
use crate::base::time::Time;
use crate::encode::{Existing, Output};
use crate::pipeline::render::{Listener, Notice, Request, Reuse, render_with_notices};
use crate::sequence::Sequence;
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;

/// Render one frame of a sequence.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron or .json)
    file: PathBuf,

    /// The picture to write: .png, .jpg, .ppm or .exr [default: output/NAME_poster.png]
    #[arg(short, long, value_name = "FILE", value_parser = values::output())]
    output: Vec<Output>,

    /// The frame, counted from 0 [default: the middle one]
    #[arg(long, value_name = "N", conflicts_with = "at")]
    frame: Option<u32>,

    /// The frame at this time, in seconds
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds, allow_hyphen_values = true)]
    at: Option<Time>,

    #[command(flatten)]
    image: ImageOptions,

    #[command(flatten)]
    options: RenderOptions,

    #[command(flatten)]
    limit: TimeLimitOption,

    #[command(flatten)]
    observe: ObserveOptions,
}

const AFTER_HELP: &str = "\
Examples:
  kinora poster turn.ron                             the middle frame
  kinora poster turn.ron --at 1.5 -s 1920x1080 -o cover.jpg
  kinora poster turn.ron --time-limit 1min           as many samples as fit into a minute
  kinora poster turn.ron --frame 0 --transparent --bits 16 -o cover.png";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    observed(&arguments.observe, |observation| rendered(arguments, observation))
}

fn rendered(arguments: &Arguments, observation: &Observation) -> Result<(), Failure> {
    let options = &arguments.options;
    let loading = LoadingReporter::new(options.progress, options.quiet);
    let read = || load::sequence(&arguments.file, options.allow_outside, loading);
    let sequence = tracing::info_span!("read").in_scope(read)?;
    let overrides = arguments.image.with(options.overrides());
    let mut sequence = overrides::apply(sequence, &overrides).map_err(Failure::Bad)?;
    sequence.quality.denoise = sequence.quality.denoise.of_stills();
    let frame = arguments.frame_of(&sequence)?;
    let outputs = match arguments.output.is_empty() {
        true => vec![default_output(&sequence, "poster")?],
        false => arguments.output.clone(),
    };
    if let Some(output) = outputs.iter().find(|output| output.is_animation()) {
        return Err(Failure::Bad(format!(
            "a poster is one picture; write .png, .jpg, .ppm or .exr, not {output}"
        )));
    }
    observation.open(&arguments.file, &outputs, &[frame])?;
    let request = Request {
        outputs,
        confined: arguments.output.is_empty(),
        existing: Existing::Replace,
        frames: vec![frame],
        threads: options.threads,
        reuse: Reuse::Share,
        time_limit: arguments.limit.time_limit,
    };

    let limit_note = time_limit::apply(&mut sequence, &request, options.quiet)?;
    let meter = Arc::new(ProgressMeter::default());
    let reporter = ProgressReporter::new(options.progress, options.quiet, 1);
    let notify = |notice: Notice| {
        forecast_text::notice_line(&sequence, notice).into_iter().for_each(|line| meter.notice(line))
    };
    let notify: Option<Listener> = if options.quiet { None } else { Some(&notify) };
    let stop = Stop::default();
    let mut done = progress::watch(&meter, 1, reporter, || {
        render_with_notices(&sequence, &request, &meter, &stop, notify)
    })?;
    done.notes.extend(limit_note);
    if options.quiet {
        return Ok(());
    }
    let json = options.progress == ProgressMode::Json;
    terminal::print_line(&if json { summary::json(&done) } else { summary::text(&done) })
}

impl Arguments {
    fn frame_of(&self, sequence: &Sequence) -> Result<u32, Failure> {
        let count = sequence.timeline.frames;
        let frame = match (self.frame, self.at) {
            (Some(frame), _) => frame,
            (None, Some(time)) => sequence.timeline.frame_at(time),
            (None, None) => count / 2,
        };
        if frame < count {
            return Ok(frame);
        }
        let message = match self.at {
            Some(time) => format!(
                "{} s is after the end: the sequence is {} s long",
                decimal(time),
                decimal(sequence.timeline.duration)
            ),
            None => format!("there is no frame {frame}; the last one is {}", count.saturating_sub(1)),
        };
        Err(Failure::Bad(message))
    }
}
