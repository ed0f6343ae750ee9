//! `kinora convert`: writes a sequence in the other notation.

use super::failure::Failure;
use super::sequence_file::SequenceFile;
use super::terminal;
use crate::base::escape;
use crate::encode::write_file;
use clap::Args;
use std::path::PathBuf;

/// Print a RON sequence as JSON, or a JSON sequence as RON.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Examples:
  kinora convert scene.ron -o scene.json   for programs that write JSON
  kinora convert scene.json > scene.ron    for people

The result renders the same frames if it is in the same folder. Values, expressions, repetitions,
templates and included files of RON are expanded, and comments are lost. sequences/README.md says
how JSON writes what RON writes. Mistakes are reported as by `kinora check` (exit code 2).")]
pub struct Arguments {
    #[command(flatten)]
    sequence: SequenceFile,

    /// The file to write; without it, the text is printed
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let text = arguments.sequence.converted()?;
    let Some(path) = &arguments.output else { return terminal::print_text(text.trim_end()) };
    write_file(path, text.as_bytes()).map_err(|error| Failure::Incomplete(error.to_string()))?;
    terminal::print_line(&format!("wrote {}", escape::path(path)))
}
