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

/// The memory per byte of JSON text while it is read, without spaces and letters between quotes. Lists of lists of one
/// number, `[0],`, take the most: 76 bytes of values, of which lists that grow have half as many again in vain, and what
/// allocators need.
const PARSED_SIZE: u64 = 128;

/// The content of a file: its JSON part, and where the data chunk lies.
pub fn parts(bytes: &[u8]) -> GltfResult<(Value, Option<Range<usize>>)> {
    if !bytes.starts_with(MAGIC) {
        // Space and a byte order mark may come first.
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if text.trim_ascii_start().first() != Some(&b'{') {
            return Err(MeshError::new(
                "it begins neither with `glTF`, as binary files do, nor with JSON's `{`",
            ));
        }
        return Ok((json(text)?, None));
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
    machine::check_memory(parsed_size(text))?;
    // Some writers pad with zeros instead of blanks.
    let end = text.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    serde_json::from_slice(&text[..end])
        .map_err(|error| MeshError::new(format!("its JSON is wrong: {error}")))
}

/// Bound of the memory in bytes that a JSON text takes while it is read.
fn parsed_size(text: &[u8]) -> u64 {
    let (mut quoted, mut structure, mut is_quoted, mut is_escaped) = (0, 0, false, false);
    for byte in text {
        let is_quote = *byte == b'"' && !is_escaped;
        is_escaped = is_quoted && *byte == b'\\' && !is_escaped;
        is_quoted ^= is_quote;
        if is_quoted && !is_quote {
            quoted += 1;
        } else if !byte.is_ascii_whitespace() {
            structure += 1;
        }
    }
    quoted + structure * PARSED_SIZE
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What an allocation needs besides its bytes.
    const ALLOCATION: usize = 16;

    /// The bytes that a value has allocated. Of maps, the entries and their table are estimated.
    fn allocated(value: &Value) -> usize {
        match value {
            Value::Array(list) => {
                let own = list.capacity() * size_of::<Value>() + ALLOCATION;
                own + list.iter().map(allocated).sum::<usize>()
            }
            Value::String(text) => text.capacity() + ALLOCATION,
            Value::Object(map) => {
                let entry = size_of::<(usize, String, Value)>() + 2 * size_of::<usize>();
                let own = map.len().next_power_of_two().max(4) * entry + 2 * ALLOCATION;
                let of_entries =
                    map.iter().map(|(key, value)| key.capacity() + ALLOCATION + allocated(value));
                if map.is_empty() { 0 } else { own + of_entries.sum::<usize>() }
            }
            _ => 0,
        }
    }

    #[test]
    fn parsed_values_take_less_memory_than_the_bound() {
        // Right after a list has grown, half of it is empty.
        let count = (1 << 14) + 1;
        let mut worst = 0.0f64;
        for part in
            ["0", "[0]", "[]", "{}", "\"\"", "\"a long text\"", "[[0]]", "[ 0, 0 ]", "{\"a\":0}", "null"]
        {
            let text = format!("[{}]", vec![part; count].join(","));
            let value: Value = serde_json::from_str(&text).expect("JSON");
            let (found, bound) = (allocated(&value) as f64, parsed_size(text.as_bytes()) as f64);
            assert!(found <= bound, "{part}: {found} {bound}");
            worst = worst.max(found / bound);
        }
        // The bound is no guess.
        assert!(worst > 0.7, "{worst}");
    }

    #[test]
    fn letters_between_quotes_count_once() {
        assert_eq!(parsed_size(b"  [ 1 ]\n"), 3 * PARSED_SIZE);
        assert_eq!(parsed_size(br#""abc""#), 3 + 2 * PARSED_SIZE);
        assert_eq!(parsed_size(br#""a\"b\\",1"#), 6 + 4 * PARSED_SIZE);
    }
}
