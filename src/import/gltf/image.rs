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
    // Many images may be the same part of a buffer, or the same text.
    let mut parts: HashMap<(*const u8, usize), Arc<[u8]>> = HashMap::new();
    let mut texts: HashMap<&str, Arc<[u8]>> = HashMap::new();
    let items = root.list("images")?;
    let mut images = Vec::with_capacity(items.len());
    for (index, item) in items.iter().enumerate() {
        let uri = item.text("uri")?;
        let bytes = match (uri, item.index("bufferView", ("bufferViews", buffers.views()))?) {
            (Some(uri), None) if texts.contains_key(uri) => ImageBytes::Given(Arc::clone(&texts[uri])),
            (Some(uri), None) => match uri::data(uri) {
                Some(bytes) => {
                    let bytes: Arc<[u8]> = bytes.map_err(|why| item.error(why))?.into();
                    texts.insert(uri, Arc::clone(&bytes));
                    ImageBytes::Given(bytes)
                }
                None => ImageBytes::File(files.path(uri).map_err(|why| item.error(why))?),
            },
            (None, Some(view)) => {
                let bytes = buffers.view(view)?.0;
                machine::check_memory(bytes.len() as u64)?;
                let same = parts.entry((bytes.as_ptr(), bytes.len())).or_insert_with(|| bytes.into());
                ImageBytes::Given(Arc::clone(same))
            }
            _ => return Err(item.error("it needs either a `uri` or a `bufferView`")),
        };
        let path = uri.filter(|uri| !uri::is_data(uri));
        let name = Some(item.name()?).filter(|name| !name.is_empty()).or(path.map(str::to_owned));
        images.push(GltfImage { name: name.unwrap_or_else(|| format!("images[{index}]")), bytes });
    }
    Ok(images)
}
