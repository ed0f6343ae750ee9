//! Files that are read: plain ones, up to a size, and inside one folder.

mod jpeg;

pub use jpeg::is_cut;

use crate::base::escape;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Why nothing can be read from where no file is.
pub const NO_FILE: &str = "there is no such file";

/// Opens a plain file of at most `most` bytes, and tells its size. What has no end, such as a device, and what
/// may wait for ever, such as a pipe, is refused before it is opened.
pub fn open(path: &Path, most: u64) -> io::Result<(File, u64)> {
    let what = fs::metadata(path)?;
    if what.is_dir() {
        // What reading one says differs between systems.
        return Err(ErrorKind::IsADirectory.into());
    }
    if !what.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is no plain file, but a device or a pipe"));
    }
    if what.len() > most {
        return Err(too_large(most));
    }
    Ok((File::open(path)?, what.len()))
}

/// All bytes of a plain file, if those are at most `most`.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    read_at_most(open(path, most)?.0, most)
}

/// All bytes of anything, if those are at most `most`: also of what does not tell its size, or grows meanwhile.
pub fn read_at_most(input: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    // One byte more than allowed tells what is too large.
    input.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(bytes) }
}

fn too_large(most: u64) -> io::Error {
    let most = match most >> 20 {
        mebibytes if mebibytes.is_multiple_of(1024) => format!("{} GiB", mebibytes >> 10),
        mebibytes => format!("{mebibytes} MiB"),
    };
    io::Error::new(ErrorKind::FileTooLarge, format!("it is larger than {most}"))
}

/// The folder in which all files lie that a sequence may name, wherever `..` and links lead; or none. It remembers which
/// files it has admitted.
#[derive(Clone, Debug, Default)]
pub struct Root {
    folder: Option<PathBuf>,
    admitted: Arc<Mutex<BTreeSet<PathBuf>>>,
}

/// The folder that marks a project: its parent is the root.
const MARK: &str = "assets";

impl Root {
    /// Files may lie anywhere.
    pub fn anywhere() -> Self {
        Self::default()
    }

    /// The root of a sequence in `folder`: the nearest folder, from this one upwards, that holds one called `assets`;
    /// else this one.
    pub fn of(folder: &Path) -> Self {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        // A folder that does not exist holds no files either, and keeps its name.
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        let marked = folder.ancestors().find(|above| above.join(MARK).is_dir());
        Self { folder: Some(marked.unwrap_or(&folder).to_owned()), admitted: Arc::default() }
    }

    /// The one name among the many of a file that is there.
    ///
    /// # Errors
    /// No such file, or one outside of the root.
    pub fn admit(&self, path: &Path) -> io::Result<PathBuf> {
        let path = path.canonicalize()?;
        match &self.folder {
            Some(root) if !path.starts_with(root) => {
                let root = escape::path(root);
                Err(io::Error::other(format!("it lies outside of {root}; --allow-outside lets it be read")))
            }
            _ => {
                self.names().insert(path.clone());
                Ok(path)
            }
        }
    }

    /// The folder, if files may not lie anywhere.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The files that were admitted so far, in the order of their names.
    pub fn admitted(&self) -> Vec<PathBuf> {
        self.names().iter().cloned().collect()
    }

    fn names(&self) -> MutexGuard<'_, BTreeSet<PathBuf>> {
        self.admitted.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The way from one folder to another, both of which are there: empty if they are one.
pub fn way(from: &Path, to: &Path) -> io::Result<PathBuf> {
    let whole = |path: &Path| if path.as_os_str().is_empty() { Path::new(".") } else { path }.canonicalize();
    let (from, to) = (whole(from)?, whole(to)?);
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    Ok(up.chain(to.components().skip(shared)).collect())
}

/// What a file is that takes bytes one after the other, and cannot be replaced by another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    Pipe,
    Device,
    /// Takes none of those who only know its name.
    Socket,
}

impl Channel {
    /// What a path leads to through all links, if that is no plain file, no folder, and not nothing.
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

/// Where a path leads that goes out of the working directory, if it does: through a link to a folder, or one that leads
/// to a pipe or a device. Any other file is replaced, be it a link or not. `path` itself has no `..`.
pub fn leaves(path: &Path) -> Option<PathBuf> {
    let here = Path::new(".").canonicalize().ok()?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let there = |path: &&Path| path.symlink_metadata().is_ok();
    let known = folder.ancestors().find(there).unwrap_or(Path::new("."));
    let known = [Some(known), Channel::at(path).map(|_| path)].into_iter().flatten();
    // A link that leads nowhere may lead anywhere by the time it is followed.
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.read_link().unwrap_or_default());
    known.map(whole).find(|whole| !whole.starts_with(&here))
}

/// The file that stands where a folder, or one above it, should be.
pub fn in_the_way(folder: &Path) -> Option<&Path> {
    // With a slash behind it, a file is not there.
    let folder = folder.components().as_path();
    folder.ancestors().find(|path| path.exists()).filter(|path| !path.is_dir())
}

/// What is wrong, the commonest in words that are the same on every system.
pub fn why(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => NO_FILE.to_owned(),
        ErrorKind::PermissionDenied => "it may not be read".to_owned(),
        ErrorKind::IsADirectory => "it is a folder".to_owned(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_files_up_to_a_size_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        let told = |path: &Path| why(&read(path, 1 << 20).expect_err("not to be read"));
        assert_eq!(told(&path), "there is no such file");
        assert_eq!(told(folder.path()), "it is a folder");
        fs::write(&path, vec![7; 1 << 20]).expect("a disk");
        assert_eq!(read(&path, 1 << 20).expect("a plain file").len(), 1 << 20);
        fs::write(&path, vec![7; (1 << 20) + 1]).expect("a disk");
        assert_eq!(told(&path), "it is larger than 1 MiB");
    }

    #[test]
    fn files_are_found_that_stand_in_the_way_of_folders() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("file");
        fs::write(&file, "").expect("a disk");
        for inside in ["", "a", "a/b/"] {
            assert_eq!(in_the_way(&file.join(inside)), Some(file.as_path()), "{inside}");
            assert_eq!(in_the_way(&folder.path().join(inside)), None, "{inside}");
        }
        assert_eq!(in_the_way(Path::new("")), None);
    }

    #[test]
    fn what_does_not_tell_its_size_is_measured() {
        assert_eq!(read_at_most(&b"abc"[..], 3).expect("short enough"), b"abc");
        let error = read_at_most(io::repeat(0), 3 << 20).expect_err("endless");
        assert_eq!(why(&error), "it is larger than 3 MiB");
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
        // A file is no folder; and what is not there has no root above it.
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
            let told = admitted.map_err(|error| why(&error)).err();
            assert!(good || told.is_some_and(|told| told.contains("--allow-outside")), "{name}");
        }
        assert_eq!(why(&root.admit(&top.join("none")).expect_err("no file")), NO_FILE);
    }

    #[test]
    fn ways_lead_up_and_down() {
        let dir = tempfile::tempdir().expect("a folder");
        let top = dir.path();
        fs::create_dir_all(top.join("a/b")).expect("a disk");
        fs::create_dir_all(top.join("c")).expect("a disk");
        let told = |from: &str, to: &str| way(&top.join(from), &top.join(to)).expect("folders");
        for (from, to, expected) in [
            ("a", "a", ""),
            ("a", "a/b", "b"),
            ("a/b", "a", ".."),
            ("a/b", "c", "../../c"),
            ("a/../c", "a", "../a"),
        ] {
            assert_eq!(told(from, to), Path::new(expected));
        }
        assert!(way(top, &top.join("none")).is_err());
    }

    #[test]
    fn a_root_remembers_what_it_admits() {
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
    fn channels_are_told_from_files() {
        let dir = tempfile::tempdir().expect("a folder");
        let socket = dir.path().join("socket");
        let _bound = std::os::unix::net::UnixListener::bind(&socket).expect("a disk");
        std::os::unix::fs::symlink("/dev/null", dir.path().join("link")).expect("a disk");
        assert_eq!(Channel::at(&socket), Some(Channel::Socket));
        assert_eq!(Channel::at(&dir.path().join("link")), Some(Channel::Device));
        assert_eq!((Channel::at(dir.path()), Channel::at(&dir.path().join("none"))), (None, None));
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_refused() {
        let error = read(Path::new("/dev/zero"), 1 << 20).expect_err("endless");
        assert_eq!(why(&error), "it is no plain file, but a device or a pipe");
    }
}
