//! Commands for people to paste into a shell.

use crate::farm::shell_quote;
use std::ffi::OsStr;

/// A word of a command, in quotes if a shell would not read it as itself.
pub fn quote(word: &OsStr) -> String {
    word.to_str().map_or_else(|| quote_bytes(word), |word| shell_quote(word).into_owned())
}

/// A word that is not UTF-8. Other bytes stand as numbers, which bash and zsh read.
fn quote_bytes(word: &OsStr) -> String {
    let mut quoted = String::from("$'");
    for chunk in word.as_encoded_bytes().utf8_chunks() {
        quoted += &chunk.valid().replace('\\', r"\\").replace('\'', r"\'");
        for byte in chunk.invalid() {
            quoted += &format!(r"\x{byte:02x}");
        }
    }
    quoted + "'"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_shells_would_break_them() {
        for (word, quoted) in
            [("sequences/a_1.ron", "sequences/a_1.ron"), ("my file.ron", "'my file.ron'"), ("", "''")]
        {
            assert_eq!(quote(OsStr::new(word)), quoted);
        }
    }

    #[cfg(unix)]
    #[test]
    fn words_with_invalid_utf8_keep_their_bytes() {
        use std::os::unix::ffi::OsStrExt;
        assert_eq!(quote(OsStr::from_bytes(b"a'\xff\\b.ron")), r"$'a\'\xff\\b.ron'");
    }
}
