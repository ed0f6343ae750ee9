//! JSON for other programs, in one line.

use crate::base::escape;
use serde::Serialize;
use serde_json::ser::{Formatter, Serializer};
use serde_json::{Map, Value};
use std::io;

/// Writes a value in one line. Its strings are safe to show on a terminal.
pub fn line(value: impl Into<Value>) -> String {
    let mut bytes = Vec::new();
    // Writing into memory cannot fail, and all keys are strings.
    let _ = value.into().serialize(&mut Serializer::with_formatter(&mut bytes, TerminalSafe));
    String::from_utf8_lossy(&bytes).into_owned()
}

/// A number rounded to the thousandth, for times in seconds; null if it is not finite.
pub fn rounded(value: f64) -> Value {
    format!("{value:.3}").parse::<f64>().map_or(Value::Null, Value::from)
}

/// The object that `json!` has made.
pub fn object(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

/// Escapes control and format characters, which JSON allows in strings but which could steer a terminal.
struct TerminalSafe;

impl Formatter for TerminalSafe {
    fn write_string_fragment<W: ?Sized + io::Write>(&mut self, out: &mut W, text: &str) -> io::Result<()> {
        // Fragments hold no quotes of their own.
        out.write_all(escape::json(text).trim_matches('"').as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn objects_keep_the_order_of_their_keys() {
        let value = json!({
            "z": "b",
            "c": u64::MAX,
            "d": ["e", "\""],
            "a": { "t": rounded(0.12345), "n": rounded(f64::NAN), "x": f64::NAN, "y": None::<f64> },
            "g": {},
        });
        let wanted = r#"{"z":"b","c":18446744073709551615,"d":["e","\""],"a":{"t":0.123,"n":null,"x":null,"y":null},"g":{}}"#;
        assert_eq!(line(value), wanted);
    }

    #[test]
    fn strings_do_not_steer_terminals() {
        assert_eq!(
            line("\"a\\\n\u{1b}[2J\u{9b}\u{202e}\u{e0041}\""),
            r#""\"a\\\n\u001b[2J\u009b\u202e\udb40\udc41\"""#
        );
    }
}
