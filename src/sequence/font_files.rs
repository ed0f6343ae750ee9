//! The fonts that a sequence names, each read once.

use super::fault::Fault;
use super::file_cache::FileCache;
use super::node::Node;
use super::suggest::shortened;
use super::values::{PATHS, file_path};
use crate::base::files::{self, Root};
use crate::drawing::Font;
use std::path::Path;

/// The largest font file in bytes.
const MAX_FILE_SIZE: u64 = 1 << 26;

pub struct FontFiles {
    files: FileCache<Result<Font, String>>,
}

impl FontFiles {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self { files: FileCache::new(folder, root) }
    }

    /// Reads a file, or returns the result of the first read.
    ///
    /// # Errors
    /// Why it cannot be read.
    pub fn font(&self, name: &str) -> Result<Font, String> {
        let path = self.files.admit(name).map_err(|error| files::describe(&error))?;
        self.files.get(path, (), |path, ()| {
            let bytes = files::read(path, MAX_FILE_SIZE).map_err(|error| files::describe(&error))?;
            Font::parse(bytes).map_err(|error| error.to_string())
        })
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
            node.fault(fault.help("fonts are .ttf and .otf files").help(PATHS));
            None
        }
    }
}
