//! `kinora filmstrip`: renders several frames into one picture.

use super::failure::Failure;
use super::frame_selection::selected_frames;
use super::loading::LoadingReporter;
use super::observe::{Observation, ObserveOptions, observed};
use super::options::RenderOptions;
use super::progress::{self, ProgressMode, ProgressReporter};
use super::{load, overrides, summary, terminal, values};
use crate::base::frame_set::FrameSet;
use crate::base::stats::ProgressMeter;
use crate::encode::{Output, StillFormat, Template, check_within, sheet_columns};
use crate::pipeline::filmstrip::{FilmstripRequest, filmstrip, spread};
use crate::sequence::Sequence;
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;

/// The approximate width of the picture in pixels, unless the user sets the size of the frames.
const DEFAULT_WIDTH: u32 = 1920;
/// The largest number of frames.
const MAX_FRAMES: u32 = 400;

/// Render several frames of a sequence into one picture, with captions.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The sequence file (.ron or .json)
    file: PathBuf,

    /// The picture to write: .png, .jpg or .ppm [default: output/NAME_filmstrip.png]
    #[arg(short, long, value_name = "FILE", value_parser = values::output())]
    output: Option<Output>,

    /// Number of frames, spread evenly over the sequence
    #[arg(short = 'n', long, value_name = "N", default_value = "9", value_parser = values::between(1, MAX_FRAMES))]
    count: u32,

    /// These frames instead, counted from 0: 0-47:8 or 0,10,20
    #[arg(long, value_name = "SET", allow_hyphen_values = true, conflicts_with = "count")]
    frames: Option<FrameSet>,

    /// Frames in a row [default: as many as fit a page]
    #[arg(long, value_name = "N", value_parser = values::between(1, MAX_FRAMES))]
    columns: Option<u32>,

    /// Text below each frame; {frame}, {frames}, {time} and {name} are replaced by their values
    #[arg(long, value_name = "TEXT", default_value = "frame {frame} · {time} s", value_parser = values::caption)]
    caption: Template,

    #[command(flatten)]
    options: RenderOptions,

    #[command(flatten)]
    observe: ObserveOptions,
}

const AFTER_HELP: &str = "\
Examples:
  kinora filmstrip turn.ron                          nine frames, about 1920 pixels wide
  kinora filmstrip turn.ron -n 4 --columns 4 -s 480x270 -o strip.png
  kinora filmstrip turn.ron --frames 0-40:10 --caption \"{time} s\"

-s is the size of each frame.";

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    observed(&arguments.observe, |observation| rendered(arguments, observation))
}

fn rendered(arguments: &Arguments, observation: &Observation) -> Result<(), Failure> {
    let options = &arguments.options;
    let loading = LoadingReporter::new(options.progress, options.quiet);
    let read = || load::sequence(&arguments.file, options.allow_outside, loading);
    let sequence = tracing::info_span!("read").in_scope(read)?;
    let mut sequence = overrides::apply(sequence, &options.overrides()).map_err(Failure::Bad)?;
    sequence.quality.denoise = sequence.quality.denoise.of_stills();
    let frames = match &arguments.frames {
        Some(set) => selected_frames(Some(set), &sequence)?,
        None => spread(sequence.timeline.frames, arguments.count),
    };
    if frames.len() > MAX_FRAMES as usize {
        return Err(Failure::Bad(format!(
            "--frames names {} frames; a filmstrip has at most {MAX_FRAMES}",
            frames.len()
        )));
    }
    let count = frames.len() as u32;
    let columns = arguments.columns.unwrap_or_else(|| sheet_columns(count, sequence.output.size));
    if options.size.is_none() {
        sequence.output.size = fitting(sequence.output.size, columns.min(count));
    }
    let output = arguments.output.clone().map_or_else(|| default_output(&sequence, "filmstrip"), Ok)?;
    if arguments.output.is_none() {
        check_within(output.name()).map_err(|error| Failure::Bad(error.to_string()))?;
    }
    if !matches!(output, Output::Stills(StillFormat::Png | StillFormat::Jpeg | StillFormat::Ppm, _)) {
        return Err(Failure::Bad(format!(
            "a filmstrip is one picture; write .png, .jpg or .ppm, not {output}"
        )));
    }
    observation.open(&arguments.file, std::slice::from_ref(&output), &frames)?;
    let threads = options.threads;
    let request = FilmstripRequest { frames, output, columns, text: arguments.caption.clone(), threads };

    let meter = Arc::new(ProgressMeter::default());
    let count = request.frames.len();
    let reporter = ProgressReporter::new(options.progress, options.quiet, count);
    let done = progress::watch(&meter, count, reporter, || filmstrip(&sequence, &request, &meter))?;
    if options.quiet {
        return Ok(());
    }
    let json = options.progress == ProgressMode::Json;
    terminal::print_line(&if json { summary::json(&done) } else { summary::text(&done) })
}

/// The size of frames that fill [`DEFAULT_WIDTH`] with this many columns. Never larger than their own size.
fn fitting((width, height): (u32, u32), columns: u32) -> (u32, u32) {
    let wanted = (DEFAULT_WIDTH / columns.max(1)).clamp(1, width);
    let scaled = u64::from(height) * u64::from(wanted) / u64::from(width);
    (wanted, (scaled as u32).max(1))
}

/// The default file name of a picture of a sequence: `output/NAME_KIND.png`.
pub fn default_output(sequence: &Sequence, kind: &str) -> Result<Output, Failure> {
    let name = sequence.name.replace(['#', '%'], "_");
    Output::parse(format!("output/{name}_{kind}.png")).map_err(|error| Failure::Bad(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_fit_their_row() {
        assert_eq!(fitting((800, 800), 3), (640, 640));
        assert_eq!(fitting((400, 250), 3), (400, 250));
        assert_eq!(fitting((4000, 1), 4), (480, 1));
    }
}
