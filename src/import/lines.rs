//! Text files line by line, as bytes. Numbers are ASCII, and names are decoded lossily, so files need not be UTF-8.

use crate::geometry::mesh::{MeshError, MeshLocation};
use std::io::{self, BufRead, Cursor, Read};
use std::str::FromStr;

/// The lines of a file, counted from 1. They end with a line feed, with a carriage return, or with both.
pub struct Lines<R> {
    input: R,
    /// What was read up to a line feed: one line, unless lines end with carriage returns alone.
    block: Vec<u8>,
    /// Where the next line begins in the block.
    start: usize,
    /// Whether the first line ended with a carriage return alone. Then a line feed behind another one belongs to what
    /// follows, which may be binary.
    returns_alone: Option<bool>,
    line: Vec<u8>,
    number: u64,
    /// Whether a line that ends with a backslash continues on the next line.
    joins: bool,
}

impl<R: BufRead> Lines<R> {
    pub fn new(input: R, joins: bool) -> Self {
        Self { input, block: Vec::new(), start: 0, returns_alone: None, line: Vec::new(), number: 0, joins }
    }

    /// The number of the next line, and the line without trailing blanks.
    pub fn next(&mut self) -> io::Result<Option<(u64, &[u8])>> {
        self.line.clear();
        let first = self.number + 1;
        loop {
            let is_read = self.append()?;
            if !is_read && self.line.is_empty() {
                return Ok(None);
            }
            self.number += 1;
            self.line.truncate(self.line.trim_ascii_end().len());
            if !is_read || !self.joins || self.line.last() != Some(&b'\\') {
                return Ok(Some((first, &self.line)));
            }
            self.line.pop();
            self.line.push(b' ');
        }
    }

    /// Appends the next line to `line`. False at the end of the file.
    fn append(&mut self) -> io::Result<bool> {
        if self.start == self.block.len() {
            self.start = 0;
            self.block.clear();
            if self.input.read_until(b'\n', &mut self.block)? == 0 {
                return Ok(false);
            }
        }
        let rest = &self.block[self.start..];
        // Nearly no file has carriage returns, and `contains` is faster than `position`.
        let returned = rest.contains(&b'\r').then(|| rest.iter().position(|byte| *byte == b'\r')).flatten();
        let feeds = |at: usize| rest.get(at + 1) == Some(&b'\n');
        let alone = *self.returns_alone.get_or_insert(returned.is_some_and(|at| !feeds(at)));
        let length = returned.map_or(rest.len(), |at| at + 1 + usize::from(!alone && feeds(at)));
        self.line.extend_from_slice(&rest[..length]);
        self.start += length;
        Ok(true)
    }

    /// The input after the lines read so far.
    pub fn into_rest(mut self) -> impl BufRead {
        self.block.drain(..self.start);
        Cursor::new(self.block).chain(self.input)
    }
}

/// What some programs write before the text of a file in UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The beginning of a text file without its byte order mark.
pub fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text)
}

/// Whether a file begins with the byte order mark of UTF-16.
pub fn is_utf16(text: &[u8]) -> bool {
    text.starts_with(b"\xff\xfe") || text.starts_with(b"\xfe\xff")
}

/// The words of a line before a comment.
pub fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    words.take_while(|word| word[0] != b'#')
}

/// The first word and the rest of a line, without the blanks between.
pub fn split_word(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (&line[..end], line[end..].trim_ascii_start())
}

/// Parses a number, correctly rounded.
pub fn parsed<T: FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Quotes a part of a file for a message, shortened if it is long.
pub fn quoted(text: &[u8]) -> String {
    const LONGEST: usize = 60;
    let shown = String::from_utf8_lossy(&text[..text.len().min(LONGEST)]);
    format!("`{shown}{}`", if text.len() > LONGEST { "..." } else { "" })
}

/// The error of an invalid line. `what` describes what would be right.
pub fn unexpected(number: u64, line: &[u8], what: &str) -> MeshError {
    MeshError::at(MeshLocation::Line(number), format!("expected {what}, found {}", quoted(line)))
}

/// Up to `N` numbers from the words of a line, and their count; `None` if a word is not a number.
pub fn numbers<'l, const N: usize>(words: impl Iterator<Item = &'l [u8]>) -> Option<([f64; N], usize)> {
    let (mut values, mut count) = ([0.0; N], 0);
    for word in words.take(N) {
        values[count] = parsed(word)?;
        count += 1;
    }
    Some((values, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_every_way() {
        let expected = [(1, "a"), (2, "b   c"), (4, ""), (5, "d")];
        for end in ["\n", "\r\n", "\r"] {
            let text = ["a", "b \\", " c", "", "d"].join(end);
            let mut lines = Lines::new(text.as_bytes(), true);
            let mut seen = Vec::new();
            while let Some((number, line)) = lines.next().expect("a line") {
                seen.push((number, String::from_utf8_lossy(line).into_owned()));
            }
            assert_eq!(seen, expected.map(|(number, line)| (number, line.to_owned())), "{end:?}");
        }
    }

    #[test]
    fn the_rest_follows_the_last_line() {
        for end in ["\n", "\r\n", "\r"] {
            let text = format!("a{end}b{end}\n\x01\r\n\x02");
            let mut lines = Lines::new(text.as_bytes(), false);
            for line in [b"a", b"b"] {
                assert_eq!(lines.next().expect("a line").map(|(_, line)| line), Some(&line[..]));
            }
            let mut rest = Vec::new();
            lines.into_rest().read_to_end(&mut rest).expect("bytes");
            assert_eq!(rest, b"\n\x01\r\n\x02", "{end:?}");
        }
    }

    #[test]
    fn a_backslash_at_the_end_of_the_file_ends() {
        let mut lines = Lines::new(&b"a\\"[..], true);
        assert_eq!(lines.next().expect("a line"), Some((1, &b"a"[..])));
        assert_eq!(lines.next().expect("the end"), None);
    }
}
