//! The most common notation, read in one pass over the text.
//!
//! ron reads a file level by level, and each level again from its beginning to its end. That is slow for files with
//! many thousands of objects. This module knows a part of the notation: plain numbers, texts without escapes, names,
//! brackets, and comments up to the end of a line. Whatever else a file contains is left to ron, and so are all faults.

/// Deepest brackets that are read here. ron accepts at least as many.
const DEEPEST: usize = 32;

/// Most digits of a number before its point. Such numbers fit into every type.
const MOST_DIGITS: usize = 15;

/// Whether a text is a single value in the most common notation, with at most `most` entries in each bracket. Then it
/// is valid RON.
pub fn is_common(text: &str, most: usize) -> bool {
    let mut reader = Reader { bytes: text.as_bytes(), at: 0, most };
    reader.value(0).is_some() && reader.blanks().is_some() && reader.at == text.len()
}

/// The entries of a bracket: each with its name or key, if it has one. Texts are without surrounding blanks.
pub type Entries<'s> = Vec<(Option<&'s str>, &'s str)>;

/// The entries of a value in the most common notation that begins with a bracket.
pub fn entries(text: &str) -> Option<Entries<'_>> {
    let mut reader = Reader { bytes: text.as_bytes(), at: 0, most: usize::MAX };
    let close = closing(reader.next()?)?;
    let mut entries = Vec::new();
    loop {
        reader.blanks()?;
        if reader.take(close) {
            return Some(entries);
        }
        let first = reader.skipped(text)?;
        reader.blanks()?;
        entries.push(match reader.take(b':') {
            true => {
                reader.blanks()?;
                (Some(first), reader.skipped(text)?)
            }
            false => (None, first),
        });
        reader.blanks()?;
        reader.take(b',');
    }
}

/// A value in the most common notation without surrounding blanks.
pub fn trimmed(text: &str) -> Option<&str> {
    let mut reader = Reader { bytes: text.as_bytes(), at: 0, most: usize::MAX };
    reader.blanks()?;
    reader.skipped(text)
}

/// The bracket that closes another one.
fn closing(open: u8) -> Option<u8> {
    match open {
        b'(' => Some(b')'),
        b'[' => Some(b']'),
        b'{' => Some(b'}'),
        _ => None,
    }
}

/// For each byte, whether it may matter to what skips a value: outside brackets, and within them.
const ENDS: [[bool; 256]; 2] = [marked(b"\"/()[]{} \n\t\r,:"), marked(b"\"/()[]{}")];

const fn marked(bytes: &[u8]) -> [bool; 256] {
    let (mut marked, mut at) = ([false; 256], 0);
    while at < bytes.len() {
        marked[bytes[at] as usize] = true;
        at += 1;
    }
    marked
}

/// Reads a text from its start. Every method returns None at something else than the most common notation.
struct Reader<'s> {
    bytes: &'s [u8],
    at: usize,
    /// Most entries of a bracket.
    most: usize,
}

impl Reader<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn next(&mut self) -> Option<u8> {
        let byte = self.peek()?;
        self.at += 1;
        Some(byte)
    }

    fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// Skips bytes, and returns their number.
    fn skip_while(&mut self, is: impl Fn(u8) -> bool) -> usize {
        let rest = &self.bytes[self.at..];
        let count = rest.iter().position(|byte| !is(*byte)).unwrap_or(rest.len());
        self.at += count;
        count
    }

    /// Skips blanks and comments.
    fn blanks(&mut self) -> Option<()> {
        loop {
            self.skip_while(|byte| matches!(byte, b' ' | b'\n' | b'\t' | b'\r'));
            if self.peek() != Some(b'/') {
                return Some(());
            }
            self.at += 1;
            self.take(b'/').then_some(())?;
            self.skip_while(|byte| byte != b'\n');
            // A comment that ends with the file is left to ron.
            self.take(b'\n').then_some(())?;
        }
    }

    /// Reads a value within `depth` brackets.
    fn value(&mut self, depth: usize) -> Option<()> {
        self.blanks()?;
        match self.peek()? {
            b'"' => self.text(),
            b'-' | b'0'..=b'9' => self.number(),
            b'(' => self.parentheses(depth),
            b'[' => self.bracket(depth, |reader| reader.value(depth + 1)),
            b'{' => self.bracket(depth, |reader| {
                // Only texts are names.
                (reader.peek()? == b'"').then_some(())?;
                reader.text()?;
                reader.named(depth)
            }),
            _ => {
                self.word()?;
                if self.peek() == Some(b'(') { self.parentheses(depth) } else { Some(()) }
            }
        }
    }

    /// Reads `: value`.
    fn named(&mut self, depth: usize) -> Option<()> {
        self.blanks()?;
        self.take(b':').then_some(())?;
        self.value(depth + 1)
    }

    /// Reads fields if the first entry has a name, and otherwise values.
    fn parentheses(&mut self, depth: usize) -> Option<()> {
        let start = self.at;
        self.at += 1;
        self.blanks()?;
        let has_names = self.word().is_some() && self.blanks().is_some() && self.peek() == Some(b':');
        self.at = start;
        match has_names {
            true => self.bracket(depth, |reader| {
                reader.word()?;
                reader.named(depth)
            }),
            false => self.bracket(depth, |reader| reader.value(depth + 1)),
        }
    }

    /// Reads a bracket of entries, separated by commas.
    fn bracket(&mut self, depth: usize, mut entry: impl FnMut(&mut Self) -> Option<()>) -> Option<()> {
        let close = closing(self.next()?).filter(|_| depth < DEEPEST)?;
        let mut entries = 0;
        loop {
            self.blanks()?;
            if self.take(close) {
                return Some(());
            }
            entries += 1;
            (entries <= self.most).then_some(())?;
            entry(self)?;
            self.blanks()?;
            if !self.take(b',') {
                return self.take(close).then_some(());
            }
        }
    }

    /// Reads a text without escapes.
    fn text(&mut self) -> Option<()> {
        self.at += 1;
        self.skip_while(|byte| byte != b'"' && byte != b'\\');
        self.take(b'"').then_some(())
    }

    /// Reads a number such as -1.5e-3.
    fn number(&mut self) -> Option<()> {
        self.take(b'-');
        let zero = self.peek() == Some(b'0');
        let digits = self.skip_while(|byte| byte.is_ascii_digit());
        (digits > 0 && digits <= if zero { 1 } else { MOST_DIGITS }).then_some(())?;
        if self.take(b'.') {
            (self.skip_while(|byte| byte.is_ascii_digit()) > 0).then_some(())?;
        }
        if self.take(b'e') || self.take(b'E') {
            if !self.take(b'-') {
                self.take(b'+');
            }
            (matches!(self.skip_while(|byte| byte.is_ascii_digit()), 1..=3)).then_some(())?;
        }
        // What follows directly may belong to the number.
        matches!(self.peek(), None | Some(b' ' | b'\n' | b'\t' | b'\r' | b',' | b')' | b']' | b'}' | b':'))
            .then_some(())
    }

    /// Reads a word that is neither an option nor the beginning of a text.
    fn word(&mut self) -> Option<()> {
        let start = self.at;
        self.peek().filter(|byte| byte.is_ascii_alphabetic() || *byte == b'_')?;
        self.skip_while(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        let ends = !matches!(self.peek(), Some(b'"' | b'\'' | b'#' | b'.' | b'-' | b'+' | 0x80..));
        let is_special = match &self.bytes[start..self.at] {
            b"Some" | b"None" | b"inf" | b"NaN" => true,
            b"true" | b"false" => self.peek() == Some(b'('),
            _ => false,
        };
        (ends && !is_special).then_some(())
    }

    /// Skips a value whose notation has been checked, and returns its text.
    fn skipped<'s>(&mut self, text: &'s str) -> Option<&'s str> {
        let (start, mut depth) = (self.at, 0);
        while let Some(byte) = self.peek() {
            match byte {
                b'"' => {
                    self.text()?;
                    if depth == 0 {
                        break;
                    }
                    continue;
                }
                b'/' if depth == 0 => break,
                b'/' => {
                    self.blanks()?;
                    continue;
                }
                b'(' | b'[' | b'{' => depth += 1,
                b')' | b']' | b'}' if depth == 0 => break,
                b')' | b']' | b'}' if depth == 1 => {
                    self.at += 1;
                    break;
                }
                b')' | b']' | b'}' => depth -= 1,
                b' ' | b'\n' | b'\t' | b'\r' | b',' | b':' if depth == 0 => break,
                _ => {
                    let ends = &ENDS[usize::from(depth > 0)];
                    self.skip_while(|byte| !ends[usize::from(byte)]);
                    continue;
                }
            }
            self.at += 1;
        }
        text.get(start..self.at).filter(|value| !value.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use serde::de::{Deserialize, IgnoredAny};

    fn is_ron(text: &str) -> bool {
        let Ok(mut reader) = ron::Deserializer::from_str(text) else { return false };
        IgnoredAny::deserialize(&mut reader).and_then(|_| reader.end()).is_ok()
    }

    #[test]
    fn common_notation_is_known() {
        for text in [
            "()",
            "( // nothing\n)",
            "(a: 1, b: -2.5e-3, c: (x, Y(1)), d: [(0, true), (1, false),], e: { \"ä\": X(y: 0), \"\": () },)",
        ] {
            assert!(is_common(text, 10) && is_ron(text), "{text}");
        }
        for text in [
            "(a: 1",
            "(a: 1)) ",
            "(1, a: 2)",
            "(a: 1, 2)",
            "{a: 1}",
            "(1 2)",
            "(007)",
            "(\"\\n\")",
            "(,)",
            "",
        ] {
            assert!(!is_common(text, 10), "{text}");
        }
        assert!(is_common("(1, 2, 3)", 3) && !is_common("(1, 2, 3)", 2));
        assert!(!is_common(&"(".repeat(1 << 20), 1));
        let nested = |depth: usize| format!("{}1{}", "X([".repeat(depth / 2), "])".repeat(depth / 2));
        assert!(is_common(&nested(DEEPEST), 1) && is_ron(&nested(DEEPEST)));
        assert!(!is_common(&nested(DEEPEST + 2), 1));
    }

    /// Whatever is taken for the most common notation is valid RON: texts that are put together at random.
    #[test]
    fn common_notation_is_ron() {
        let parts = [
            "(", ")", "[", "]", "{", "}", ",", ":", "\"", "a", "Some", "r", "1", "-", ".", "0", "e", " ",
            "//", "\n", "/*", "*/", "\\", "#", "'", "_", "+", "ä", "b", "true", "false", "()", "None", "inf",
            "a: 1", "\"k\": 2", "x: (", "y: [", "M(",
        ];
        let (mut random, mut known) = (Random(2), 0);
        for _ in 0..200_000 {
            let count = 1 + (9.0 * random.unit()) as usize;
            let part = |random: &mut Random| parts[(random.unit() * parts.len() as f64) as usize];
            let text: String = (0..count).map(|_| part(&mut random)).collect();
            let text = format!("({text})");
            if is_common(&text, 100) {
                known += 1;
                assert!(is_ron(&text), "{text:?}");
                assert!(entries(&text).is_some(), "{text:?}");
            }
        }
        assert!(known > 300, "{known}");
    }

    #[test]
    fn entries_have_names_and_texts() {
        let text = "( a: 1 , // one, )\n b: (2, [\")\"]),\nc: { \"x:\": Y(z: 1) } )";
        let expected = [(Some("a"), "1"), (Some("b"), "(2, [\")\"])"), (Some("c"), "{ \"x:\": Y(z: 1) }")];
        assert_eq!(entries(text).as_deref(), Some(&expected[..]));
        assert_eq!(entries("{ \"x:\": Y(z: 1), }").as_deref(), Some(&[(Some("\"x:\""), "Y(z: 1)")][..]));
        assert_eq!(entries("[(0, 1), A]").as_deref(), Some(&[(None, "(0, 1)"), (None, "A")][..]));
        assert_eq!(entries("()").as_deref(), Some(&[][..]));
        assert_eq!(trimmed(" // (\n X(a: \"(\") // )\n"), Some("X(a: \"(\")"));
        assert_eq!(trimmed("-1.5"), Some("-1.5"));
    }
}
