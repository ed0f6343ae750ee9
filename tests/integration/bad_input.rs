//! Broken files and their messages: `tests/bad/NAME.ron` gives exactly `tests/bad/NAME.txt`.
//! `KINORA_BLESS=1` writes the messages as they are now.

use kinora::sequence::parse;
use std::fs;
use std::path::{Path, PathBuf};

fn bad_files() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad");
    let entries = fs::read_dir(directory).expect("tests/bad");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "ron"));
    files.sort();
    files
}

#[test]
fn every_bad_file_gives_its_message() {
    let bless = std::env::var_os("KINORA_BLESS").is_some();
    let files = bad_files();
    assert!(files.len() >= 25, "the corpus has shrunk to {}", files.len());
    let mut wrong = Vec::new();
    for path in files {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let source = fs::read_to_string(&path).expect("a text");
        // Images are found by the whole path, of which messages keep what is the same on every machine.
        let path_text = path.to_string_lossy();
        let message = match parse(&path_text, &source) {
            Ok(_) => panic!("{name} is accepted"),
            Err(faults) => format!("{faults}\n").replace(&*path_text, &name),
        };
        let expected = path.with_extension("txt");
        if bless {
            fs::write(&expected, message).expect("a writable corpus");
        } else if fs::read_to_string(&expected).unwrap_or_default() != message {
            wrong.push(format!("{name} now says:\n{message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
