//! Images: files, data URIs, or parts of buffers. They are decoded where they are used.

use super::GltfResult;
use super::buffers::Buffers;
use super::json::Item;
use super::uri::{self, Resources};
use crate::base::machine;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// An image of a file.
#[derive(Debug)]
pub struct GltfImage {
    /// Its name for messages.
    pub name: String,
    pub bytes: ImageBytes,
}

/// Where the bytes of an image are.
#[derive(Debug)]
pub enum ImageBytes {
    /// In a file within the root.
    File(PathBuf),
    /// In the glTF file.
    Given(Arc<[u8]>),
}

/// Reads all images.
pub fn images(root: &Item<'_>, buffers: &Buffers<'_>, files: &Resources<'_>) -> GltfResult<Vec<GltfImage>> {
    // Many images may be the same part of a buffer.
    let mut parts: HashMap<usize, Arc<[u8]>> = HashMap::new();
    let image = |(index, item): (usize, &Item<'_>)| {
        let uri = item.text("uri")?;
        let bytes = match (uri, item.index("bufferView", ("bufferViews", buffers.views()))?) {
            (Some(uri), None) => match uri::data(uri) {
                Some(bytes) => ImageBytes::Given(bytes.map_err(|why| item.error(why))?.into()),
                None => ImageBytes::File(files.path(uri).map_err(|why| item.error(why))?),
            },
            (None, Some(view)) => {
                let bytes = buffers.view(view)?.0;
                machine::check_memory(bytes.len() as u64)?;
                ImageBytes::Given(Arc::clone(parts.entry(view).or_insert_with(|| bytes.into())))
            }
            _ => return Err(item.error("it needs either a `uri` or a `bufferView`")),
        };
        let path = uri.filter(|uri| !uri.starts_with("data:"));
        let name = Some(item.name()?).filter(|name| !name.is_empty()).or(path.map(str::to_owned));
        Ok(GltfImage { name: name.unwrap_or_else(|| format!("images[{index}]")), bytes })
    };
    root.list("images")?.iter().enumerate().map(image).collect()
}
