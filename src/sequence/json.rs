//! JSON as a second notation of sequences.
//!
//! JSON is almost a part of RON's syntax: only escapes in texts differ. So a JSON file is read as RON, value by value,
//! and each decoder takes the form that it needs:
//!
//! | RON | JSON |
//! |---|---|
//! | `(radius: 2)`, `{ "ball": ... }` | `{"radius": 2}`, `{"ball": ...}` |
//! | `(1, 2, 3)`, `[a, b]` | `[1, 2, 3]`, `[a, b]` |
//! | `Sphere(radius: 2)`, `Mesh("a.obj")`, `Bezier(0, 0, 1, 1)` | `{"Sphere": {"radius": 2}}`, `{"Mesh": "a.obj"}`, `{"Bezier": [0, 0, 1, 1]}` |
//! | `Smooth` | `"Smooth"`, or `{"Smooth": []}` where a text could stand, too |

use super::expand;
use super::fault::Fault;
use super::node::Node;
use super::symbols::Symbols;
use serde::de::IgnoredAny;
use std::borrow::Cow;
use std::path::Path;

/// The field of a document that says where its schema is.
pub const SCHEMA: &str = "$schema";

/// Whether a file is in JSON: its name ends with `.json`.
pub fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

/// The text of a JSON file as RON: the same values at the same lines. Only escapes that RON lacks differ.
///
/// # Errors
/// The first fault of the syntax, at its place in `text`.
pub fn as_ron(text: &str) -> Result<Cow<'_, str>, Fault> {
    if let Err(error) = serde_json::from_str::<IgnoredAny>(text) {
        return Err(syntax_fault(text, &error));
    }
    if !text.contains('\\') {
        return Ok(Cow::Borrowed(text));
    }
    let (mut ron, mut rest) = (String::with_capacity(text.len()), text);
    // Escapes are in texts only.
    while let Some(at) = rest.find('\\') {
        ron.push_str(&rest[..at]);
        let (character, len) = escaped(&rest[at..]);
        match character {
            '"' => ron.push_str("\\\""),
            '\\' => ron.push_str("\\\\"),
            control if control.is_control() => ron.extend(control.escape_unicode()),
            plain => ron.push(plain),
        }
        rest = rest.get(at + len..).unwrap_or_default();
    }
    ron.push_str(rest);
    Ok(Cow::Owned(ron))
}

/// The character that an escape at the start of a text stands for, and the bytes of the escape. Surrogates in pairs are
/// one escape; the check before this has refused lone ones.
fn escaped(text: &str) -> (char, usize) {
    let unit = |at: usize| text.get(at..at + 4).and_then(|digits| u16::from_str_radix(digits, 16).ok());
    match text.as_bytes().get(1) {
        Some(b'u') => {
            let units = [unit(2), unit(8)].into_iter().flatten();
            let first = char::decode_utf16(units).next().and_then(Result::ok).unwrap_or('\u{fffd}');
            (first, if first.len_utf16() == 2 { 12 } else { 6 })
        }
        Some(b'b') => ('\u{8}', 2),
        Some(b'f') => ('\u{c}', 2),
        Some(b'n') => ('\n', 2),
        Some(b'r') => ('\r', 2),
        Some(b't') => ('\t', 2),
        Some(byte) => (char::from(*byte), 2),
        None => ('\\', 1),
    }
}

/// serde_json's error, at its place.
fn syntax_fault(text: &str, error: &serde_json::Error) -> Fault {
    let line: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
    // Its columns count bytes; the last one that was read is the wrong one.
    let mut at = (line + error.column().saturating_sub(1)).min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    let len = text[at..].chars().next().map_or(0, char::len_utf8);
    let message = error.to_string();
    let reason = message.split(" at line ").next().unwrap_or_default().to_owned();
    let help = "a file whose name ends with .json is read as JSON: no comments, and names in double quotes";
    Fault::new(at..at + len, "this is no JSON", reason).help(help)
}

/// Reports a file that is no object, and what only RON has: the parts of a sequence that stand for others. `"= ..."` is
/// no expression in JSON, so that a text may begin with it.
pub fn check(root: Node<'_>) {
    let Some(entries) = root.map() else {
        let help = "a sequence looks like {\"timeline\": {\"frames\": 48}, \"objects\": {\"ball\": {\"shape\": \"Sphere\"}}}";
        root.fault(root.mismatch("an object {\"name\": value, ...}").help(help));
        return;
    };
    for (key, value) in entries {
        let field = name(key.text());
        if expand::OWN_FIELDS.contains(&field) {
            root.fault(unsupported(key.span(), format!("`{field}` needs RON")));
        }
        if !["objects", "lights"].contains(&field) {
            continue;
        }
        for (_, value) in value.map().unwrap_or_default() {
            if value.word() == expand::REPEAT {
                root.fault(unsupported(value.head(), "`Repeat` needs RON".to_owned()));
            }
            let fields = value.map().unwrap_or_default();
            if let Some((key, _)) = fields.iter().find(|(key, _)| name(key.text()) == expand::TEMPLATE) {
                root.fault(unsupported(key.span(), "`template` needs RON".to_owned()));
            }
        }
    }
}

fn unsupported(span: std::ops::Range<usize>, title: String) -> Fault {
    let help = "`kinora convert` turns a RON file that has them into a plain JSON file";
    Fault::new(span, title, "JSON files have plain values only").help(help)
}

/// A name without its quotes.
pub fn name(key: &str) -> &str {
    key.strip_prefix('"').and_then(|key| key.strip_suffix('"')).unwrap_or(key)
}

/// Whether a text looks like a word of RON.
pub fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c == '_' || c.is_alphabetic())
        && text.chars().all(|c| c == '_' || c.is_alphanumeric())
}

/// The word and the rest of an object that stands for `Word(rest)`: its only name begins with a capital letter. The
/// rest is empty if it has no entries.
pub fn leading_word(text: &str) -> Option<(&str, &str)> {
    let inner = text.strip_prefix('{')?.trim_start().strip_prefix('"')?;
    if !inner.starts_with(|c: char| c.is_ascii_uppercase()) {
        return None;
    }
    let (word, rest) = inner.split_at(inner.find('"')?);
    let body = rest[1..].trim_start().strip_prefix(':')?.trim_start();
    let end = end_of_value(body)?;
    let (body, rest) = body.split_at(end);
    let is_only = rest.trim_start() == "}";
    let is_empty =
        body.len() >= 2 && body.starts_with(['[', '{']) && body[1..body.len() - 1].trim().is_empty();
    (is_only && is_word(word)).then_some((word, if is_empty { "" } else { body }))
}

/// The length of the value at the start of a text.
fn end_of_value(text: &str) -> Option<usize> {
    let mut depth = 0;
    for (at, c) in Symbols::new(text) {
        match c {
            '{' | '[' => depth += 1,
            '}' | ']' if depth == 0 => return Some(text[..at].trim_end().len()),
            '}' | ']' => {
                depth -= 1;
                if depth == 0 {
                    return Some(at + 1);
                }
            }
            ',' if depth == 0 => return Some(text[..at].trim_end().len()),
            _ => {}
        }
    }
    None
}

/// Whether an array without a decoder that asks for a list or a tuple is a tuple: a tuple begins with a plain value, as
/// a vector or a key does, and a list of keys or colours holds brackets or texts.
pub fn is_tuple(items: &[Node<'_>]) -> bool {
    items.iter().any(|item| !item.text().starts_with(['{', '[', '"'])) || items.is_empty()
}
