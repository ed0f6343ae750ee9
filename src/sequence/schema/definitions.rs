//! Schemas of values of which decoders ask the same.

use super::Ask;
use serde_json::{Map, Value, json};
use std::collections::{BTreeSet, HashMap, HashSet};

/// Schemas up to this length are written where they are used.
const SHORT: usize = 200;

/// What decoders ask of values. Those of one kind have the same schema, so decoders of different values must differ in what
/// they accept at first sight, or in how they describe it.
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Kind {
    pub asked: BTreeSet<Ask>,
    /// What they ask of the values of keys, if the value may have keys.
    pub of_keys: Option<BTreeSet<Ask>>,
}

/// Each schema with its name, and what decoders ask of its values. Values of which they ask the same have one schema: so
/// the schema of patterns within patterns has an end.
#[derive(Default)]
pub struct Definitions {
    known: HashMap<Kind, String>,
    schemas: Map<String, Value>,
}

impl Definitions {
    /// The reference to the schema of values of which decoders ask this.
    pub fn reference(&self, kind: &Kind) -> Option<Value> {
        self.known.get(kind).map(|name| reference(name))
    }

    /// Begins the schema of the values of a field, and returns the reference to it.
    pub fn begin(&mut self, kind: &Kind, field: &str) -> Value {
        let what = kind.asked.iter().rev().find_map(|ask| match ask {
            Ask::Fields { what } | Ask::Word { what, .. } if !what.is_empty() => Some(what.as_str()),
            _ => None,
        });
        let name = self.unused_name(what.unwrap_or(field));
        self.known.insert(kind.clone(), name.clone());
        let reference = reference(&name);
        self.schemas.insert(name, Value::Null);
        reference
    }

    /// Sets a schema that has been begun.
    pub fn complete(&mut self, reference: &Value, schema: Value) {
        if let Some(name) = name_of(reference) {
            self.schemas.insert(name.to_owned(), schema);
        }
    }

    /// A name in small letters that no schema has yet.
    fn unused_name(&self, text: &str) -> String {
        let words = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        let words =
            words.map(str::to_ascii_lowercase).filter(|word| !["a", "an", "the"].contains(&word.as_str()));
        let name = words.collect::<Vec<_>>().join("_");
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        let mut names = std::iter::once(name.clone()).chain(numbered);
        names.find(|name| !self.schemas.contains_key(name)).unwrap_or(name)
    }

    /// The schema of the document, to which `root` refers, and all others that are used. Short ones are written out where
    /// they are used.
    pub fn finish(self, mut root: Value) -> (Value, Value) {
        let mut schemas = self.schemas;
        if let Some(schema) = name_of(&root).and_then(|name| schemas.get(name)) {
            root = schema.clone();
        }
        while merge_equal(&mut schemas, &mut root) {}
        let is_short = |schema: &Value| {
            let text = schema.to_string();
            text.len() <= SHORT && !text.contains("\"$ref\"")
        };
        let short: Map<String, Value> = schemas
            .iter()
            .filter(|(_, schema)| is_short(schema))
            .map(|(name, schema)| (name.clone(), schema.clone()))
            .collect();
        schemas.retain(|name, _| !short.contains_key(name));
        let mut write_out = |schema: &mut Value| {
            let content =
                name_of(schema).and_then(|name| short.get(name)).and_then(Value::as_object).cloned();
            if let (Some(content), Value::Object(schema)) = (content, schema) {
                schema.remove("$ref");
                schema.extend(content);
            }
        };
        each_reference(&mut root, &mut write_out);
        schemas.values_mut().for_each(|schema| each_reference(schema, &mut write_out));
        let mut used = HashSet::new();
        each_reference(&mut root, &mut |schema| used.extend(name_of(schema).map(str::to_owned)));
        for schema in schemas.values_mut() {
            each_reference(schema, &mut |schema| used.extend(name_of(schema).map(str::to_owned)));
        }
        schemas.retain(|name, _| used.contains(name));
        (root, Value::Object(schemas))
    }
}

/// Gives equal schemas one name. Whether there were any.
fn merge_equal(schemas: &mut Map<String, Value>, root: &mut Value) -> bool {
    let mut first: HashMap<String, String> = HashMap::new();
    let mut other: HashMap<String, String> = HashMap::new();
    for (name, schema) in schemas.iter() {
        match first.get(&schema.to_string()) {
            Some(same) => drop(other.insert(name.clone(), same.clone())),
            None => drop(first.insert(schema.to_string(), name.clone())),
        }
    }
    schemas.retain(|name, _| !other.contains_key(name));
    for schema in schemas.values_mut().chain([root]) {
        each_reference(schema, &mut |schema| {
            if let Some(same) = name_of(schema).and_then(|name| other.get(name)) {
                schema["$ref"] = reference(same)["$ref"].take();
            }
        });
    }
    !other.is_empty()
}

/// Calls a function for each schema that refers to another one, within a schema.
fn each_reference(schema: &mut Value, change: &mut impl FnMut(&mut Value)) {
    match schema {
        Value::Array(items) => items.iter_mut().for_each(|item| each_reference(item, change)),
        Value::Object(entries) => entries.values_mut().for_each(|entry| each_reference(entry, change)),
        _ => {}
    }
    if name_of(schema).is_some() {
        change(schema);
    }
}

const PREFIX: &str = "#/$defs/";

fn reference(name: &str) -> Value {
    json!({"$ref": format!("{PREFIX}{name}")})
}

/// The name of the schema that a schema refers to.
fn name_of(schema: &Value) -> Option<&str> {
    schema.get("$ref")?.as_str()?.strip_prefix(PREFIX)
}

/// A schema that accepts what one of several accepts; anything without one.
pub fn any_of(schemas: Vec<Value>) -> Value {
    match <[Value; 1]>::try_from(schemas) {
        Ok([only]) => only,
        Err(none) if none.is_empty() => json!({}),
        Err(schemas) => json!({"anyOf": schemas}),
    }
}
