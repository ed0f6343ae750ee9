//! The file of a turntable's sequence.

use crate::base::escape;
use crate::base::files;
use crate::cli::failure::Failure;
use crate::cli::settings::RecordedSettings;
use crate::cli::shell;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A sequence that is written.
pub struct Written {
    pub path: PathBuf,
    pub text: String,
    /// How it is rendered again.
    pub note: String,
}

impl Written {
    /// Checks that there is a folder, and no other file.
    pub fn check(&self) -> Result<(), Failure> {
        match std::fs::read(&self.path) {
            Ok(there) if there == self.text.as_bytes() => Ok(()),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            _ => Err(exists(&self.path)),
        }
    }

    /// Writes the file, unless it is there.
    pub fn write(&self) -> Result<(), Failure> {
        let Self { path, text, .. } = self;
        let file = OpenOptions::new().write(true).create_new(true).open(path);
        file.and_then(|mut file| file.write_all(text.as_bytes())).or_else(|error| match error.kind() {
            ErrorKind::AlreadyExists => self.check(),
            _ => {
                Err(Failure::Bad(format!("cannot write {}: {}", escape::path(path), files::describe(&error))))
            }
        })
    }
}

fn exists(path: &Path) -> Failure {
    let name = escape::path(path);
    Failure::Bad(format!("--write: {name} exists already, and may have changes; choose another name"))
}

/// How a written sequence is rendered again: with the options that its text does not hold.
pub fn note(path: &Path, outside: bool, recorded: &RecordedSettings) -> String {
    let RecordedSettings { settings, arguments } = recorded;
    // A draft changes what the text holds, unless the options are there again.
    let held: &[&str] =
        if settings.options.draft { &[] } else { &["--size", "--fps", "--antialias", "--bounces"] };
    let is_held = |word: &str| word.split('=').next().is_some_and(|name| held.contains(&name));
    let more = arguments.iter().filter(|word| !is_held(word) && *word != "--allow-outside");
    let more = more.map(|word| shell::quote(word.as_ref()));
    let allow = outside.then(|| "--allow-outside".to_owned());
    let words: Vec<_> = [shell::quote(path.as_os_str())].into_iter().chain(allow).chain(more).collect();
    format!("{} is the sequence; `kinora render {}` renders it again", escape::path(path), words.join(" "))
}
