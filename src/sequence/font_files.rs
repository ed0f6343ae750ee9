//! The fonts that a sequence names, each read once.

use super::fault::Fault;
use super::node::Node;
use super::suggest::shortened;
use super::values::file_path;
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

/// Decodes the name of a font file.
pub fn font(node: Node<'_>) -> Option<Font> {
    let name = file_path(node)?;
    match node.file.fonts.font(&name) {
        Ok(font) => Some(font),
        Err(why) => {
            let title = format!("cannot read the font {:?}", shortened(&name));
            let fault = Fault::new(node.span(), title, why);
            node.fault(
                fault.help("fonts are .ttf and .otf files; paths are relative to the sequence file's folder"),
            );
            None
        }
    }
}
