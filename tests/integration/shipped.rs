//! The sequences and assets of the repository: those that its READMEs list.

use kinora::sequence::load;
use std::fs;
use std::path::Path;

/// Made by `cargo run --release --example assets`, and too large for the repository.
const MADE: &str = "cannot read the mesh \"../assets/meshes/shell.ply\"";

/// The names in the first column of a folder's README, between `open` and `close`.
fn listed(folder: &str, open: &str, close: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join("README.md");
    let readme = fs::read_to_string(path).expect("a README");
    let name = |line: &str| Some(line.strip_prefix(open)?.split_once(close)?.0.to_owned());
    readme.lines().filter_map(name).filter(|name| name.contains('.')).collect()
}

#[test]
fn shipped_sequences_have_no_mistakes() {
    let sequences = listed("sequences", "| [", "]");
    assert!(sequences.len() >= 15, "{sequences:?}");
    for name in sequences {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("sequences").join(name);
        let Err(error) = load(&path) else { continue };
        let error = error.to_string();
        let missing = error.contains(MADE) && error.contains("there is no such file");
        assert!(missing && error.matches("error:").count() == 1, "{path:?}: {error}");
        // The line that is shown says how to make it.
        assert!(error.contains("cargo run --release --example assets"), "{error}");
    }
}

#[test]
fn listed_assets_are_there() {
    let assets = listed("assets", "| `", "`");
    assert!(assets.len() >= 8, "{assets:?}");
    for name in assets.iter().filter(|name| !name.ends_with(".ply")) {
        assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name).is_file(), "{name}");
    }
}
