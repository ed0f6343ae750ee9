//! `kinora fmt`: lays sequence files out regularly.

use super::failure::Failure;
use super::{load, terminal};
use crate::base::escape;
use crate::base::files::{self, describe};
use crate::base::units::counted;
use crate::encode::write_file;
use crate::sequence::{Formatted, LoadError, formatted, formatted_text, is_json};
use clap::Args;
use std::io::stdin;
use std::path::{Path, PathBuf};

/// Lay out sequence files regularly: indentation, blanks, commas, rows of at most 160 characters.
#[derive(Args, Debug, PartialEq)]
#[command(after_help = "\
Examples:
  kinora fmt scene.ron parts/*.ron   lay out these files in place
  kinora fmt --check *.ron           write nothing; exit code 3 if a file would change
  kinora fmt - < scene.ron           for editors: from the standard input to the standard output

Values and comments stay, and so do line breaks between the entries of a bracket.")]
pub struct Arguments {
    /// Sequence files and included files (.ron), or - for the standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Write nothing, and list the files that would change
    #[arg(long)]
    check: bool,
}

/// The largest text from the standard input in bytes.
const LARGEST_TEXT: u64 = 64 << 20;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    // Everything is read before anything is written.
    let files = arguments.files.iter().map(|path| Ok((path.as_path(), read(path)?)));
    let files = files.collect::<Result<Vec<_>, Failure>>()?;
    let changed: Vec<_> = files.iter().filter(|(_, file)| file.before != file.after).collect();
    if arguments.check {
        changed.iter().try_for_each(|(path, _)| terminal::print_line(&escape::path(path)))?;
        return match changed.len() {
            0 => Ok(()),
            count => {
                let files = counted(count as u64, "file");
                Err(Failure::Incomplete(format!(
                    "{files} would change; `kinora fmt` without --check lays them out"
                )))
            }
        };
    }
    for (path, file) in &files {
        if is_stream(path) {
            terminal::print_text(file.after.trim_end())?;
        } else if file.before != file.after {
            // Links stay links.
            let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
            let written = write_file(&target, file.after.as_bytes());
            written.map_err(|error| Failure::Incomplete(error.to_string()))?;
            terminal::print_line(&format!("wrote {}", escape::path(path)))?;
        }
    }
    Ok(())
}

fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

fn read(path: &Path) -> Result<Formatted, Failure> {
    let refused = |error: LoadError| Failure::Faults(error.render(terminal::color()));
    if is_json(path) {
        let name = escape::path(path);
        return Err(Failure::Bad(format!("{name} is in JSON; `kinora fmt` lays out RON files")));
    }
    if !is_stream(path) {
        load::check_file(path)?;
        return formatted(path).map_err(refused);
    }
    let bytes = files::read_at_most(stdin().lock(), LARGEST_TEXT).map_err(|error| describe(&error));
    let before = bytes
        .and_then(files::utf8)
        .map_err(|reason| Failure::Bad(format!("the standard input: {reason}")))?;
    let after = formatted_text("standard input", &before).map_err(refused)?;
    Ok(Formatted { before, after })
}
