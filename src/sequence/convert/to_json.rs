//! RON as JSON. [`json`](super::super::json) describes the forms.

use super::super::fmt::tree::{Brackets, Document};
use super::super::source_file::Form;
use super::{Value, named, start_of};
use serde::de::IgnoredAny;
use std::collections::HashMap;

/// Brackets up to this length stand in one row.
const ROW: usize = 100;

/// A value. Numbers are texts, so that they keep all digits.
enum Json {
    Plain(String),
    Array(Vec<Json>),
    Object(Vec<(String, Json)>),
}

/// A text in quotes.
fn quoted(text: &str) -> Json {
    Json::Plain(serde_json::Value::from(text).to_string())
}

/// A plain file as JSON text.
pub fn text(document: &Document<'_>, source: &str, forms: &HashMap<usize, Form>) -> String {
    let json = Writer { source, forms }.value(&named(&document.entry).1);
    let mut text = String::new();
    write(&mut text, &json, 0);
    text.push('\n');
    text
}

struct Writer<'w> {
    source: &'w str,
    forms: &'w HashMap<usize, Form>,
}

impl Writer<'_> {
    fn value(&self, value: &Value<'_, '_>) -> Json {
        match value {
            Value::Atom(atom) => self.atom(atom),
            Value::Brackets(brackets) => self.brackets(brackets),
            Value::Worded(word, brackets) if brackets.entries.is_empty() => self.atom(word),
            Value::Worded(word, brackets) => {
                Json::Object(vec![((*word).to_owned(), self.arguments(brackets))])
            }
        }
    }

    fn arguments(&self, brackets: &Brackets<'_>) -> Json {
        match brackets.entries.as_slice() {
            [only] => match named(only) {
                (None, value @ Value::Atom(_)) => self.value(&value),
                _ => self.brackets(brackets),
            },
            _ => self.brackets(brackets),
        }
    }

    fn brackets(&self, brackets: &Brackets<'_>) -> Json {
        let is_object = brackets.open == "{"
            || brackets.open == "(" && brackets.entries.first().is_none_or(|entry| named(entry).0.is_some());
        if !is_object {
            return Json::Array(brackets.entries.iter().map(|entry| self.value(&named(entry).1)).collect());
        }
        let entries = brackets.entries.iter().map(named).map(|(name, value)| {
            let name = name.unwrap_or_default();
            (text_of(name).unwrap_or_else(|| name.to_owned()), self.value(&value))
        });
        Json::Object(entries.collect())
    }

    fn atom(&self, atom: &str) -> Json {
        if matches!(atom, "true" | "false") {
            return Json::Plain(atom.to_owned());
        }
        if atom.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
            return number(atom).map_or_else(|| quoted(atom), Json::Plain);
        }
        if let Some(text) = text_of(atom) {
            return quoted(&text);
        }
        match self.forms.get(&start_of(self.source, atom)) {
            Some(Form::WordOrText) => Json::Object(vec![(atom.to_owned(), Json::Array(Vec::new()))]),
            _ => quoted(atom),
        }
    }
}

/// The content of a text in quotes, also of a raw one.
fn text_of(atom: &str) -> Option<String> {
    atom.contains('"').then(|| ron::from_str(atom).ok()).flatten()
}

/// A decimal number of RON, digit by digit: `+.5` and `1_000.` become `0.5` and `1000`.
fn number(atom: &str) -> Option<String> {
    let digits = atom.replace('_', "");
    let (sign, digits) = match digits.strip_prefix('-') {
        Some(digits) => ("-", digits),
        None => ("", digits.trim_start_matches('+')),
    };
    let (mantissa, exponent) = match digits.find(['e', 'E']) {
        Some(at) => digits.split_at(at),
        None => (digits, ""),
    };
    let zero = if mantissa.starts_with('.') { "0" } else { "" };
    let number = format!("{sign}{zero}{}{exponent}", mantissa.trim_end_matches('.'));
    serde_json::from_str::<IgnoredAny>(&number).is_ok().then_some(number)
}

/// Writes a value. Brackets that are too long for a row have a row for each entry.
fn write(out: &mut String, json: &Json, depth: usize) {
    let (open, close) = match json {
        Json::Object(entries) if !entries.is_empty() => ('{', '}'),
        Json::Array(items) if !items.is_empty() => ('[', ']'),
        _ => return out.push_str(&row(json)),
    };
    if depth > 0 {
        let row = row(json);
        if 4 * depth + row.len() <= ROW {
            return out.push_str(&row);
        }
    }
    out.push(open);
    let begin = |out: &mut String, index: usize| {
        out.push_str(if index == 0 { "\n" } else { ",\n" });
        out.push_str(&"    ".repeat(depth + 1));
    };
    match json {
        Json::Plain(_) => {}
        Json::Array(items) => items.iter().enumerate().for_each(|(index, item)| {
            begin(out, index);
            write(out, item, depth + 1);
        }),
        Json::Object(entries) => entries.iter().enumerate().for_each(|(index, (name, value))| {
            begin(out, index);
            out.push_str(&row(&quoted(name)));
            out.push_str(": ");
            write(out, value, depth + 1);
        }),
    }
    out.push('\n');
    out.push_str(&"    ".repeat(depth));
    out.push(close);
}

/// A value in one row.
fn row(json: &Json) -> String {
    match json {
        Json::Plain(text) => text.clone(),
        Json::Object(entries) => {
            let entries =
                entries.iter().map(|(name, value)| format!("{}: {}", row(&quoted(name)), row(value)));
            format!("{{{}}}", entries.collect::<Vec<_>>().join(", "))
        }
        Json::Array(items) => format!("[{}]", items.iter().map(row).collect::<Vec<_>>().join(", ")),
    }
}
