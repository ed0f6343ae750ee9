//! One test per file: broken files and their messages, golden images, and the sequences of the repository, which must
//! render and mean the same in JSON.
//!
//! ```text
//! cargo test --release --test corpus                    # all of them
//! cargo test --release --test corpus golden/            # one kind
//! cargo test --release --test corpus sequences/hello    # one file
//! KINORA_BLESS=1 cargo test --release --test corpus bad/ # accept what is new
//! ```
#![allow(
    clippy::expect_used,
    clippy::panic,
    reason = "a test that panics has done its work; clippy knows only `#[test]`"
)]

mod bad;
mod converted;
mod golden;
mod meshes;
#[path = "../../examples/assets/paint.rs"]
#[allow(dead_code, reason = "meshes need a part of it")]
mod paint;
mod render;
mod shipped;
#[path = "../../src/sequence/schema/tests/validator.rs"]
mod validator;

use libtest_mimic::{Arguments, Failed, Trial};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// A file's test: what is wrong with it, if anything is.
type Check = fn(&Path) -> Result<(), Failed>;

/// Names of tests, the folder of their files, the number of files at least, so that none gets lost, and the test.
const FOLDERS: [(&str, &str, usize, Check); 7] = [
    ("bad", "tests/bad", 60, bad::check),
    ("golden", "tests/golden", 5, golden::check),
    ("sequences", "sequences", 26, shipped::check),
    ("sequences/bench", "sequences/bench", 4, shipped::check_bench),
    ("benches/targets", "benches/targets", 5, shipped::check),
    ("json/sequences", "sequences", 26, converted::check),
    ("json/bench", "sequences/bench", 4, converted::check),
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let mut trials = Vec::new();
    for (kind, folder, least, check) in FOLDERS {
        let files = sequences(folder);
        assert!(files.len() >= least, "{folder} has shrunk to {} files", files.len());
        for path in files {
            let name = path.file_stem().expect("a name").to_string_lossy();
            trials.push(Trial::test(format!("{kind}/{name}"), move || check(&path)));
        }
    }
    libtest_mimic::run(&arguments, trials).exit_code()
}

/// Whether new results replace the expected ones.
fn bless() -> bool {
    std::env::var_os("KINORA_BLESS").is_some()
}

/// The sequences in a folder of the repository, by name.
fn sequences(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).expect(folder);
    let mut files: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "ron"));
    files.sort();
    files
}
