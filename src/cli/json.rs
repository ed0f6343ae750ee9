//! Just enough JSON to write one object per line for other programs.

use crate::base::escape::json as quoted;
use std::fmt::{Display, Write};

/// An object in the making; keys are plain words.
pub struct Object(String);

impl Object {
    pub fn new() -> Self {
        Self(String::new())
    }

    pub fn text(self, key: &str, value: &str) -> Self {
        self.raw(key, quoted(value))
    }

    pub fn whole(self, key: &str, value: u64) -> Self {
        self.raw(key, value)
    }

    /// To the thousandth; null if absent or not finite, for which JSON has no number.
    pub fn real(self, key: &str, value: Option<f64>) -> Self {
        match value.filter(|value| value.is_finite()) {
            Some(value) => self.raw(key, format_args!("{value:.3}")),
            None => self.raw(key, "null"),
        }
    }

    /// With all digits; null if absent or not finite.
    pub fn exact(self, key: &str, value: Option<f64>) -> Self {
        match value.filter(|value| value.is_finite()) {
            Some(value) => self.raw(key, format_args!("{value:e}")),
            None => self.raw(key, "null"),
        }
    }

    pub fn texts(self, key: &str, values: impl Iterator<Item = String>) -> Self {
        self.raw(key, list(values.map(|value| quoted(&value))))
    }

    pub fn objects(self, key: &str, values: impl Iterator<Item = Self>) -> Self {
        let values = values.map(Self::finish).collect::<Vec<_>>();
        self.raw(key, format_args!("[{}]", values.join(",")))
    }

    pub fn object(self, key: &str, value: Self) -> Self {
        self.raw(key, value.finish())
    }

    pub fn finish(self) -> String {
        format!("{{{}}}", self.0)
    }

    /// What is JSON already.
    pub fn raw(mut self, key: &str, value: impl Display) -> Self {
        let comma = if self.0.is_empty() { "" } else { "," };
        // Writing to a string cannot fail.
        let _ = write!(self.0, "{comma}{}:{value}", quoted(key));
        self
    }
}

/// A list of what is JSON already.
pub fn list(values: impl Iterator<Item = String>) -> String {
    format!("[{}]", values.collect::<Vec<_>>().join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_nest() {
        let inner = Object::new().real("t", Some(0.12345)).real("n", Some(f64::NAN)).real("x", None);
        let text = Object::new()
            .text("a", "b")
            .whole("c", u64::MAX)
            .texts("d", ["e".to_owned(), "\"".to_owned()].into_iter())
            .object("f", inner)
            .object("g", Object::new())
            .objects("h", [Object::new().whole("i", 1), Object::new()].into_iter())
            .finish();
        let wanted = r#"{"a":"b","c":18446744073709551615,"d":["e","\""],"f":{"t":0.123,"n":null,"x":null},"g":{},"h":[{"i":1},{}]}"#;
        assert_eq!(text, wanted);
    }
}
