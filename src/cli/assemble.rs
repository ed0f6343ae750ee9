//! `kinora assemble`: finished frames in, animations and filmstrips out.

use super::failure::Failure;
use super::json::Object;
use super::overrides::{self, Overrides};
use super::progress::ProgressMode;
use super::render::frames_of;
use super::settings::Settings;
use super::{load, loading, terminal, values};
use crate::base::color::Rgb;
use crate::base::escape;
use crate::base::files::{in_the_way, why};
use crate::base::frame_set::{FrameSet, MOST_FRAMES};
use crate::encode::{Existing, Formats, FramePattern, Output, Plays, Report, Still, Template};
use crate::pipeline::assemble::{Chosen, Request, Wanted, assemble, check_outputs, choose, choose_of};
use crate::pipeline::render::{self, RenderError, Reuse};
use crate::sequence::Sequence;
use clap::Args;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Make GIFs, videos and filmstrips of frames that are rendered already.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP, mut_arg("caption", |argument| argument
    .long("frame-caption")
    .help("The caption in the frames: what `render` had as --caption")
    .long_help("The caption in the frames: what `render` had as --caption")))]
pub struct Arguments {
    /// The frames: a name with #### or %04d in the place of their numbers, such as out/f_####.png
    pattern: PathBuf,

    /// File to write; may be given several times
    ///
    /// .mp4, .gif, .apng, .webp, .y4m or - for an animation; .png, .jpg or .ppm for a filmstrip.
    #[arg(short, long, value_name = "FILE", value_parser = values::output(), required = true)]
    output: Vec<Output>,

    /// Only these frames: 0-47, 0..48, 7,9,20 or 1-40:2 [default: the whole sequence]
    ///
    /// Without --of, that is as many as the frames tell, or else from the first that is there to
    /// the last. Each of them has to be there.
    #[arg(long, value_name = "SET", allow_hyphen_values = true, verbatim_doc_comment)]
    frames: Option<FrameSet>,

    /// Compare every frame with what this sequence evaluates to, and write what `render` would
    ///
    /// Frames that are missing, damaged, or would be made otherwise now are refused. The formats
    /// and the rate are the sequence's. Settings that the frames were rendered with count: give
    /// the same, such as -s or --samples.
    #[arg(long, value_name = "SEQUENCE", verbatim_doc_comment)]
    of: Option<PathBuf>,

    /// Leave out the frames that are missing; those that are damaged or stale are refused still
    #[arg(long)]
    allow_gaps: bool,

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

    /// What stands below each frame of a filmstrip
    #[arg(long = "caption", value_name = "TEXT", default_value = "frame {frame} · {time} s", value_parser = values::caption)]
    below: Template,

    /// Frames in a row of a filmstrip
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=400))]
    columns: Option<u32>,

    /// The limit of time that the frames were rendered with
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

Nothing is written unless every frame is right, as far as that can be known. With --of, it is known
of PNGs of 8 bits with metadata: the files are those that `render` would write. Without --of,
frames are refused that are missing or damaged, whose pixels were exchanged, that show another
frame than their names say, or that tell of another sequence, version, rate, seed or number of
samples than most. -r is then the rate at which they are shown; with --of it is that of the render.";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    terminal::check_stream(&arguments.output)?;
    let pattern = arguments.pattern()?;
    // Those frames count too that are not asked for now.
    let own = |path: &Path| pattern.matches(path).then_some(pattern.name());
    check_outputs(&arguments.output, own).map_err(RenderError::from)?;
    let (chosen, formats, matte) = match &arguments.of {
        Some(file) => arguments.chosen_of(file, &pattern)?,
        None => (arguments.chosen(&pattern)?, Formats::default(), Request::default().matte),
    };
    let request = arguments.request(&chosen, formats, matte);
    let mut report = assemble(&request)?;
    report.notes.extend(chosen.notes);
    arguments.tell(&report, &request)
}

impl Arguments {
    fn pattern(&self) -> Result<FramePattern, Failure> {
        let pattern = FramePattern::parse(&self.pattern).ok().filter(FramePattern::has_place);
        pattern.ok_or_else(|| {
            Failure::Bad(format!(
                "`{}` has no place for frame numbers; write it as in out/frame_####.png",
                escape::path(&self.pattern)
            ))
        })
    }

    /// The frames of a sequence, and its settings of formats.
    fn chosen_of(&self, file: &Path, pattern: &FramePattern) -> Result<(Chosen, Formats, Rgb), Failure> {
        let options = &self.settings.options;
        let loading = loading::Reporter::new(options.progress, options.quiet);
        let sequence = load::sequence(file, options.allow_outside, loading)?;
        let mut sequence = overrides::applied(sequence, &self.settings.overrides()).map_err(Failure::Bad)?;
        let format = Output::parse(pattern.name());
        let Ok(stills @ Output::Stills(Still::Png, _)) = format.clone() else {
            return Err(Failure::Bad(format!(
                "--of takes PNGs, which say what they show, not {pattern}; leave it out"
            )));
        };
        if sequence.output.formats.png.deep {
            return Err(Failure::Bad(format!(
                "files are made of PNGs of 8 bits, and those of {} have 16; leave --of out to make them of these",
                escape::path(file)
            )));
        }
        let request = render::Request {
            frames: frames_of(self.frames.as_ref(), &sequence)?,
            outputs: vec![stills],
            confined: false,
            existing: Existing::Keep,
            threads: options.threads,
            reuse: Reuse::Off,
            time_limit: self.time_limit,
        };
        self.settle(&mut sequence, &request)?;
        // That a folder is not there at all is told in words of its own.
        pattern.numbers().map_err(|error| Failure::Bad(nowhere(pattern, &error)))?;
        let wanted = Wanted { pattern, numbers: Some(&request.frames), gaps: self.allow_gaps };
        let chosen = choose_of(&sequence, &request, wanted)?;
        Ok((chosen, sequence.output.formats, sequence.output.matte))
    }

    /// Gives the sequence the samples that the frames tell a limit of time has settled.
    fn settle(&self, sequence: &mut Sequence, request: &render::Request) -> Result<(), Failure> {
        if self.time_limit.is_none() {
            return Ok(());
        }
        let message = "no frame tells that it was rendered with this --time-limit for as many frames";
        sequence.quality =
            render::settled(sequence, request).ok_or_else(|| Failure::Bad(message.to_owned()))?;
        Ok(())
    }

    /// The frames that are there, by their numbers.
    fn chosen(&self, pattern: &FramePattern) -> Result<Chosen, Failure> {
        let Overrides { rate, max_size, encode_quality, .. } = self.settings.overrides();
        let files = Overrides { rate, max_size, encode_quality, ..Overrides::default() };
        if self.settings.overrides() != files || self.settings.options.allow_outside {
            return Err(Failure::Bad(
                "how frames were rendered counts where they are compared with a sequence: name it with --of"
                    .to_owned(),
            ));
        }
        let there = pattern.numbers().map_err(|error| Failure::Bad(nowhere(pattern, &error)))?;
        let Some(last) = there.last() else {
            return Err(Failure::Bad(format!("there are no frames {pattern}")));
        };
        // Of a set that goes on behind the last frame, those are named that are missing.
        let counted = |set: &FrameSet| set.frames(last.saturating_add(MOST_FRAMES as u32));
        let numbers = self.frames.as_ref().map(counted).transpose();
        let numbers = numbers.map_err(|error| Failure::Bad(format!("--frames: {error}")))?;
        let wanted = Wanted { pattern, numbers: numbers.as_deref(), gaps: self.allow_gaps };
        Ok(choose(wanted, &there, self.settings.options.threads)?)
    }

    fn request(&self, chosen: &Chosen, mut formats: Formats, matte: Rgb) -> Request {
        let wanted = self.settings.overrides();
        formats.gif.colors = self.colors.unwrap_or(formats.gif.colors);
        formats.gif.dither &= !self.no_dither;
        formats.gif.max_size = wanted.max_size.or(formats.gif.max_size);
        if self.plays.is_some() {
            formats.gif.plays = self.plays;
            (formats.apng, formats.webp) = (Plays(self.plays), Plays(self.plays));
        }
        if let Some(quality) = wanted.encode_quality {
            (formats.mp4.quality, formats.jpeg.quality) = (quality, quality);
        }
        Request {
            frames: chosen.frames.clone(),
            name: chosen.name.clone().unwrap_or_default(),
            outputs: self.output.clone(),
            rate: wanted.rate.or(chosen.rate).unwrap_or_default(),
            formats,
            matte: self.matte.unwrap_or(matte),
            text: self.below.clone(),
            columns: self.columns,
            threads: self.settings.options.threads,
        }
    }

    fn tell(&self, report: &Report, request: &Request) -> Result<(), Failure> {
        let options = &self.settings.options;
        if options.quiet {
            return Ok(());
        }
        let told = match options.progress {
            ProgressMode::Json => json(report, request),
            _ => text(report, request),
        };
        if self.output.iter().any(Output::is_stream) {
            terminal::complain(&told);
            return Ok(());
        }
        terminal::say(&told)
    }
}

fn text(report: &Report, request: &Request) -> String {
    let wrote = report.files.iter().map(|file| format!("wrote   {}", escape::path(file)));
    let facts = format!("frames  {} at {} per second", request.frames.len(), request.rate);
    let notes = report.notes.iter().map(|note| format!("note    {}", escape::line(note)));
    wrote.chain([facts]).chain(notes).collect::<Vec<_>>().join("\n")
}

fn json(report: &Report, request: &Request) -> String {
    Object::new()
        .text("event", "summary")
        .texts("files", report.files.iter().map(|file| file.to_string_lossy().into_owned()))
        .whole("frames", request.frames.len() as u64)
        .text("rate", &request.rate.to_string())
        .texts("notes", report.notes.iter().cloned())
        .finish()
}

/// Why the frames' folder cannot be looked into.
fn nowhere(pattern: &FramePattern, error: &io::Error) -> String {
    let path = pattern.path(0);
    let folder = path.parent().unwrap_or(Path::new(""));
    let reason = match (in_the_way(folder), error.kind()) {
        (Some(file), _) => format!("{} is a file; name a folder there", escape::path(file)),
        (None, ErrorKind::NotFound) => {
            format!(
                "there is no folder {}; name the one that the frames were rendered into",
                escape::path(folder)
            )
        }
        _ => why(error),
    };
    format!("cannot look for {pattern}: {reason}")
}
