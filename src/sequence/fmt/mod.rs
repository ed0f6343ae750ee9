//! The layout of a sequence file: indentation, blanks, line breaks, commas. The content and all comments stay.
//!
//! Line breaks between the entries of a bracket stay where they are, as tables of keys and groups of fields are written
//! on purpose. Rows that are too long are broken.

mod layout;
pub mod tokens;
pub mod tree;

use super::expand::include;
use super::expand::source::Sources;
use super::faults::Faults;
use super::load::{LoadError, read};
use super::syntax;
use std::path::Path;
use tokens::Token;

/// A file, before and after it is formatted.
pub struct Formatted {
    pub before: String,
    pub after: String,
}

/// Reads the sequence file, or included file, at `path` and formats it.
///
/// # Errors
/// The file cannot be read, or its syntax is wrong. Its content is not checked.
pub fn formatted(path: &Path) -> Result<Formatted, LoadError> {
    let before = read(path).map_err(|reason| LoadError::Unreadable { path: path.to_owned(), reason })?;
    let after = formatted_text(&path.to_string_lossy(), &before)?;
    Ok(Formatted { before, after })
}

/// Formats the text of a file called `name`.
pub fn formatted_text(name: &str, text: &str) -> Result<String, LoadError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let (is_common, faults) = syntax::checked(text);
    if !faults.is_empty() {
        let sources = Sources::new(include::main(name, text, is_common));
        return Err(LoadError::Faults(Box::new(Faults::new(sources, faults))));
    }
    let end_of_line = if text.contains("\r\n") { "\r\n" } else { "\n" };
    let formatted = layout::text(&tree::Document::read(&tokens::tokens(text)), end_of_line);
    // Nothing is ever lost: a file that would change its content stays as it is.
    Ok(if content(&formatted) == content(text) { formatted } else { text.to_owned() })
}

/// All tokens, without commas in front of closing brackets, and the lines of comments without blanks around them.
fn content(text: &str) -> Vec<String> {
    let mut content: Vec<String> = Vec::new();
    let tokens = tokens::tokens(text);
    let mut solid = tokens.iter().filter(|token| !token.is_comment()).peekable();
    while let Some(token) = solid.next() {
        if token.text != "," || solid.peek().is_some_and(|next| !next.is_close()) {
            content.push(token.text.to_owned());
        }
    }
    let comments = tokens.iter().filter(|token| token.is_comment());
    content
        .extend(comments.flat_map(|comment: &Token| comment.text.lines().map(|line| line.trim().to_owned())));
    content
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> String {
        let once = formatted_text("a.ron", text).unwrap_or_else(|error| panic!("{error}"));
        let again = formatted_text("a.ron", &once).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(once, again, "formatting it again changes nothing");
        once
    }

    #[test]
    fn blanks_and_commas_are_regular() {
        assert_eq!(of("( a :1,b: [ 1,2 , ],c:{\"x\":S( )} , )"), "(a: 1, b: [1, 2], c: { \"x\": S() })\n");
        assert_eq!(of("Sequence (\n  a:-1.5e-3)"), "Sequence(\n    a: -1.5e-3,\n)\n");
        assert_eq!(
            of("(a: r#\"x, \"(\"#, b: \"\\\"(,\", c: '(',)"),
            "(a: r#\"x, \"(\"#, b: \"\\\"(,\", c: '(')\n"
        );
        assert_eq!(of("()"), "()\n");
        assert_eq!(of("(\n\n)"), "()\n");
    }

    #[test]
    fn rows_stay_and_are_indented() {
        let text = "(\n a: 1, b: 2,\n\n\n\n   keys: [(0, 1),(1, 2),\n (2, 3)],\n)";
        let expected =
            "(\n    a: 1, b: 2,\n\n    keys: [\n        (0, 1), (1, 2),\n        (2, 3),\n    ],\n)\n";
        assert_eq!(of(text), expected);
    }

    #[test]
    fn long_rows_are_broken() {
        let item = "123456789";
        let numbers = vec![item; 26].join(", ");
        let text = of(&format!("(values: [{numbers}], after: 1)"));
        assert!(text.lines().all(|line| line.len() <= 160), "{text}");
        let row = format!("        {},\n", vec![item; 13].join(", "));
        assert_eq!(text, format!("(\n    values: [\n{row}{row}    ],\n    after: 1,\n)\n"));
        // A text cannot be broken.
        let long = "x".repeat(200);
        assert_eq!(of(&format!("(a: \"{long}\", b: 2)")), format!("(\n    a: \"{long}\",\n    b: 2,\n)\n"));
    }

    #[test]
    fn brackets_share_the_rows_of_their_last_entry() {
        let text = "(\n    angle: AxisAngle(axis: 1, angle: Track(ease: Smooth, keys: [\n        (0, 1),\n        (1, 2),\n    ])),\n)\n";
        assert_eq!(of(text), text);
        assert_eq!(
            of("(a: S(b: [\n1], c: 2))"),
            "(\n    a: S(\n        b: [\n            1,\n        ],\n        c: 2,\n    ),\n)\n"
        );
    }

    #[test]
    fn comments_stay_where_they_are() {
        let text = "// head\n\n(  // open\n// of a\na: 1, // after a\nbb: (2), /* block */\n\n/* of c */ c: /* in */ 3\n// last\n)\n// end";
        let expected = "// head\n\n(\n    // open\n    // of a\n    a: 1,    // after a\n    bb: (2), /* block */\n\n    /* of c */ c: /* in */ \
                        3,\n    // last\n)\n// end\n";
        assert_eq!(of(text), expected);
        assert_eq!(of("(a: // of 1\n1, b: 2)"), "(\n    a: // of 1\n        1,\n    b: 2,\n)\n");
        assert_eq!(of("(a: [1 // one\n, 2])"), "(a: [\n    1, // one\n    2,\n])\n");
        assert_eq!(of("(/* only */)"), "(\n    /* only */\n)\n");
    }

    #[test]
    fn ends_of_lines_stay() {
        assert_eq!(of("(\r\n a: 1,\r\n)\r\n"), "(\r\n    a: 1,\r\n)\r\n");
        assert_eq!(of("\u{feff}(a: 1)"), "(a: 1)\n");
    }

    #[test]
    fn broken_syntax_is_refused() {
        let error = formatted_text("a.ron", "(a: [1, 2)").expect_err("a fault").to_string();
        assert!(error.contains("a.ron:1"), "{error}");
    }
}
