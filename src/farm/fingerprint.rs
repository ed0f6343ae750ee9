//! The version of Kinora and the contents of all input files of a job.
//!
//! The frames of a job are rendered at different times on different machines. They fit together only if the same
//! version renders them from the same files. So every task compares fingerprints before it starts.

use crate::base::digest::{Digest, Digester};
use crate::base::escape;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Written as `0.1.0:6f1b0c9e24aa:…`: the version, then twelve digits of each file's digest. The sequence's file is
/// first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fingerprint {
    version: String,
    files: Vec<(PathBuf, String)>,
}

/// The version of this program.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Digits of a file's digest: 48 bits, so that a changed file goes unnoticed with a probability of 2⁻⁴⁸.
const DIGITS: usize = 12;

/// Bytes of one read.
const BLOCK: usize = 1 << 20;

impl Fingerprint {
    /// Reads a sequence's file and the files that it names. Their order must be the same on every machine.
    ///
    /// # Errors
    /// The path of the file that cannot be read, and why.
    pub fn of(sequence: &Path, assets: &[PathBuf]) -> Result<Self, (PathBuf, io::Error)> {
        let files = std::iter::once(sequence).chain(assets.iter().map(PathBuf::as_path));
        let digests = files.map(|path| match digest(path) {
            Ok(digest) => Ok((path.to_owned(), digest.to_string()[..DIGITS].to_owned())),
            Err(error) => Err((path.to_owned(), error)),
        });
        Ok(Self { version: VERSION.to_owned(), files: digests.collect::<Result<_, _>>()? })
    }

    /// Compares this version and these files with those of a job.
    ///
    /// # Errors
    /// A message that names the difference and says what to do.
    pub fn check(&self, expected: &str) -> Result<(), String> {
        const EXPORT_AGAIN: &str = "export the job again";
        let (version, files) = expected.split_once(':').unwrap_or((expected, ""));
        let files: Vec<&str> = files.split(':').collect();
        let valid = |file: &&str| file.len() == DIGITS && file.bytes().all(|byte| byte.is_ascii_hexdigit());
        if version.is_empty() || !files.iter().all(valid) {
            return Err(format!(
                "--expect: {expected:?} is not a fingerprint; use one that `kinora farm export` has written"
            ));
        }
        if version != self.version {
            return Err(format!(
                "the job was exported by Kinora {version}, but this is Kinora {}, which may render other frames; run \
                 it with {version}, or {EXPORT_AGAIN}",
                self.version
            ));
        }
        let changed = |path: &Path| {
            format!("{} has changed since the job was exported; {EXPORT_AGAIN}", escape::path(path))
        };
        let mut pairs = self.files.iter().zip(&files);
        match pairs.find(|((_, found), expected)| found != *expected) {
            Some(((path, _), _)) if self.files.len() == files.len() => Err(changed(path)),
            // With another number of files, only the sequence's own digest is at a known place.
            Some(((path, _), _)) if path == &self.files[0].0 => Err(changed(path)),
            None if self.files.len() == files.len() => Ok(()),
            _ => Err(format!(
                "the sequence reads {} files now, but read {} when the job was exported; {EXPORT_AGAIN}",
                self.files.len() - 1,
                files.len() - 1
            )),
        }
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.version)?;
        self.files.iter().try_for_each(|(_, digest)| write!(f, ":{digest}"))
    }
}

fn digest(path: &Path) -> io::Result<Digest> {
    let mut file = File::open(path)?;
    let (mut digester, mut block) = (Digester::new(), vec![0; BLOCK]);
    loop {
        match file.read(&mut block)? {
            0 => return Ok(digester.finish()),
            read => digester.bytes(&block[..read]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn differences_are_reported() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        for name in ["a.ron", "x.ply", "y.png"] {
            fs::write(at(name), name).expect("a disk");
        }
        let now = |assets: &[&str]| {
            let assets: Vec<PathBuf> = assets.iter().map(|name| at(name)).collect();
            Fingerprint::of(&at("a.ron"), &assets).expect("files")
        };
        let before = now(&["x.ply", "y.png"]).to_string();
        assert_eq!(before.len(), VERSION.len() + 3 * (1 + DIGITS));
        assert_eq!(now(&["x.ply", "y.png"]).check(&before), Ok(()));
        let refused = |found: Fingerprint, expected: &str, part: &str| {
            let message = found.check(expected).expect_err("a difference");
            assert!(message.contains(part), "{message}");
        };
        refused(now(&["x.ply", "y.png"]), &before.replacen('0', "9", 1), "exported by Kinora 9");
        refused(now(&["x.ply"]), &before, "reads 1 files now, but read 2 when");
        for text in ["", "0.1.0", "0.1.0:", "0.1.0:abc", "::", "0.1.0:00000000000g"] {
            refused(now(&[]), text, "is not a fingerprint");
        }
        fs::write(at("y.png"), "other").expect("a disk");
        refused(now(&["x.ply", "y.png"]), &before, "y.png has changed");
        fs::write(at("a.ron"), "other").expect("a disk");
        refused(now(&["x.ply"]), &before, "a.ron has changed");
    }
}
