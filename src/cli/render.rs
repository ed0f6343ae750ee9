//! `kinora render`: a sequence file in, frames and animations out.

use super::failure::Failure;
use super::outputs::Run;
use super::overrides::{self, Overrides};
use super::progress::{self, ProgressMode};
use super::{load, loading, summary, terminal, values};
use crate::counters::Meter;
use crate::encode::{Output, Template, Tonemap};
use crate::frame_set::FrameSet;
use crate::quality::Integrator;
use crate::render::{Request, render};
use crate::sequence::Sequence;
use crate::time::Rate;
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;

/// Render a sequence into pictures, GIFs and videos.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron).
    file: PathBuf,

    /// File to write; may be given several times [default: those that the sequence names]
    ///
    /// The format follows the extension: .mp4, .gif, .apng, .webp or .y4m for an animation, .png,
    /// .jpg or .ppm for a picture per frame, .exr for its linear radiance, where #### or %04d is the
    /// place of the frame number; - for raw video (Y4M) on the standard output, for any encoder.
    /// Without this option, a draft's files are called draft_..., and a part of the frames
    /// leaves the whole animation as it is.
    #[arg(short, long, value_name = "FILE", value_parser = Output::parse, verbatim_doc_comment)]
    output: Vec<Output>,

    /// Frames to render, counted from 0: 0-47, 0..48, 7,9,20 or 1-40:2 [default: all]
    ///
    /// 0-47 includes its end, 0..48 does not; 1-40:2 (or 1-40x2) takes every second frame.
    /// Each frame shows the same moment as in the whole sequence.
    #[arg(long, value_name = "SET", allow_hyphen_values = true, verbatim_doc_comment)]
    frames: Option<FrameSet>,

    /// Width and height in pixels, such as 1280x720 [default: as the sequence says]
    #[arg(short, long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    size: Option<(u32, u32)>,

    /// Frames per second: 24, 29.97 or 30000/1001 [default: as the sequence says]
    ///
    /// The animation keeps its duration in seconds.
    #[arg(short = 'r', long, value_name = "RATE", value_parser = values::rate, allow_hyphen_values = true)]
    fps: Option<Rate>,

    /// Threads to render with; the picture is the same with any [default: one per processor]
    #[arg(short, long, value_name = "N", value_parser = values::threads, allow_hyphen_values = true)]
    threads: Option<NonZeroUsize>,

    /// How light is followed: whitted or path [default: as the sequence says]
    #[arg(long, value_name = "NAME", value_parser = values::integrator)]
    integrator: Option<Integrator>,

    /// Longest chain of reflections and refractions, 0 for none [default: as the sequence says]
    #[arg(long, value_name = "N", value_parser = values::bounces, allow_hyphen_values = true)]
    bounces: Option<u32>,

    /// N×N samples per pixel where nothing is random, 1 to 64 [default: as the sequence says]
    #[arg(long, value_name = "N", value_parser = values::antialias, allow_hyphen_values = true)]
    antialias: Option<u32>,

    /// Random samples per pixel where something is [default: as the sequence says]
    ///
    /// Paths, area lights, rough surfaces, lenses and motion blur are drawn at random: four times
    /// the samples halve the noise.
    #[arg(long, value_name = "N", value_parser = values::samples, allow_hyphen_values = true, verbatim_doc_comment)]
    samples: Option<u32>,

    /// Another number gives other noise [default: as the sequence says]
    #[arg(long, value_name = "N", value_parser = values::seed, allow_hyphen_values = true)]
    seed: Option<u32>,

    /// How radiance is displayed: srgb, none, reinhard or filmic [default: as the sequence says]
    #[arg(long, value_name = "MAP", value_parser = values::tonemap)]
    tonemap: Option<Tonemap>,

    /// Stops by which pictures are brightened, such as -1.5 [default: as the sequence says]
    #[arg(long, value_name = "STOPS", value_parser = values::exposure, allow_hyphen_values = true)]
    exposure: Option<f64>,

    /// Leave the background out: PNG, APNG, WebP and EXR get alpha
    #[arg(long)]
    transparent: bool,

    /// Write this into every picture, such as "frame {frame}, {time} s"
    ///
    /// {frame}, {frames}, {time} and {name} stand for their values.
    #[arg(long, value_name = "TEXT", value_parser = values::caption)]
    caption: Option<Template>,

    /// Bits of a PNG's channels: 8 or 16 [default: as the sequence says]
    #[arg(long, value_name = "N", value_parser = values::bits)]
    bits: Option<bool>,

    /// Quality of JPEGs and of MP4 video, 1 to 100 [default: as the sequence says]
    #[arg(long, value_name = "N", value_parser = values::encode_quality, allow_hyphen_values = true)]
    quality: Option<u8>,

    /// How large a GIF may become, such as 5MB: it loses colours, pixels or frames until it fits
    #[arg(long, value_name = "SIZE", value_parser = values::file_size, allow_hyphen_values = true)]
    max_size: Option<u64>,

    /// PNGs without text about the frame
    #[arg(long)]
    no_metadata: bool,

    /// A quick look: half the width and height, antialias 1, at most 16 samples and 1 bounce
    ///
    /// What --size, --antialias, --samples and --bounces say goes before it.
    #[arg(long)]
    draft: bool,

    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,

    /// How progress is told
    #[arg(long, value_enum, default_value_t, value_name = "HOW")]
    progress: ProgressMode,
}

const AFTER_HELP: &str = "\
Examples:
  kinora render turn.ron                             everything as the file says
  kinora render turn.ron -o t_####.png -o t.gif      frames and an animation
  kinora render turn.ron -o turn.mp4 --quality 80    a video for browsers and slides
  kinora render turn.ron -o - | x265 --y4m - -o t.hevc  raw video for any encoder
  kinora render turn.ron --frames 0-47:2 -s 640x360  every second frame, small
  kinora render turn.ron -r 30 --draft               a quick look at another rate";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let loading = loading::Reporter::new(arguments.progress, arguments.quiet);
    let sequence = load::sequence(&arguments.file, loading)?;
    let sequence = overrides::applied(sequence, &arguments.overrides()).map_err(Failure::Bad)?;
    let frames = arguments.frames_of(&sequence)?;
    let run = Run {
        own: &sequence.output.files,
        wanted: &arguments.output,
        draft: arguments.draft,
        partial: frames.len() < sequence.timeline.frames as usize,
    };
    let (outputs, note) = run.outputs();
    let streams = outputs.contains(&Output::Stream);
    let json = arguments.progress == ProgressMode::Json;
    if streams && json {
        let message = "-o - and --progress json both write to the standard output; leave one out";
        return Err(Failure::Bad(message.to_owned()));
    }
    let request = Request { outputs, frames, threads: arguments.threads };

    let meter = Arc::new(Meter::default());
    let frames = request.frames.len();
    let show = progress::Reporter::new(arguments.progress, arguments.quiet, frames);
    let mut done = progress::watch(&meter, frames, show, || render(&sequence, &request, &meter))?;

    done.notes.extend(note);
    if arguments.draft {
        done.notes.insert(0, draft_note(&sequence));
    }
    if !arguments.quiet {
        let told = if json { summary::json(&done) } else { summary::text(&done) };
        if streams {
            terminal::complain(&told);
        } else {
            terminal::say(&told)?;
        }
    }
    Ok(())
}

impl Arguments {
    fn overrides(&self) -> Overrides {
        Overrides {
            size: self.size,
            rate: self.fps,
            bounces: self.bounces,
            antialias: self.antialias,
            samples: self.samples,
            integrator: self.integrator,
            seed: self.seed,
            tonemap: self.tonemap,
            exposure: self.exposure,
            transparent: self.transparent,
            caption: self.caption.clone(),
            max_size: self.max_size,
            encode_quality: self.quality,
            deep: self.bits,
            no_metadata: self.no_metadata,
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
        "a draft: {width}x{height}, antialias {}, samples {}, bounces {}; leave out --draft for the full quality",
        quality.antialias, quality.samples, quality.bounces
    )
}
