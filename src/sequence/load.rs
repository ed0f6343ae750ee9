//! Loads a [`Sequence`] from text.

use super::document;
use super::fault::{Fault, Faults};
use super::node;
use super::{Sequence, outline, syntax};
use crate::base::files::{self, Root};
use crate::import::LoadProgress;
use std::fmt;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Maximum size of a sequence file in bytes.
const LARGEST_FILE: u64 = 64 << 20;

/// Why a sequence could not be loaded.
#[derive(Debug)]
pub enum LoadError {
    /// The file cannot be read or is not text.
    Unreadable { path: PathBuf, reason: String },
    /// The file contains faults.
    Faults(Box<Faults>),
}

impl LoadError {
    /// The error as text for a terminal, with or without ANSI colours.
    pub fn render(&self, color: bool) -> String {
        match self {
            Self::Faults(faults) => faults.render(color),
            Self::Unreadable { path, reason } => {
                let (on, off) = if color { ("\x1b[1m\x1b[91m", "\x1b[0m") } else { ("", "") };
                format!("{on}error{off}: cannot read {path:?}: {reason}")
            }
        }
    }
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for LoadError {}

/// Loads the sequence in a file. The files that it names must be within its root, see [`Root::of`].
pub fn load(path: &Path) -> Result<Sequence, LoadError> {
    load_watched(path, Root::of(folder_of(path)), &Arc::default())
}

/// [`load`] with a meter for another thread to watch, and with files from `root`.
pub fn load_watched(path: &Path, root: Root, meter: &Arc<LoadProgress>) -> Result<Sequence, LoadError> {
    let text = read(path).map_err(|reason| LoadError::Unreadable { path: path.to_owned(), reason })?;
    load_text(path, &text, root, meter)
}

/// Loads a sequence from the text that a file called `path` would have, with files from `root`.
pub fn load_text(
    path: &Path,
    text: &str,
    root: Root,
    meter: &Arc<LoadProgress>,
) -> Result<Sequence, LoadError> {
    let source = SourceText { name: &path.to_string_lossy(), folder: folder_of(path), root, text };
    source.parse(meter).map_err(|faults| LoadError::Faults(Box::new(faults)))
}

fn read(path: &Path) -> Result<String, String> {
    // A pipe works too: the user who passes it also writes to it.
    let bytes = File::open(path).and_then(|file| files::read_at_most(file, LARGEST_FILE));
    let bytes = bytes.map_err(|error| files::describe(&error))?;
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = good.iter().filter(|byte| **byte == b'\n').count() + 1;
        format!("it is not UTF-8 text; the first wrong byte is in line {line}")
    })
}

/// Parses a sequence from text. `name` is its path in messages. The files that it names are relative to the directory
/// of `name` and must be within the root of that directory. The file stem becomes the sequence's name.
pub fn parse(name: &str, text: &str) -> Result<Sequence, Faults> {
    let folder = folder_of(Path::new(name));
    SourceText { name, folder, root: Root::of(folder), text }.parse(&Arc::default())
}

/// The folder to which a file's own paths are relative.
fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// A text with its name, and the folder to which its own paths are relative.
struct SourceText<'s> {
    name: &'s str,
    folder: &'s Path,
    root: Root,
    text: &'s str,
}

impl SourceText<'_> {
    fn parse(self, meter: &Arc<LoadProgress>) -> Result<Sequence, Faults> {
        let Self { name, folder, root, text } = self;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let is_common = outline::is_common(text, syntax::MAX_ENTRIES);
        let faults = if is_common { Vec::new() } else { syntax::faults(text) };
        if !faults.is_empty() {
            return Err(Faults::new(name, text, faults));
        }
        let stem =
            Path::new(name).file_stem().map_or_else(|| "sequence".into(), |stem| stem.to_string_lossy());
        let mut file = node::File::new(text, folder, root, is_common);
        file.meshes.meter = Arc::clone(meter);
        file.scenes.meter = Arc::clone(meter);
        file.tables.meter = Arc::clone(meter);
        let sequence = document::sequence(file.root(), &stem);
        let warnings = file.warnings(name);
        let mut faults = file.into_faults();
        match sequence {
            Some(sequence) if faults.is_empty() => Ok(Sequence { warnings, ..sequence }),
            _ => {
                if faults.is_empty() {
                    // Every decoder that fails reports a fault. If one does not, the file is still refused.
                    faults.push(Fault::new(0..0, "this file cannot be read", "for an unknown reason"));
                }
                Err(Faults::new(name, text, faults))
            }
        }
    }
}
