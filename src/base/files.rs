//! Reading files: regular files, up to a size, and within one folder.

mod jpeg;

pub use jpeg::is_truncated;

use crate::base::escape;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

/// The message if a file does not exist.
pub const NO_FILE: &str = "there is no such file";

/// Opens a regular file of at most `most` bytes and returns it with its size. Devices, which may be endless, and
/// pipes, which may block for ever, are refused before they are opened.
pub fn open(path: &Path, most: u64) -> io::Result<(File, u64)> {
    let what = fs::metadata(path)?;
    if what.is_dir() {
        // The error of reading a folder differs between systems.
        return Err(ErrorKind::IsADirectory.into());
    }
    if !what.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is a device or a pipe, not a regular file"));
    }
    if what.len() > most {
        return Err(too_large(most));
    }
    Ok((File::open(path)?, what.len()))
}

/// Reads a regular file of at most `most` bytes.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read_at_most(open(path, most)?.0, most)
}

/// Reads an input of at most `most` bytes. Its size may be unknown, or may grow meanwhile.
pub fn read_at_most(input: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // Reading one byte more than allowed reveals inputs that are too large.
    input.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(bytes) }
}

/// The text in the bytes of a file.
///
/// # Errors
/// The line of the first byte that is not UTF-8.
pub fn utf8(bytes: Vec<u8>) -> Result<String, String> {
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = good.iter().filter(|byte| **byte == b'\n').count() + 1;
        format!("it is not UTF-8 text; the first wrong byte is in line {line}")
    })
}

fn too_large(most: u64) -> io::Error {
    let most = match most >> 20 {
        mebibytes if mebibytes.is_multiple_of(1024) => format!("{} GiB", mebibytes >> 10),
        mebibytes => format!("{mebibytes} MiB"),
    };
    io::Error::new(ErrorKind::FileTooLarge, format!("it is larger than {most}"))
}

/// What differs after a file was written again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileStamp {
    modified: Option<SystemTime>,
    length: u64,
}

impl FileStamp {
    /// The stamp of a file as it is now; `None` if there is none.
    pub fn of(path: &Path) -> Option<Self> {
        let data = fs::metadata(path).ok()?;
        Some(Self { modified: data.modified().ok(), length: data.len() })
    }
}

/// The folder that contains all files that a sequence may name, after `..` and links are resolved; or no such limit.
/// It remembers the files that were named.
#[derive(Clone, Debug, Default)]
pub struct Root {
    folder: Option<PathBuf>,
    named: Arc<Mutex<NamedFiles>>,
}

/// The files that a sequence names.
#[derive(Debug, Default)]
struct NamedFiles {
    /// With their stamps before they were read.
    admitted: BTreeMap<PathBuf, Option<FileStamp>>,
    missing: BTreeSet<PathBuf>,
}

/// The name of a folder that marks a project. Its parent is the root.
const MARK: &str = "assets";

impl Root {
    /// Files may be anywhere.
    pub fn anywhere() -> Self {
        Self::default()
    }

    /// The root of a sequence in `folder`: the nearest folder, from `folder` upwards, that contains a folder
    /// `assets`; otherwise `folder`.
    pub fn of(folder: &Path) -> Self {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        // A folder that does not exist keeps its name; it contains no files.
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        let marked = folder.ancestors().find(|above| above.join(MARK).is_dir());
        Self { folder: Some(marked.unwrap_or(&folder).to_owned()), named: Arc::default() }
    }

    /// The canonical path of a file.
    ///
    /// # Errors
    /// If the file does not exist or is outside of the root.
    pub fn admit(&self, path: &Path) -> io::Result<PathBuf> {
        let path = path.canonicalize().inspect_err(|_| {
            self.named().missing.insert(path.to_owned());
        })?;
        match &self.folder {
            Some(root) if !path.starts_with(root) => {
                let root = escape::path(root);
                Err(io::Error::other(format!("it is outside of {root}; --allow-outside permits reading it")))
            }
            _ => {
                self.named().admitted.entry(path.clone()).or_insert_with(|| FileStamp::of(&path));
                Ok(path)
            }
        }
    }

    /// The folder; `None` if files may be anywhere.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The files that were admitted so far, sorted by path.
    pub fn admitted(&self) -> Vec<PathBuf> {
        self.named().admitted.keys().cloned().collect()
    }

    /// All files that were named so far, with their stamps before they were read. Missing files have none.
    pub fn stamps(&self) -> BTreeMap<PathBuf, Option<FileStamp>> {
        let named = self.named();
        let missing = named.missing.iter().map(|path| (path.clone(), None));
        missing.chain(named.admitted.iter().map(|(path, stamp)| (path.clone(), *stamp))).collect()
    }

    fn named(&self) -> MutexGuard<'_, NamedFiles> {
        self.named.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The relative path from one existing folder to another. It is empty if they are the same.
pub fn relative_path(from: &Path, to: &Path) -> io::Result<PathBuf> {
    let whole = |path: &Path| if path.as_os_str().is_empty() { Path::new(".") } else { path }.canonicalize();
    let (from, to) = (whole(from)?, whole(to)?);
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    Ok(up.chain(to.components().skip(shared)).collect())
}

/// A file that is written in place, byte after byte, and cannot be replaced by a new file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpecialFile {
    Pipe,
    Device,
    /// Cannot be opened by its path.
    Socket,
}

impl SpecialFile {
    /// The kind of special file that a path leads to through all links; `None` for regular files, folders and missing
    /// files.
    #[cfg(unix)]
    pub fn at(path: &Path) -> Option<Self> {
        use std::os::unix::fs::FileTypeExt;
        let what = fs::metadata(path).ok()?.file_type();
        match () {
            () if what.is_fifo() => Some(Self::Pipe),
            () if what.is_char_device() || what.is_block_device() => Some(Self::Device),
            () if what.is_socket() => Some(Self::Socket),
            () => None,
        }
    }

    #[cfg(not(unix))]
    pub fn at(_: &Path) -> Option<Self> {
        None
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Pipe => "a pipe",
            Self::Device => "a device",
            Self::Socket => "a socket",
        }
    }
}

/// The target of a path that leaves the working directory through links: through a link to a folder, or a link to a
/// pipe or a device; `None` if it stays inside. Any other file is replaced, even if it is a link. `path` itself has no
/// `..`.
pub fn outside_target(path: &Path) -> Option<PathBuf> {
    let here = Path::new(".").canonicalize().ok()?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let there = |path: &&Path| path.symlink_metadata().is_ok();
    let known = folder.ancestors().find(there).unwrap_or(Path::new("."));
    let known = [Some(known), SpecialFile::at(path).map(|_| path)].into_iter().flatten();
    // The target of a dangling link may exist by the time it is followed.
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.read_link().unwrap_or_default());
    known.map(whole).find(|whole| !whole.starts_with(&here))
}

/// The file that exists in place of a folder or of one of its parents.
pub fn blocking_file(folder: &Path) -> Option<&Path> {
    // A file does not exist under a path with a trailing slash.
    let folder = folder.components().as_path();
    folder.ancestors().find(|path| path.exists()).filter(|path| !path.is_dir())
}

/// The message of an error. The most common errors have the same message on every system.
pub fn describe(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => NO_FILE.to_owned(),
        ErrorKind::PermissionDenied => "reading it is not permitted".to_owned(),
        ErrorKind::IsADirectory => "it is a folder".to_owned(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_up_to_a_size_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        let message = |path: &Path| describe(&read(path, 1 << 20).expect_err("not to be read"));
        assert_eq!(message(&path), "there is no such file");
        assert_eq!(message(folder.path()), "it is a folder");
        fs::write(&path, vec![7; 1 << 20]).expect("a disk");
        assert_eq!(read(&path, 1 << 20).expect("a plain file").len(), 1 << 20);
        fs::write(&path, vec![7; (1 << 20) + 1]).expect("a disk");
        assert_eq!(message(&path), "it is larger than 1 MiB");
    }

    #[test]
    fn files_that_block_folders_are_found() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("file");
        fs::write(&file, "").expect("a disk");
        for inside in ["", "a", "a/b/"] {
            assert_eq!(blocking_file(&file.join(inside)), Some(file.as_path()), "{inside}");
            assert_eq!(blocking_file(&folder.path().join(inside)), None, "{inside}");
        }
        assert_eq!(blocking_file(Path::new("")), None);
    }

    #[test]
    fn inputs_of_unknown_size_are_measured() {
        assert_eq!(read_at_most(&b"abc"[..], 3).expect("short enough"), b"abc");
        let error = read_at_most(io::repeat(0), 3 << 20).expect_err("endless");
        assert_eq!(describe(&error), "it is larger than 3 MiB");
    }

    #[test]
    fn the_root_is_the_nearest_folder_with_assets() {
        let dir = tempfile::tempdir().expect("a folder");
        let top = dir.path().canonicalize().expect("a folder");
        for folder in ["assets", "a/b", "c/assets", "c/d"] {
            fs::create_dir_all(top.join(folder)).expect("a disk");
        }
        let root = |folder: &str| Root::of(&top.join(folder)).folder().map(Path::to_owned);
        assert_eq!(root("a/b"), Some(top.clone()));
        assert_eq!(root("c/d/../d"), Some(top.join("c")));
        // A file named `assets` does not count. A folder that does not exist is its own root.
        fs::remove_dir(top.join("assets")).expect("a disk");
        fs::write(top.join("a/assets"), "").expect("a disk");
        assert_eq!(root("a/b"), Some(top.join("a/b")));
        assert_eq!(root("none"), Some(top.join("none")));
    }

    #[cfg(unix)]
    #[test]
    fn links_and_dots_do_not_lead_out_of_the_root() {
        let dir = tempfile::tempdir().expect("a folder");
        let top = dir.path().canonicalize().expect("a folder");
        for folder in ["in/assets", "inner"] {
            fs::create_dir_all(top.join(folder)).expect("a disk");
        }
        for file in ["secret", "in/plain", "inner/near"] {
            fs::write(top.join(file), "").expect("a disk");
        }
        std::os::unix::fs::symlink(top.join("secret"), top.join("in/link")).expect("a disk");
        std::os::unix::fs::symlink(top.join("in/plain"), top.join("back")).expect("a disk");
        let root = Root::of(&top.join("in/assets"));
        for (name, good) in [
            ("in/plain", true),
            ("in/assets/../plain", true),
            ("back", true),
            ("in/link", false),
            ("in/../secret", false),
            ("inner/near", false),
        ] {
            let admitted = root.admit(&top.join(name));
            assert_eq!(admitted.is_ok(), good, "{name}");
            assert!(Root::anywhere().admit(&top.join(name)).is_ok());
            let message = admitted.map_err(|error| describe(&error)).err();
            assert!(good || message.is_some_and(|message| message.contains("--allow-outside")), "{name}");
        }
        assert_eq!(describe(&root.admit(&top.join("none")).expect_err("no file")), NO_FILE);
    }

    #[test]
    fn relative_paths_lead_up_and_down() {
        let dir = tempfile::tempdir().expect("a folder");
        let top = dir.path();
        fs::create_dir_all(top.join("a/b")).expect("a disk");
        fs::create_dir_all(top.join("c")).expect("a disk");
        let path = |from: &str, to: &str| relative_path(&top.join(from), &top.join(to)).expect("folders");
        for (from, to, expected) in [
            ("a", "a", ""),
            ("a", "a/b", "b"),
            ("a/b", "a", ".."),
            ("a/b", "c", "../../c"),
            ("a/../c", "a", "../a"),
        ] {
            assert_eq!(path(from, to), Path::new(expected));
        }
        assert!(relative_path(top, &top.join("none")).is_err());
    }

    #[test]
    fn a_root_records_admitted_files() {
        let dir = tempfile::tempdir().expect("a folder");
        let top = dir.path().canonicalize().expect("a folder");
        for name in ["b", "a"] {
            fs::write(top.join(name), "").expect("a disk");
        }
        let root = Root::of(&top);
        let copy = root.clone();
        for name in ["b", "a", "./b", "none", ".."] {
            let _ = copy.admit(&top.join(name));
        }
        assert_eq!(root.admitted(), [top.join("a"), top.join("b")]);
    }

    #[cfg(unix)]
    #[test]
    fn special_files_are_recognized() {
        let dir = tempfile::tempdir().expect("a folder");
        let socket = dir.path().join("socket");
        let _bound = std::os::unix::net::UnixListener::bind(&socket).expect("a disk");
        std::os::unix::fs::symlink("/dev/null", dir.path().join("link")).expect("a disk");
        assert_eq!(SpecialFile::at(&socket), Some(SpecialFile::Socket));
        assert_eq!(SpecialFile::at(&dir.path().join("link")), Some(SpecialFile::Device));
        assert_eq!((SpecialFile::at(dir.path()), SpecialFile::at(&dir.path().join("none"))), (None, None));
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_refused() {
        let error = read(Path::new("/dev/zero"), 1 << 20).expect_err("endless");
        assert_eq!(describe(&error), "it is a device or a pipe, not a regular file");
    }
}
