//! The texts that a sequence consists of.

use std::ops::Range;
use std::path::PathBuf;

/// A text with its name. All texts of a sequence share one numbering of bytes, in which each begins at its `base`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Its path in messages.
    pub name: String,
    /// The path from the folder of the sequence to that of this file. Empty for the sequence itself.
    pub folder: PathBuf,
    pub text: String,
    pub base: usize,
    /// Whether it is in the most common notation.
    pub is_common: bool,
    /// The files that it includes, by their indices, and the places that name them.
    pub includes: Vec<(usize, Range<usize>)>,
    /// Its canonical path, if it is a file.
    pub path: Option<PathBuf>,
}

impl Source {
    /// A part of the text, by its place among all texts.
    pub fn part(&self, span: &Range<usize>) -> &str {
        let inside = span.start.saturating_sub(self.base)..span.end.saturating_sub(self.base);
        self.text.get(inside).unwrap_or_default()
    }

    /// The line of a place, counted from 1.
    pub fn line(&self, at: usize) -> usize {
        let before = self.text.as_bytes().get(..at.saturating_sub(self.base)).unwrap_or(self.text.as_bytes());
        before.iter().filter(|byte| **byte == b'\n').count() + 1
    }
}

/// All texts of a sequence. The first one is the sequence itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sources {
    first: Source,
    rest: Vec<Source>,
}

impl Sources {
    pub fn new(first: Source) -> Self {
        Self { first, rest: Vec::new() }
    }

    /// Adds a text behind the others, and returns its index. Sets its base.
    pub fn push(&mut self, source: Source) -> usize {
        let base = self.end();
        self.rest.push(Source { base, ..source });
        self.rest.len()
    }

    /// The base of the next text.
    pub fn end(&self) -> usize {
        let last = self.rest.last().unwrap_or(&self.first);
        // One byte apart, so that the end of a text is a place of its own.
        last.base + last.text.len() + 1
    }

    pub fn iter(&self) -> impl Iterator<Item = &Source> {
        std::iter::once(&self.first).chain(&self.rest)
    }

    pub fn len(&self) -> usize {
        1 + self.rest.len()
    }

    /// The text with this index, which [`Sources::push`] returned; 0 is the sequence itself.
    pub fn get(&self, index: usize) -> &Source {
        index.checked_sub(1).and_then(|index| self.rest.get(index)).unwrap_or(&self.first)
    }

    pub fn get_mut(&mut self, index: usize) -> &mut Source {
        match index.checked_sub(1).and_then(|index| self.rest.get_mut(index)) {
            Some(source) => source,
            None => &mut self.first,
        }
    }

    /// The index of the text around a byte of all texts.
    pub fn index_of(&self, at: usize) -> usize {
        self.rest.partition_point(|source| source.base <= at)
    }

    /// The text around a byte of all texts.
    pub fn of(&self, at: usize) -> &Source {
        self.get(self.index_of(at))
    }
}

/// A name in the notation of the file, with quotes: the key of a map.
pub fn quoted(text: &str) -> String {
    if text.contains(is_escaped) {
        // RON and Rust have the same escapes.
        return format!("{text:?}");
    }
    format!("\"{text}\"")
}

/// A text as a value in the notation of the file, with quotes. It is not read as an expression.
pub fn quoted_value(text: &str) -> String {
    match text.strip_prefix('=') {
        Some(rest) if text.contains(is_escaped) => format!("\"\\u{{3d}}{}", &format!("{rest:?}")[1..]),
        Some(_) => format!("r\"{text}\""),
        None => quoted(text),
    }
}

fn is_escaped(c: char) -> bool {
    c == '"' || c == '\\' || c.is_control()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_no_expressions() {
        for (text, written) in
            [("a", "\"a\""), ("a\"b", "\"a\\\"b\""), ("=x", "r\"=x\""), ("=a\"b", "\"\\u{3d}a\\\"b\"")]
        {
            assert_eq!(quoted_value(text), written);
            assert_eq!(ron::from_str::<String>(written).as_deref(), Ok(text));
        }
    }
}
