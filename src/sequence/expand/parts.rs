//! Splits the text of a value into copies and expressions.

use super::super::fault::Fault;
use super::super::symbols::{Symbols, token};
use super::expression::{self, Expression};
use super::writer::Fragment;
use std::ops::Range;
use std::rc::Rc;

/// A part of an expanded text. Places are bytes of all sources.
#[derive(Debug)]
pub enum Part<'s> {
    /// A part of a source, and its first byte.
    Copy(&'s str, usize),
    /// The value of the expression at this place.
    Value(Expression, Range<usize>),
    /// A text that was made because of this place.
    Made(String, Range<usize>),
    /// A part of a named value, which is used at this place.
    Slice(Rc<Fragment>, Range<usize>, Range<usize>),
    /// An expression with a fault, which has been reported.
    Faulty,
}

/// Whether a value is an expression: a text that begins with `"=`. Raw texts, `r"= 5"`, are not.
pub fn is_expression(text: &str) -> bool {
    text.starts_with("\"=")
}

/// The parts of a text that begins at byte `from` of all sources. Reports the faults of expressions.
pub fn parts<'s>(text: &'s str, from: usize, faults: &mut Vec<Fault>) -> Vec<Part<'s>> {
    let (mut parts, mut at) = (Vec::new(), 0);
    for Range { start, end } in expressions(text) {
        parts.push(Part::Copy(&text[at..start], from + at));
        at = end;
        match expression::parse(&text[start..end], from + start) {
            Ok(expression) => parts.push(Part::Value(expression, from + start..from + end)),
            Err(fault) => {
                faults.push(fault);
                parts.push(Part::Faulty);
            }
        }
    }
    parts.push(Part::Copy(&text[at..], from + at));
    parts.retain(|part| !matches!(part, Part::Copy("", _)));
    parts
}

/// Whether a text has any expression.
pub fn has_expressions(text: &str) -> bool {
    !expressions(text).is_empty()
}

/// The places of the expressions in a text. Names of maps are none.
fn expressions(text: &str) -> Vec<Range<usize>> {
    if !text.contains("\"=") {
        return Vec::new();
    }
    let (mut found, mut last) = (Vec::new(), None);
    for (at, c) in Symbols::new(text) {
        found.extend(last.take().filter(|_| c != ':'));
        if c == '"' && is_expression(&text[at..]) {
            last = Some(token(text, at));
        }
    }
    found.extend(last);
    found
}

/// A text between two entries without the comma that separates them: what is before and behind it.
pub fn without_comma(gap: &str) -> (&str, &str) {
    let comma = Symbols::new(gap).find(|(_, c)| *c == ',');
    comma.map_or((gap, ""), |(at, _)| (&gap[..at], &gap[at + 1..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_are_texts_with_an_equals_sign() {
        let text = "(a: \"=1\", // \"=2\"\n b: \"x=3\", c: r\"=4\", d: { \"=5\": \"=6\" }, e: [\"=7\"])";
        let found: Vec<_> = expressions(text).into_iter().map(|place| &text[place]).collect();
        assert_eq!(found, ["\"=1\"", "\"=6\"", "\"=7\""]);
        assert_eq!(expressions("\"=1\"").len(), 1);
    }

    #[test]
    fn the_comma_between_entries_is_found() {
        assert_eq!(without_comma(" // a, b\n , // c, d\n"), (" // a, b\n ", " // c, d\n"));
        assert_eq!(without_comma("\n"), ("\n", ""));
    }
}
