//! `kinora render`: a sequence file in, frames and animations out.

use super::failure::Failure;
use super::overrides::{self, Overrides};
use super::progress::{self, ProgressMode};
use super::{load, summary, terminal, values};
use crate::counters::Meter;
use crate::frame_set::FrameSet;
use crate::render::{Request, render};
use crate::sequence::Sequence;
use crate::time::Rate;
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Render a sequence into PNG frames and GIFs.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron).
    file: PathBuf,

    /// File to write; may be given several times [default: the files that the sequence names].
    ///
    /// The format follows the extension: .png for one picture per frame, with #### or %04d where the frame
    /// number goes, .gif for an animation.
    #[arg(short, long, value_name = "FILE")]
    output: Vec<String>,

    /// Frames to render, counted from 0: 0-47, 0..48, 7,9,20 or 1-40:2 [default: all].
    ///
    /// The end of 0-47 is included, that of 0..48 is not. 1-40:2 and 1-40x2 take every second frame. Each
    /// frame shows the same moment as in the whole sequence.
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    /// Width and height in pixels, such as 1280x720 [default: as the sequence says].
    #[arg(short, long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    size: Option<(u32, u32)>,

    /// Frames per second: 24, 29.97 or 30000/1001; the duration stays [default: as the sequence says].
    #[arg(short = 'r', long, value_name = "RATE", value_parser = values::rate, allow_negative_numbers = true)]
    fps: Option<Rate>,

    /// Threads to render with; they do not change the picture [default: one per processor].
    #[arg(short, long, value_name = "N", value_parser = values::threads, allow_negative_numbers = true)]
    threads: Option<NonZeroUsize>,

    /// Longest chain of mirror reflections, from 0 [default: as the sequence says].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    bounces: Option<u32>,

    /// N×N samples per pixel, 1 to 256 [default: as the sequence says].
    #[arg(long, value_name = "N", allow_negative_numbers = true,
          value_parser = clap::value_parser!(u32).range(1..=256))]
    antialias: Option<u32>,

    /// A quick look: half the width and height, antialias 1, at most 1 bounce.
    ///
    /// --size, --antialias and --bounces go before it where they are given.
    #[arg(long)]
    draft: bool,

    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,

    /// How progress is told.
    #[arg(long, value_enum, default_value_t, value_name = "HOW")]
    progress: ProgressMode,
}

const AFTER_HELP: &str = "\
Examples:
  kinora render turn.ron                                  everything as the file says
  kinora render turn.ron -o out/turn_####.png -o turn.gif frames and an animation
  kinora render turn.ron --frames 0-47:2 -s 640x360       every second frame, small
  kinora render turn.ron -r 30 --draft                    a quick look at another rate";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let wanted = arguments.overrides();
    let sequence = overrides::applied(load::sequence(&arguments.file)?, &wanted).map_err(Failure::Bad)?;
    let source = if wanted.outputs.is_empty() { "output.files:" } else { "--output" };
    let request = Request {
        outputs: load::outputs(&sequence.output.files, source)?,
        frames: arguments.frames_of(&sequence)?,
        threads: arguments.threads,
    };

    let meter = Meter::default();
    let frames = request.frames.len();
    let show = progress::Reporter::new(arguments.progress, arguments.quiet, frames);
    let mut done = progress::watch(&meter, frames, show, || render(&sequence, &request, &meter))?;

    if arguments.draft {
        done.notes.insert(0, draft_note(&sequence));
    }
    if !arguments.quiet {
        let json = arguments.progress == ProgressMode::Json;
        terminal::say(&if json { summary::json(&done) } else { summary::text(&done) });
    }
    Ok(())
}

impl Arguments {
    fn overrides(&self) -> Overrides {
        Overrides {
            outputs: self.output.clone(),
            size: self.size,
            rate: self.fps,
            bounces: self.bounces,
            antialias: self.antialias,
            draft: self.draft,
        }
    }

    fn frames_of(&self, sequence: &Sequence) -> Result<Vec<u32>, Failure> {
        let count = sequence.timeline.frames;
        let (set, option) = match &self.frames {
            Some(set) => (Some(set.clone()), "--frames: "),
            None => (FrameSet::whole(count), ""),
        };
        let set = set.ok_or_else(|| Failure::Bad("the sequence has no frames".to_owned()))?;
        set.frames(count).map_err(|error| Failure::Bad(format!("{option}{error}")))
    }
}

/// Says what a draft came out as, so that nobody takes it for the real thing.
fn draft_note(sequence: &Sequence) -> String {
    let (width, height) = sequence.output.size;
    let quality = sequence.quality;
    format!(
        "a draft: {width}x{height}, antialias {}, bounces {}; leave out --draft for the full quality",
        quality.antialias, quality.bounces
    )
}
