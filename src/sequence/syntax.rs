//! Explains syntax errors. ron finds them; this module checks brackets and quotes again for better messages.

use super::fault::Fault;
use super::outline;
use super::symbols::{Symbols, token};
use ron::error::{Error, Position};
use serde::de::{Deserialize, IgnoredAny};
use std::ops::Range;

/// Maximum number of entries of one list, map or struct.
pub const MAX_ENTRIES: usize = 1_000_000;

/// Whether a text is in the most common notation, and its syntax errors.
pub fn checked(text: &str) -> (bool, Vec<Fault>) {
    let is_common = outline::is_common(text, MAX_ENTRIES);
    (is_common, if is_common { Vec::new() } else { faults(text) })
}

/// The syntax errors of a text. Empty if it is valid RON.
pub fn faults(text: &str) -> Vec<Fault> {
    if let Some((at, '#')) = Symbols::new(text).next() {
        if let Some(fault) = other_notation(text, true) {
            return vec![fault];
        }
        let title = "`#` starts neither a comment nor anything else here";
        let help = "comments start with //; attributes such as `#![enable(...)]` are not supported";
        return vec![Fault::new(at..at + 1, title, "remove this").help(help)];
    }
    if Symbols::new(text).next().is_none() && unclosed(text).is_none() {
        let help = "the shortest sequence is `()`; see sequences/README.md for what goes inside";
        return vec![Fault::new(0..0, "the file is empty", "expected ( ... )").help(help)];
    }
    // Before ron parses them, which is slow.
    if let Some(fault) = overfull(text, MAX_ENTRIES) {
        return vec![fault];
    }
    let Err((error, position)) = check(text) else { return Vec::new() };
    if let Some(fault) = other_notation(text, matches!(error, Error::TrailingCharacters)) {
        return vec![fault];
    }
    if let Some(fault) = unclosed(text) {
        return vec![fault];
    }
    let notation = translated(text, &error, offset(text, position));
    let (bracket, opened) = unbalanced(text).unzip();
    // Errors inside an unclosed bracket are caused by that bracket.
    let notation = notation.filter(|fault| opened.is_none_or(|opened| fault.span.start < opened));
    if bracket.is_none() && notation.is_none() {
        let end = text.trim_end().len();
        return vec![Fault::new(end..end, "the file ends too early", "expected more here")];
    }
    [notation, bracket].into_iter().flatten().collect()
}

/// Detects other notations, such as YAML, TOML or source code. RON begins and ends with a bracket. `trailing` is true
/// if text follows the first value.
fn other_notation(text: &str, trailing: bool) -> Option<Fault> {
    // Comments in many notations.
    let is_comment = |line: &&str| line.trim().is_empty() || line.trim_start().starts_with('#');
    let skipped: usize = text.split_inclusive('\n').take_while(is_comment).map(str::len).sum();
    let mut symbols = Symbols::new(&text[skipped..]);
    let (start, first) = symbols.next()?;
    let start = skipped + start;
    // `Sequence(...)` is accepted here if nothing follows; a better message comes later.
    let opens = first.is_alphabetic() && symbols.next().is_some_and(|(_, next)| next == '(');
    if matches!(first, '(' | '{') || opens && !trailing {
        return None;
    }
    let fault = Fault::new(token(text, start), "this is no sequence in RON", "a sequence begins with `(`");
    Some(fault.help(EXAMPLE))
}

/// An example of a sequence, for messages.
pub const EXAMPLE: &str = "a sequence looks like (timeline: (frames: 48), objects: { \"ball\": (shape: Sphere()) }); \
                           sequences/README.md explains it";

/// Maximum depth of brackets whose entries are counted; far more than ron accepts.
const DEEPEST: usize = 1000;

/// An open bracket, and the number of its entries.
struct OpenBracket {
    start: usize,
    entries: usize,
    /// Whether the next symbol begins an entry.
    begins: bool,
}

/// The first bracket with more than `most` entries.
fn overfull(text: &str, most: usize) -> Option<Fault> {
    let mut open: Vec<OpenBracket> = Vec::new();
    for (at, c) in Symbols::new(text) {
        if matches!(c, ')' | ']' | '}') {
            open.pop();
            continue;
        }
        if let Some(inner) = open.last_mut() {
            inner.entries += usize::from(inner.begins && c != ',');
            inner.begins = c == ',';
            if inner.entries > most {
                let title = format!("more than {most} entries");
                return Some(Fault::new(inner.start..inner.start + 1, title, "too many"));
            }
        }
        if matches!(c, '(' | '[' | '{') {
            open.push(OpenBracket { start: at, entries: 0, begins: true });
        }
        if open.len() > DEEPEST {
            return None;
        }
    }
    None
}

/// Parses the text without keeping anything.
fn check(text: &str) -> Result<(), (Error, Position)> {
    let mut reader = ron::Deserializer::from_str(text).map_err(|error| (error.code, error.span.end))?;
    let result = IgnoredAny::deserialize(&mut reader).and_then(|_| reader.end());
    result.map_err(|error| {
        let spanned = reader.span_error(error);
        (spanned.code, spanned.span.end)
    })
}

/// The byte at a position. Positions count lines and characters from 1.
fn offset(text: &str, position: Position) -> usize {
    let line = match position.line {
        0 | 1 => 0,
        n => text.match_indices('\n').nth(n - 2).map_or(text.len(), |(newline, _)| newline + 1),
    };
    let column = position.col.saturating_sub(1);
    text[line..].char_indices().nth(column).map_or(text.len(), |(at, _)| line + at)
}

/// Finds a text or comment without an end.
fn unclosed(text: &str) -> Option<Fault> {
    let mut symbols = Symbols::new(text);
    symbols.by_ref().for_each(drop);
    let (mut start, kind) = symbols.unclosed?;
    if kind == "text" {
        // A missing quote swaps what is inside and outside of all texts behind it, up to the end of the file. Texts
        // rarely continue on the next line, so the first that does lacks its quote.
        start = symbols.first_long_text.unwrap_or(start);
    }
    let (span, end) = if kind == "text" { (start..start + 1, "\"") } else { (start..start + 2, "*/") };
    Some(Fault::new(span, format!("this {kind} has no end"), format!("needs a closing `{end}`")))
}

/// The first bracket without a matching partner, and the place where the unclosed bracket opens.
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

/// Explains ron's error at its place. None if a missing bracket explains it better.
fn translated(text: &str, error: &Error, at: usize) -> Option<Fault> {
    let here = token(text, at);
    let found = text[here.clone()].to_owned();
    let fault = |title: &str, label: &str| Some(Fault::new(here.clone(), title, label));
    match error {
        Error::Eof => None,
        Error::ExceededRecursionLimit => fault(
            "this is nested too deeply",
            "nest brackets about 60 deep at most, including nested patterns",
        ),
        Error::TrailingCharacters => {
            fault("there is text after the closing bracket of the file", "nothing may follow")
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

/// Two adjacent values: the comma is missing behind the first.
fn missing_comma(text: &str, here: Range<usize>, found: &str) -> Fault {
    if found == "%" {
        return percent(text, here);
    }
    if found == ":" {
        let help = "in ( ) every field has a name; in { } names are in quotes; in [ ] there are none";
        return Fault::new(here, "`:` is out of place", "not expected here").help(help);
    }
    let before = Symbols::new(&text[..here.start]).last().map_or(0, |(start, _)| token(text, start).end);
    let last = text[..before].chars().next_back().map_or(0, char::len_utf8);
    let fault = Fault::new(before - last..before, "a comma is missing", "expected `,` after this");
    fault.also(here, "before this")
}

/// A percentage, which must be written as a number.
fn percent(text: &str, here: Range<usize>) -> Fault {
    let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '_' | '+' | '-');
    let number = text[..here.start].trim_end();
    let start = number.trim_end_matches(is_part).len();
    let label = plain_number(&number[start..])
        .unwrap_or_else(|| "write a share as a number: 0.01 for 1 %".to_owned());
    Fault::new(start..here.end, "shares are written as plain numbers, without `%`", label)
}

/// The number to write instead of a percentage, if it is short enough. A whole percentage may also be meant as a plain
/// number.
fn plain_number(percent: &str) -> Option<String> {
    /// Maximum number of digits in a suggestion.
    const MAX_DIGITS: usize = 12;
    let percent: f64 = percent.replace('_', "").parse().ok().filter(|number: &f64| number.is_finite())?;
    // Parsed as a decimal, because a division could change digits.
    let share: f64 = format!("{percent}e-2").parse().ok()?;
    let (share, whole) = (share.to_string(), percent.to_string());
    match percent.fract() == 0.0 {
        _ if share.len() > MAX_DIGITS => None,
        true => Some(format!("write {share}, or {whole} where no share is meant")),
        false => Some(format!("write {share}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_counted_in_all_brackets_at_all_depths() {
        for text in [
            "(a: 1, b: 2, c: 3)",
            "(a: [1, 2, 3,])",
            "(a: {\"b\": X(y: (1, [2], -3.5)), })",
            "(a: { \"b\": 1, 'c': 2 /* , */, \"d,e\": [(0, 0), (0, 0), // ,\n (1,)] })",
            "[[], (), {},]",
        ] {
            assert_eq!(overfull(text, 3), None, "{text}");
            let fault = overfull(text, 2).expect(text);
            assert!("([{".contains(&text[fault.span]), "{text}");
        }
        assert_eq!(overfull(") ] , }", 0), None);
        assert_eq!(overfull(&"(".repeat(1 << 20), 1), None);
    }

    #[test]
    fn shares_in_per_cent_are_given_as_numbers() {
        let general = "write a share as a number: 0.01 for 1 %";
        for (number, label) in [
            ("0.29", "write 0.0029"),
            ("12.5", "write 0.125"),
            ("-2.5", "write -0.025"),
            ("3", "write 0.03, or 3 where no share is meant"),
            ("1e2", "write 1, or 100 where no share is meant"),
            ("1_000", "write 10, or 1000 where no share is meant"),
            ("1e400", general),
            ("0x10", general),
            ("99999999999999999999999999", general),
            ("1e-7", "write 0.000000001"),
            ("1e-30", general),
        ] {
            for blank in ["", " "] {
                let text = format!("(quality: (noise: {number}{blank}%))");
                let faults = faults(&text);
                let [fault] = &faults[..] else { panic!("{text}: {faults:?}") };
                assert_eq!(&text[fault.span.clone()], format!("{number}{blank}%"));
                let debug = format!("{fault:?}");
                assert!(debug.contains(&format!("label: {label:?}")), "{debug}");
            }
        }
    }
}
