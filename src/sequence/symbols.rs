//! A minimal tokenizer for messages about broken syntax. ron itself parses the file.

use std::ops::Range;

/// Iterates over the first characters of all words, numbers, texts and brackets. Skips blanks and comments.
pub struct Symbols<'s> {
    text: &'s str,
    at: usize,
    /// The start and the kind of an unclosed text or comment.
    pub unclosed: Option<(usize, &'static str)>,
    /// The start of the first text in quotes that continues on another line.
    pub first_long_text: Option<usize>,
}

impl<'s> Symbols<'s> {
    pub fn new(text: &'s str) -> Self {
        Self { text, at: 0, unclosed: None, first_long_text: None }
    }

    /// Moves behind the next `end`, or to the end of the file if there is no `end`.
    fn skip_past(&mut self, start: usize, end: &str, kind: &'static str) {
        match self.text[self.at..].find(end) {
            Some(found) => self.at += found + end.len(),
            None => {
                self.at = self.text.len();
                self.unclosed = Some((start, kind));
            }
        }
    }

    fn skip_block_comment(&mut self) {
        let (start, mut depth) = (self.at, 0usize);
        loop {
            let rest = &self.text[self.at..];
            let (open, close) = (rest.find("/*"), rest.find("*/"));
            match (open, close) {
                (Some(open), Some(close)) if open < close => {
                    (self.at, depth) = (self.at + open + 2, depth + 1)
                }
                (_, Some(close)) => (self.at, depth) = (self.at + close + 2, depth - 1),
                (_, None) => {
                    self.at = self.text.len();
                    self.unclosed = Some((start, "comment"));
                    return;
                }
            }
            if depth == 0 {
                return;
            }
        }
    }

    fn skip_text(&mut self, start: usize) {
        let mut escaped = false;
        for (i, c) in self.text[start + 1..].char_indices() {
            match c {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '"' => {
                    self.at = start + 1 + i + 1;
                    if self.first_long_text.is_none() && self.text[start..self.at].contains('\n') {
                        self.first_long_text = Some(start);
                    }
                    return;
                }
                _ => {}
            }
        }
        self.at = self.text.len();
        self.unclosed = Some((start, "text"));
    }

    fn skip_word(&mut self, start: usize) {
        let rest = &self.text[start..];
        let hashes = rest[1..].bytes().take_while(|byte| *byte == b'#').count();
        if rest.starts_with('r') && rest[1 + hashes..].starts_with('"') {
            self.at = start + hashes + 2;
            self.skip_past(start, &format!("\"{}", "#".repeat(hashes)), "text");
            return;
        }
        self.at += rest.find(|c: char| c != '_' && !c.is_alphanumeric()).unwrap_or(rest.len());
    }
}

impl Iterator for Symbols<'_> {
    type Item = (usize, char);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let rest = &self.text[self.at..];
            let c = rest.chars().next()?;
            let start = self.at;
            match c {
                _ if c.is_whitespace() || matches!(c, '\u{200e}' | '\u{200f}') => self.at += c.len_utf8(),
                '/' if rest.starts_with("//") => self.at += rest.find('\n').unwrap_or(rest.len()),
                '/' if rest.starts_with("/*") => self.skip_block_comment(),
                '"' => {
                    self.skip_text(start);
                    return Some((start, c));
                }
                'a'..='z' | 'A'..='Z' | '_' => {
                    self.skip_word(start);
                    return Some((start, c));
                }
                // A quoted bracket is a character. A lone quote does not hide the text behind it.
                '\'' if rest.chars().nth(2) == Some('\'') => {
                    self.at += rest.char_indices().nth(3).map_or(rest.len(), |(at, _)| at);
                    return Some((start, c));
                }
                _ => {
                    self.at += c.len_utf8();
                    return Some((start, c));
                }
            }
        }
    }
}

/// The word, number or single character at a place.
pub fn token(text: &str, at: usize) -> Range<usize> {
    let rest = &text[at..];
    let Some(first) = rest.chars().next() else { return at..at };
    let word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    let len = match first {
        '"' => {
            let mut symbols = Symbols { at, ..Symbols::new(text) };
            symbols.skip_text(at);
            symbols.at - at
        }
        c if word(c) || c == '-' => {
            let more = &rest[c.len_utf8()..];
            c.len_utf8() + more.find(|c| !word(c)).unwrap_or(more.len())
        }
        c => c.len_utf8(),
    };
    at..at + len
}
