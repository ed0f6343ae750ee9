//! The image files that a sequence names, each read once.

use crate::appearance::texture::{ColorEncoding, Image, ImageError, SharedAsset};
use crate::base::files::Root;
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// The images read so far.
pub struct ImageFiles {
    folder: PathBuf,
    root: Root,
    images: RefCell<HashMap<(PathBuf, ColorEncoding), ImageResult>>,
}

/// An image, or the reason why it cannot be read.
type ImageResult = Result<SharedAsset<Image>, Rc<ImageError>>;

impl ImageFiles {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self { folder: folder.to_owned(), root, images: RefCell::default() }
    }

    /// Reads a file, or returns the result of the first read. Paths are absolute or relative to the sequence's folder,
    /// and must be within the root.
    pub fn image(&self, name: &str, encoding: ColorEncoding) -> ImageResult {
        let path = self.root.admit(&self.folder.join(name)).map_err(|error| Rc::new(error.into()))?;
        let mut images = self.images.borrow_mut();
        let read = images.entry((path, encoding)).or_insert_with_key(|(path, _)| {
            Image::load(path, encoding).map(SharedAsset::new).map_err(Rc::new)
        });
        read.clone()
    }
}
