//! Loads sequence files.

use super::failure::Failure;
use super::loading::{self, LoadingReporter};
use super::terminal;
use crate::base::escape;
use crate::base::files::{Root, describe};
use crate::farm::Fingerprint;
use crate::sequence::{self, Sequence, load_watched};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::Arc;

/// Loads a sequence. Its images and meshes must be inside of its root, unless `outside` is set. Meshes may take long to
/// load, so there is a reporter.
pub fn sequence(path: &Path, outside: bool, reporter: LoadingReporter) -> Result<Sequence, Failure> {
    with_files(path, outside, reporter).map(|(sequence, _)| sequence)
}

/// Like [`sequence`]. Also returns the root, which lists the files that were read.
pub fn with_files(
    path: &Path,
    outside: bool,
    reporter: LoadingReporter,
) -> Result<(Sequence, Root), Failure> {
    check_file(path)?;
    let meter = Arc::default();
    let root = root_of(path, outside);
    let load = || load_watched(path, root.clone(), &meter);
    let sequence = loading::watch(&meter, reporter, load);
    let sequence = sequence.map_err(|error| Failure::Faults(error.render(terminal::color())))?;
    Ok((sequence, root))
}

/// The sequence in a file in the other notation.
pub fn converted(path: &Path, outside: bool) -> Result<String, Failure> {
    check_file(path)?;
    sequence::converted(path, root_of(path, outside))
        .map_err(|error| Failure::Faults(error.render(terminal::color())))
}

/// The sequence in a file as one plain file.
pub fn expanded(path: &Path, outside: bool, reporter: LoadingReporter) -> Result<String, Failure> {
    check_file(path)?;
    let (meter, root) = (Arc::default(), root_of(path, outside));
    let text = loading::watch(&meter, reporter, || sequence::expanded(path, root, &meter));
    text.map_err(|error| Failure::Faults(error.render(terminal::color())))
}

fn root_of(path: &Path, outside: bool) -> Root {
    if outside { Root::anywhere() } else { Root::of(path.parent().unwrap_or(Path::new(""))) }
}

/// Fails if there is no such file.
pub fn check_file(path: &Path) -> Result<(), Failure> {
    let name = escape::path(path);
    match std::fs::metadata(path) {
        Ok(what) if what.is_dir() => {
            return Err(Failure::Bad(format!("{name} is a folder; give the sequence file in it")));
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(Failure::Bad(format!("there is no file {name}{}", suggestion(path))));
        }
        Err(error) => return Err(Failure::Bad(format!("cannot read {name}: {error}"))),
        Ok(_) => {}
    }
    Ok(())
}

/// A hint, if only the extension is missing.
fn suggestion(path: &Path) -> String {
    let ron = path.with_extension("ron");
    if ron.is_file() { format!("; did you mean {}?", escape::path(ron)) } else { String::new() }
}

/// The fingerprint of the files that were read, for jobs.
pub fn fingerprint(file: &Path, root: &Root) -> Result<Fingerprint, Failure> {
    Fingerprint::of(file, &root.admitted()).map_err(|(path, error)| {
        Failure::Bad(format!("cannot read {}: {}", escape::path(path), describe(&error)))
    })
}
