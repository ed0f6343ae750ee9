//! The JSON Schema of sequences, made by the decoders themselves.
//!
//! A schema that is written beside the decoders would drift from them. So it is made by watching them: [`probe`] lets
//! them decode small documents with one value that changes, and takes down what they ask of that value: whether it is a
//! number, begins with one of these words, has this field. [`explore`] follows the answers into fields, lists and words,
//! and [`definitions`] writes them as a schema.
//!
//! The schema accepts every sequence that `kinora convert` writes. Where decoders know more than it can say, such as the
//! names of objects or the columns of a table, it accepts too much. It refuses one thing that the reader lets pass: a word
//! in front of fields that need none, as in `{"Camera": {"position": [0, 1, 5]}}`.

mod ask;
mod definitions;
mod explore;
mod probe;
#[cfg(test)]
mod tests;

pub use ask::{Ask, KEY, Watch};

use definitions::Definitions;
use explore::Explorer;
use probe::Place;
use serde_json::{Value, json};

/// The version of JSON Schema.
const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// The JSON Schema of a sequence in JSON. `describe` returns what the reference says about a name; in front of it are the
/// names of its owners, from the outside in.
pub fn schema(describe: &dyn Fn(&[&str]) -> Option<String>) -> Value {
    let mut definitions = Definitions::default();
    let root =
        Explorer { describe, definitions: &mut definitions, path: Vec::new() }.value(&Place::default());
    let (root, definitions) = definitions.finish(root);
    let mut schema = json!({"$schema": DIALECT, "title": "A Kinora sequence"});
    if let (Some(schema), Value::Object(root)) = (schema.as_object_mut(), root) {
        schema.extend(root);
        schema.insert("$defs".to_owned(), definitions);
    }
    schema
}
