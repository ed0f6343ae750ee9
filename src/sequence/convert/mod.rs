//! Writes sequences in the other notation: RON as JSON, and JSON as RON.
//!
//! The decoders say what the other notation must know: they read the text first, and note where a word stands in place
//! of a text, and which brackets hold tuples, lists, fields and maps.

#[cfg(test)]
mod tests;
mod to_json;
mod to_ron;

use super::fmt::{formatted_text, tokens, tree};
use super::json::{as_ron, is_json};
use super::load::{LoadError, expanded_text, load_forms, read};
use crate::base::files::Root;
use std::path::Path;
use std::sync::Arc;

/// The sequence in a file in the other notation: JSON if its name does not end with `.json`, else RON. It loads as the
/// same sequence. Expressions, templates and included files of RON are expanded; comments are lost.
///
/// # Errors
/// If the file cannot be read or has faults.
pub fn converted(path: &Path, root: Root) -> Result<String, LoadError> {
    let text = read(path).map_err(|reason| LoadError::Unreadable { path: path.to_owned(), reason })?;
    converted_text(path, &text, root)
}

/// [`converted`] for the text that a file called `path` would have.
///
/// # Errors
/// If the text has faults.
pub fn converted_text(path: &Path, text: &str, root: Root) -> Result<String, LoadError> {
    if is_json(path) {
        let forms = load_forms(path, text, root)?;
        let ron = as_ron(text.strip_prefix('\u{feff}').unwrap_or(text));
        // Its syntax has been checked.
        let ron = ron.unwrap_or_default();
        let document = tree::Document::read(&tokens::tokens(&ron));
        return formatted_text(&path.to_string_lossy(), &to_ron::text(&document, &ron, &forms));
    }
    let plain = expanded_text(path, text, root.clone(), &Arc::default())?;
    let forms = load_forms(path, &plain, root)?;
    Ok(to_json::text(&tree::Document::read(&tokens::tokens(&plain)), &plain, &forms))
}

/// The value of an entry without comments, and the name in front of it.
fn named<'t, 's>(entry: &'t tree::Entry<'s>) -> (Option<&'s str>, Value<'t, 's>) {
    let solid = entry.parts.iter().filter(|part| !matches!(part, tree::Part::Comment(_)));
    let parts: Vec<_> = solid.collect();
    match parts.as_slice() {
        [tree::Part::Atom(name), tree::Part::Colon, value @ ..] => (Some(name), Value::of(value)),
        value => (None, Value::of(value)),
    }
}

/// A value of either notation.
enum Value<'t, 's> {
    /// A number, text or word.
    Atom(&'s str),
    Brackets(&'t tree::Brackets<'s>),
    /// `Word(...)`
    Worded(&'s str, &'t tree::Brackets<'s>),
}

impl<'t, 's> Value<'t, 's> {
    fn of(parts: &[&'t tree::Part<'s>]) -> Self {
        match parts {
            [tree::Part::Brackets(brackets), ..] => Self::Brackets(brackets),
            [tree::Part::Atom(word), tree::Part::Brackets(brackets), ..] => Self::Worded(word, brackets),
            [tree::Part::Atom(atom), ..] => Self::Atom(atom),
            // No file without faults has such a value.
            _ => Self::Atom(""),
        }
    }
}

/// The byte of a text at which a part of it begins.
fn start_of(text: &str, part: &str) -> usize {
    (part.as_ptr() as usize).saturating_sub(text.as_ptr() as usize)
}
