//! Files into sequences, and a sequence's files into outputs, with faults as failures.

use super::failure::Failure;
use super::terminal;
use crate::encode::Output;
use crate::sequence::Sequence;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The sequence in a file.
pub fn sequence(path: &Path) -> Result<Sequence, Failure> {
    let name = path.display();
    match std::fs::metadata(path) {
        Ok(what) if what.is_dir() => {
            return Err(Failure::Bad(format!("{name} is a folder; name the sequence file in it")));
        }
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err(Failure::Bad(format!("there is no file {name}{}", suggestion(path))));
        }
        Err(error) => return Err(Failure::Bad(format!("cannot read {name}: {error}"))),
        Ok(_) => {}
    }
    read(path).map_err(|error| Failure::Faults(error.render(terminal::color())))
}

/// The usual slip is to leave out the extension.
fn suggestion(path: &Path) -> String {
    let ron = path.with_extension("ron");
    if ron.is_file() { format!("; did you mean {}?", ron.display()) } else { String::new() }
}

/// What a sequence's files are, each different. `source` says where they are named: `-o` or a field.
pub fn outputs(files: &[String], source: &str) -> Result<Vec<Output>, Failure> {
    let mut outputs = Vec::new();
    for file in files {
        let output = output(file).map_err(|error| Failure::Bad(format!("{source} {file}: {error}")))?;
        if outputs.contains(&output) {
            return Err(Failure::Bad(format!("{source} {file}: named twice")));
        }
        outputs.push(output);
    }
    Ok(outputs)
}

/// Stands in for `crate::sequence::LoadError`.
struct Unread(PathBuf);

impl Unread {
    fn render(&self, _color: bool) -> String {
        format!("error: {}: this build cannot read sequence files", self.0.display())
    }
}

/// Stands in for `crate::sequence::load`.
fn read(path: &Path) -> Result<Sequence, Unread> {
    Err(Unread(path.to_owned()))
}

/// Stands in for `Output::parse`.
fn output(file: &str) -> Result<Output, String> {
    match Path::new(file).extension().and_then(|e| e.to_str()) {
        Some("png") => Ok(Output::Png(file.into())),
        Some("gif") => Ok(Output::Gif(file.into())),
        _ => Err("the name must end in .png or .gif".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(files: &[&str]) -> Result<Vec<Output>, Failure> {
        outputs(&files.iter().map(|&file| file.to_owned()).collect::<Vec<_>>(), "--output")
    }

    #[test]
    fn outputs_are_told_apart() {
        let both = vec![Output::Png("a/####.png".into()), Output::Gif("a.gif".into())];
        assert_eq!(named(&["a/####.png", "a.gif"]), Ok(both));
        let twice = Failure::Bad("--output a.gif: named twice".into());
        assert_eq!(named(&["a.gif", "b.gif", "a.gif"]), Err(twice));
        assert!(matches!(named(&["a.mp3"]), Err(Failure::Bad(text)) if text.starts_with("--output a.mp3: ")));
    }
}
