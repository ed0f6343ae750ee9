//! Files into sequences, with faults as failures.

use super::failure::Failure;
use super::loading::{self, Reporter};
use super::terminal;
use crate::base::escape;
use crate::base::files::Root;
use crate::sequence::{Sequence, load_watched};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::Arc;

/// The sequence in a file, which names others only within its root unless they may lie outside. Meshes may take their
/// time, so progress is told.
pub fn sequence(path: &Path, outside: bool, show: Reporter) -> Result<Sequence, Failure> {
    with_files(path, outside, show).map(|(sequence, _)| sequence)
}

/// The same, with the root that knows which files were read.
pub fn with_files(path: &Path, outside: bool, show: Reporter) -> Result<(Sequence, Root), Failure> {
    let name = escape::path(path);
    match std::fs::metadata(path) {
        Ok(what) if what.is_dir() => {
            return Err(Failure::Bad(format!("{name} is a folder; name the sequence file in it")));
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(Failure::Bad(format!("there is no file {name}{}", suggestion(path))));
        }
        Err(error) => return Err(Failure::Bad(format!("cannot read {name}: {error}"))),
        Ok(_) => {}
    }
    let meter = Arc::default();
    let root = if outside { Root::anywhere() } else { Root::of(path.parent().unwrap_or(Path::new(""))) };
    let load = || load_watched(path, root.clone(), &meter);
    let sequence = loading::watch(&meter, show, load);
    let sequence = sequence.map_err(|error| Failure::Faults(error.render(terminal::color())))?;
    Ok((sequence, root))
}

/// The usual slip is to leave out the extension.
fn suggestion(path: &Path) -> String {
    let ron = path.with_extension("ron");
    if ron.is_file() { format!("; did you mean {}?", escape::path(ron)) } else { String::new() }
}
