//! Files into sequences, and a sequence's files into outputs, with faults as failures.

use super::failure::Failure;
use super::terminal;
use crate::encode::Output;
use crate::sequence::Sequence;
use std::io::ErrorKind;
use std::path::Path;

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
    crate::sequence::load(path).map_err(|error| Failure::Faults(error.render(terminal::color())))
}

/// The usual slip is to leave out the extension.
fn suggestion(path: &Path) -> String {
    let ron = path.with_extension("ron");
    if ron.is_file() { format!("; did you mean {}?", ron.display()) } else { String::new() }
}

/// What the files of a sequence or of `-o` are, each different.
pub fn outputs(files: &[String]) -> Result<Vec<Output>, Failure> {
    let mut outputs = Vec::new();
    for file in files {
        let output = Output::parse(file).map_err(|error| Failure::Bad(error.to_string()))?;
        if outputs.contains(&output) {
            return Err(Failure::Bad(format!("output \"{file}\" is named twice; name each file once")));
        }
        outputs.push(output);
    }
    Ok(outputs)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(files: &[&str]) -> Result<Vec<Output>, Failure> {
        outputs(&files.iter().map(|&file| file.to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn outputs_keep_their_order_and_differ() {
        let found = named(&["a/####.png", "a.gif"]);
        assert!(matches!(found.as_deref(), Ok([Output::Png(_), Output::Gif(_)])), "{found:?}");
        let twice = named(&["a.gif", "b.gif", "a.gif"]);
        assert!(
            matches!(&twice, Err(Failure::Bad(text)) if text.contains("\"a.gif\" is named twice")),
            "{twice:?}"
        );
        let unknown = named(&["a.gif", "b.mp3"]);
        assert!(matches!(&unknown, Err(Failure::Bad(text)) if text.contains("\"b.mp3\"")), "{unknown:?}");
    }
}
