//! Values of the file as text with a place, taken apart one level at a time.
//!
//! ron reads everything; what is nested stays raw text, borrowed from the source, so that every value keeps
//! its place and one that is wrong does not stop the others from being read.

use super::assets::Assets;
use super::fault::Fault;
use super::keys::KeyClock;
use super::level::{Entries, Parts, Raw};
use super::mesh::Meshes;
use super::suggest::shortened;
use crate::base::files::Root;
use ron::value::RawValue;
use serde::de::{Deserialize, Deserializer, IgnoredAny};
use std::cell::{Cell, RefCell};
use std::ops::Range;
use std::path::Path;

/// The file that is read, what is wrong with it so far, and what its key times and paths mean.
pub struct File<'s> {
    source: &'s str,
    faults: RefCell<Vec<Fault>>,
    pub clock: Cell<KeyClock>,
    /// Images named in the file.
    pub assets: Assets,
    /// Meshes named in the file.
    pub meshes: Meshes,
}

impl<'s> File<'s> {
    /// `folder` is where the file's own paths begin, and `root` where they lead.
    pub fn new(source: &'s str, folder: &Path, root: Root) -> Self {
        let (assets, meshes) = (Assets::new(folder, root.clone()), Meshes::new(folder, root));
        Self { source, faults: RefCell::default(), clock: Cell::default(), assets, meshes }
    }

    /// The whole file as one value; its syntax has been checked.
    pub fn root<'f>(&'f self) -> Node<'f> {
        Node::new(self, self.source)
    }

    pub fn push(&self, fault: Fault) {
        self.faults.borrow_mut().push(fault);
    }

    pub fn fault_count(&self) -> usize {
        self.faults.borrow().len()
    }

    /// Says of the faults from `first` on which field they are about.
    pub fn name_faults(&self, first: usize, field: &str) {
        self.faults.borrow_mut().iter_mut().skip(first).for_each(|fault| fault.name_field(field));
    }

    pub fn into_faults(self) -> Vec<Fault> {
        self.faults.into_inner()
    }

    /// The place of a part of the source.
    pub fn span_of(&self, part: &str) -> Range<usize> {
        let start = (part.as_ptr() as usize).saturating_sub(self.source.as_ptr() as usize);
        start..start + part.len()
    }
}

/// A value: its text without the blanks around it, split into a leading word and the rest.
#[derive(Clone, Copy)]
pub struct Node<'s> {
    pub file: &'s File<'s>,
    text: &'s str,
    word: &'s str,
    body: &'s str,
}

/// What a value consists of, one level deep.
pub enum Content<'s> {
    /// `(a: 1, b: 2)`
    Fields(Vec<(&'s str, Node<'s>)>),
    /// `(1, 2)`
    Tuple(Vec<Node<'s>>),
    /// `[1, 2]`
    List(Vec<Node<'s>>),
    /// `{ "a": 1, "b": 2 }`
    Map(Vec<(Node<'s>, Node<'s>)>),
    /// A number, a text or a word alone.
    Plain,
}

impl<'s> Node<'s> {
    fn new(file: &'s File<'s>, raw: &'s str) -> Self {
        let text = without_blanks(raw);
        let (word, body) = split_word(text);
        let text = if body.is_empty() { word } else { text };
        Self { file, text, word, body }
    }

    pub fn text(&self) -> &'s str {
        self.text
    }

    pub fn span(&self) -> Range<usize> {
        self.file.span_of(self.text)
    }

    /// The leading word or, without one, the opening bracket.
    pub fn head(&self) -> Range<usize> {
        let start = self.span().start;
        let len = if self.word.is_empty() {
            self.text.chars().next().map_or(0, char::len_utf8)
        } else {
            self.word.len()
        };
        start..start + len
    }

    /// `Sphere` of `Sphere(radius: 2)`; empty if there is none.
    pub fn word(&self) -> &'s str {
        self.word
    }

    /// The word if the value is nothing else.
    pub fn bare_word(&self) -> Option<&'s str> {
        (self.body.is_empty() && !self.word.is_empty()).then_some(self.word)
    }

    pub fn opens_with(&self, bracket: char) -> bool {
        self.word.is_empty() && self.text.starts_with(bracket)
    }

    pub fn is_text(&self) -> bool {
        self.word.is_empty() && (self.text.starts_with('"') || self.text.starts_with('r'))
    }

    /// Takes the value apart.
    pub fn content(&self) -> Option<Content<'s>> {
        match self.read() {
            Ok(content) => Some(content),
            // The file's syntax is known to be good; if ron still refuses a part, say so rather than fail.
            Err(error) => {
                self.fault(Fault::new(self.span(), "this cannot be read", error.to_string()));
                None
            }
        }
    }

    fn read(&self) -> Result<Content<'s>, ron::Error> {
        let node = |raw: &'s RawValue| Node::new(self.file, raw.get_ron());
        let mut reader = ron::Deserializer::from_str(self.body)?;
        Ok(match self.body.chars().next() {
            Some('(') => match reader.deserialize_any(Parts)? {
                Raw::Fields(fields) => {
                    Content::Fields(fields.into_iter().map(|(name, raw)| (name, node(raw))).collect())
                }
                Raw::Items(items) => Content::Tuple(items.into_iter().map(node).collect()),
            },
            Some('[') => match reader.deserialize_seq(Parts)? {
                Raw::Items(items) => Content::List(items.into_iter().map(node).collect()),
                Raw::Fields(_) => Content::Plain,
            },
            Some('{') => {
                let entries = reader.deserialize_map(Entries)?;
                Content::Map(entries.into_iter().map(|(key, value)| (node(key), node(value))).collect())
            }
            _ => Content::Plain,
        })
    }

    pub fn fault(&self, fault: Fault) {
        self.file.push(fault);
    }

    /// Reports that something else was expected here.
    pub fn expected(&self, what: impl Into<String>) {
        self.fault(self.mismatch(what));
    }

    /// The fault of [`Node::expected`], for adding help.
    pub fn mismatch(&self, what: impl Into<String>) -> Fault {
        Fault::expected(self.span(), what, format!("found {}", self.describe()))
    }

    /// What the value is, in words.
    pub fn describe(&self) -> String {
        let first = self.text.chars().next().unwrap_or(' ');
        match (self.bare_word(), first) {
            (Some(word), _) => format!("`{}`", shortened(word)),
            (None, _) if !self.word.is_empty() => format!("`{}(...)`", shortened(self.word)),
            (None, '0'..='9' | '-' | '+' | '.') => shortened(self.text),
            (None, '"') => format!("the text {}", shortened(self.text)),
            (None, '[') => "a list".to_owned(),
            (None, '{') => "a map".to_owned(),
            (None, '(') => match self.read() {
                Ok(Content::Tuple(items)) if items.len() == 1 => "one value in parentheses".to_owned(),
                Ok(Content::Tuple(items)) if items.is_empty() => "empty parentheses".to_owned(),
                Ok(Content::Tuple(items)) => format!("{} values in parentheses", items.len()),
                _ => "named fields".to_owned(),
            },
            _ => format!("`{}`", shortened(self.text)),
        }
    }
}

/// The value in `raw` without blanks and comments around it.
fn without_blanks(raw: &str) -> &str {
    if is_plain(raw) {
        return raw.trim();
    }
    // A new reader stands on the first character that is no blank, and after a value right behind it.
    let Ok(mut reader) = ron::Deserializer::from_str(raw) else { return raw };
    let start = reader.remainder();
    match IgnoredAny::deserialize(&mut reader) {
        Ok(_) => start[..start.len() - reader.remainder().len()].trim_end(),
        Err(_) => start,
    }
}

/// Whether all that may stand around a value are blanks on which ron and Rust agree: those of ASCII, no comment, and no
/// attribute of the file.
fn is_plain(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii() && byte != b'/' && byte != b'#')
}

/// A leading word, and what follows it behind any blanks.
fn split_word(text: &str) -> (&str, &str) {
    let letter = |c: char| c == '_' || c.is_alphanumeric();
    if !text.starts_with(|c: char| letter(c) && !c.is_ascii_digit()) {
        return ("", text);
    }
    let (word, rest) = text.split_at(text.find(|c| !letter(c)).unwrap_or(text.len()));
    // r"..", r#".."#, b".." and b'.' are no words.
    if rest.starts_with(['"', '\'', '#']) {
        return ("", text);
    }
    let rest = match is_plain(rest) {
        true => rest.trim_start(),
        false => ron::Deserializer::from_str(rest).map_or(rest, |reader| reader.remainder()),
    };
    (word, if rest.starts_with('(') { rest } else { "" })
}
