//! `kinora assemble`: finished frames in, animations and filmstrips out.

use super::failure::Failure;
use super::{load, loading, terminal, values};
use crate::assemble::{Request, assemble, told_by};
use crate::color::Rgb;
use crate::encode::{FramePattern, Output, Plays, Template};
use crate::files::{in_the_way, why};
use crate::frame_set::FrameSet;
use crate::sequence::Sequence;
use crate::time::Rate;
use clap::Args;
use std::io::{self, ErrorKind};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Make GIFs, videos and filmstrips of frames that are rendered already.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The frames: a name with #### or %04d in the place of their numbers, such as out/f_####.png
    pattern: String,

    /// File to write; may be given several times
    ///
    /// .mp4, .gif, .apng, .webp, .y4m or - for an animation; .png, .jpg or .ppm for a filmstrip.
    #[arg(short, long, value_name = "FILE", value_parser = Output::parse, required = true)]
    output: Vec<Output>,

    /// Only these frames: 0-47, 0..48, 7,9,20 or 1-40:2 [default: all that are there]
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    /// Settings of GIFs, videos and the rate as this sequence has them, so that the files are
    /// those that `render` would write
    #[arg(long, value_name = "SEQUENCE", verbatim_doc_comment)]
    of: Option<PathBuf>,

    /// What the sequence reads may lie outside of its root, as `render` has it
    #[arg(long, requires = "of")]
    allow_outside: bool,

    /// Frames per second: 24, 29.97 or 30000/1001 [default: as the frames tell, or else 24]
    #[arg(short = 'r', long, value_name = "RATE", value_parser = values::rate, allow_hyphen_values = true)]
    fps: Option<Rate>,

    /// How large a GIF may become, such as 5MB
    #[arg(long, value_name = "SIZE", value_parser = values::file_size, allow_hyphen_values = true)]
    max_size: Option<u64>,

    /// Colours of a GIF's palette, 2 to 256 [default: 256]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=256))]
    colors: Option<u16>,

    /// How often a GIF, APNG or WebP plays, 1 to 65535 [default: for ever]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    plays: Option<u16>,

    /// What formats without alpha show behind transparent frames [default: white]
    ///
    /// Three or six digits, such as "#ff8800" or "#f80".
    #[arg(long, value_name = "COLOR", value_parser = values::matte)]
    matte: Option<Rgb>,

    /// GIFs without dithering
    #[arg(long)]
    no_dither: bool,

    /// Quality of MP4 video and JPEG filmstrips, 1 to 100
    #[arg(long, value_name = "N", value_parser = values::encode_quality, allow_hyphen_values = true)]
    quality: Option<u8>,

    /// What stands below each frame of a filmstrip
    #[arg(long, value_name = "TEXT", default_value = "frame {frame} · {time} s", value_parser = values::caption)]
    caption: Template,

    /// Frames in a row of a filmstrip
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=400))]
    columns: Option<u32>,

    /// Threads [default: one per processor]
    #[arg(short, long, value_name = "N", value_parser = values::threads, allow_hyphen_values = true)]
    threads: Option<NonZeroUsize>,

    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

const AFTER_HELP: &str = "\
Examples:
  kinora assemble out/turn/frame_####.png -o turn.mp4 -o turn.gif
  kinora assemble out/turn/frame_####.png --frames 0-70:10 -o strip.png";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let frames = arguments.found()?;
    let sequence = arguments.sequence()?;
    let rate = arguments.fps.or_else(|| arguments.own_rate(&frames, sequence.as_ref()));
    let mut request = Request {
        frames,
        outputs: arguments.output.clone(),
        rate: rate.unwrap_or_default(),
        text: arguments.caption.clone(),
        columns: arguments.columns,
        threads: arguments.threads,
        ..Request::default()
    };
    if let Some(sequence) = sequence {
        (request.formats, request.matte) = (sequence.output.formats, sequence.output.matte);
    }
    let formats = &mut request.formats;
    formats.gif.colors = arguments.colors.unwrap_or(formats.gif.colors);
    formats.gif.dither &= !arguments.no_dither;
    formats.gif.max_size = arguments.max_size.or(formats.gif.max_size);
    if arguments.plays.is_some() {
        formats.gif.plays = arguments.plays;
        (formats.apng, formats.webp) = (Plays(arguments.plays), Plays(arguments.plays));
    }
    request.matte = arguments.matte.unwrap_or(request.matte);
    if let Some(quality) = arguments.quality {
        (formats.mp4.quality, formats.jpeg.quality) = (quality, quality);
    }
    let report = assemble(&request)?;
    if arguments.quiet {
        return Ok(());
    }
    let wrote = report.files.iter().map(|file| format!("wrote   {}", file.display()));
    let facts = format!("frames  {} at {} per second", request.frames.len(), request.rate);
    let notes = report.notes.iter().map(|note| format!("note    {note}"));
    let told: Vec<String> = wrote.chain([facts]).chain(notes).collect();
    if arguments.output.iter().any(Output::is_stream) {
        terminal::complain(&told.join("\n"));
        return Ok(());
    }
    terminal::say(&told.join("\n"))
}

impl Arguments {
    /// The sequence whose settings are wanted.
    fn sequence(&self) -> Result<Option<Sequence>, Failure> {
        let load = |path: &PathBuf| load::sequence(path, self.allow_outside, loading::Reporter::Silent);
        self.of.as_ref().map(load).transpose()
    }

    /// The rate that the sequence has, or that the frames tell.
    fn own_rate(&self, frames: &[(u32, PathBuf)], sequence: Option<&Sequence>) -> Option<Rate> {
        let told = frames.iter().find(|(number, _)| *number > 0);
        let told = || told.and_then(|(number, path)| told_by(path, *number).1);
        sequence.map(|sequence| sequence.timeline.rate).or_else(told)
    }

    /// The frames that are there, by their numbers.
    fn found(&self) -> Result<Vec<(u32, PathBuf)>, Failure> {
        let bad = |what: String| Failure::Bad(what);
        let pattern =
            FramePattern::parse(&self.pattern).ok().filter(FramePattern::has_place).ok_or_else(|| {
                bad(format!(
                    "`{}` has no place for frame numbers; write it as in out/frame_####.png",
                    self.pattern
                ))
            })?;
        let there = pattern.numbers().map_err(|error| bad(nowhere(&pattern, &error)))?;
        let Some(last) = there.last() else {
            return Err(bad(format!("there are no frames {pattern}")));
        };
        let wanted = match &self.frames {
            None => there,
            Some(set) => {
                let set = set.frames(last + 1).map_err(|error| bad(format!("--frames: {error}")))?;
                if let Some(missing) = set.iter().find(|frame| there.binary_search(frame).is_err()) {
                    return Err(bad(format!("there is no frame {}", pattern.path(*missing).display())));
                }
                set
            }
        };
        Ok(wanted.into_iter().map(|frame| (frame, pattern.path(frame))).collect())
    }
}

/// Why the frames' folder cannot be looked into.
fn nowhere(pattern: &FramePattern, error: &io::Error) -> String {
    let path = pattern.path(0);
    let folder = path.parent().unwrap_or(Path::new(""));
    let reason = match (in_the_way(folder), error.kind()) {
        (Some(file), _) => format!("{} is a file; name a folder there", file.display()),
        (None, ErrorKind::NotFound) => {
            format!(
                "there is no folder {}; name the one that the frames were rendered into",
                folder.display()
            )
        }
        _ => why(error),
    };
    format!("cannot look for {pattern}: {reason}")
}
