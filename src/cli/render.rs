//! `kinora render`: a sequence file in, frames and animations out.

use super::failure::Failure;
use super::outputs::Run;
use super::overrides;
use super::progress::{self, ProgressMode};
use super::settings::Settings;
use super::signals::{self, Next};
use super::time_limit::{self, TimeLimit};
use super::{load, loading, outlook, summary, terminal, values};
use crate::base::escape;
use crate::base::files::{self, Root};
use crate::base::frame_set::{FrameSet, Shard};
use crate::base::stats::Meter;
use crate::base::units::counted;
use crate::encode::{Existing, Output, Streamed};
use crate::farm::Fingerprint;
use crate::pipeline::plan::with_shared;
use crate::pipeline::render::{Notice, RenderError, Request, Summary, render_told};
use crate::sequence::Sequence;
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Render a sequence into pictures, GIFs and videos.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron).
    file: PathBuf,

    /// File to write; may be given several times [default: those that the sequence names]
    ///
    /// The format follows the extension: .mp4, .gif, .apng, .webp or .y4m for an animation,
    /// .png, .jpg or .ppm for a picture per frame, .exr for its linear radiance, where ####
    /// or %04d is the place of the frame number; - for the standard output, as --format says.
    /// Without this option, a draft's files are called draft_..., and a part of the frames
    /// leaves the whole animation as it is.
    #[arg(short, long, value_name = "FILE", value_parser = values::output(), verbatim_doc_comment)]
    output: Vec<Output>,

    /// What -o - writes to the standard output: y4m, ppm, ppm-ascii or png [default: y4m]
    ///
    /// y4m is raw video for any encoder; ppm (P6), ppm-ascii (P3) and png are a file per frame,
    /// one after the other.
    #[arg(long, value_name = "FORMAT", value_parser = values::streamed, verbatim_doc_comment)]
    format: Option<Streamed>,

    /// Frames to render, counted from 0: 0-47, 0..48, 7,9,20 or 1-40:2 [default: all]
    ///
    /// 0-47 includes its end, 0..48 does not; 1-40:2 (or 1-40x2) takes every second frame.
    /// Each frame shows the same moment as in the whole sequence.
    #[arg(long, value_name = "SET", allow_hyphen_values = true, verbatim_doc_comment)]
    frames: Option<FrameSet>,

    /// Only a part of these frames, for one of several processes: 2/4 is the second of four
    ///
    /// Shards may write into one folder at the same time. They write stills; `kinora assemble`
    /// makes animations of them.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true, verbatim_doc_comment)]
    shard: Option<Shard>,

    /// Also those of these frames that are made of the films of the frames to render
    ///
    /// What is traced for one frame serves all in which the same is seen, or only lights are
    /// switched and faded. For whoever hands out films: `kinora farm export openjd`.
    #[arg(long, value_name = "SET", conflicts_with = "shard", verbatim_doc_comment)]
    with_shared: Option<FrameSet>,

    /// Claim each frame before it is made, so that any number of processes may do the same
    ///
    /// Each skips what others have done and are doing; at the end it waits for them, and takes
    /// over what processes had in hand that have died. Only stills that say what they show, PNG
    /// and EXR, can be shared like this.
    #[arg(long, conflicts_with_all = ["overwrite", "fail_if_exists"], verbatim_doc_comment)]
    claim: bool,

    /// Refuse to begin with another version, or if the sequence or what it reads has changed
    /// since `kinora farm export` told this
    #[arg(long, value_name = "FINGERPRINT", verbatim_doc_comment)]
    expect: Option<String>,

    /// Keep PNG and EXR frames that are there and right, as without any of these
    ///
    /// Runs that write only animations, such as a GIF, have no such frames and start again.
    #[arg(long, conflicts_with_all = ["overwrite", "fail_if_exists"])]
    resume: bool,

    /// Render all frames anew [default: keep those that are there and right]
    #[arg(long, conflicts_with = "fail_if_exists")]
    overwrite: bool,

    /// Write nothing if a file is there already
    #[arg(long)]
    fail_if_exists: bool,

    #[command(flatten)]
    settings: Settings,

    #[command(flatten)]
    limit: TimeLimit,
}

const AFTER_HELP: &str = "\
Examples:
  kinora render turn.ron                             everything as the file says
  kinora render turn.ron -o t_####.png -o t.gif      frames and an animation
  kinora render turn.ron -o turn.mp4 --quality 80    a video for browsers and slides
  kinora render turn.ron -o - | x265 --y4m - -o t.hevc  raw video for any encoder
  kinora render turn.ron --frames 7 -o - --format ppm > 7.ppm  a frame for another program
  kinora render turn.ron --frames 0-47:2 -s 640x360  every second frame, small
  kinora render turn.ron --shard 2/4                 one of four processes, on any machine
  kinora render turn.ron -r 30 --draft               a quick look at another rate";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let done = rendered(arguments);
    let watched = arguments.settings.options.progress == ProgressMode::OpenJd;
    if let Some(failure) = done.as_ref().err().filter(|_| watched) {
        // Whoever watches may be gone; the failure is told once more on the other stream.
        let _ = terminal::say(&failure.openjd());
    }
    done
}

fn rendered(arguments: &Arguments) -> Result<(), Failure> {
    let options = &arguments.settings.options;
    let mut sequence = arguments.sequence()?;
    let all = frames_of(arguments.frames.as_ref(), &sequence)?;
    let frames = arguments.part_of(&all, &sequence)?;
    let wanted = arguments.outputs()?;
    let run = Run {
        own: &sequence.output.files,
        wanted: &wanted,
        draft: options.draft,
        partial: arguments.shares() || frames.len() < sequence.timeline.frames as usize,
    };
    let (outputs, note) = run.outputs();
    arguments.refuse(&outputs)?;
    if let Some(shard) = arguments.shard.filter(|_| frames.is_empty()) {
        let there = counted(all.len() as u64, "frame");
        return terminal::say(&format!("shard {shard} has no frames: there are {there}"));
    }
    let request = Request {
        outputs,
        confined: arguments.output.is_empty(),
        existing: arguments.existing(),
        frames,
        threads: options.threads,
        reuse: arguments.settings.reuse(),
        time_limit: arguments.limit.time_limit,
    };
    let chosen = time_limit::settle(&mut sequence, &request, options.quiet)?;
    let mut done = arguments.watched(&sequence, &request)?;
    done.notes.extend(note);
    done.notes.extend(chosen);
    if options.draft {
        done.notes.insert(0, draft_note(&sequence));
    }
    arguments.tell(&done, &request.outputs)
}

impl Arguments {
    /// The sequence with the settings of the command line, if it is the one that is expected.
    fn sequence(&self) -> Result<Sequence, Failure> {
        let options = &self.settings.options;
        let loading = loading::Reporter::new(options.progress, options.quiet);
        let (sequence, root) = load::with_files(&self.file, options.allow_outside, loading)?;
        if let Some(expected) = &self.expect {
            fingerprint(&self.file, &root)?.check(expected).map_err(Failure::Bad)?;
        }
        overrides::applied(sequence, &self.settings.overrides()).map_err(Failure::Bad)
    }

    /// What the command line says to write.
    fn outputs(&self) -> Result<Vec<Output>, Failure> {
        let Some(streamed) = self.format else { return Ok(self.output.clone()) };
        if !self.output.iter().any(Output::is_stream) {
            let message = "--format says what goes to the standard output, and nothing does: write -o - as well; formats \
                           of files follow their extensions";
            return Err(Failure::Bad(message.to_owned()));
        }
        let as_said = |output: &Output| match output {
            Output::Stream(_) => Output::Stream(streamed),
            _ => output.clone(),
        };
        Ok(self.output.iter().map(as_said).collect())
    }

    /// Those of the frames that this process is to make.
    fn part_of(&self, all: &[u32], sequence: &Sequence) -> Result<Vec<u32>, Failure> {
        let frames = self.shard.map_or(all, |shard| shard.of(all));
        let Some(among) = &self.with_shared else { return Ok(frames.to_vec()) };
        let among = among.frames(sequence.timeline.frames);
        let among = among.map_err(|error| Failure::Bad(format!("--with-shared: {error}")))?;
        Ok(with_shared(sequence, frames, &among))
    }

    /// Refuses options that do not go together with what is written.
    fn refuse(&self, outputs: &[Output]) -> Result<(), Failure> {
        if self.shares() {
            only_stills(outputs)?;
        }
        terminal::check_stream(outputs)?;
        let told = match self.settings.options.progress {
            ProgressMode::Json => Some("json"),
            ProgressMode::OpenJd => Some("openjd"),
            ProgressMode::Auto | ProgressMode::Plain => None,
        };
        if let Some(mode) = told.filter(|_| outputs.iter().any(Output::is_stream)) {
            return Err(Failure::Bad(format!(
                "-o - and --progress {mode} both write to the standard output; leave one out"
            )));
        }
        if self.limit.time_limit.is_some() && self.shares() {
            let message = "--time-limit picks the samples of all frames, and each process would pick others: find out how \
                           many there are without --shard and --claim, then give them to all processes by --samples";
            return Err(Failure::Bad(message.to_owned()));
        }
        Ok(())
    }

    /// Renders while progress is told.
    fn watched(&self, sequence: &Sequence, request: &Request) -> Result<Summary, Failure> {
        let options = &self.settings.options;
        let meter = Arc::new(Meter::default());
        let frames = request.frames.len();
        let show = progress::Reporter::new(options.progress, options.quiet, frames);
        let stop = signals::watched();
        let tell =
            |notice: Notice| outlook::line(sequence, notice).into_iter().for_each(|line| meter.notice(line));
        let done =
            progress::watch(&meter, frames, show, || render_told(sequence, request, &meter, &stop, &tell));
        done.map_err(|error| failure(error, &request.outputs, options.quiet))
    }

    /// Tells what was done, beside frames that go to the standard output.
    fn tell(&self, done: &Summary, outputs: &[Output]) -> Result<(), Failure> {
        let options = &self.settings.options;
        if options.quiet {
            return Ok(());
        }
        let json = options.progress == ProgressMode::Json;
        let told = if json { summary::json(done) } else { summary::text(done) };
        if outputs.iter().any(Output::is_stream) {
            terminal::complain(&told);
            return Ok(());
        }
        terminal::say(&told)
    }
}

/// Why a run failed; if it was stopped, how it goes on, unless errors alone are told.
fn failure(error: RenderError, outputs: &[Output], quiet: bool) -> Failure {
    let RenderError::Stopped { signal, done, files, rest, keeps } = error else { return error.into() };
    if quiet {
        return Failure::Stopped { signal, message: String::new() };
    }
    let next = match (keeps, outputs.iter().any(Output::is_animation)) {
        (true, _) => Next::Same,
        (false, false) => Next::Frames(&rest),
        (false, true) => Next::Anew,
    };
    Failure::Stopped { signal, message: signals::told(done, &files, std::env::args_os(), next) }
}

/// Processes that share the work write no animations.
fn only_stills(outputs: &[Output]) -> Result<(), Failure> {
    let Some(output) = outputs.iter().find(|output| output.is_animation()) else { return Ok(()) };
    Err(Failure::Bad(format!(
        "every process would write all of {output}; let them write stills (-o f_####.png), and then make it of them \
         with `kinora assemble`"
    )))
}

impl Arguments {
    /// Whether this process makes a part of the frames, and others the rest.
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

/// What is read now, to be compared with what was read for a job.
pub fn fingerprint(file: &Path, root: &Root) -> Result<Fingerprint, Failure> {
    Fingerprint::of(file, &root.admitted()).map_err(|(path, error)| {
        Failure::Bad(format!("cannot read {}: {}", escape::path(path), files::why(&error)))
    })
}

/// The frames of a set, or all.
pub fn frames_of(wanted: Option<&FrameSet>, sequence: &Sequence) -> Result<Vec<u32>, Failure> {
    let count = sequence.timeline.frames;
    let (set, option) = match wanted {
        Some(set) => (Some(set.clone()), "--frames: "),
        None => (FrameSet::whole(count), ""),
    };
    let set = set.ok_or_else(|| Failure::Bad("the sequence has no frames".to_owned()))?;
    set.frames(count).map_err(|error| Failure::Bad(format!("{option}{error}")))
}

/// Says what a draft came out as, so that nobody takes it for the real thing.
fn draft_note(sequence: &Sequence) -> String {
    let (width, height) = sequence.output.size;
    let quality = sequence.quality;
    format!(
        "a draft: {width}x{height}, antialias {}, samples {}, bounces {}; leave out --draft for the full quality",
        quality.antialias, quality.samples, quality.bounces
    )
}
