//! Escapes text from outside so that it is safe to display: names of files, names in sequences and parts of their
//! source. Control characters could control a terminal, and format characters change the display of the text around
//! them.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::fmt::Write;

/// The ranges of format characters (general category Cf of Unicode 17), in ascending order: bidirectional controls,
/// zero-width and tag characters, and others that are not displayed themselves.
const FORMAT: [(char, char); 21] = [
    ('\u{ad}', '\u{ad}'),
    ('\u{600}', '\u{605}'),
    ('\u{61c}', '\u{61c}'),
    ('\u{6dd}', '\u{6dd}'),
    ('\u{70f}', '\u{70f}'),
    ('\u{890}', '\u{891}'),
    ('\u{8e2}', '\u{8e2}'),
    ('\u{180e}', '\u{180e}'),
    ('\u{200b}', '\u{200f}'),
    ('\u{202a}', '\u{202e}'),
    ('\u{2060}', '\u{2064}'),
    ('\u{2066}', '\u{206f}'),
    ('\u{feff}', '\u{feff}'),
    ('\u{fff9}', '\u{fffb}'),
    ('\u{110bd}', '\u{110bd}'),
    ('\u{110cd}', '\u{110cd}'),
    ('\u{13430}', '\u{1343f}'),
    ('\u{1bca0}', '\u{1bca3}'),
    ('\u{1d173}', '\u{1d17a}'),
    ('\u{e0001}', '\u{e0001}'),
    ('\u{e0020}', '\u{e007f}'),
];

/// Whether a character must be escaped for a terminal: a control character (C0, DEL and C1), a separator of lines or
/// paragraphs, or a format character.
pub fn must_escape(c: char) -> bool {
    let format = || {
        let place = FORMAT.partition_point(|(_, last)| *last < c);
        FORMAT.get(place).is_some_and(|(first, _)| *first <= c)
    };
    c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') || (c >= '\u{ad}' && format())
}

/// Text for one line of a message. Every such character, also a line break, is written like `\u{9b}`.
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, must_escape)
}

/// Text of several lines: like [`line`], but line breaks stay.
pub fn lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| c != '\n' && must_escape(c))
}

fn escaped(text: &str, must: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&must) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match must(c) {
            true => escaped.extend(c.escape_unicode()),
            false => escaped.push(c),
        }
    }
    Cow::Owned(escaped)
}

/// A path for one line of a message. Bytes that are not valid UTF-8 are written like `\xff`.
pub fn path(path: impl AsRef<OsStr>) -> String {
    let mut escaped = String::new();
    for chunk in path.as_ref().as_encoded_bytes().utf8_chunks() {
        escaped += &line(chunk.valid());
        for byte in chunk.invalid() {
            // Writing to a string cannot fail.
            let _ = write!(escaped, r"\x{byte:02x}");
        }
    }
    escaped
}

/// A double-quoted string for TOML and YAML. Characters that are not allowed there, or that could control a terminal,
/// are escaped.
pub fn quoted(text: &str) -> String {
    in_quotes(text, |quoted, c| {
        // Writing to a string cannot fail.
        let _ = write!(quoted, "\\U{:08x}", u32::from(c));
    })
}

/// A double-quoted string for JSON, whose escapes have 16 bits.
pub fn json(text: &str) -> String {
    in_quotes(text, |quoted, c| {
        for unit in c.encode_utf16(&mut [0; 2]) {
            let _ = write!(quoted, "\\u{unit:04x}");
        }
    })
}

/// `write_long` writes the escape of a character above U+FFFF.
fn in_quotes(text: &str, write_long: impl Fn(&mut String, char)) -> String {
    let mut quoted = String::with_capacity(text.len() + 2);
    quoted.push('"');
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            c if c > '\u{ffff}' && must_escape(c) => write_long(&mut quoted, c),
            c if must_escape(c) => {
                let _ = write!(quoted, "\\u{:04x}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_are_escaped() {
        for quoted in [quoted, json] {
            assert_eq!(quoted("a\"b\\c/ü→"), r#""a\"b\\c/ü→""#);
            assert_eq!(quoted("\n\t\r\x00\x1f\x7f"), r#""\n\t\u000d\u0000\u001f\u007f""#);
            assert_eq!(quoted("\u{85}\u{9b}\u{202e}\u{2028}"), r#""\u0085\u009b\u202e\u2028""#);
        }
        assert_eq!(quoted("\u{e0041}"), r#""\U000e0041""#);
        assert_eq!(json("\u{e0041}"), r#""\udb40\udc41""#);
    }

    #[test]
    fn control_characters_are_shown_as_numbers() {
        assert_eq!(
            line("a\x1b[31m\u{9b}2J\n\u{202e}\u{2069}\r"),
            r"a\u{1b}[31m\u{9b}2J\u{a}\u{202e}\u{2069}\u{d}"
        );
        assert_eq!(lines("a\nb\tc\u{85}"), "a\nb\\u{9}c\\u{85}");
        let plain = "Zwölf ☕ 图像 🎬, e\u{301}\u{a0}\u{3000}…";
        assert!(matches!(line(plain), Cow::Borrowed(text) if text == plain));
    }

    #[test]
    fn all_of_their_kinds_are_escaped_and_no_others() {
        let found: Vec<char> = ('\0'..=char::MAX).filter(|c| must_escape(*c)).collect();
        // C0 and DEL, C1, separators, and the 170 characters of category Cf.
        assert_eq!(found.len(), 33 + 32 + 2 + 170);
        // The standard library does not print any of them either.
        assert!(found.iter().all(|c| c.escape_debug().len() > 1));
        assert!(FORMAT.is_sorted() && FORMAT.iter().all(|(first, last)| first <= last));
    }

    #[cfg(unix)]
    #[test]
    fn invalid_utf8_is_shown_as_bytes() {
        use std::os::unix::ffi::OsStrExt;
        assert_eq!(path(OsStr::from_bytes(b"a\xff/\xc2\x9b\xe2\x82")), r"a\xff/\u{9b}\xe2\x82");
    }
}
