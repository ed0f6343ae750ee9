//! Finds values in the text of a sequence file, by the names that lead to them.
//!
//! The reader of sequences keeps no places, because it expands templates and copies. This scanner knows brackets,
//! texts and comments only, so it also works in files that are being written.

use std::ops::Range;

/// The bytes of the value to which `names` lead from the outermost bracket: `["lights", "sun", "intensity"]`.
pub fn find(text: &str, names: &[&str]) -> Option<Range<usize>> {
    let mut scanner = Scanner { text: text.as_bytes(), at: 0 };
    scanner.blanks();
    let mut value = scanner.value()?;
    for name in names {
        value = entry(text, value, name)?;
    }
    Some(value)
}

/// The place behind the last entry of a value with brackets, and whether a comma is missing before a new one. None for
/// other values.
pub fn end_of_entries(text: &str, value: Range<usize>) -> Option<(usize, bool)> {
    let mut scanner = opened(text, &value)?;
    let (mut end, mut comma) = (scanner.at, true);
    loop {
        scanner.blanks();
        match scanner.peek()? {
            b')' | b']' | b'}' => return Some((end, !comma)),
            b',' => {
                scanner.at += 1;
                (end, comma) = (scanner.at, true);
            }
            b':' => scanner.at += 1,
            _ => {
                (end, comma) = (scanner.value()?.end, false);
            }
        }
    }
}

/// The line of a byte, counted from 1.
pub fn line_of(text: &str, at: usize) -> usize {
    text.as_bytes()[..at.min(text.len())].iter().filter(|byte| **byte == b'\n').count() + 1
}

/// The entry of a value with brackets that has this name or key.
fn entry(text: &str, value: Range<usize>, name: &str) -> Option<Range<usize>> {
    let mut scanner = opened(text, &value)?;
    loop {
        scanner.blanks();
        match scanner.peek()? {
            b')' | b']' | b'}' => return None,
            b',' => {
                scanner.at += 1;
                continue;
            }
            _ => {}
        }
        let key = scanner.value()?;
        scanner.blanks();
        if scanner.peek() != Some(b':') {
            continue;
        }
        scanner.at += 1;
        scanner.blanks();
        let value = scanner.value()?;
        let key = &text[key];
        if key == name || key.strip_prefix('"').and_then(|key| key.strip_suffix('"')) == Some(name) {
            return Some(value);
        }
    }
}

/// A scanner behind the opening bracket of a value: `(`, `[`, `{`, or a name and its bracket.
fn opened<'s>(text: &'s str, value: &Range<usize>) -> Option<Scanner<'s>> {
    let mut scanner = Scanner { text: text.get(..value.end)?.as_bytes(), at: value.start };
    scanner.word();
    scanner.blanks();
    matches!(scanner.peek()?, b'(' | b'[' | b'{').then(|| scanner.at += 1)?;
    Some(scanner)
}

struct Scanner<'s> {
    text: &'s [u8],
    at: usize,
}

impl Scanner<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    fn starts(&self, with: &[u8]) -> bool {
        self.text[self.at.min(self.text.len())..].starts_with(with)
    }

    /// Skips blanks and comments, which may be nested.
    fn blanks(&mut self) {
        loop {
            if self.peek().is_some_and(|byte| byte.is_ascii_whitespace()) {
                self.at += 1;
            } else if self.starts(b"//") {
                while self.peek().is_some_and(|byte| byte != b'\n') {
                    self.at += 1;
                }
            } else if self.starts(b"/*") {
                let mut depth = 0;
                while self.at < self.text.len() {
                    if self.starts(b"/*") {
                        (depth, self.at) = (depth + 1, self.at + 2);
                    } else if self.starts(b"*/") {
                        (depth, self.at) = (depth - 1, self.at + 2);
                        if depth == 0 {
                            break;
                        }
                    } else {
                        self.at += 1;
                    }
                }
            } else {
                return;
            }
        }
    }

    /// Skips a name or a number.
    fn word(&mut self) {
        let is_part = |byte: u8| byte.is_ascii_alphanumeric() || b"_+-.#".contains(&byte) || byte >= 0x80;
        // A raw text begins like a name.
        while !self.is_raw_text() && self.peek().is_some_and(is_part) {
            self.at += 1;
        }
    }

    fn is_raw_text(&self) -> bool {
        let rest = &self.text[self.at.min(self.text.len())..];
        let hashes = rest.get(1..).unwrap_or_default().iter().take_while(|byte| **byte == b'#').count();
        rest.first() == Some(&b'r') && rest.get(1 + hashes) == Some(&b'"')
    }

    /// Skips a value. None at the end of the text, or if brackets do not match.
    fn value(&mut self) -> Option<Range<usize>> {
        let start = self.at;
        match self.peek()? {
            b'"' => self.quoted(b'"')?,
            b'\'' => self.quoted(b'\'')?,
            _ if self.is_raw_text() => self.raw_text()?,
            b'(' | b'[' | b'{' => self.brackets()?,
            _ => {
                self.word();
                let end = self.at;
                // The content of a name may follow.
                self.blanks();
                match self.peek() {
                    Some(b'(') if end > start => self.brackets()?,
                    _ => self.at = end,
                }
                // A byte that no value begins with.
                (self.at > start).then_some(())?;
            }
        }
        Some(start..self.at)
    }

    fn brackets(&mut self) -> Option<()> {
        let mut open = Vec::new();
        loop {
            self.blanks();
            match self.peek()? {
                byte @ (b'(' | b'[' | b'{') => {
                    open.push(byte);
                    self.at += 1;
                }
                byte @ (b')' | b']' | b'}') => {
                    let matching = matches!((open.pop()?, byte), (b'(', b')') | (b'[', b']') | (b'{', b'}'));
                    matching.then_some(())?;
                    self.at += 1;
                    if open.is_empty() {
                        return Some(());
                    }
                }
                b'"' => self.quoted(b'"')?,
                b'\'' => self.quoted(b'\'')?,
                _ if self.is_raw_text() => self.raw_text()?,
                _ => {
                    let before = self.at;
                    self.word();
                    self.at = self.at.max(before + 1);
                }
            }
        }
    }

    fn quoted(&mut self, quote: u8) -> Option<()> {
        self.at += 1;
        while self.peek()? != quote {
            self.at += if self.peek()? == b'\\' { 2 } else { 1 };
        }
        self.at += 1;
        Some(())
    }

    fn raw_text(&mut self) -> Option<()> {
        self.at += 1;
        let mut end = b"\"".to_vec();
        while self.peek()? == b'#' {
            end.push(b'#');
            self.at += 1;
        }
        self.at += 1;
        while !self.starts(&end) {
            self.peek()?;
            self.at += 1;
        }
        self.at += end.len();
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r##"// A file. "lights": none here
(
    timeline: (duration: 3, fps: 24), /* camera: /* nested */ (x: 1) */
    camera: (position: (0, 2.4, 6), path: Orbit()), // once
    lights: {
        "sun": Point(position: (60, 90, 50), color: "#fff", intensity: [(0, 1), (2, 3, Smooth)]),
        "la\"mp": Sphere (center: (1, 2, 3), note: r#"a "raw" ) text"#, radius: 2,),
    },
)"##;

    fn found(names: &[&str]) -> Option<&'static str> {
        find(TEXT, names).map(|span| &TEXT[span])
    }

    #[test]
    fn values_are_found_by_their_names() {
        assert_eq!(found(&["camera", "position"]), Some("(0, 2.4, 6)"));
        assert_eq!(found(&["camera", "path"]), Some("Orbit()"));
        assert_eq!(found(&["lights", "sun", "intensity"]), Some("[(0, 1), (2, 3, Smooth)]"));
        assert_eq!(found(&["lights", "sun", "color"]), Some("\"#fff\""));
        assert_eq!(found(&["lights", "la\\\"mp", "radius"]), Some("2"));
        assert_eq!(found(&["timeline", "fps"]), Some("24"));
        for names in [&["objects"][..], &["camera", "x"], &["lights", "moon"], &["timeline", "fps", "a"]] {
            assert_eq!(found(names), None);
        }
        let lamp = find(TEXT, &["lights", "sun"]).expect("a light").start;
        assert_eq!(line_of(TEXT, lamp), 6);
    }

    #[test]
    fn new_entries_have_a_place() {
        let end = |names: &[&str]| end_of_entries(TEXT, find(TEXT, names).expect("a value"));
        let (at, comma) = end(&["camera"]).expect("brackets");
        assert_eq!((&TEXT[..at].ends_with("path: Orbit()"), comma), (&true, true));
        let (at, comma) = end(&["lights", "la\\\"mp"]).expect("brackets");
        assert_eq!((&TEXT[..at].ends_with("radius: 2,"), comma), (&true, false));
        assert_eq!(end(&["timeline", "fps"]), None);
    }

    #[test]
    fn broken_texts_give_nothing() {
        for text in
            ["", "(", "(a: [1, 2)", "(a: \"", "(a: r#\"x\")", "(a /* b", "(((", "(a: ,)", "\u{e4}(", ")"]
        {
            for names in [&["a"][..], &["a", "b"]] {
                let _ = find(text, names);
            }
        }
        // Every cut of a file.
        for end in (0..TEXT.len()).filter(|end| TEXT.is_char_boundary(*end)) {
            let _ = find(&TEXT[..end], &["lights", "sun", "intensity"]);
        }
    }
}
