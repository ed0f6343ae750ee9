//! Faults of the notation itself, in words: ron finds them, brackets and quotes are looked at once more.

use super::fault::Fault;
use super::symbols::{Symbols, token};
use ron::error::{Error, Position};
use serde::de::{Deserialize, IgnoredAny};
use std::ops::Range;

/// What keeps the text from being RON. Empty if it is.
pub fn faults(text: &str) -> Vec<Fault> {
    if let Some((at, '#')) = Symbols::new(text).next() {
        let title = "`#` starts neither a comment nor anything else here";
        let help = "comments start with //; attributes such as `#![enable(...)]` are not supported";
        return vec![Fault::new(at..at + 1, title, "remove this").help(help)];
    }
    if Symbols::new(text).next().is_none() && unclosed(text).is_none() {
        let help = "the shortest sequence is `()`; see sequences/README.md for what goes inside";
        return vec![Fault::new(0..0, "the file is empty", "expected ( ... )").help(help)];
    }
    let Err((error, position)) = check(text) else { return Vec::new() };
    if let Some(fault) = unclosed(text) {
        return vec![fault];
    }
    let notation = translated(text, &error, offset(text, position));
    let (bracket, opened) = unbalanced(text).unzip();
    // What goes wrong inside a bracket that is not closed follows from that.
    let notation = notation.filter(|fault| opened.is_none_or(|opened| fault.span.start < opened));
    if bracket.is_none() && notation.is_none() {
        let end = text.trim_end().len();
        return vec![Fault::new(end..end, "the file ends too early", "expected more here")];
    }
    [notation, bracket].into_iter().flatten().collect()
}

/// Reads through the text without keeping anything.
fn check(text: &str) -> Result<(), (Error, Position)> {
    let mut reader = ron::Deserializer::from_str(text).map_err(|error| (error.code, error.span.end))?;
    let result = IgnoredAny::deserialize(&mut reader).and_then(|_| reader.end());
    result.map_err(|error| {
        let spanned = reader.span_error(error);
        (spanned.code, spanned.span.end)
    })
}

/// The byte of a position, which counts lines and characters from 1.
fn offset(text: &str, position: Position) -> usize {
    let line = match position.line {
        0 | 1 => 0,
        n => text.match_indices('\n').nth(n - 2).map_or(text.len(), |(newline, _)| newline + 1),
    };
    let column = position.col.saturating_sub(1);
    text[line..].char_indices().nth(column).map_or(text.len(), |(at, _)| line + at)
}

/// A text or comment without an end.
fn unclosed(text: &str) -> Option<Fault> {
    let mut symbols = Symbols::new(text);
    symbols.by_ref().for_each(drop);
    let (start, kind) = symbols.unclosed?;
    let (span, end) = if kind == "text" { (start..start + 1, "\"") } else { (start..start + 2, "*/") };
    Some(Fault::new(span, format!("this {kind} has no end"), format!("needs a closing `{end}`")))
}

/// The first bracket that has no partner or a wrong one, and where the unclosed one opens.
fn unbalanced(text: &str) -> Option<(Fault, usize)> {
    let mut open: Vec<(usize, char)> = Vec::new();
    for (at, c) in Symbols::new(text) {
        match c {
            '(' => open.push((at, ')')),
            '[' => open.push((at, ']')),
            '{' => open.push((at, '}')),
            ')' | ']' | '}' => match open.pop() {
                Some((_, expected)) if expected == c => {}
                Some((start, expected)) => {
                    let title = format!("`{c}` does not match the bracket that is open");
                    let label = format!("expected `{expected}`; a bracket is missing, or one too many");
                    let fault = Fault::new(at..at + 1, title, label);
                    return Some((fault.also(start..start + 1, "opened here"), start));
                }
                None => {
                    let label = "closes nothing";
                    return Some((
                        Fault::new(at..at + 1, format!("`{c}` without an opening bracket"), label),
                        at,
                    ));
                }
            },
            _ => {}
        }
    }
    let (start, expected) = open.pop()?;
    let fault = Fault::new(start..start + 1, "this bracket is never closed", format!("needs a `{expected}`"));
    Some((fault, start))
}

/// ron's error in words, at the place it is about. None if a missing bracket says it better.
fn translated(text: &str, error: &Error, at: usize) -> Option<Fault> {
    let here = token(text, at);
    let found = text[here.clone()].to_owned();
    let fault = |title: &str, label: &str| Some(Fault::new(here.clone(), title, label));
    match error {
        Error::Eof => None,
        Error::ExceededRecursionLimit => fault(
            "this is nested too deeply",
            "brackets may stand about 60 deep, those of nested patterns too",
        ),
        Error::TrailingCharacters => {
            fault("the file goes on after its closing bracket", "nothing may follow")
        }
        Error::ExpectedIdentifier | Error::InvalidIdentifier(_) | Error::SuggestRawIdentifier(_) => {
            fault("expected a field's name", "fields are written `name: value`")
        }
        Error::InvalidEscape(_) => {
            let start = text[..at].rfind('\\').unwrap_or(here.start);
            let title = "this text has a wrong escape";
            let fault = Fault::new(start..at.max(start), title, "\\ stands for a special character");
            Some(fault.help("in paths write / instead of \\"))
        }
        Error::IntegerOutOfBounds
        | Error::InvalidIntegerDigit { .. }
        | Error::UnderscoreAtBeginning
        | Error::FloatUnderscore
        | Error::ExpectedFloat
        | Error::ExpectedInteger => fault("this is not a number", "write numbers like 2, -0.5 or 1.5e-3"),
        _ if found == "=" => fault("a value follows `:`, not `=`", "write `:` here"),
        _ if found == ";" => fault("values are separated by commas", "write `,` here"),
        Error::ExpectedMapColon => {
            fault("expected `:` between a name and its value", "a `:` belongs before this")
        }
        Error::ExpectedComma => Some(missing_comma(text, here, &found)),
        Error::UnexpectedChar(_) => {
            let title = format!("`{}` is not understood here", super::suggest::shortened(&found));
            Some(Fault::new(here, title, "expected a value").help(if found == "#" {
                "colours go in quotes: \"#ff8800\""
            } else {
                "values are numbers, true, false, text in quotes, (fields), [lists] and { \"name\": ... }"
            }))
        }
        Error::ExpectedChar => {
            let start = text[..at].rfind('\'').unwrap_or(here.start);
            let title = "text goes in double quotes";
            Some(Fault::new(start..at.max(start + 1), title, "write \" instead of '"))
        }
        _ => Some(Fault::new(here, "the notation is wrong here", error.to_string())),
    }
}

/// Two values side by side: the comma belongs behind the first.
fn missing_comma(text: &str, here: Range<usize>, found: &str) -> Fault {
    if found == ":" {
        let help = "in ( ) every field has a name; in { } names are in quotes; in [ ] there are none";
        return Fault::new(here, "`:` is out of place", "not expected here").help(help);
    }
    let before = Symbols::new(&text[..here.start]).last().map_or(0, |(start, _)| token(text, start).end);
    let last = text[..before].chars().next_back().map_or(0, char::len_utf8);
    let fault = Fault::new(before - last..before, "a comma is missing", "expected `,` after this");
    fault.also(here, "before this")
}
