//! The files of one kind that a sequence names, each read once.

use crate::base::files::Root;
use std::cell::RefCell;
use std::collections::HashMap;
use std::hash::Hash;
use std::io;
use std::path::{Path, PathBuf};

/// What was read so far: the results `R` by file and by the way `K` in which its data are prepared.
pub struct FileCache<R, K = ()> {
    /// Paths are relative to it.
    pub folder: PathBuf,
    pub root: Root,
    read: RefCell<HashMap<(PathBuf, K), R>>,
}

impl<R: Clone, K: Eq + Hash> FileCache<R, K> {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self { folder: folder.to_owned(), root, read: RefCell::default() }
    }

    /// The canonical path of a file that the sequence may read.
    ///
    /// # Errors
    /// If the file does not exist or is outside of the root.
    pub fn admit(&self, name: impl AsRef<Path>) -> io::Result<PathBuf> {
        self.root.admit(&self.folder.join(name))
    }

    /// Reads an admitted file, or returns the result of the first read.
    pub fn get(&self, path: PathBuf, key: K, read: impl FnOnce(&Path, &K) -> R) -> R {
        self.read.borrow_mut().entry((path, key)).or_insert_with_key(|(path, key)| read(path, key)).clone()
    }
}
