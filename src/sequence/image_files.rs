//! The image files that a sequence names, each read once.

use super::file_cache::FileCache;
use crate::appearance::texture::{ColorEncoding, Image, ImageError, SharedAsset};
use crate::base::files::Root;
use std::path::Path;
use std::rc::Rc;

pub struct ImageFiles {
    files: FileCache<ImageResult, ColorEncoding>,
}

/// An image, or the reason why it cannot be read.
type ImageResult = Result<SharedAsset<Image>, Rc<ImageError>>;

impl ImageFiles {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self { files: FileCache::new(folder, root) }
    }

    /// Reads a file, or returns the result of the first read. Paths are absolute or relative to the sequence's folder,
    /// and must be within the root.
    pub fn image(&self, name: &str, encoding: ColorEncoding) -> ImageResult {
        let path = self.files.admit(name).map_err(|error| Rc::new(error.into()))?;
        self.files.get(path, encoding, |path, encoding| {
            Image::load(path, *encoding).map(SharedAsset::new).map_err(Rc::new)
        })
    }
}
