//! JSON as RON. [`json`](super::super::json) describes the forms.

use super::super::expand::source::quoted_value;
use super::super::fmt::tree::{Brackets, Document};
use super::super::json;
use super::super::source_file::Form;
use super::{Value, named, start_of};
use std::collections::HashMap;

/// A JSON file as RON text in one row.
pub fn text(document: &Document<'_>, source: &str, forms: &HashMap<usize, Form>) -> String {
    Writer { source, forms }.value(&named(&document.entry).1)
}

struct Writer<'w> {
    source: &'w str,
    forms: &'w HashMap<usize, Form>,
}

impl Writer<'_> {
    fn value(&self, value: &Value<'_, '_>) -> String {
        match value {
            Value::Atom(atom) => match self.form(atom) {
                Some(Form::Word) => json::name(atom).to_owned(),
                _ if atom.starts_with("\"=") => plain_text(atom),
                _ => (*atom).to_owned(),
            },
            Value::Brackets(brackets) if brackets.open == "{" => self.object(brackets),
            Value::Brackets(brackets) => match self.form(brackets.open) {
                Some(Form::List | Form::LikelyList) => format!("[{}]", self.items(brackets)),
                _ => format!("({})", self.items(brackets)),
            },
            // JSON has no such values.
            Value::Worded(word, _) => (*word).to_owned(),
        }
    }

    fn object(&self, brackets: &Brackets<'_>) -> String {
        let form = self.form(brackets.open);
        if form == Some(Form::Map) {
            let entries = brackets
                .entries
                .iter()
                .map(named)
                .map(|(name, value)| format!("{}: {}", name.unwrap_or_default(), self.value(&value)));
            return format!("{{{}}}", entries.collect::<Vec<_>>().join(", "));
        }
        if let Some((word, value)) = self.worded(brackets) {
            return match value {
                Value::Brackets(inner) if inner.entries.is_empty() => word.to_owned(),
                Value::Brackets(inner) if inner.open == "[" => format!("{word}({})", self.items(inner)),
                Value::Brackets(inner) if self.worded(inner).is_none() => {
                    format!("{word}({})", self.fields(inner))
                }
                value => format!("{word}({})", self.value(&value)),
            };
        }
        format!("({})", self.fields(brackets))
    }

    /// The word of an object that stands for `Word(...)`, and its value.
    fn worded<'t, 's>(&self, brackets: &'t Brackets<'s>) -> Option<(&'s str, Value<'t, 's>)> {
        let [only] = brackets.entries.as_slice() else { return None };
        json::leading_word(
            &self.source[start_of(self.source, brackets.open)..end_of(self.source, brackets.close)],
        )?;
        let (name, value) = named(only);
        Some((json::name(name?), value))
    }

    fn fields(&self, brackets: &Brackets<'_>) -> String {
        let entries = brackets.entries.iter().map(named);
        let entries = entries.map(|(name, value)| (json::name(name.unwrap_or_default()), value));
        // RON has no such names, and no editor that looks for a schema.
        let entries = entries.filter(|(name, _)| *name != json::SCHEMA);
        let entries = entries.map(|(name, value)| format!("{name}: {}", self.value(&value)));
        entries.collect::<Vec<_>>().join(", ")
    }

    fn items(&self, brackets: &Brackets<'_>) -> String {
        let items = brackets.entries.iter().map(|entry| self.value(&named(entry).1));
        items.collect::<Vec<_>>().join(", ")
    }

    fn form(&self, first: &str) -> Option<Form> {
        self.forms.get(&start_of(self.source, first)).copied()
    }
}

/// A text in quotes that RON would read as an expression, as the text that it is in JSON.
fn plain_text(atom: &str) -> String {
    ron::from_str::<String>(atom).map_or_else(|_| atom.to_owned(), |text| quoted_value(&text))
}

fn end_of(text: &str, part: &str) -> usize {
    start_of(text, part) + part.len()
}
