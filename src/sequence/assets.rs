//! Files that a sequence refers to, found from its own folder and read once.

use super::fault::Fault;
use super::node::Node;
use super::suggest::shortened;
use super::values::text;
use crate::appearance::texture::{Encoding, Image, ImageError, Shared};
use crate::base::files::Root;
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// The images read so far.
pub struct Assets {
    folder: PathBuf,
    root: Root,
    images: RefCell<HashMap<(PathBuf, Encoding), Read>>,
}

/// What came of a file: an image, or why there is none.
type Read = Result<Shared<Image>, Rc<ImageError>>;

impl Assets {
    pub fn new(folder: &Path, root: Root) -> Self {
        Self { folder: folder.to_owned(), root, images: RefCell::default() }
    }

    /// Reads a file, or remembers what came of it. Paths are relative to the sequence's folder, or absolute, and lead
    /// into the root.
    pub fn image(&self, name: &str, encoding: Encoding) -> Read {
        let path = self.root.admit(&self.folder.join(name)).map_err(|error| Rc::new(error.into()))?;
        let mut images = self.images.borrow_mut();
        let read = images
            .entry((path, encoding))
            .or_insert_with_key(|(path, _)| Image::load(path, encoding).map(Shared::new).map_err(Rc::new));
        read.clone()
    }
}

/// A decoder for the name of an image file in quotes.
pub fn image<'s>(encoding: Encoding) -> impl Fn(Node<'s>) -> Option<Shared<Image>> {
    move |node| named_image(node, &text(node)?, encoding)
}

/// The image called `name`; `node` is where the file says so.
pub fn named_image(node: Node<'_>, name: &str, encoding: Encoding) -> Option<Shared<Image>> {
    match node.file.assets.image(name, encoding) {
        Ok(image) => Some(image),
        Err(why) => {
            let title = format!("cannot read the image {:?}", shortened(name));
            let fault = Fault::new(node.span(), title, why.to_string());
            let help = "paths of images begin at the folder of the sequence file";
            node.fault(if why.is_missing() { fault.help(help) } else { fault });
            None
        }
    }
}
