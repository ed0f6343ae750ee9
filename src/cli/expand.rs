//! `kinora expand`: prints a sequence as one plain file.

use super::failure::Failure;
use super::loading::LoadingReporter;
use super::progress::ProgressMode;
use super::{load, terminal};
use clap::Args;
use std::path::PathBuf;

/// Print a sequence as one plain file, without values, expressions, repetitions, templates and includes.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Example:
  kinora expand scene.ron > plain.ron

The plain file renders the same frames if it is in the same folder, because its paths are relative
to it. Mistakes are reported as by `kinora check` (exit code 2).")]
pub struct Arguments {
    /// The sequence file (.ron)
    file: PathBuf,

    /// Allow files outside of the sequence's root folder, as in `render`
    #[arg(long)]
    allow_outside: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let loading = LoadingReporter::new(ProgressMode::Auto, false);
    let text = load::expanded(&arguments.file, arguments.allow_outside, loading)?;
    terminal::print_text(text.trim_end())
}
