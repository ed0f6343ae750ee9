//! The fonts that a sequence names, each read once.

use crate::base::files::{self, Root};
use crate::drawing::Font;
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The largest font file in bytes.
const MAX_FILE_SIZE: u64 = 1 << 26;

/// The fonts read so far.
pub struct FontFiles {
    folder: PathBuf,
    root: Root,
    fonts: RefCell<HashMap<PathBuf, Result<Font, String>>>,
}

impl FontFiles {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self { folder: folder.to_owned(), root, fonts: RefCell::default() }
    }

    /// Reads a file, or returns the result of the first read.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn font(&self, name: &str) -> Result<Font, String> {
        let path = self.root.admit(&self.folder.join(name)).map_err(|error| files::describe(&error))?;
        let mut fonts = self.fonts.borrow_mut();
        let read = fonts.entry(path).or_insert_with_key(|path| {
            let bytes = files::read(path, MAX_FILE_SIZE).map_err(|error| files::describe(&error))?;
            Font::parse(bytes).map_err(|error| error.to_string())
        });
        read.clone()
    }
}
