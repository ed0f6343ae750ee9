//! `kinora filmstrip`: a sequence file in, one picture of several frames out.

use super::failure::Failure;
use super::options::Options;
use super::{load, loading, overrides, progress, render, summary, terminal, values};
use crate::base::frame_set::FrameSet;
use crate::base::stats::Meter;
use crate::cli::progress::ProgressMode;
use crate::encode::{Output, Still, Template, check_within, sheet_columns};
use crate::pipeline::filmstrip::{Request, filmstrip, spread};
use crate::sequence::Sequence;
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;

/// Pixels across a sheet, about, if its frames are not given a size.
const WIDTH: u32 = 1920;
/// More frames than these are no figure.
const MOST: u32 = 400;

/// Render several frames of a sequence into one picture, with their numbers and times.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron).
    file: PathBuf,

    /// The picture to write: .png, .jpg or .ppm [default: output/NAME_filmstrip.png]
    #[arg(short, long, value_name = "FILE", value_parser = values::output())]
    output: Option<Output>,

    /// How many frames, from the first to the last
    #[arg(short = 'n', long, value_name = "N", default_value = "9", value_parser = clap::value_parser!(u32).range(1..=MOST as i64))]
    count: u32,

    /// These frames instead, counted from 0: 0-47:8, 0,10,20
    #[arg(long, value_name = "SET", allow_hyphen_values = true, conflicts_with = "count")]
    frames: Option<FrameSet>,

    /// Frames in a row [default: as many as make a picture that fits a page]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST as i64))]
    columns: Option<u32>,

    /// What stands below each frame; {frame}, {frames}, {time} and {name} stand for their values
    #[arg(long, value_name = "TEXT", default_value = "frame {frame} · {time} s", value_parser = values::caption)]
    caption: Template,

    #[command(flatten)]
    options: Options,
}

const AFTER_HELP: &str = "\
Examples:
  kinora filmstrip turn.ron                          nine frames, about 1920 pixels wide
  kinora filmstrip turn.ron -n 4 --columns 4 -s 480x270 -o strip.png
  kinora filmstrip turn.ron --frames 0-40:10 --caption \"{time} s\"

-s is the size of each frame.";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = &arguments.options;
    let loading = loading::Reporter::new(options.progress, options.quiet);
    let sequence = load::sequence(&arguments.file, options.allow_outside, loading)?;
    let mut sequence = overrides::applied(sequence, &options.overrides()).map_err(Failure::Bad)?;
    let frames = match &arguments.frames {
        Some(set) => render::frames_of(Some(set), &sequence)?,
        None => spread(sequence.timeline.frames, arguments.count),
    };
    if frames.len() > MOST as usize {
        return Err(Failure::Bad(format!(
            "--frames names {} frames; a filmstrip has at most {MOST}",
            frames.len()
        )));
    }
    let count = frames.len() as u32;
    let columns = arguments.columns.unwrap_or_else(|| sheet_columns(count, sequence.output.size));
    if options.size.is_none() {
        sequence.output.size = fitting(sequence.output.size, columns.min(count));
    }
    let output = arguments.output.clone().map_or_else(|| named(&sequence, "filmstrip"), Ok)?;
    if arguments.output.is_none() {
        check_within(output.name()).map_err(|error| Failure::Bad(error.to_string()))?;
    }
    if !matches!(output, Output::Stills(Still::Png | Still::Jpeg | Still::Ppm, _)) {
        return Err(Failure::Bad(format!(
            "a filmstrip is one picture; write .png, .jpg or .ppm, not {output}"
        )));
    }
    let threads = options.threads;
    let request = Request { frames, output, columns, text: arguments.caption.clone(), threads };

    let meter = Arc::new(Meter::default());
    let show = progress::Reporter::new(options.progress, options.quiet, request.frames.len());
    let done =
        progress::watch(&meter, request.frames.len(), show, || filmstrip(&sequence, &request, &meter))?;
    if options.quiet {
        return Ok(());
    }
    let json = options.progress == ProgressMode::Json;
    terminal::say(&if json { summary::json(&done) } else { summary::text(&done) })
}

/// The size of frames of which so many are about [`WIDTH`] wide, and never larger than they are.
fn fitting((width, height): (u32, u32), columns: u32) -> (u32, u32) {
    let wanted = (WIDTH / columns.max(1)).clamp(1, width);
    let scaled = u64::from(height) * u64::from(wanted) / u64::from(width);
    (wanted, (scaled as u32).max(1))
}

/// The usual file of something that is made of a sequence.
pub fn named(sequence: &Sequence, what: &str) -> Result<Output, Failure> {
    let name = sequence.name.replace(['#', '%'], "_");
    Output::parse(format!("output/{name}_{what}.png")).map_err(|error| Failure::Bad(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_made_small_enough_for_their_row() {
        assert_eq!(fitting((800, 800), 3), (640, 640));
        assert_eq!(fitting((400, 250), 3), (400, 250));
        assert_eq!(fitting((4000, 1), 4), (480, 1));
    }
}
