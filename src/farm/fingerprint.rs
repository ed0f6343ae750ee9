//! What a job was exported with: the version, and the contents of the sequence's file and of all files that it reads.
//!
//! Frames of one job are made at different times on different machines. They fit together if each of them was made by
//! the same version of the same files; so every task looks before it begins.

use crate::base::digest::{Digest, Digester};
use crate::base::escape;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Told as `0.1.0:6f1b0c9e24aa:…`: the version, then twelve digits of each file's digest, the sequence's own first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fingerprint {
    version: String,
    files: Vec<(PathBuf, String)>,
}

/// This one.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Digits of a file's digest: changes are found, unless 2⁴⁸ files are tried to hide one.
const DIGITS: usize = 12;

/// Bytes that are read at once.
const BLOCK: usize = 1 << 20;

impl Fingerprint {
    /// Of a sequence's file and the files that it reads, in an order that is the same on every machine.
    ///
    /// # Errors
    /// The file that cannot be read.
    pub fn of(sequence: &Path, assets: &[PathBuf]) -> Result<Self, (PathBuf, io::Error)> {
        let files = std::iter::once(sequence).chain(assets.iter().map(PathBuf::as_path));
        let digests = files.map(|path| match digest(path) {
            Ok(digest) => Ok((path.to_owned(), digest.to_string()[..DIGITS].to_owned())),
            Err(error) => Err((path.to_owned(), error)),
        });
        Ok(Self { version: VERSION.to_owned(), files: digests.collect::<Result<_, _>>()? })
    }

    /// Whether these are the version and the files that a job was exported with.
    ///
    /// # Errors
    /// What is another, and what to do.
    pub fn check(&self, expected: &str) -> Result<(), String> {
        const ANEW: &str = "export the job anew";
        let (version, files) = expected.split_once(':').unwrap_or((expected, ""));
        let files: Vec<&str> = files.split(':').collect();
        let told = |file: &&str| file.len() == DIGITS && file.bytes().all(|byte| byte.is_ascii_hexdigit());
        if version.is_empty() || !files.iter().all(told) {
            return Err(format!(
                "--expect: {expected:?} is no fingerprint; `kinora farm export` writes them"
            ));
        }
        if version != self.version {
            return Err(format!(
                "the job was exported by Kinora {version}, and this is {}: their frames may differ; run it with \
                 {version}, or {ANEW}",
                self.version
            ));
        }
        let changed =
            |path: &Path| format!("{} has changed since the job was exported; {ANEW}", escape::path(path));
        let mut pairs = self.files.iter().zip(&files);
        match pairs.find(|((_, found), expected)| found != *expected) {
            Some(((path, _), _)) if self.files.len() == files.len() => Err(changed(path)),
            // A file more or less moves all after it, unless it is the sequence's own that is another.
            Some(((path, _), _)) if path == &self.files[0].0 => Err(changed(path)),
            None if self.files.len() == files.len() => Ok(()),
            _ => Err(format!(
                "the sequence reads {} files now, and read {} when the job was exported; {ANEW}",
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
    fn what_is_another_is_told() {
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
            let told = found.check(expected).expect_err("another");
            assert!(told.contains(part), "{told}");
        };
        refused(now(&["x.ply", "y.png"]), &before.replacen('0', "9", 1), "exported by Kinora 9");
        refused(now(&["x.ply"]), &before, "reads 1 files now, and read 2 when");
        for text in ["", "0.1.0", "0.1.0:", "0.1.0:abc", "::", "0.1.0:00000000000g"] {
            refused(now(&[]), text, "is no fingerprint");
        }
        fs::write(at("y.png"), "other").expect("a disk");
        refused(now(&["x.ply", "y.png"]), &before, "y.png has changed");
        fs::write(at("a.ron"), "other").expect("a disk");
        refused(now(&["x.ply"]), &before, "a.ron has changed");
    }
}
