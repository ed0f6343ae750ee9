//! The golden sequences, for tests of what does not change their pictures.

use std::path::{Path, PathBuf};

/// All golden sequences, in order of their names.
pub fn sequences() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let entries = std::fs::read_dir(directory).expect("tests/golden");
    let mut files: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "ron"));
    files.sort();
    files
}
