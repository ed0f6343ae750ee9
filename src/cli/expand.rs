//! `kinora expand`: prints a sequence as one plain file.

use super::failure::Failure;
use super::sequence_file::SequenceFile;
use super::terminal;
use clap::Args;

/// Print a sequence as one plain file, without values, expressions, repetitions, templates and includes.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Example:
  kinora expand scene.ron > plain.ron

The plain file renders the same frames if it is in the same folder, because its paths are relative
to it. Mistakes are reported as by `kinora check` (exit code 2).")]
pub struct Arguments {
    #[command(flatten)]
    sequence: SequenceFile,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    terminal::print_text(arguments.sequence.expanded()?.trim_end())
}
