//! Buffers and the views of them: bytes from the file, from other files, and from data URIs.

use super::GltfResult;
use super::json::Item;
use super::uri::Resources;
use crate::geometry::mesh::MeshError;
use std::ops::Range;

/// The largest buffer file in bytes.
const MAX_BUFFER: u64 = 8 << 30;

/// The bytes of all buffers.
pub struct Buffers<'f> {
    /// Of each buffer, its bytes; none if the file does not say where they are.
    all: Vec<Option<Bytes<'f>>>,
    views: Vec<View>,
}

enum Bytes<'f> {
    /// Of the file itself.
    Chunk(&'f [u8]),
    Read(Vec<u8>),
}

/// A part of a buffer.
#[derive(Clone)]
struct View {
    buffer: usize,
    range: Range<usize>,
    stride: Option<usize>,
}

impl Bytes<'_> {
    fn get(&self) -> &[u8] {
        match self {
            Self::Chunk(bytes) => bytes,
            Self::Read(bytes) => bytes,
        }
    }
}

impl<'f> Buffers<'f> {
    /// Reads all buffers. `chunk` is the data chunk of a binary file, which is the first buffer without a URI.
    pub fn read(root: &Item<'_>, chunk: Option<&'f [u8]>, files: &Resources<'_>) -> GltfResult<Self> {
        let buffers = root.list("buffers")?;
        let buffer = |(index, item): (usize, &Item<'_>)| {
            let length = item.whole("byteLength")?.ok_or_else(|| item.error("it has no `byteLength`"))?;
            let bytes = match item.text("uri")? {
                Some(uri) => Bytes::Read(files.bytes(uri, MAX_BUFFER).map_err(|why| item.error(why))?),
                None => match chunk.filter(|_| index == 0) {
                    Some(chunk) => Bytes::Chunk(chunk),
                    None => return Ok(None),
                },
            };
            let found = bytes.get().len() as u64;
            if found < length {
                return Err(item.error(format!("it has {found} bytes, not {length}")));
            }
            Ok(Some(bytes))
        };
        let all = buffers.iter().enumerate().map(buffer).collect::<GltfResult<Vec<_>>>()?;
        let views = root.list("bufferViews")?;
        let views = views.iter().map(|item| view(item, &all)).collect::<GltfResult<_>>()?;
        Ok(Self { all, views })
    }

    /// The number of views.
    pub fn views(&self) -> usize {
        self.views.len()
    }

    /// The bytes of a view whose index has been checked, and the distance of its elements if it is given.
    pub fn view(&self, index: usize) -> GltfResult<(&[u8], Option<usize>)> {
        let found = self.views.get(index).and_then(|view| {
            let bytes = self.all.get(view.buffer)?.as_ref()?.get();
            Some((bytes.get(view.range.clone())?, view.stride))
        });
        found.ok_or_else(|| {
            MeshError::new(format!("bufferViews[{index}]: the file does not say where its buffer is"))
        })
    }
}

fn view(item: &Item<'_>, buffers: &[Option<Bytes<'_>>]) -> GltfResult<View> {
    let buffer = item.index("buffer", ("buffers", buffers.len()))?;
    let buffer = buffer.ok_or_else(|| item.error("it has no `buffer`"))?;
    let length = item.whole("byteLength")?.ok_or_else(|| item.error("it has no `byteLength`"))?;
    let offset = item.whole("byteOffset")?.unwrap_or(0);
    let stride = item.whole("byteStride")?;
    if stride.is_some_and(|stride| !(1..=252).contains(&stride)) {
        return Err(item.error("its `byteStride` is not from 4 to 252"));
    }
    // The size of a buffer without bytes does not matter: its views are never read.
    let known = buffers[buffer].as_ref().map(|bytes| bytes.get().len() as u64);
    let end = offset.checked_add(length).filter(|end| known.is_none_or(|known| *end <= known));
    let Some(end) = end else {
        let known = known.unwrap_or_default();
        return Err(item.error(format!(
            "it has {length} bytes from byte {offset} on, but its buffer has {known} bytes"
        )));
    };
    Ok(View { buffer, range: offset as usize..end as usize, stride: stride.map(|stride| stride as usize) })
}
