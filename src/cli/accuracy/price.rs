//! `kinora accuracy FILE`: a sequence file in, a folder with a report out.

use super::data;
use crate::accuracy::report::{Origin, charts, page};
use crate::accuracy::{Measured, Request, measure};
use crate::base::escape;
use crate::base::files::in_the_way;
use crate::base::frame_set::FrameSet;
use crate::base::units;
use crate::cli::failure::Failure;
use crate::cli::progress::ProgressMode;
use crate::cli::share;
use crate::cli::shell::quoted;
use crate::cli::{load, loading, render, terminal, values};
use crate::encode::{EncodeError, png_bytes, write_file};
use clap::Args;
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What to measure of a sequence, and where the report goes.
#[derive(Args, Debug, PartialEq)]
pub struct Options {
    /// The sequence file (.ron)
    #[arg(required_unless_present = "hard_cases")]
    file: Option<PathBuf>,

    /// Folder for the report [default: output/NAME_accuracy]
    ///
    /// It holds report.html, its plots, data.csv and data.json.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Frames to measure, as of `render` [default: that in the middle]
    #[arg(long, value_name = "SET", allow_hyphen_values = true)]
    frames: Option<FrameSet>,

    /// About how long it may take, such as 90s, 10min or 2h [default: 5min]
    ///
    /// Pictures are measured in the largest size that it allows.
    #[arg(long, value_name = "TIME", value_parser = values::duration, conflicts_with = "quick")]
    time: Option<Duration>,

    /// Width and height to measure in [default: what the time allows]
    #[arg(short, long, value_name = "WxH", value_parser = values::size, allow_hyphen_values = true)]
    size: Option<(u32, u32)>,

    /// The most samples of the curve [default: four times the file's own]
    #[arg(long, value_name = "N", value_parser = values::samples, allow_hyphen_values = true)]
    most_samples: Option<u32>,

    /// Threads to render with [default: one per processor]
    #[arg(short, long, value_name = "N", value_parser = values::threads, allow_hyphen_values = true)]
    threads: Option<NonZeroUsize>,

    /// Images and meshes may lie outside of the sequence's root, as of `render`
    #[arg(long)]
    allow_outside: bool,

    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,

    /// How progress is told
    #[arg(long, value_enum, default_value_t, value_name = "HOW")]
    progress: ProgressMode,
}

/// What a first answer may take: with loading and writing, less than a minute.
const QUICK: Duration = Duration::from_secs(44);
const USUAL: Duration = Duration::from_secs(5 * 60);

pub fn run(options: &Options, quick: bool) -> Result<(), Failure> {
    let Some(file) = &options.file else {
        return Err(Failure::Bad("name the sequence file to measure".to_owned()));
    };
    let sequence =
        load::sequence(file, options.allow_outside, loading::Reporter::new(options.progress, options.quiet))?;
    let frames = match &options.frames {
        Some(_) => render::frames_of(options.frames.as_ref(), &sequence)?,
        None => vec![sequence.timeline.frames / 2],
    };
    let folder = options.output.clone();
    let folder = folder.unwrap_or_else(|| Path::new("output").join(format!("{}_accuracy", sequence.name)));
    // Nobody wants to learn after the work that it cannot be written.
    if let Some(file) = in_the_way(&folder) {
        let (folder, file) = (escape::path(&folder), escape::path(file));
        return Err(Failure::Bad(format!(
            "cannot write into the folder {folder}: {file} is a file; name another folder with -o"
        )));
    }
    let new = !folder.exists();
    std::fs::create_dir_all(&folder).map_err(|error| {
        Failure::Bad(format!("cannot create the folder {}: {error}", escape::path(&folder)))
    })?;
    let request = Request {
        frames,
        time: options.time.unwrap_or(if quick { QUICK } else { USUAL }),
        quick,
        size: options.size,
        most_samples: options.most_samples,
        threads: options.threads,
    };
    let mut show = share::Reporter::new(options.progress, options.quiet);
    let measured = measure(&sequence, &request, &mut |done| show.tell(done)).inspect_err(|_| {
        // Nothing came of it, so nothing stays. A folder that is in use again is not empty, and does.
        let _ = new.then(|| std::fs::remove_dir(&folder));
    })?;
    show.finish();
    let origin = origin(file, std::env::args_os());
    let report = write(&folder, &measured, &origin)?;
    if options.quiet {
        return Ok(());
    }
    if options.progress == ProgressMode::Json {
        return terminal::say(&data::summary(&measured, &report));
    }
    terminal::say(&told(&measured, &report))
}

/// Where the report comes from; the command and the file as a shell reads them.
fn origin(file: &Path, arguments: impl Iterator<Item = OsString>) -> Origin {
    let words: Vec<String> = arguments.map(|word| quoted(&word)).collect();
    Origin { command: words.join(" "), machine: machine(), file: quoted(file.as_os_str()) }
}

/// The answer in lines, and where the rest of it is.
fn told(measured: &Measured, report: &Path) -> String {
    let mut lines = measured.lines();
    lines.push(format!("The whole report, with commands to paste: {}", escape::path(report)));
    lines.join("\n")
}

/// Writes the report; returns where the page is.
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

/// What it ran on, as far as the system tells.
fn machine() -> String {
    let told = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = told.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
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
    fn a_report_tells_commands_that_shells_read() {
        let words = ["kinora", "accuracy", "my file.ron", "-s", "8x8"].map(OsString::from);
        let Origin { command, file, .. } = origin(Path::new("my file.ron"), words.into_iter());
        assert_eq!((&*command, &*file), ("kinora accuracy 'my file.ron' -s 8x8", "'my file.ron'"));
        let name = OsStr::from_bytes(b"a\xff.ron");
        let Origin { command, file, .. } = origin(Path::new(name), [name.to_owned()].into_iter());
        assert_eq!((&*command, &*file), (r"$'a\xff.ron'", r"$'a\xff.ron'"));
    }
}
