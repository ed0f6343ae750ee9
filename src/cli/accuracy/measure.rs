//! `kinora accuracy FILE`: measures a sequence and writes a folder with a report.

use super::data;
use super::progress::MeasureReporter;
use crate::accuracy::report::{Origin, charts, page};
use crate::accuracy::{Measured, MeasurementRequest, measure};
use crate::base::escape;
use crate::base::files::blocking_file;
use crate::base::frame_set::FrameSet;
use crate::base::units;
use crate::cli::failure::Failure;
use crate::cli::frame_selection::selected_frames;
use crate::cli::loading::LoadingReporter;
use crate::cli::progress::ProgressMode;
use crate::cli::shell::quote;
use crate::cli::{arguments, load, terminal, values};
use crate::encode::{EncodeError, png_bytes, write_file};
use clap::Args;
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options for measuring a sequence.
#[derive(Args, Debug, PartialEq)]
pub struct MeasureOptions {
    /// The sequence file (.ron or .json)
    #[arg(required_unless_present = "hard_cases")]
    file: Option<PathBuf>,

    /// Folder for the report [default: output/NAME_accuracy]
    ///
    /// It gets report.html, its plots, data.csv and data.json.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Frames to measure, written as for `render` [default: the middle one]
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    /// Approximate time of the measurement, such as 90s, 10min or 2h [default: 5min]
    ///
    /// Pictures have the largest size that this time allows.
    #[arg(long, value_name = "TIME", value_parser = values::duration, conflicts_with = "quick")]
    time: Option<Duration>,

    /// Width and height of the measured pictures [default: as the time allows]
    #[arg(short, long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    size: Option<(u32, u32)>,

    /// Maximum samples per pixel that are measured [default: four times those of the file]
    #[arg(long, value_name = "N", value_parser = values::samples, allow_hyphen_values = true)]
    max_samples: Option<u32>,

    /// Number of threads [default: one per processor]
    #[arg(short, long, value_name = "N", value_parser = values::threads, allow_hyphen_values = true)]
    threads: Option<NonZeroUsize>,

    /// Allow images and meshes outside of the sequence's root folder, as in `render`
    #[arg(long)]
    allow_outside: bool,

    /// Print errors only
    #[arg(short, long)]
    quiet: bool,

    /// How to report progress
    #[arg(long, value_enum, default_value_t, value_name = "MODE")]
    progress: ProgressMode,
}

/// The time with `--quick`. With loading and writing, the command takes less than a minute.
const QUICK_TIME: Duration = Duration::from_secs(44);
const DEFAULT_TIME: Duration = Duration::from_secs(5 * 60);

pub fn run(options: &MeasureOptions, quick: bool) -> Result<(), Failure> {
    let Some(file) = &options.file else {
        return Err(Failure::Bad("give the sequence file to measure".to_owned()));
    };
    let sequence =
        load::sequence(file, options.allow_outside, LoadingReporter::new(options.progress, options.quiet))?;
    let frames = match &options.frames {
        Some(_) => selected_frames(options.frames.as_ref(), &sequence)?,
        None => vec![sequence.timeline.frames / 2],
    };
    let folder = options.output.clone();
    let folder = folder.unwrap_or_else(|| Path::new("output").join(format!("{}_accuracy", sequence.name)));
    // Check before the work that the report can be written.
    if let Some(file) = blocking_file(&folder) {
        let (folder, file) = (escape::path(&folder), escape::path(file));
        return Err(Failure::Bad(format!(
            "cannot write into the folder {folder}: {file} is a file; name another folder with -o"
        )));
    }
    let new = !folder.exists();
    std::fs::create_dir_all(&folder).map_err(|error| {
        Failure::Bad(format!("cannot create the folder {}: {error}", escape::path(&folder)))
    })?;
    let request = MeasurementRequest {
        frames,
        time: options.time.unwrap_or(if quick { QUICK_TIME } else { DEFAULT_TIME }),
        quick,
        size: options.size,
        most_samples: options.max_samples,
        threads: options.threads,
    };
    let mut reporter = MeasureReporter::new(options.progress, options.quiet);
    let measured = measure(&sequence, &request, &mut |done| reporter.update(done)).inspect_err(|_| {
        // A failed run leaves no folder behind. A folder with files of others stays, because it is not empty.
        let _ = new.then(|| std::fs::remove_dir(&folder));
    })?;
    reporter.finish();
    let origin = origin(file, arguments().into_iter());
    let report = write(&folder, &measured, &origin)?;
    if options.quiet {
        return Ok(());
    }
    if options.progress == ProgressMode::Json {
        return terminal::print_line(&data::summary(&measured, &report));
    }
    terminal::print_line(&text(&measured, &report))
}

/// The origin of the report. The command and the file are quoted for a shell.
fn origin(file: &Path, arguments: impl Iterator<Item = OsString>) -> Origin {
    let words: Vec<String> = arguments.map(|word| quote(&word)).collect();
    Origin { command: words.join(" "), machine: machine(), file: quote(file.as_os_str()) }
}

/// The findings in lines, and the path of the report.
fn text(measured: &Measured, report: &Path) -> String {
    let mut lines = measured.lines();
    lines.push(format!("Full report, with commands to paste: {}", escape::path(report)));
    lines.join("\n")
}

/// Writes the report. Returns the path of its page.
fn write(folder: &Path, measured: &Measured, origin: &Origin) -> Result<PathBuf, Failure> {
    let broken =
        |error: &dyn std::fmt::Display| Failure::Incomplete(format!("cannot make the report: {error}"));
    let file = |name: &str, bytes: &[u8]| -> Result<PathBuf, EncodeError> {
        let path = folder.join(name);
        write_file(&path, bytes)?;
        Ok(path)
    };
    let unwritten = |error: EncodeError| Failure::Incomplete(error.to_string());
    for chart in charts(measured) {
        let svg = chart.plot.svg().map_err(|error| broken(&error))?;
        let image = chart.plot.image().map_err(|error| broken(&error))?;
        let png = png_bytes(&image).map_err(|error| broken(&error))?;
        file(&format!("{}.svg", chart.name), svg.as_bytes()).map_err(unwritten)?;
        file(&format!("{}.png", chart.name), &png).map_err(unwritten)?;
    }
    file("data.csv", data::csv(measured).as_bytes()).map_err(unwritten)?;
    file("data.json", data::json(measured, origin).as_bytes()).map_err(unwritten)?;
    let page = page(measured, origin).map_err(|error| broken(&error))?;
    file("report.html", page.as_bytes()).map_err(unwritten)
}

/// The processor, the number of processors and the operating system.
fn machine() -> String {
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpuinfo.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned());
    let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    format!("{model}, {}, {}", units::counted(processors as u64, "processor"), std::env::consts::OS)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    #[test]
    fn commands_of_reports_are_quoted_for_shells() {
        let words = ["kinora", "accuracy", "my file.ron", "-s", "8x8"].map(OsString::from);
        let Origin { command, file, .. } = origin(Path::new("my file.ron"), words.into_iter());
        assert_eq!((&*command, &*file), ("kinora accuracy 'my file.ron' -s 8x8", "'my file.ron'"));
        let name = OsStr::from_bytes(b"a\xff.ron");
        let Origin { command, file, .. } = origin(Path::new(name), [name.to_owned()].into_iter());
        assert_eq!((&*command, &*file), (r"$'a\xff.ron'", r"$'a\xff.ron'"));
    }
}
