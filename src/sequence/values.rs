//! Decodes plain values: numbers, vectors, angles, booleans, text. Each decoder reports faults and then returns None.

use super::decimal::{NotExact, exact, is_decimal};
use super::fault::Fault;
use super::node::{Node, NodeContent};
use super::schema::Ask;
use super::source_file::Form;
use super::words::word;
use crate::base::math::{Angle, DVec3, UpAxis};
use crate::base::time::Time;
use serde_json::{Value, json};
use std::ops::RangeInclusive;

/// Maximum absolute value of a number, so that squares and products do not overflow.
pub const LARGEST: f64 = 1e30;

/// Minimum length, so that squares do not underflow.
pub const SHORTEST: f64 = 1e-30;

/// Whether a value looks like a number.
pub fn is_number(node: Node<'_>) -> bool {
    let unsigned = node.text().trim_start_matches(['+', '-', '.']);
    let starts = |text: &str| unsigned.starts_with(text);
    unsigned.starts_with(|c: char| c.is_ascii_digit()) || starts("inf") || starts("NaN")
}

/// A plain decimal number of any size.
fn decimal(node: Node<'_>) -> Option<f64> {
    let text = node.text();
    if !is_decimal(text) {
        return None;
    }
    match text.contains('_') {
        true => text.replace('_', "").parse().ok(),
        false => text.parse().ok(),
    }
}

/// Notes for the schema that a plain value is accepted.
fn ask(node: Node<'_>, schema: impl FnOnce() -> Value) {
    node.ask(|| Ask::plain(&schema()));
}

/// A finite number.
pub fn number(node: Node<'_>) -> Option<f64> {
    ask(node, || json!({"type": "number"}));
    finite(node)
}

fn finite(node: Node<'_>) -> Option<f64> {
    let text = node.text();
    if let Some(value) = decimal(node) {
        if value.abs() <= LARGEST {
            return Some(value);
        }
        node.expected("a number between -1e30 and 1e30");
        return None;
    }
    let unsigned = text.trim_start_matches(['+', '-']);
    if unsigned.starts_with("inf") || unsigned.starts_with("NaN") {
        node.fault(Fault::expected(node.span(), "a finite number", format!("found `{text}`")));
    } else if text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        node.fault(node.mismatch("a plain decimal number").help("write numbers like 2, -0.5 or 1.5e-3"));
    } else if node.opens_with('[') {
        node.fault(
            node.mismatch("a number").help("this field takes no keys; sequences/README.md says which do"),
        );
    } else {
        node.expected("a number");
    }
    None
}

/// A number that satisfies `good`, as the caller has asked for. `what` describes it for messages.
fn number_where(node: Node<'_>, what: &str, good: impl Fn(f64) -> bool) -> Option<f64> {
    let value = finite(node)?;
    if good(value) {
        return Some(value);
    }
    node.expected(what);
    None
}

/// [`number_where`] for bounds that are narrower than those of all numbers.
fn bounded(node: Node<'_>, what: &str, good: impl Fn(f64) -> bool) -> Option<f64> {
    if decimal(node).is_some_and(|value| value.abs() > LARGEST) {
        node.expected(what);
        return None;
    }
    number_where(node, what, good)
}

/// A number above 0, such as a radius.
pub fn positive(node: Node<'_>) -> Option<f64> {
    ask(node, || json!({"type": "number", "exclusiveMinimum": 0}));
    let value = number_where(node, "a number above 0", |value| value > 0.0)?;
    if value < SHORTEST {
        node.expected("a number of at least 1e-30");
        return None;
    }
    Some(value)
}

/// A number of 0 or more, such as a strength.
pub fn not_negative(node: Node<'_>) -> Option<f64> {
    ask(node, || json!({"type": "number", "minimum": 0}));
    number_where(node, "a number of 0 or more", |value| value >= 0.0)
}

/// A number within bounds.
pub fn between(range: RangeInclusive<f64>) -> impl Fn(Node<'_>) -> Option<f64> {
    move |node| {
        ask(node, || json!({"type": "number", "minimum": range.start(), "maximum": range.end()}));
        let what = format!("a number from {} to {}", range.start(), range.end());
        bounded(node, &what, |value| range.contains(&value))
    }
}

/// A share of the picture's shorter side that stays free on every side.
pub fn margin(node: Node<'_>) -> Option<f64> {
    ask(node, || json!({"type": "number", "minimum": 0, "exclusiveMaximum": 0.5}));
    bounded(node, "a number from 0 to below 0.5", |value| (0.0..0.5).contains(&value))
}

/// A whole number within bounds.
pub fn whole(range: RangeInclusive<u32>) -> impl Fn(Node<'_>) -> Option<u32> {
    move |node| {
        ask(node, || json!({"type": "integer", "minimum": range.start(), "maximum": range.end()}));
        let what = format!("a whole number from {} to {}", range.start(), range.end());
        let bounds = f64::from(*range.start())..=f64::from(*range.end());
        let value = bounded(node, &what, |value| value.fract() == 0.0 && bounds.contains(&value))?;
        Some(value as u32)
    }
}

/// A whole number with a sign.
pub fn whole_number(range: RangeInclusive<i32>) -> impl Fn(Node<'_>) -> Option<i32> {
    move |node| {
        ask(node, || json!({"type": "integer", "minimum": range.start(), "maximum": range.end()}));
        let what = format!("a whole number from {} to {}", range.start(), range.end());
        let bounds = f64::from(*range.start())..=f64::from(*range.end());
        let value = bounded(node, &what, |value| value.fract() == 0.0 && bounds.contains(&value))?;
        Some(value as i32)
    }
}

/// A decimal number as an exact fraction with at most `places` decimal places.
fn exact_number(node: Node<'_>, places: u32) -> Option<Time> {
    match exact(node.text(), places) {
        Ok(value) => Some(value),
        // The message is the same as for any other number.
        Err(NotExact::NotDecimal) => {
            finite(node);
            None
        }
        Err(NotExact::TooFine) => {
            let what = format!("a number with at most {places} decimal places");
            node.fault(node.mismatch(what).help("such numbers are kept as exact fractions"));
            None
        }
        Err(NotExact::TooLarge) => {
            node.expected("a smaller number");
            None
        }
    }
}

/// A decimal number as an exact fraction with at most `places` decimal places. Results of expressions are rounded to these.
pub fn exact_or_rounded(node: Node<'_>, places: u32) -> Option<Time> {
    ask(node, || json!({"type": "number"}));
    rounded_if_computed(node, places)
}

/// [`exact_or_rounded`] where numbers of 0 or less are mistakes, which the caller reports with its own bounds.
pub fn exact_above_zero(node: Node<'_>, places: u32) -> Option<Time> {
    ask(node, || json!({"type": "number", "exclusiveMinimum": 0}));
    rounded_if_computed(node, places)
}

fn rounded_if_computed(node: Node<'_>, places: u32) -> Option<Time> {
    if exact(node.text(), places) == Err(NotExact::TooFine)
        && node.file.is_computed(&node.span())
        && let Some(value) = decimal(node)
        && let rounded = format!("{value:.*}", places as usize)
        && let Ok(time) = exact(&rounded, places)
    {
        node.file.rewrite(node.span(), rounded);
        return Some(time);
    }
    exact_number(node, places)
}

/// Exactly `N` values in parentheses. `what` describes them for messages.
pub fn tuple<'s, const N: usize>(node: Node<'s>, what: &str) -> Option<[Node<'s>; N]> {
    node.note_form(Form::Tuple);
    node.ask(|| Ask::Tuple { what: what.to_owned(), count: N });
    let items = match node.content()? {
        NodeContent::Tuple(items) => items,
        // In JSON an array is what is asked for.
        NodeContent::List(items) if node.file.is_json => items,
        NodeContent::List(_) => {
            node.fault(node.mismatch(what).help("a value goes in parentheses ( ), a list [ ] holds keys"));
            return None;
        }
        _ => {
            node.expected(what);
            return None;
        }
    };
    let items = <[Node<'s>; N]>::try_from(items).ok();
    if items.is_none() {
        node.expected(what);
    }
    items
}

/// Decodes all `N` values, so that every fault is reported.
pub fn each<'s, T, const N: usize>(
    nodes: [Node<'s>; N],
    decode: impl Fn(Node<'s>) -> Option<T>,
) -> Option<[T; N]> {
    let values: Option<Vec<T>> = nodes.map(decode).into_iter().collect();
    values?.try_into().ok()
}

/// `(x, y, z)`
pub fn vector(node: Node<'_>) -> Option<DVec3> {
    if !node.word().is_empty() || !node.opens_with('(') && !node.opens_with('[') {
        node.expected("three numbers (x, y, z)");
        return None;
    }
    each(tuple(node, "three numbers (x, y, z)")?, number).map(DVec3::from_array)
}

/// `Y` or `Z`.
pub fn up_axis(node: Node<'_>) -> Option<UpAxis> {
    word(node, "upward axis", &[("Y", UpAxis::Y), ("Z", UpAxis::Z)])
}

/// A point or a difference of points of the world, in Kinora's axes.
pub fn world_vector(node: Node<'_>) -> Option<DVec3> {
    vector(node).map(|v| node.file.up.get().to_y_up(v))
}

/// [`direction`] in Kinora's axes.
pub fn world_direction(node: Node<'_>) -> Option<DVec3> {
    direction(node).map(|v| node.file.up.get().to_y_up(v))
}

/// A vector of nonzero length.
pub fn direction(node: Node<'_>) -> Option<DVec3> {
    let value = vector(node)?;
    if value.length() >= SHORTEST {
        return Some(value);
    }
    node.fault(node.mismatch("a direction (x, y, z)").label("has no length, so it points nowhere"));
    None
}

/// A vector of length 1.
pub fn unit_vector(node: Node<'_>) -> Option<DVec3> {
    direction(node).map(|v| (v / v.abs().max_element()).normalize())
}

/// An angle in degrees.
pub fn angle(node: Node<'_>) -> Option<Angle> {
    ask(node, || json!({"type": "number"}));
    number_where(node, "an angle between -1e9 and 1e9 degrees", |value| value.abs() <= 1e9).map(Angle)
}

/// An angle within bounds in degrees.
pub fn angle_between(least: f64, most: f64) -> impl Fn(Node<'_>) -> Option<Angle> {
    move |node| {
        ask(node, || json!({"type": "number", "minimum": least, "maximum": most}));
        let what = format!("an angle from {least} to {most} degrees");
        bounded(node, &what, |value| (least..=most).contains(&value)).map(Angle)
    }
}

/// A vertical field of view in degrees.
pub fn field_of_view(node: Node<'_>) -> Option<Angle> {
    ask(node, || json!({"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 180}));
    let what = "an angle from 0.000001 to below 180 degrees";
    number_where(node, what, |value| (1e-6..180.0).contains(&value)).map(Angle)
}

/// `true` or `false`
pub fn switch(node: Node<'_>) -> Option<bool> {
    ask(node, || json!({"type": "boolean"}));
    let value = match node.bare_word() {
        Some("true") => Some(true),
        Some("false") => Some(false),
        _ => None,
    };
    if value.is_none() {
        node.expected("`true` or `false`");
    }
    value
}

/// Text in quotes.
pub fn text(node: Node<'_>) -> Option<String> {
    ask(node, || json!({"type": "string"}));
    if !node.is_text() {
        let fault = node.mismatch("text in quotes");
        node.fault(match node.bare_word() {
            Some(word) => fault.help(format!("write \"{}\"", super::suggest::shortened(word))),
            None => fault,
        });
        return None;
    }
    let inner = node.text().strip_prefix('"').and_then(|text| text.strip_suffix('"'));
    if let Some(text) = inner.filter(|text| !text.contains(['"', '\\'])) {
        return Some(text.to_owned());
    }
    match ron::from_str(node.text()) {
        Ok(text) => Some(text),
        Err(error) => {
            node.fault(node.mismatch("text in quotes").help(error.code.to_string()));
            None
        }
    }
}

/// Help about files that do not exist.
pub const PATHS: &str = "paths are relative to the folder of the file that names them";

/// The path of a file in quotes, relative to the folder of the sequence. Paths of included files are relative to those.
pub fn file_path(node: Node<'_>) -> Option<String> {
    text(node).map(|name| node.file.path(&node.span(), name))
}

/// Decodes each value of a list. None if any value has a fault.
pub fn list<'s, T>(node: Node<'s>, what: &str, decode: impl Fn(Node<'s>) -> Option<T>) -> Option<Vec<T>> {
    node.note_form(Form::List);
    node.ask(|| Ask::List { what: what.to_owned() });
    let items = match node.content()? {
        NodeContent::List(items) if node.word().is_empty() => items,
        NodeContent::Tuple(items) if node.file.is_json && node.word().is_empty() => items,
        _ => {
            node.expected(format!("a list of {what} [ ... ]"));
            return None;
        }
    };
    // Collecting before checking reports the faults of all values.
    let values: Vec<Option<T>> = items.into_iter().map(decode).collect();
    values.into_iter().collect()
}

/// A word from a table.
pub fn one_of<'s, T: Copy>(
    what: &'static str,
    table: &'static [(&'static str, T)],
) -> impl Fn(Node<'s>) -> Option<T> {
    move |node| word(node, what, table)
}
