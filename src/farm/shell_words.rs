//! Commands as POSIX shells read them.

use std::borrow::Cow;

/// A word, in quotes if a shell would not read it as itself.
pub fn shell_quote(word: &str) -> Cow<'_, str> {
    // Only a NUL cannot be quoted, and arguments of a process never hold one.
    shlex::try_quote(word).unwrap_or(Cow::Borrowed(word))
}

/// A command of several words.
pub fn shell_command(words: &[String]) -> String {
    words.iter().map(|word| shell_quote(word)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_they_must_be() {
        for (word, expected) in [
            ("f_00.png", "f_00.png"),
            ("f_##.png", "'f_##.png'"),
            ("a b.ron", "'a b.ron'"),
            ("--fps=30", "'--fps=30'"),
            ("it's", r#""it's""#),
            ("", "''"),
            ("$HOME", "'$HOME'"),
        ] {
            assert_eq!(shell_quote(word), expected);
        }
        assert_eq!(shell_command(&["a".to_owned(), "b c".to_owned()]), "a 'b c'");
    }
}
