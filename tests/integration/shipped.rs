//! The sequences and assets of the repository.

use kinora::sequence::load;
use std::fs;
use std::path::{Path, PathBuf};

/// Made by `cargo run --release --example assets`, and too large for the repository.
const MADE: &str = "cannot read the mesh \"../assets/meshes/shell.ply\"";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All files in a folder and below it, in order of their names.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let below = |path: PathBuf| if path.is_dir() { files(&path) } else { vec![path] };
    paths.into_iter().flat_map(below).collect()
}

/// The files in a folder that its README names in no table: `column` makes a file's name what stands there.
fn unlisted(folder: &str, column: impl Fn(&str) -> String) -> Vec<String> {
    let folder = root().join(folder);
    let readme = fs::read_to_string(folder.join("README.md")).expect("a README");
    let names = files(&folder).into_iter().map(|path| {
        let name = path.strip_prefix(&folder).expect("a file in the folder").to_string_lossy();
        name.replace('\\', "/")
    });
    let listed = |name: &String| readme.lines().any(|line| line.starts_with(&column(name)));
    names.filter(|name| name != "README.md" && !listed(name)).collect()
}

#[test]
fn shipped_sequences_have_no_mistakes() {
    let sequences = files(&root().join("sequences"));
    let sequences = sequences.iter().filter(|path| path.extension().is_some_and(|end| end == "ron"));
    for path in sequences {
        let Err(error) = load(path) else { continue };
        let error = error.to_string();
        let missing = error.contains(MADE) && error.contains("there is no such file");
        assert!(missing && error.matches("error:").count() == 1, "{path:?}: {error}");
        // The line that is shown says how to make it.
        assert!(error.contains("cargo run --release --example assets"), "{error}");
    }
}

#[test]
fn shipped_sequences_are_listed() {
    assert_eq!(unlisted("sequences", |name| format!("| [{name}]({name}) |")), [""; 0]);
}

/// Every asset's source and licence are known.
#[test]
fn assets_are_listed() {
    assert_eq!(unlisted("assets", |name| format!("| `{name}` |")), [""; 0]);
}
