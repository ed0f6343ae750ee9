//! Follows what decoders ask for, from the whole document into its fields, lists and words.

use super::definitions::{Definitions, Kind, any_of};
use super::probe::Place;
use super::{Ask, KEY};
use crate::sequence::expand::REPEAT;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

type Asked = BTreeSet<Ask>;

/// Makes the schemas of values.
pub struct Explorer<'e> {
    /// What the reference says about a name behind those of its owners.
    pub describe: &'e dyn Fn(&[&str]) -> Option<String>,
    pub definitions: &'e mut Definitions,
    /// The names of the fields and words around the value.
    pub path: Vec<String>,
}

/// A word of a place, as the text before and after what the word stands in front of. Without a word both are empty.
type Word<'w> = (&'w str, &'w str);

impl Explorer<'_> {
    /// The schema of the values at a place. It is empty if decoders ask for nothing there.
    pub fn value(&mut self, place: &Place) -> Value {
        let asked = place.asked_of_forms("", "");
        if asked.is_empty() {
            return json!({});
        }
        // Keys are asked for alike, whatever their values are.
        let is_key = |ask: &Ask| matches!(ask, Ask::Tuple { what, .. } if what == KEY);
        let value = match (asked.contains(&Ask::Keys), asked.iter().any(is_key)) {
            (true, _) => Some(place.within("[[1, ", "]]")),
            (_, true) => Some(place.within("[1, ", "]")),
            _ => None,
        };
        let of_keys = value.map(|value| value.asked_of_forms("", ""));
        let kind = Kind { asked, of_keys };
        if let Some(reference) = self.definitions.reference(&kind) {
            return reference;
        }
        let field = self.path.last().map_or("value", String::as_str);
        let reference = self.definitions.begin(&kind, field);
        let asked = kind.asked;
        let plain = asked.iter().filter_map(|ask| match ask {
            Ask::Plain(schema) => serde_json::from_str(schema).ok(),
            _ => None,
        });
        let mut schemas: Vec<Value> = plain.collect();
        schemas.extend(self.words(place, &asked));
        schemas.extend(self.brackets(place, &asked, ("", "")));
        self.definitions.complete(&reference, any_of(schemas));
        reference
    }

    /// Words alone, and objects with a word as their only name.
    fn words(&mut self, place: &Place, asked: &Asked) -> Vec<Value> {
        let words: BTreeSet<&str> = asked
            .iter()
            .filter_map(|ask| match ask {
                // Only RON has repetitions, which are written out before.
                Ask::Word { word, .. } => Some(word.as_str()).filter(|word| *word != REPEAT),
                _ => None,
            })
            .collect();
        let (mut alone, mut worded) = (Vec::new(), Map::new());
        for word in words {
            let around = (&*format!("{{\"{word}\": "), "}");
            let mut asked = place.asked_of_forms(around.0, around.1);
            asked.retain(|ask| !matches!(ask, Ask::Plain(_) | Ask::Word { .. }));
            let description = self.enter(word);
            let mut inner = self.brackets(place, &asked, around);
            self.path.pop();
            if may_be_alone(&place.asked(&format!("{}[]{}", around.0, around.1))) {
                alone.push(word);
                inner.push(json!({"type": "array", "maxItems": 0}));
                inner.push(json!({"type": "object", "maxProperties": 0}));
            }
            worded.insert(word.to_owned(), described(any_of(inner), description));
        }
        let mut schemas = Vec::new();
        if !alone.is_empty() {
            schemas.push(json!({"enum": alone}));
        }
        if !worded.is_empty() {
            schemas.push(json!({
                "type": "object",
                "properties": worded,
                "additionalProperties": false,
                "minProperties": 1,
                "maxProperties": 1,
            }));
        }
        schemas
    }

    /// What a value holds in brackets, possibly behind a word.
    fn brackets(&mut self, place: &Place, asked: &Asked, word: Word<'_>) -> Vec<Value> {
        let (before, after) = word;
        let mut schemas = Vec::new();
        let counts: BTreeSet<usize> = asked
            .iter()
            .filter_map(|ask| if let Ask::Tuple { count, .. } = ask { Some(*count) } else { None })
            .collect();
        for count in counts {
            let item = |index: usize| {
                let (left, right) = ("1, ".repeat(index), ", 1".repeat(count - index - 1));
                place.within(&format!("{before}[{left}"), &format!("{right}]{after}"))
            };
            let items: Vec<Value> = (0..count).map(|index| self.value(&item(index))).collect();
            // A single value needs no brackets behind a word.
            if let ([only], false) = (&items[..], before.is_empty()) {
                schemas.push(only.clone());
            }
            schemas.push(match items.windows(2).all(|pair| pair[0] == pair[1]) {
                true => json!({"type": "array", "items": items[0], "minItems": count, "maxItems": count}),
                false => json!({"type": "array", "prefixItems": items, "minItems": count, "maxItems": count}),
            });
        }
        if asked.iter().any(|ask| matches!(ask, Ask::List { .. } | Ask::Keys)) {
            let item = self.value(&place.within(&format!("{before}["), &format!("]{after}")));
            schemas.push(json!({"type": "array", "items": item}));
        }
        if asked.iter().any(|ask| matches!(ask, Ask::Map { .. })) {
            let entry = self.value(&place.within(&format!("{before}{{\"probe\": "), &format!("}}{after}")));
            schemas.push(json!({"type": "object", "additionalProperties": entry}));
        }
        if asked.iter().any(|ask| matches!(ask, Ask::Fields { .. })) {
            schemas.push(self.fields(place, word));
        }
        schemas
    }

    /// An object with fields.
    fn fields(&mut self, place: &Place, (before, after): Word<'_>) -> Value {
        let owner = Owner::at(place, (before, after));
        let mut properties = Map::new();
        for name in owner.known.iter().chain(&owner.former) {
            let description = self.enter(name);
            let mut schemas: Vec<Value> = Vec::new();
            for sibling in owner.siblings.iter().filter(|sibling| sibling.as_str() != *name) {
                let field = format!("{before}{{{}\"{name}\": ", with_comma(sibling));
                let schema = self.value(&place.within(&field, &format!("}}{after}")));
                if !schemas.contains(&schema) && schema != json!({}) {
                    schemas.push(schema);
                }
            }
            self.path.pop();
            let mut schema = described(any_of(schemas), description);
            if owner.former.contains(name) {
                schema["deprecated"] = true.into();
            }
            properties.insert((*name).to_owned(), schema);
        }
        let mut schema = json!({"type": "object", "properties": properties});
        if owner.refuses_others {
            schema["additionalProperties"] = false.into();
        }
        if let Some(required) = owner.required.filter(|required| !required.is_empty()) {
            schema["required"] = required.into_iter().collect();
        }
        schema
    }

    /// Adds a name to the path, and returns what the reference says about it.
    fn enter(&mut self, name: &str) -> Option<String> {
        self.path.push(name.to_owned());
        (self.describe)(&self.path.iter().map(String::as_str).collect::<Vec<_>>())
    }
}

/// The fields of a value. Decoders may look which other fields are there before they read one, so the value is decoded
/// without fields, and with each of those that decoders look for.
#[derive(Default)]
struct Owner {
    known: BTreeSet<&'static str>,
    former: BTreeSet<&'static str>,
    /// Fields that are missed whatever is there.
    required: Option<BTreeSet<&'static str>>,
    refuses_others: bool,
    /// The names of fields that decoders look for, and an empty one.
    siblings: Vec<String>,
}

impl Owner {
    fn at(place: &Place, (before, after): Word<'_>) -> Self {
        let mut owner = Self { siblings: vec![String::new()], ..Self::default() };
        let mut next = 0;
        while let Some(sibling) = owner.siblings.get(next) {
            // Without any field, the value could be a word alone.
            let name = if sibling.is_empty() { "probe" } else { sibling };
            let asked = place.asked(&format!("{before}{{\"{name}\": 1}}{after}"));
            owner.learn(asked);
            next += 1;
        }
        owner
    }

    fn learn(&mut self, asked: Asked) {
        let mut missed = BTreeSet::new();
        for ask in asked {
            match ask {
                Ask::Field(name) => drop(self.known.insert(name)),
                Ask::Former(name) => drop(self.former.insert(name)),
                Ask::Required(name) => drop(missed.insert(name)),
                Ask::NoOthers => self.refuses_others = true,
                Ask::Sibling(name) if !self.siblings.contains(&name) => self.siblings.push(name),
                _ => {}
            }
        }
        self.known.retain(|name| !self.former.contains(name));
        self.required = Some(match self.required.take() {
            Some(required) => required.intersection(&missed).copied().collect(),
            None => missed,
        });
    }
}

/// Whether a word needs nothing behind it, by what decoders ask of it alone.
fn may_be_alone(asked: &Asked) -> bool {
    let has = |test: fn(&Ask) -> bool| asked.iter().any(test);
    let needs_brackets =
        has(|ask| matches!(ask, Ask::Tuple { .. })) && !has(|ask| matches!(ask, Ask::Fields { .. }));
    !needs_brackets && !has(|ask| matches!(ask, Ask::Required(_)))
}

/// A field with some value and a comma behind it. Nothing for the empty name.
fn with_comma(name: &str) -> String {
    if name.is_empty() { String::new() } else { format!("\"{name}\": 1, ") }
}

fn described(mut schema: Value, description: Option<String>) -> Value {
    if let Some(description) = description {
        schema["description"] = description.into();
    }
    schema
}
