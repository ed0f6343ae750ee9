//! Options that had another name in earlier versions. The old names still work.

use std::ffi::OsString;

/// The old and the current name of each renamed option.
const RENAMED: [(&str, &str); 5] = [
    ("--memory", "--film-cache"),
    ("--with-shared", "--include-shared"),
    ("--most-samples", "--max-samples"),
    ("--plays", "--loop-count"),
    ("--matte", "--background-color"),
];

/// Replaces old names by current ones. Returns a note for each replaced name.
pub fn to_current(mut arguments: Vec<OsString>) -> (Vec<OsString>, Vec<String>) {
    let mut notes = Vec::new();
    // Words after `--` are not options.
    for argument in arguments.iter_mut().take_while(|argument| *argument != "--") {
        let Some(text) = argument.to_str() else { continue };
        let (name, value) = text.split_once('=').map_or((text, None), |(name, value)| (name, Some(value)));
        let Some((old, current)) = RENAMED.into_iter().find(|(old, _)| *old == name) else { continue };
        notes.push(format!("note: {old} is now called {current}"));
        *argument = value.map_or_else(|| current.into(), |value| format!("{current}={value}").into());
    }
    (arguments, notes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_names_become_current_ones_with_a_note() {
        let words = |text: &str| text.split(' ').map(OsString::from).collect::<Vec<_>>();
        let (arguments, notes) =
            to_current(words("kinora render a.ron --memory=2GB --with-shared 0-9 -- --memory"));
        assert_eq!(arguments, words("kinora render a.ron --film-cache=2GB --include-shared 0-9 -- --memory"));
        let wanted = [
            "note: --memory is now called --film-cache",
            "note: --with-shared is now called --include-shared",
        ];
        assert_eq!(notes, wanted);
        let current = words("kinora plan a.ron --film-cache 2GB");
        assert_eq!(to_current(current.clone()), (current, Vec::new()));
    }
}
