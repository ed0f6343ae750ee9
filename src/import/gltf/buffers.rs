//! Buffers and the views of them: bytes from the file, from other files, and from data URIs.

use super::GltfResult;
use super::json::Item;
use super::uri::{self, Resources};
use crate::base::machine;
use crate::geometry::mesh::MeshError;
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The largest buffer in bytes.
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
    Data(Vec<u8>),
    /// The first bytes of a file, which other buffers may share.
    File(Arc<Vec<u8>>, usize),
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
            Self::Data(bytes) => bytes,
            Self::File(bytes, length) => bytes.get(..*length).unwrap_or_default(),
        }
    }
}

impl<'f> Buffers<'f> {
    /// Reads all buffers. `chunk` is the data chunk of a binary file, which is the first buffer without a URI.
    pub fn read(root: &Item<'_>, chunk: Option<&'f [u8]>, files: &Resources<'_>) -> GltfResult<Self> {
        let buffers = root.list("buffers")?;
        let sources = buffers.iter().map(|item| source(item, files)).collect::<GltfResult<Vec<_>>>()?;
        let mut files = BufferFiles::of(&sources);
        let mut all = Vec::with_capacity(buffers.len());
        for (index, (item, (source, length))) in buffers.iter().zip(&sources).enumerate() {
            let bytes = match source {
                Source::None => chunk.filter(|_| index == 0).map(Bytes::Chunk),
                Source::Data(uri) => Some(Bytes::Data(data(uri, *length).map_err(|why| item.error(why))?)),
                Source::File(path) => {
                    let bytes = files.bytes(path).map_err(|why| item.error(why))?;
                    let length = bytes.len().min(*length);
                    Some(Bytes::File(bytes, length))
                }
            };
            if let Some(found) = bytes.as_ref().map(|bytes| bytes.get().len()).filter(|found| found < length)
            {
                return Err(item.error(format!("it has {found} bytes, not {length}")));
            }
            all.push(bytes);
        }
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

/// Where the bytes of a buffer are.
enum Source<'a> {
    /// The file does not say it.
    None,
    Data(&'a str),
    File(PathBuf),
}

/// The files of buffers. Many buffers may be one file, which is read once, as far as buffers need it.
struct BufferFiles<'a> {
    lengths: HashMap<&'a Path, usize>,
    read: HashMap<PathBuf, Arc<Vec<u8>>>,
}

impl<'a> BufferFiles<'a> {
    fn of(sources: &'a [(Source<'_>, usize)]) -> Self {
        let mut lengths: HashMap<&Path, usize> = HashMap::new();
        for (source, length) in sources {
            if let Source::File(path) = source {
                let longest = lengths.entry(path).or_default();
                *longest = (*longest).max(*length);
            }
        }
        Self { lengths, read: HashMap::new() }
    }

    fn bytes(&mut self, path: &Path) -> Result<Arc<Vec<u8>>, String> {
        if let Some(bytes) = self.read.get(path) {
            return Ok(Arc::clone(bytes));
        }
        let length = self.lengths.get(path).copied().unwrap_or_default();
        let bytes = Arc::new(uri::start_of(path, length)?);
        self.read.insert(path.to_owned(), Arc::clone(&bytes));
        Ok(bytes)
    }
}

/// The first `length` bytes of a data URI, or all of a shorter one.
fn data(uri: &str, length: usize) -> Result<Vec<u8>, String> {
    machine::check_memory(uri.len() as u64).map_err(|error| error.to_string())?;
    let mut bytes = uri::data(uri).unwrap_or_else(|| Ok(Vec::new()))?;
    if bytes.len() > length {
        bytes.truncate(length);
        bytes.shrink_to_fit();
    }
    Ok(bytes)
}

/// Where the bytes of a buffer are, and how many there are.
fn source<'a>(item: &Item<'a>, files: &Resources<'_>) -> GltfResult<(Source<'a>, usize)> {
    let length = item.whole("byteLength")?.ok_or_else(|| item.error("it has no `byteLength`"))?;
    if length > MAX_BUFFER {
        return Err(item.error(format!("it has {length} bytes; a buffer has at most {MAX_BUFFER}")));
    }
    let source = match item.text("uri")? {
        None => Source::None,
        Some(uri) if uri::is_data(uri) => Source::Data(uri),
        Some(uri) => Source::File(files.path(uri).map_err(|why| item.error(why))?),
    };
    Ok((source, length as usize))
}

fn view(item: &Item<'_>, buffers: &[Option<Bytes<'_>>]) -> GltfResult<View> {
    let buffer = item.index("buffer", ("buffers", buffers.len()))?;
    let buffer = buffer.ok_or_else(|| item.error("it has no `buffer`"))?;
    let length = item.whole("byteLength")?.ok_or_else(|| item.error("it has no `byteLength`"))?;
    let offset = item.whole("byteOffset")?.unwrap_or(0);
    let stride = item.whole("byteStride")?;
    if stride.is_some_and(|stride| !(1..=252).contains(&stride)) {
        return Err(item.error("its `byteStride` is not from 1 to 252"));
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
