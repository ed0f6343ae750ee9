//! Loads a [`Sequence`] from text.

use super::document;
use super::expand::source::Sources;
use super::expand::{self, Expanded, include};
use super::fault::Fault;
use super::faults::Faults;
use super::source_file::{self, Form, Written};
use super::{Sequence, json, syntax, version};
use crate::base::files::{self, Root};
use crate::import::LoadProgress;
use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Maximum size of a sequence file in bytes.
const LARGEST_FILE: u64 = 64 << 20;

/// Why a sequence could not be loaded.
#[derive(Debug)]
#[warn(missing_docs)]
pub enum LoadError {
    /// The file cannot be read or is not text.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says, or that the file is not text.
        reason: String,
    },
    /// The file contains faults.
    Faults(Box<Faults>),
}

#[warn(missing_docs)]
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
#[warn(missing_docs)]
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
    let source =
        SourceText { name: &path.to_string_lossy(), folder: folder_of(path), root, text, wants_plain: false };
    source.parse(meter).map(|loaded| loaded.sequence).map_err(|faults| LoadError::Faults(Box::new(faults)))
}

/// The text of a sequence file.
pub(super) fn read(path: &Path) -> Result<String, String> {
    // A pipe works too: the user who passes it also writes to it.
    let bytes = File::open(path).and_then(|file| files::read_at_most(file, LARGEST_FILE));
    files::utf8(bytes.map_err(|error| files::describe(&error))?)
}

/// The sequence in a file as one plain file: without values, expressions, repetitions, templates and included files.
/// Its paths are relative to the folder of `path`. It loads as the same sequence.
pub fn expanded(path: &Path, root: Root, meter: &Arc<LoadProgress>) -> Result<String, LoadError> {
    let text = read(path).map_err(|reason| LoadError::Unreadable { path: path.to_owned(), reason })?;
    expanded_text(path, &text, root, meter)
}

/// [`expanded`] for the text that a file called `path` would have.
pub(super) fn expanded_text(
    path: &Path,
    text: &str,
    root: Root,
    meter: &Arc<LoadProgress>,
) -> Result<String, LoadError> {
    let source =
        SourceText { name: &path.to_string_lossy(), folder: folder_of(path), root, text, wants_plain: true };
    source
        .parse(meter)
        .map(|loaded| loaded.plain.unwrap_or_default())
        .map_err(|faults| LoadError::Faults(Box::new(faults)))
}

/// Parses a sequence from text. `name` is its path in messages. The files that it names are relative to the directory
/// of `name` and must be within the root of that directory. The file stem becomes the sequence's name.
#[warn(missing_docs)]
pub fn parse(name: &str, text: &str) -> Result<Sequence, Faults> {
    let folder = folder_of(Path::new(name));
    SourceText { name, folder, root: Root::of(folder), text, wants_plain: false }
        .parse(&Arc::default())
        .map(|loaded| loaded.sequence)
}

/// What the decoders take the values of a text for.
pub(super) fn load_forms(path: &Path, text: &str, root: Root) -> Result<HashMap<usize, Form>, LoadError> {
    let source =
        SourceText { name: &path.to_string_lossy(), folder: folder_of(path), root, text, wants_plain: false };
    let loaded = source.parse(&Arc::default()).map_err(|faults| LoadError::Faults(Box::new(faults)))?;
    Ok(loaded.forms)
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
    /// Whether the text is needed as one plain file.
    wants_plain: bool,
}

/// A sequence, and its text as one plain file if that is needed.
struct Loaded {
    sequence: Sequence,
    plain: Option<String>,
    forms: HashMap<usize, Form>,
}

impl SourceText<'_> {
    fn parse(self, meter: &Arc<LoadProgress>) -> Result<Loaded, Faults> {
        let Self { name, folder, root, text, wants_plain } = self;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let is_json = json::is_json(Path::new(name));
        let text = &*match is_json {
            true => json::as_ron(text)
                .map_err(|fault| Faults::new(Sources::new(include::main(name, text, false)), vec![fault]))?,
            false => Cow::Borrowed(text),
        };
        let (is_common, faults) = syntax::checked(text);
        let main = || include::main(name, text, is_common);
        if !faults.is_empty() {
            return Err(Faults::new(Sources::new(main()), faults));
        }
        let decoder = Decoder { name, meter, wants_plain };
        let mut file = source_file::File::new(text, folder, root.clone(), is_common);
        file.is_json = is_json;
        // Whatever else is unknown in the file may be new.
        if let Some(fault) = version::too_new(&file) {
            return Err(Faults::new(Sources::new(main()), vec![fault]));
        }
        if is_json {
            json::check(file.root());
        }
        if is_json || !expand::is_needed(file.root()) {
            let decoded = decoder.decoded(file, |at| {
                format!("{name}:{}", text.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count() + 1)
            });
            return decoded.map_err(|faults| Faults::new(Sources::new(main()), faults));
        }
        let included = include::read(main(), folder, &root);
        let sources = &included.sources;
        if !included.faults.is_empty() {
            return Err(Faults::new(sources.clone(), included.faults.clone()));
        }
        let expanded = expand::expand(&included, folder, &root);
        let Expanded { text, map } = expanded.map_err(|faults| Faults::new(sources.clone(), faults))?;
        let written = |fault: Fault| {
            let uses = map.uses_of(&map.place(&fault.span));
            fault.relocated(|span| map.place(&span).span, uses)
        };
        let refused =
            |faults: Vec<Fault>| Faults::new(sources.clone(), faults.into_iter().map(written).collect());
        let (is_common, faults) = syntax::checked(&text);
        if !faults.is_empty() {
            return Err(refused(faults));
        }
        let mut file = source_file::File::new(&text, folder, root, is_common);
        file.written = Some(Written { map: &map, sources });
        let decoded = decoder.decoded(file, |at| {
            let place = map.place(&(at..at + 1)).span.start;
            let source = sources.of(place);
            format!("{}:{}", source.name, source.line(place))
        });
        decoded.map_err(refused)
    }
}

/// Decodes plain texts.
struct Decoder<'d> {
    name: &'d str,
    meter: &'d Arc<LoadProgress>,
    wants_plain: bool,
}

impl Decoder<'_> {
    /// Decodes a text. `line` names the file and the line of a byte.
    fn decoded(
        &self,
        mut file: source_file::File<'_>,
        line: impl Fn(usize) -> String,
    ) -> Result<Loaded, Vec<Fault>> {
        let stem = Path::new(self.name).file_stem();
        let stem = stem.map_or_else(|| "sequence".into(), |stem| stem.to_string_lossy());
        file.meshes.meter = Arc::clone(self.meter);
        file.scenes.meter = Arc::clone(self.meter);
        file.tables.meter = Arc::clone(self.meter);
        let sequence = document::sequence(file.root(), &stem);
        let warnings =
            file.warnings().iter().map(|(at, warning)| format!("{}: {warning}", line(*at))).collect();
        let mut faults = file.take_faults();
        match sequence {
            Some(sequence) if faults.is_empty() => {
                let plain = self.wants_plain.then(|| file.plain());
                Ok(Loaded { sequence: Sequence { warnings, ..sequence }, plain, forms: file.take_forms() })
            }
            _ => {
                if faults.is_empty() {
                    // Every decoder that fails reports a fault. If one does not, the file is still refused.
                    faults.push(Fault::new(0..0, "this file cannot be read", "for an unknown reason"));
                }
                Err(faults)
            }
        }
    }
}
