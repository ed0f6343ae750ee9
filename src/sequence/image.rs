//! Decodes names of image files.

use super::fault::Fault;
use super::node::Node;
use super::suggest::shortened;
use super::values::{PATHS, file_path};
use crate::appearance::texture::{ColorEncoding, Image, SharedAsset};

/// A decoder for the quoted name of an image file.
pub fn image<'s>(encoding: ColorEncoding) -> impl Fn(Node<'s>) -> Option<SharedAsset<Image>> {
    move |node| named_image(node, &file_path(node)?, encoding)
}

/// The image called `name`. `node` is the place of the name.
pub fn named_image(node: Node<'_>, name: &str, encoding: ColorEncoding) -> Option<SharedAsset<Image>> {
    match node.file.images.image(name, encoding) {
        Ok(image) => Some(image),
        Err(why) => {
            let title = format!("cannot read the image {:?}", shortened(name));
            let fault = Fault::new(node.span(), title, why.to_string());
            node.fault(if why.is_missing() { fault.help(PATHS) } else { fault });
            None
        }
    }
}
