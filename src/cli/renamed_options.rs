//! Options that had another name in earlier versions. The old names still work.

use crate::sequence::nearest;
use clap::Command;
use std::ffi::OsString;

/// The old and the current name of each renamed option.
const RENAMED: [(&str, &str); 5] = [
    ("--memory", "--film-cache"),
    ("--with-shared", "--include-shared"),
    ("--most-samples", "--max-samples"),
    ("--plays", "--loop-count"),
    ("--matte", "--background-color"),
];

/// Replaces old names of options of the given command by current ones. Returns a note for each replaced name.
pub fn to_current(mut arguments: Vec<OsString>, program: &Command) -> (Vec<OsString>, Vec<String>) {
    let command = given_command(&arguments, program);
    let mut notes = Vec::new();
    // Words after `--` are not options.
    for argument in arguments.iter_mut().take_while(|argument| *argument != "--") {
        let Some(text) = argument.to_str() else { continue };
        let (name, value) = text.split_once('=').map_or((text, None), |(name, value)| (name, Some(value)));
        let Some(current) = current_name(name).filter(|current| has(command, current)) else { continue };
        notes.push(format!("note: {name} is now called {current}"));
        *argument = value.map_or_else(|| current.into(), |value| format!("{current}={value}").into());
    }
    (arguments, notes)
}

/// The current name of an option that had the name `old`.
pub fn current_name(old: &str) -> Option<&'static str> {
    RENAMED.into_iter().find(|(name, _)| *name == old).map(|(_, current)| current)
}

/// The old and the current name of a renamed option whose old name is near a misspelt one.
pub fn nearest_old_name(wrong: &str) -> Option<(&'static str, &'static str)> {
    let old = nearest(wrong, RENAMED.map(|(old, _)| old))?;
    RENAMED.into_iter().find(|(name, _)| *name == old)
}

/// Whether a command has an option, which is given with its dashes.
pub fn has(command: &Command, option: &str) -> bool {
    let name = option.trim_start_matches('-');
    command.get_arguments().any(|argument| argument.get_long() == Some(name))
}

/// The innermost command that the first words name.
pub fn given_command<'c>(arguments: &[OsString], program: &'c Command) -> &'c Command {
    let words = arguments.iter().skip(1).filter_map(|word| word.to_str());
    let names = words.filter(|word| !word.starts_with('-'));
    let mut command = program;
    for name in names {
        let Some(inner) = command.find_subcommand(name) else { break };
        command = inner;
    }
    command
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Arg;

    fn program() -> Command {
        let option = |name: &'static str| Arg::new(name).long(name);
        let render = Command::new("render").arg(option("film-cache")).arg(option("include-shared"));
        let export = Command::new("export").arg(option("film-cache"));
        Command::new("kinora").subcommand(render).subcommand(Command::new("farm").subcommand(export))
    }

    fn words(text: &str) -> Vec<OsString> {
        text.split(' ').map(OsString::from).collect()
    }

    #[test]
    fn old_names_become_current_ones_with_a_note() {
        let (arguments, notes) =
            to_current(words("kinora render a.ron --memory=2GB --with-shared 0-9 -- --memory"), &program());
        assert_eq!(arguments, words("kinora render a.ron --film-cache=2GB --include-shared 0-9 -- --memory"));
        let wanted = [
            "note: --memory is now called --film-cache",
            "note: --with-shared is now called --include-shared",
        ];
        assert_eq!(notes, wanted);
        let current = words("kinora farm export a.ron --film-cache 2GB");
        assert_eq!(to_current(current.clone(), &program()), (current, Vec::new()));
    }

    #[test]
    fn options_that_the_command_lacks_keep_their_names() {
        for text in
            ["kinora render a.ron --plays 2", "kinora farm export --with-shared 2", "kinora --memory 2"]
        {
            assert_eq!(to_current(words(text), &program()), (words(text), Vec::new()));
        }
    }

    #[test]
    fn misspelt_old_names_are_recognised() {
        assert_eq!(nearest_old_name("--memroy"), Some(("--memory", "--film-cache")));
        assert_eq!(nearest_old_name("--bounces"), None);
    }
}
