//! `kinora assemble`: makes animations and filmstrips from finished frames.

use super::failure::Failure;
use super::frame_selection::selected_frames;
use super::json::line;
use super::loading::LoadingReporter;
use super::overrides::{self, Overrides};
use super::progress::ProgressMode;
use super::settings::Settings;
use super::summary::file_name;
use super::{load, terminal, values};
use crate::base::color::Rgb;
use crate::base::escape;
use crate::base::files::{blocking_file, describe};
use crate::base::frame_set::{FrameSet, MAX_FRAMES};
use crate::encode::{Existing, Formats, FramePattern, LoopCount, Output, Report, StillFormat, Template};
use crate::pipeline::assemble::{
    AssembleRequest, FrameSelection, SelectedFrames, assemble, check_outputs, select_frames, select_frames_of,
};
use crate::pipeline::render::{self, RenderError, Reuse};
use crate::sequence::Sequence;
use clap::Args;
use serde_json::json;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The largest number of frames in a row of a filmstrip.
const MAX_COLUMNS: u32 = 400;

/// The text below the frames of a filmstrip, unless there is another one.
const STRIP_CAPTION: &str = "frame {frame} · {time} s";

/// Make GIFs, videos and filmstrips from rendered frames.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP, mut_arg("caption", |argument| argument
    .long("frame-caption")
    .help("The value of --caption in the command that rendered the frames")
    .long_help("The value of --caption in the command that rendered the frames")),
    mut_arg("film_cache", |argument| argument.hide(true)), mut_arg("no_reuse", |argument| argument.hide(true)))]
pub struct Arguments {
    /// File names of the frames, with #### or %04d in place of the number: out/f_####.png
    pattern: PathBuf,

    /// File to write; repeat for several files
    ///
    /// .mp4, .gif, .apng, .webp, .y4m or - for an animation; .png, .jpg or .ppm for a filmstrip.
    #[arg(short, long, value_name = "FILE", value_parser = values::output(), required = true)]
    output: Vec<Output>,

    /// Only these frames: 0-47, 0..48, 7,9,20 or 1-40:2 [default: the whole sequence]
    ///
    /// Without --of, the whole sequence is the number of frames in the frames' metadata, or else
    /// the range from the first existing frame to the last. Every frame must exist.
    #[arg(long, value_name = "SET", allow_hyphen_values = true, verbatim_doc_comment)]
    frames: Option<FrameSet>,

    /// Verify every frame against this sequence, and write the same files as `render`
    ///
    /// Refuses frames that are missing, damaged or stale. Takes the formats and the rate from the
    /// sequence. Give the options that rendered the frames, such as -s or --samples.
    #[arg(long, value_name = "SEQUENCE", verbatim_doc_comment)]
    of: Option<PathBuf>,

    /// Skip missing frames; damaged and stale ones are still refused
    #[arg(long)]
    allow_gaps: bool,

    /// Colours in the palette of a GIF, 2 to 256 [default: 256]
    #[arg(long, value_name = "N", value_parser = values::between::<u16>(2, 256))]
    colors: Option<u16>,

    /// How often a GIF, APNG or WebP plays, 1 to 65535 [default: forever]
    #[arg(long, value_name = "N", value_parser = values::between::<u16>(1, u16::MAX))]
    loop_count: Option<u16>,

    /// Colour behind transparent frames in formats without alpha [default: white]
    ///
    /// Three or six hexadecimal digits, such as "#ff8800" or "#f80".
    #[arg(long, value_name = "COLOR", value_parser = values::background_color)]
    background_color: Option<Rgb>,

    /// Do not dither GIFs
    #[arg(long)]
    no_dither: bool,

    /// Text below each frame of a filmstrip
    #[arg(long = "caption", value_name = "TEXT", default_value = STRIP_CAPTION, value_parser = values::caption)]
    strip_caption: Template,

    /// Frames in a row of a filmstrip
    #[arg(long, value_name = "N", value_parser = values::between::<u32>(1, MAX_COLUMNS))]
    columns: Option<u32>,

    /// The --time-limit of the render command
    #[arg(long, value_name = "TIME", value_parser = values::duration, requires = "of")]
    time_limit: Option<Duration>,

    #[command(flatten)]
    settings: Settings,
}

const AFTER_HELP: &str = "\
Examples:
  kinora assemble out/turn/frame_####.png --of turn.ron -o turn.mp4 -o turn.gif
  kinora assemble out/turn/frame_####.png --frames 0-70:10 -o strip.png
  kinora assemble shots/####.jpg -r 12 -o shots.mp4

Nothing is written unless all frames pass. With --of, frames must be PNGs with 8 bits; if they have
metadata, the files have the bytes that `render` would write. Without --of, a frame is refused if it
is missing or damaged, if its pixels were replaced, if its metadata names another frame than its
file name, or if its sequence, version, rate, seed or number of samples differs from most frames.
-r is the rate of the animation; with --of, it is the rate that rendered the frames.";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    terminal::check_stream(&arguments.output)?;
    let is_default = Template::parse(STRIP_CAPTION).is_ok_and(|usual| usual == arguments.strip_caption);
    if !is_default && !arguments.output.iter().any(|output| matches!(output, Output::Stills(..))) {
        return Err(Failure::Bad(
            "--caption is the text below the frames of a filmstrip, and no output is one; the --caption with which \
             the frames were rendered is --frame-caption here"
                .to_owned(),
        ));
    }
    let pattern = arguments.pattern()?;
    // No output may replace a frame, not even one outside of --frames.
    let own = |path: &Path| pattern.matches(path).then_some(pattern.name());
    check_outputs(&arguments.output, own).map_err(RenderError::from)?;
    let (chosen, formats, background_color) = match &arguments.of {
        Some(file) => arguments.chosen_of(file, &pattern)?,
        None => {
            (arguments.chosen(&pattern)?, Formats::default(), AssembleRequest::default().background_color)
        }
    };
    let request = arguments.request(&chosen, formats, background_color);
    let mut report = assemble(&request)?;
    report.notes.extend(chosen.notes);
    arguments.print(&report, &request)
}

impl Arguments {
    fn pattern(&self) -> Result<FramePattern, Failure> {
        let pattern = FramePattern::parse(&self.pattern).ok().filter(FramePattern::has_placeholder);
        pattern.ok_or_else(|| {
            Failure::Bad(format!(
                "`{}` has no place for frame numbers; write for example out/frame_####.png",
                escape::path(&self.pattern)
            ))
        })
    }

    /// The verified frames of a sequence, with its format settings and its background colour.
    fn chosen_of(
        &self,
        file: &Path,
        pattern: &FramePattern,
    ) -> Result<(SelectedFrames, Formats, Rgb), Failure> {
        let options = &self.settings.options;
        let reporter = LoadingReporter::new(options.progress, options.quiet);
        let sequence = load::sequence(file, options.allow_outside, reporter)?;
        let mut sequence = overrides::apply(sequence, &self.settings.overrides()).map_err(Failure::Bad)?;
        let format = Output::parse(pattern.name());
        let Ok(stills @ Output::Stills(StillFormat::Png, _)) = format.clone() else {
            return Err(Failure::Bad(format!(
                "--of takes PNGs, because their metadata identifies them, not {pattern}; leave out --of"
            )));
        };
        if sequence.output.formats.png.deep {
            return Err(Failure::Bad(format!(
                "--of takes PNGs of 8 bits, but those of {} have 16; leave out --of to use them",
                escape::path(file)
            )));
        }
        let request = render::Request {
            frames: selected_frames(self.frames.as_ref(), &sequence)?,
            outputs: vec![stills],
            confined: false,
            existing: Existing::Keep,
            threads: options.threads,
            reuse: Reuse::Off,
            time_limit: self.time_limit,
        };
        self.settle(&mut sequence, &request)?;
        // A missing folder has an error of its own.
        pattern.numbers().map_err(|error| Failure::Bad(unreadable_folder(pattern, &error)))?;
        let wanted = FrameSelection { pattern, numbers: Some(&request.frames), gaps: self.allow_gaps };
        let chosen = select_frames_of(&sequence, &request, wanted)?;
        Ok((chosen, sequence.output.formats, sequence.output.background_color))
    }

    /// Takes the number of samples that `--time-limit` chose from the frames' metadata.
    fn settle(&self, sequence: &mut Sequence, request: &render::Request) -> Result<(), Failure> {
        if self.time_limit.is_none() {
            return Ok(());
        }
        let message = "no frame was rendered with this --time-limit for the same number of frames";
        sequence.quality =
            render::existing_quality(sequence, request).ok_or_else(|| Failure::Bad(message.to_owned()))?;
        Ok(())
    }

    /// The existing frames, by their numbers.
    fn chosen(&self, pattern: &FramePattern) -> Result<SelectedFrames, Failure> {
        let Overrides { rate, max_size, encode_quality, .. } = self.settings.overrides();
        let files = Overrides { rate, max_size, encode_quality, ..Overrides::default() };
        if self.settings.overrides() != files || self.settings.options.allow_outside {
            return Err(Failure::Bad(
                "options of the render serve to verify frames against a sequence; name it with --of"
                    .to_owned(),
            ));
        }
        let there = pattern.numbers().map_err(|error| Failure::Bad(unreadable_folder(pattern, &error)))?;
        let Some(last) = there.last() else {
            return Err(Failure::Bad(format!("there are no frames {pattern}")));
        };
        // If a set goes beyond the last frame, the missing frames are named.
        let counted = |set: &FrameSet| set.frames(last.saturating_add(MAX_FRAMES as u32));
        let numbers = self.frames.as_ref().map(counted).transpose();
        let numbers = numbers.map_err(|error| Failure::Bad(format!("--frames: {error}")))?;
        let wanted = FrameSelection { pattern, numbers: numbers.as_deref(), gaps: self.allow_gaps };
        Ok(select_frames(wanted, &there, self.settings.options.threads)?)
    }

    fn request(
        &self,
        chosen: &SelectedFrames,
        mut formats: Formats,
        background_color: Rgb,
    ) -> AssembleRequest {
        let wanted = self.settings.overrides();
        formats.gif.colors = self.colors.unwrap_or(formats.gif.colors);
        formats.gif.dither &= !self.no_dither;
        formats.gif.max_size = wanted.max_size.or(formats.gif.max_size);
        if self.loop_count.is_some() {
            formats.gif.loop_count = self.loop_count;
            (formats.apng, formats.webp) = (LoopCount(self.loop_count), LoopCount(self.loop_count));
        }
        if let Some(quality) = wanted.encode_quality {
            (formats.mp4.quality, formats.jpeg.quality) = (quality, quality);
        }
        AssembleRequest {
            frames: chosen.frames.clone(),
            name: chosen.name.clone().unwrap_or_default(),
            outputs: self.output.clone(),
            rate: wanted.rate.or(chosen.rate).unwrap_or_default(),
            formats,
            drawings: chosen.drawings.clone(),
            background_color: self.background_color.unwrap_or(background_color),
            text: self.strip_caption.clone(),
            columns: self.columns,
            threads: self.settings.options.threads,
        }
    }

    fn print(&self, report: &Report, request: &AssembleRequest) -> Result<(), Failure> {
        let options = &self.settings.options;
        if options.quiet {
            return Ok(());
        }
        let summary = match options.progress {
            ProgressMode::Json => json(report, request),
            _ => text(report, request),
        };
        if self.output.iter().any(Output::is_stream) {
            terminal::eprint_line(&summary);
            return Ok(());
        }
        terminal::print_line(&summary)
    }
}

fn text(report: &Report, request: &AssembleRequest) -> String {
    let wrote = report.files.iter().map(|file| format!("wrote   {}", file_name(file)));
    let facts = format!("frames  {} at {} per second", request.frames.len(), request.rate);
    let notes = report.notes.iter().map(|note| format!("note    {}", escape::line(note)));
    wrote.chain([facts]).chain(notes).collect::<Vec<_>>().join("\n")
}

fn json(report: &Report, request: &AssembleRequest) -> String {
    line(json!({
        "event": "summary",
        "files": report.files.iter().map(|file| file.to_string_lossy()).collect::<Vec<_>>(),
        "frames": request.frames.len(),
        "rate": request.rate.to_string(),
        "notes": report.notes,
    }))
}

/// The error for a folder of frames that cannot be read.
fn unreadable_folder(pattern: &FramePattern, error: &io::Error) -> String {
    let path = pattern.path(0);
    let folder = path.parent().unwrap_or(Path::new(""));
    let reason = match (blocking_file(folder), error.kind()) {
        (Some(file), _) => format!("{} is a file; name a folder there", escape::path(file)),
        (None, ErrorKind::NotFound) => {
            format!("there is no folder {}; name the folder of the rendered frames", escape::path(folder))
        }
        _ => describe(error),
    };
    format!("cannot look for {pattern}: {reason}")
}
