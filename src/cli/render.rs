//! `kinora render`: renders a sequence into frames and animations.

use super::failure::Failure;
use super::frame_selection::selected_frames;
use super::loading::LoadingReporter;
use super::observe::{Observation, ObserveOptions, observed};
use super::options::RenderOptions;
use super::outputs::OutputChoice;
use super::progress::{self, ProgressMode, ProgressReporter};
use super::settings::Settings;
use super::signals::{self, Continuation};
use super::time_limit::{self, TimeLimitOption};
use super::{forecast_text, load, overrides, summary, terminal, values};
use crate::base::frame_set::{FrameSet, Shard};
use crate::base::stats::ProgressMeter;
use crate::base::units::counted;
use crate::encode::{Existing, Output, StreamFormat};
use crate::pipeline::plan::with_shared;
use crate::pipeline::render::{Listener, Notice, RenderError, Request, Summary, render_with_notices};
use crate::sequence::Sequence;
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;
use tracing::info_span;

/// Render a sequence into pictures, GIFs and videos.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron or .json)
    file: PathBuf,

    /// File to write; repeat for several files [default: the files that the sequence names]
    ///
    /// The extension sets the format. Animations: .mp4, .gif, .apng, .webp or .y4m. One picture
    /// per frame: .png, .jpg or .ppm, or .exr for linear radiance; #### or %04d in the name is
    /// replaced by the frame number. - is the standard output, in the format of --format.
    /// Without this option, the names of a draft's files start with draft_, and a run of only
    /// some frames does not overwrite the full animation.
    #[arg(short, long, value_name = "FILE", value_parser = values::output(), verbatim_doc_comment)]
    output: Vec<Output>,

    /// Format of the standard output for -o -: y4m, ppm, ppm-ascii or png [default: y4m]
    ///
    /// y4m is raw video for any encoder. ppm (P6), ppm-ascii (P3) and png give one file per
    /// frame, one after the other.
    #[arg(long, value_name = "FORMAT", value_parser = values::streamed, verbatim_doc_comment)]
    format: Option<StreamFormat>,

    /// Frames to render, counted from 0: 0-47, 0..48, 7,9,20 or 1-40:2 [default: all]
    ///
    /// 0-47 includes frame 47, and 0..48 excludes frame 48; 1-40:2 (or 1-40x2) takes every second
    /// frame. Each frame shows the same moment as in the whole sequence.
    #[arg(long, value_name = "SET", allow_hyphen_values = true, verbatim_doc_comment)]
    frames: Option<FrameSet>,

    /// Render one part of the frames in each of several processes: 2/4 is the second of four
    ///
    /// Shards may write into one folder at the same time. They write stills, from which
    /// `kinora assemble` makes animations.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true, verbatim_doc_comment)]
    shard: Option<Shard>,

    /// Also render the frames of this set that share a film with the frames of --frames
    ///
    /// Frames share a film (the traced light) if they show the same scene, or if only lights
    /// change their brightness. Frames that share samples of a zoom count too, and blocks of
    /// frames that are denoised with their neighbours. Jobs of `kinora farm export openjd` use
    /// this option.
    #[arg(long, value_name = "SET", conflicts_with = "shard", verbatim_doc_comment)]
    include_shared: Option<FrameSet>,

    /// Share the frames with other processes that run the same command
    ///
    /// Each process claims a frame before it renders it, and skips frames that others have
    /// finished or claimed. At the end it waits for the others, and takes over the frames of
    /// processes that died. Works for PNG and EXR frames, because they have metadata.
    #[arg(long, conflicts_with_all = ["overwrite", "fail_if_exists"], verbatim_doc_comment)]
    claim: bool,

    /// Fail if the version, the sequence or a file that it reads differs from this fingerprint
    ///
    /// `kinora farm export` writes the fingerprint into the job.
    #[arg(long, value_name = "FINGERPRINT", verbatim_doc_comment)]
    expect: Option<String>,

    /// Keep existing PNG and EXR frames that are up to date [default]
    ///
    /// Runs that write only animations, such as a GIF, have no such frames and start again.
    #[arg(long, conflicts_with_all = ["overwrite", "fail_if_exists"])]
    resume: bool,

    /// Render all frames again, and replace existing files
    #[arg(long, conflicts_with = "fail_if_exists")]
    overwrite: bool,

    /// Fail if an output file exists already
    #[arg(long)]
    fail_if_exists: bool,

    #[command(flatten)]
    settings: Settings,

    #[command(flatten)]
    limit: TimeLimitOption,

    #[command(flatten)]
    observe: ObserveOptions,
}

const AFTER_HELP: &str = "\
Examples:
  kinora render turn.ron                             the files that the sequence names
  kinora render turn.ron -o t_####.png -o t.gif      frames and an animation
  kinora render turn.ron -o turn.mp4 --quality 80    a video for browsers and slides
  kinora render turn.ron -o - | x265 --y4m - -o t.hevc  raw video for any encoder
  kinora render turn.ron --frames 7 -o - --format ppm > 7.ppm  a frame for another program
  kinora render turn.ron --frames 0-47:2 -s 640x360  every second frame, small
  kinora render turn.ron --trace run.json            where the time goes, for ui.perfetto.dev
  kinora render turn.ron --shard 2/4                 one of four processes, on any machine
  kinora render turn.ron -r 30 --draft               a fast preview at another rate";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let result = observed(&arguments.observe, |observation| rendered(arguments, observation));
    let openjd = arguments.settings.options.progress == ProgressMode::OpenJd;
    if let Some(failure) = result.as_ref().err().filter(|_| openjd) {
        // If the runner went away, stderr still gets the failure.
        let _ = terminal::print_line(&failure.openjd());
    }
    result
}

fn rendered(arguments: &Arguments, observation: &Observation) -> Result<(), Failure> {
    let options = &arguments.settings.options;
    let mut sequence = info_span!("read").in_scope(|| arguments.sequence())?;
    let all = selected_frames(arguments.frames.as_ref(), &sequence)?;
    let frames = arguments.own_frames(&all, &sequence)?;
    let wanted = arguments.outputs()?;
    let choice = OutputChoice {
        own: &sequence.output.files,
        wanted: &wanted,
        draft: options.draft,
        partial: arguments.shares() || frames.len() < sequence.timeline.frames as usize,
    };
    let (outputs, note) = choice.resolve();
    arguments.check_outputs(&outputs)?;
    if let Some(shard) = arguments.shard.filter(|_| frames.is_empty()) {
        let count = counted(all.len() as u64, "frame");
        return terminal::print_line(&format!("shard {shard} has no frames: there are {count}"));
    }
    observation.open(&arguments.file, &outputs, &frames)?;
    let request = Request {
        outputs,
        confined: arguments.output.is_empty(),
        existing: arguments.existing(),
        frames,
        threads: options.threads,
        reuse: arguments.settings.reuse(),
        time_limit: arguments.limit.time_limit,
    };
    let limit_note = time_limit::apply(&mut sequence, &request, options.quiet)?;
    let mut done = with_progress(options, &sequence, &request)?;
    done.notes.extend(note);
    done.notes.extend(limit_note);
    if options.draft {
        done.notes.insert(0, draft_note(&sequence));
    }
    print(options, &done, &request.outputs)
}

impl Arguments {
    /// Loads the sequence, checks its fingerprint, and applies the settings of the command line.
    fn sequence(&self) -> Result<Sequence, Failure> {
        let options = &self.settings.options;
        let reporter = LoadingReporter::new(options.progress, options.quiet);
        let (sequence, root) = load::with_files(&self.file, options.allow_outside, reporter)?;
        if let Some(expected) = &self.expect {
            load::fingerprint(&self.file, &root)?.check(expected).map_err(Failure::Bad)?;
        }
        overrides::apply(sequence, &self.settings.overrides()).map_err(Failure::Bad)
    }

    /// The files of the command line.
    fn outputs(&self) -> Result<Vec<Output>, Failure> {
        let Some(streamed) = self.format else { return Ok(self.output.clone()) };
        if !self.output.iter().any(Output::is_stream) {
            let message = "--format sets the format of the standard output, but nothing goes there: write -o - as \
                           well; the extension of a file sets its format";
            return Err(Failure::Bad(message.to_owned()));
        }
        let with_format = |output: &Output| match output {
            Output::Stream(_) => Output::Stream(streamed),
            _ => output.clone(),
        };
        Ok(self.output.iter().map(with_format).collect())
    }

    /// The frames that this process renders.
    fn own_frames(&self, all: &[u32], sequence: &Sequence) -> Result<Vec<u32>, Failure> {
        let frames = self.shard.map_or(all, |shard| shard.of(all));
        let Some(among) = &self.include_shared else { return Ok(frames.to_vec()) };
        let among = among.frames(sequence.timeline.frames);
        let among = among.map_err(|error| Failure::Bad(format!("--include-shared: {error}")))?;
        Ok(with_shared(sequence, frames, &among))
    }

    /// Fails if options conflict with the outputs.
    fn check_outputs(&self, outputs: &[Output]) -> Result<(), Failure> {
        if self.shares() {
            only_stills(outputs)?;
        }
        terminal::check_stream(outputs)?;
        let on_stdout = match self.settings.options.progress {
            ProgressMode::Json => Some("json"),
            ProgressMode::OpenJd => Some("openjd"),
            ProgressMode::Auto | ProgressMode::Plain => None,
        };
        if let Some(mode) = on_stdout.filter(|_| outputs.iter().any(Output::is_stream)) {
            return Err(Failure::Bad(format!(
                "-o - and --progress {mode} both write to the standard output; leave one out"
            )));
        }
        if self.limit.time_limit.is_some() && self.shares() {
            let message = "--time-limit picks the samples of all frames, and each process would pick other ones: run \
                           it once without --shard and --claim to learn their number, then give --samples to all \
                           processes";
            return Err(Failure::Bad(message.to_owned()));
        }
        Ok(())
    }
}

/// Renders, and shows the progress.
pub(super) fn with_progress(
    options: &RenderOptions,
    sequence: &Sequence,
    request: &Request,
) -> Result<Summary, Failure> {
    let meter = Arc::new(ProgressMeter::default());
    let frames = request.frames.len();
    let reporter = ProgressReporter::new(options.progress, options.quiet, frames);
    let stop = signals::stop_on_signals();
    let notify = |notice: Notice| {
        forecast_text::notice_line(sequence, notice).into_iter().for_each(|line| meter.notice(line))
    };
    // Nobody would read the forecast of a quiet run.
    let notify: Option<Listener> = if options.quiet { None } else { Some(&notify) };
    let render = || render_with_notices(sequence, request, &meter, &stop, notify);
    let done = progress::watch(&meter, frames, reporter, render);
    done.map_err(|error| failure(error, &request.outputs, options.quiet))
}

/// Prints the summary: on stderr if frames go to the standard output.
pub(super) fn print(options: &RenderOptions, done: &Summary, outputs: &[Output]) -> Result<(), Failure> {
    if options.quiet {
        return Ok(());
    }
    let json = options.progress == ProgressMode::Json;
    let summary = if json { summary::json(done) } else { summary::text(done) };
    if outputs.iter().any(Output::is_stream) {
        terminal::eprint_line(&summary);
        return Ok(());
    }
    terminal::print_line(&summary)
}

/// The failure of a run. If the run was stopped, the message says how to continue, except with `--quiet`.
fn failure(error: RenderError, outputs: &[Output], quiet: bool) -> Failure {
    let RenderError::Stopped { signal, done, files, rest, keeps } = error else { return error.into() };
    if quiet {
        return Failure::Stopped { signal, message: String::new() };
    }
    let continuation = match (keeps, outputs.iter().any(Output::is_animation)) {
        (true, _) => Continuation::Same,
        (false, false) => Continuation::MissingFrames(&rest),
        (false, true) => Continuation::StartOver,
    };
    let message = signals::stop_message(done, &files, super::arguments().into_iter(), continuation);
    Failure::Stopped { signal, message }
}

/// Fails if there are animations, which processes that share the frames cannot write.
fn only_stills(outputs: &[Output]) -> Result<(), Failure> {
    let Some(output) = outputs.iter().find(|output| output.is_animation()) else { return Ok(()) };
    Err(Failure::Bad(format!(
        "every process would write all of {output}; let them write stills (-o f_####.png), then make it from them \
         with `kinora assemble`"
    )))
}

impl Arguments {
    /// Whether other processes render some of the frames.
    fn shares(&self) -> bool {
        self.shard.is_some() || self.claim
    }

    fn existing(&self) -> Existing {
        match (self.overwrite, self.fail_if_exists, self.claim) {
            (true, ..) => Existing::Replace,
            (_, true, _) => Existing::Refuse,
            (.., true) => Existing::Share,
            _ => Existing::Keep,
        }
    }
}

/// A note with the settings of a draft, so that nobody films it for the final result.
pub(super) fn draft_note(sequence: &Sequence) -> String {
    let (width, height) = sequence.output.size;
    let quality = sequence.quality;
    format!(
        "a draft: {width}x{height}, antialias {}, samples {}, bounces {}; leave out --draft for the full quality",
        quality.antialias, quality.samples, quality.bounces
    )
}
