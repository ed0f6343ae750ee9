//! Commands as shells read them, for whoever copies them.

use crate::farm;
use std::ffi::OsStr;

/// A word as it stands in a command, in quotes if it needs some.
pub fn quoted(word: &OsStr) -> String {
    word.to_str().map_or_else(|| escaped(word), farm::quoted)
}

/// A word that is no text, with its bytes by their numbers, as bash and zsh read them.
fn escaped(word: &OsStr) -> String {
    let mut told = String::from("$'");
    for chunk in word.as_encoded_bytes().utf8_chunks() {
        told += &chunk.valid().replace('\\', r"\\").replace('\'', r"\'");
        for byte in chunk.invalid() {
            told += &format!(r"\x{byte:02x}");
        }
    }
    told + "'"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_shells_would_break_them() {
        for (word, told) in [
            ("sequences/a_1.ron", "sequences/a_1.ron"),
            ("my file.ron", "'my file.ron'"),
            ("f_##.png", "'f_##.png'"),
            ("it's", r"'it'\''s'"),
            ("", "''"),
        ] {
            assert_eq!(quoted(OsStr::new(word)), told);
        }
    }

    #[cfg(unix)]
    #[test]
    fn words_that_are_no_text_keep_their_bytes() {
        use std::os::unix::ffi::OsStrExt;
        assert_eq!(quoted(OsStr::from_bytes(b"a'\xff\\b.ron")), r"$'a\'\xff\\b.ron'");
    }
}
