//! Reads the files that a sequence includes.

use super::super::fault::Fault;
use super::super::node::{Node, NodeContent};
use super::super::source_file::File;
use super::super::suggest::shortened;
use super::super::syntax;
use super::super::values::{PATHS, list, text};
use super::super::version::too_new;
use super::parts::is_expression;
use super::source::{Source, Sources};
use super::state::NO_EXPRESSION;
use super::writer::LARGEST;
use crate::base::files::{self, Root};
use std::io;
use std::ops::Range;
use std::path::Path;

/// Maximum number of included files.
const MOST_FILES: usize = 1000;

/// Files that include each other this deep.
const DEEPEST: usize = 16;

/// The main text: the sequence itself, without faults of syntax, whose own path is `name`.
pub fn main(name: &str, text: &str, is_common: bool) -> Source {
    let path = Path::new(name).canonicalize().ok();
    Source { name: name.to_owned(), text: text.to_owned(), is_common, path, ..Source::default() }
}

/// A text for decoders.
pub fn file<'s>(source: &'s Source, folder: &Path, root: &Root) -> File<'s> {
    let mut file = File::new(&source.text, folder, root.clone(), source.is_common);
    file.base = source.base;
    file
}

/// Why a file is not included.
struct Refusal {
    why: String,
    /// Whether another path may help.
    is_path: bool,
}

/// The texts of a sequence.
pub struct Included {
    pub sources: Sources,
    /// Indices of all texts. Each comes after those that it includes, so the sequence itself is last.
    pub order: Vec<usize>,
    /// The faults of files that cannot be read.
    pub faults: Vec<Fault>,
}

/// Reads all files that a sequence includes. Their paths are relative to the file that names them, and must be within
/// the root.
pub fn read(main: Source, folder: &Path, root: &Root) -> Included {
    let sources = Sources::new(main);
    let mut reader =
        Reader { sources, order: Vec::new(), folder, root, faults: Vec::new(), open: vec![(0, 0..0)] };
    reader.includes(0);
    reader.order.push(0);
    Included { sources: reader.sources, order: reader.order, faults: reader.faults }
}

struct Reader<'r> {
    sources: Sources,
    order: Vec<usize>,
    folder: &'r Path,
    root: &'r Root,
    faults: Vec<Fault>,
    /// The files that are being read, from the outside in, each with the place that names it.
    open: Vec<(usize, Range<usize>)>,
}

impl Reader<'_> {
    /// Reads the files that a text includes, and those that they include.
    fn includes(&mut self, index: usize) {
        for (name, place) in self.names(index) {
            let folder = self.sources.get(index).folder.clone();
            match self.include(&folder.join(&name), &place) {
                Ok(Some(included)) => self.sources.get_mut(index).includes.push((included, place)),
                Ok(None) => {}
                Err(Refusal { why, is_path }) => {
                    let title = format!("cannot include {:?}", shortened(&name));
                    let fault = Fault::new(place, title, why);
                    let fault = if is_path { fault.help(PATHS) } else { fault };
                    let is_expression = is_path && name.starts_with('=');
                    self.faults.push(if is_expression { fault.help(NO_EXPRESSION) } else { fault });
                }
            }
        }
    }

    /// The names of the files that a text includes, with their places.
    fn names(&mut self, index: usize) -> Vec<(String, Range<usize>)> {
        let file = file(self.sources.get(index), self.folder, self.root);
        let field = top_field(file.root(), "include");
        let is_expression = field.is_some_and(|node| is_expression(node.text()));
        let names = field.and_then(|node| list(node, "file names", |item| Some((text(item)?, item.span()))));
        let faults = file.into_faults();
        self.faults.extend(faults.into_iter().map(|mut fault| {
            fault.name_field("include");
            if is_expression { fault.help(NO_EXPRESSION) } else { fault }
        }));
        names.unwrap_or_default()
    }

    /// The index of the file with this path, relative to the sequence's folder. None after a fault in it.
    fn include(&mut self, relative: &Path, place: &Range<usize>) -> Result<Option<usize>, Refusal> {
        let limit = |why: String| Refusal { why, is_path: false };
        let unreadable = |error: &io::Error| Refusal { why: files::describe(error), is_path: true };
        let shown = self.folder.join(relative);
        let path = self.root.admit(&shown).map_err(|error| unreadable(&error))?;
        let known = |source: &Source| source.path.as_ref() == Some(&path);
        let index = self.sources.iter().position(known);
        if let Some(index) = index {
            if let Some(from) = self.open.iter().position(|(open, _)| *open == index) {
                self.report_circle(from, place);
                return Ok(None);
            }
            return Ok(Some(index));
        }
        if self.sources.len() > MOST_FILES {
            return Err(limit(format!("a sequence includes at most {MOST_FILES} files")));
        }
        if self.open.len() > DEEPEST {
            return Err(limit(format!("files include each other at most {DEEPEST} deep")));
        }
        let read: usize = self.sources.iter().map(|source| source.text.len()).sum();
        let bytes = files::read(&path, (LARGEST - read.min(LARGEST)) as u64);
        let bytes = bytes.map_err(|error| match error.kind() {
            io::ErrorKind::FileTooLarge => {
                limit(format!("all files of a sequence together have at most {} MiB", LARGEST >> 20))
            }
            _ => unreadable(&error),
        })?;
        let text = files::utf8(bytes).map_err(limit)?;
        let text = text.strip_prefix('\u{feff}').map_or_else(|| text.clone(), str::to_owned);
        let base = self.sources.end();
        let (is_common, faults) = syntax::checked(&text);
        let is_whole = faults.is_empty();
        self.faults.extend(faults.into_iter().map(|fault| fault.moved(base)));
        let folder = relative.parent().unwrap_or(Path::new("")).to_owned();
        let name = shown.to_string_lossy().into_owned();
        let source = Source { name, folder, text, is_common, path: Some(path), ..Source::default() };
        let index = self.sources.push(source);
        if !is_whole {
            return Ok(None);
        }
        if let Some(fault) = too_new(&file(self.sources.get(index), self.folder, self.root)) {
            self.faults.push(fault);
            return Ok(None);
        }
        self.open.push((index, place.clone()));
        self.includes(index);
        self.open.pop();
        self.order.push(index);
        Ok(Some(index))
    }

    /// Reports files that include each other. The first of them is open at index `from`.
    fn report_circle(&mut self, from: usize, place: &Range<usize>) {
        let names: Vec<_> = self.open.iter().skip(from).map(|(index, _)| self.sources.get(*index)).collect();
        let first = names.first().map_or_else(String::new, |source| shown_name(source));
        let title = "files include each other";
        let label = match names.as_slice() {
            [_] => format!("{first} includes itself"),
            _ => {
                let chain =
                    names.iter().map(|source| shown_name(source)).collect::<Vec<_>>().join(" includes ");
                format!("{chain} includes {first}")
            }
        };
        let steps: Vec<_> = self.open.iter().skip(from + 1).map(|(_, place)| place.clone()).collect();
        let fault = Fault::new(place.clone(), title, label);
        let fault = steps.into_iter().rev().fold(fault, |fault, place| fault.used(place, "included here"));
        self.faults.push(fault);
    }
}

/// The file name of a source.
fn shown_name(source: &Source) -> String {
    let name = Path::new(&source.name).file_name().unwrap_or_default().to_string_lossy();
    format!("{:?}", shortened(&name))
}

/// The value of a field of the whole file.
pub fn top_field<'s>(root: Node<'s>, name: &str) -> Option<Node<'s>> {
    let NodeContent::Fields(fields) = root.content()? else { return None };
    fields.into_iter().find(|(found, _)| *found == name).map(|(_, value)| value)
}
