//! `--trace`, `--log` and `--metrics`: files about a run for those who want to know where its time goes.
//!
//! The library emits spans and events of the crate `tracing`; the recorder here receives them. Without these options
//! there is no recorder, and spans cost one comparison each. Pictures never depend on them.

mod log_file;
mod metrics_file;
mod recorder;
mod thread_slot;
mod trace_file;

use super::failure::Failure;
use crate::base::escape;
use crate::base::files::{SpecialFile, describe};
use crate::encode::{Output, same_file};
use clap::Args;
use recorder::Recorder;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tracing::{Dispatch, error, info_span};

#[derive(Args, Debug, Default, PartialEq)]
pub struct ObserveOptions {
    /// Write a timeline of the run for ui.perfetto.dev or chrome://tracing, such as run.json
    ///
    /// It has the steps of the run, the stages of each frame, the tiles of each thread, the
    /// encoder, and all waits, in Chrome's trace event format.
    #[arg(long, value_name = "FILE", verbatim_doc_comment)]
    trace: Option<PathBuf>,

    /// Write a line for each step of the run, with its time and duration
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,

    /// Write a JSON object for each finished frame: its time, rays, noise and bytes
    #[arg(long, value_name = "FILE")]
    metrics: Option<PathBuf>,
}

impl ObserveOptions {
    /// The files, each with its option.
    fn files(&self) -> Vec<(&'static str, &Path)> {
        let all = [("--trace", &self.trace), ("--log", &self.log), ("--metrics", &self.metrics)];
        all.into_iter().filter_map(|(option, path)| Some((option, path.as_deref()?))).collect()
    }
}

/// The recorder of a run, if an option asks for one.
pub struct Observation<'a> {
    options: &'a ObserveOptions,
    recorder: Option<Arc<Recorder>>,
}

/// Runs a command. Its work must [open](Observation::open) the files before the first frame; until then, records wait in
/// memory.
pub fn observed(
    options: &ObserveOptions,
    work: impl FnOnce(&Observation) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let wanted = !options.files().is_empty();
    let recorder = wanted.then(|| {
        let ObserveOptions { trace, log, metrics } = options;
        Arc::new(Recorder::new(trace.is_some(), log.is_some(), metrics.is_some()))
    });
    if let Some(recorder) = &recorder {
        // There is one command per process.
        let _ = tracing::dispatcher::set_global_default(Dispatch::new(Arc::clone(recorder)));
    }
    let observation = Observation { options, recorder };
    let done = info_span!("run").in_scope(|| work(&observation));
    observation.end(done)
}

impl Observation<'_> {
    /// Creates the files.
    ///
    /// # Errors
    /// If a file would replace the file that is rendered, an output, or another of these files, or cannot be created.
    pub fn open(&self, input: &Path, outputs: &[Output], frames: &[u32]) -> Result<(), Failure> {
        let Some(recorder) = &self.recorder else { return Ok(()) };
        let files = self.options.files();
        for (place, &(option, path)) in files.iter().enumerate() {
            self.check(option, path, input)?;
            let name = escape::path(path);
            if let Some((other, _)) = files[..place].iter().find(|(_, other)| is_same(other, path)) {
                return Err(Failure::Bad(format!("{other} and {option} both write {name}; give two files")));
            }
            let clashes = |output: &&Output| {
                let stills = output.pattern().is_some_and(|pattern| pattern.has_placeholder());
                let frames = if stills { frames } else { &[0] };
                !output.is_stream() && frames.iter().any(|frame| is_same(&output.path(*frame), path))
            };
            if let Some(output) = outputs.iter().find(clashes) {
                return Err(Failure::Bad(format!(
                    "{option} {name} is also the output {output}; give another file"
                )));
            }
        }
        for (option, path) in files {
            let file = created(path).map_err(|error| {
                let name = escape::path(path);
                Failure::Incomplete(format!("{option}: cannot create {name}: {}", describe(&error)))
            })?;
            recorder.open(option, file);
        }
        Ok(())
    }

    /// Fails if a file would replace this one, which the command reads.
    pub fn open_check(&self, input: &Path) -> Result<(), Failure> {
        self.options.files().into_iter().try_for_each(|(option, path)| self.check(option, path, input))
    }

    fn check(&self, option: &str, path: &Path, input: &Path) -> Result<(), Failure> {
        let name = escape::path(path);
        if path.is_dir() {
            return Err(Failure::Bad(format!("{option}: {name} is a folder; give a file")));
        }
        if is_same(path, input) {
            return Err(Failure::Bad(format!(
                "{option} {name} is the file that is rendered; give another file"
            )));
        }
        if option == "--trace" && SpecialFile::at(path).is_some() {
            let message =
                format!("--trace: {name} is no plain file; a trace is completed in place, so give one");
            return Err(Failure::Bad(message));
        }
        Ok(())
    }

    /// Completes the files. If one could not be written, the run fails, although its pictures are there.
    fn end(self, done: Result<(), Failure>) -> Result<(), Failure> {
        let Some(recorder) = self.recorder else { return done };
        if let Err(failure) = &done {
            error!(code = failure.code(), "the run failed or was stopped");
        }
        let faults = recorder.finish();
        done?;
        let Some((option, error)) = faults.into_iter().next() else { return Ok(()) };
        let path = self.options.files().into_iter().find(|(other, _)| *other == option);
        let name = path.map_or_else(String::new, |(_, path)| escape::path(path));
        let message =
            format!("{option}: cannot write {name}: {}; the pictures are complete", describe(&error));
        Err(Failure::Incomplete(message))
    }
}

/// Whether two paths are one file, links followed: unlike outputs, these files are written in place.
fn is_same(one: &Path, other: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    same_file(one, other) || real(one).is_some_and(|one| real(other) == Some(one))
}

fn created(path: &Path) -> std::io::Result<File> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder)?;
    }
    File::create(path)
}
