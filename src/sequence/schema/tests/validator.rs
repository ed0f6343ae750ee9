//! Validates JSON against the part of JSON Schema that Kinora's schema uses.

use serde_json::{Map, Value};

/// Words of schemas that say nothing about values.
const ANNOTATIONS: [&str; 5] = ["$schema", "$defs", "title", "description", "deprecated"];

/// Why a value does not satisfy a schema: the place in the value, and the reason. `root` is the whole schema.
pub fn validate(root: &Value, schema: &Value, value: &Value) -> Result<(), String> {
    let Value::Object(words) = schema else {
        return if *schema == Value::Bool(true) {
            Ok(())
        } else {
            Err(": nothing is allowed here".to_owned())
        };
    };
    words.iter().try_for_each(|(word, rule)| satisfies(root, words, (word, rule), value))
}

fn satisfies(
    root: &Value,
    schema: &Map<String, Value>,
    (word, rule): (&str, &Value),
    value: &Value,
) -> Result<(), String> {
    let refuse = |satisfied: bool| match satisfied {
        true => Ok(()),
        false => Err(format!(": {value} against `{word}: {rule}`")),
    };
    let within = |place: String, schema: &Value, value: &Value| {
        validate(root, schema, value).map_err(|fault| format!("/{place}{fault}"))
    };
    let compare = |test: fn(f64, f64) -> bool| {
        refuse(value.as_f64().zip(rule.as_f64()).is_none_or(|(value, limit)| test(value, limit)))
    };
    let count = |count: Option<usize>, test: fn(f64, f64) -> bool| {
        refuse(count.zip(rule.as_f64()).is_none_or(|(count, limit)| test(count as f64, limit)))
    };
    let (array, object) = (value.as_array(), value.as_object());
    let (items, fields) = (array.map(Vec::len), object.map(Map::len));
    match word {
        _ if ANNOTATIONS.contains(&word) => Ok(()),
        "$ref" => {
            let schema = rule.as_str().and_then(|place| root.pointer(place.strip_prefix('#')?));
            validate(root, schema.unwrap_or(&Value::Bool(false)), value)
        }
        "anyOf" => {
            let faults: Vec<String> = rule
                .as_array()
                .into_iter()
                .flatten()
                .map_while(|schema| validate(root, schema, value).err())
                .collect();
            match rule.as_array().is_some_and(|schemas| faults.len() < schemas.len()) {
                true => Ok(()),
                false => Err(format!(": none of ({})", faults.join(" | "))),
            }
        }
        "type" => refuse(match rule.as_str() {
            Some("string") => value.is_string(),
            Some("boolean") => value.is_boolean(),
            Some("array") => value.is_array(),
            Some("object") => value.is_object(),
            Some("number") => value.is_number(),
            Some("integer") => value.as_f64().is_some_and(|number| number.fract() == 0.0),
            _ => false,
        }),
        "enum" => refuse(rule.as_array().is_some_and(|values| values.contains(value))),
        "minimum" => compare(|value, limit| value >= limit),
        "maximum" => compare(|value, limit| value <= limit),
        "exclusiveMinimum" => compare(|value, limit| value > limit),
        "exclusiveMaximum" => compare(|value, limit| value < limit),
        "minItems" => count(items, |count, limit| count >= limit),
        "maxItems" => count(items, |count, limit| count <= limit),
        "minProperties" => count(fields, |count, limit| count >= limit),
        "maxProperties" => count(fields, |count, limit| count <= limit),
        "items" => {
            let mut items = array.into_iter().flatten().enumerate();
            items.try_for_each(|(index, item)| within(index.to_string(), rule, item))
        }
        "prefixItems" => {
            let mut items =
                array.into_iter().flatten().zip(rule.as_array().into_iter().flatten()).enumerate();
            items.try_for_each(|(index, (item, schema))| within(index.to_string(), schema, item))
        }
        "required" => {
            let names = rule.as_array().into_iter().flatten().filter_map(Value::as_str);
            let missing =
                names.into_iter().find(|name| object.is_some_and(|object| !object.contains_key(*name)));
            missing.map_or(Ok(()), |name| Err(format!(": `{name}` is missing")))
        }
        "properties" | "additionalProperties" => {
            let known = |name: &str| schema.get("properties").and_then(|fields| fields.get(name));
            object.into_iter().flatten().try_for_each(|(name, value)| match (known(name), word) {
                (Some(schema), "properties") => within(name.clone(), schema, value),
                (None, "additionalProperties") => within(name.clone(), rule, value),
                _ => Ok(()),
            })
        }
        _ => Err(format!(": the schema has the word `{word}`, which this validator does not know")),
    }
}
