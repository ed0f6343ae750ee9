//! The two containers: JSON text (`.gltf`), and the binary file of a JSON and a data chunk (`.glb`).
//!
//! Source: glTF 2.0 specification, section 4, "GLB File Format Specification".

use super::GltfResult;
use crate::base::machine;
use crate::geometry::mesh::{MeshError, MeshLocation};
use serde_json::Value;
use std::ops::Range;

/// The first bytes of a binary file.
const MAGIC: &[u8; 4] = b"glTF";

/// The types of chunks.
const JSON: &[u8; 4] = b"JSON";
const DATA: &[u8; 4] = b"BIN\0";

/// The largest JSON part in bytes. It has no geometry, but may have images and buffers as text.
const MAX_JSON: usize = 1 << 30;

/// The memory per byte of JSON text while it is read.
const PARSED_SIZE: u64 = 16;

/// The content of a file: its JSON part, and where the data chunk lies.
pub fn parts(bytes: &[u8]) -> GltfResult<(Value, Option<Range<usize>>)> {
    if !bytes.starts_with(MAGIC) {
        return Ok((json(bytes)?, None));
    }
    let version = word(bytes, 4)?;
    if version != 2 {
        return Err(MeshError::new(format!("it is of version {version} of glTF; Kinora reads version 2")));
    }
    let length = word(bytes, 8)? as usize;
    if length > bytes.len() {
        let why = format!("it is cut off: it has {} of {length} bytes", bytes.len());
        return Err(MeshError::new(why));
    }
    let whole = &bytes[..length];
    let (kind, text) = chunk(whole, 12)?.ok_or_else(|| MeshError::new("it has no chunk of JSON"))?;
    if &kind != JSON {
        return Err(MeshError::at(MeshLocation::Byte(16), "expected the type of a chunk of JSON"));
    }
    let data = chunk(whole, text.end)?.filter(|(kind, _)| kind == DATA).map(|(_, range)| range);
    Ok((json(&whole[text])?, data))
}

/// The type and the place of the chunk at a byte, if one begins there.
fn chunk(bytes: &[u8], at: usize) -> GltfResult<Option<([u8; 4], Range<usize>)>> {
    if at >= bytes.len() {
        return Ok(None);
    }
    let length = word(bytes, at)? as usize;
    let kind = word(bytes, at + 4)?.to_le_bytes();
    let start = at + 8;
    match start.checked_add(length).filter(|end| *end <= bytes.len()) {
        Some(end) => Ok(Some((kind, start..end))),
        None => {
            let why = format!("the chunk has {length} bytes, but the file ends before");
            Err(MeshError::at(MeshLocation::Byte(at as u64), why))
        }
    }
}

/// The number of 32 bits at a byte.
fn word(bytes: &[u8], at: usize) -> GltfResult<u32> {
    let word = bytes.get(at..).and_then(|rest| rest.first_chunk());
    word.map(|word| u32::from_le_bytes(*word))
        .ok_or_else(|| MeshError::at(MeshLocation::Byte(at as u64), "the file is cut off"))
}

fn json(text: &[u8]) -> GltfResult<Value> {
    if text.len() > MAX_JSON {
        return Err(MeshError::new("its JSON part is larger than 1 GiB"));
    }
    machine::check_memory(text.len() as u64 * PARSED_SIZE)?;
    // Some writers pad with zeros instead of blanks.
    let end = text.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    serde_json::from_slice(&text[..end])
        .map_err(|error| MeshError::new(format!("its JSON is wrong: {error}")))
}
