//! Text in quotes, as JSON, TOML and YAML read it.

use std::fmt::Write;

/// A string in double quotes, with everything escaped that may not stand in one.
pub fn quoted(text: &str) -> String {
    let mut quoted = String::with_capacity(text.len() + 2);
    quoted.push('"');
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            c if c < ' ' || c == '\x7f' => {
                // Writing to a string cannot fail.
                let _ = write!(quoted, "\\u{:04x}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_are_escaped() {
        assert_eq!(quoted("a\"b\\c/ü→"), r#""a\"b\\c/ü→""#);
        assert_eq!(quoted("\n\t\r\x00\x1f\x7f"), r#""\n\t\u000d\u0000\u001f\u007f""#);
    }
}
