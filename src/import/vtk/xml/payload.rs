//! The numbers of an array: text, base64 or raw bytes, maybe compressed in blocks.

use super::document::{Array, Compressor, Document, Place};
use crate::base::machine;
use crate::base::units::count;
use crate::geometry::mesh::{MeshError, MeshLocation};
use crate::import::lines::quoted;
use crate::import::vtk::number::NumberType;
use base64::Engine;
use base64::engine::GeneralPurpose;
use base64::engine::general_purpose::STANDARD;
use std::borrow::Cow;
use std::io::Read;

/// The largest factors by which the compressors make data smaller.
const ZLIB_RATIO: u64 = 1032;
const LZ4_RATIO: u64 = 255;

/// The numbers of an array.
pub fn numbers(document: &Document<'_>, array: &Array, kind: NumberType) -> Result<Vec<f64>, MeshError> {
    let name = &array.name;
    let encoded = |bytes: &[u8], place: MeshLocation| {
        let payload = Payload { document, bytes: Cow::Borrowed(bytes) };
        let decoded = payload.decoded_base64().and_then(|payload| payload.numbers(kind));
        decoded.map_err(|why| MeshError::at(place, format!("in the array `{name}`, {why}")))
    };
    match &array.place {
        Place::Text(place) => text(document, place.start, &document.bytes[place.clone()], name),
        Place::Base64(place) => encoded(&document.bytes[place.clone()], line(document, array.at)),
        Place::Appended(offset) => {
            let Some((place, base64)) = &document.appended else {
                return Err(document.fault(
                    array.at,
                    format!("the array `{name}` is appended, but there is no `AppendedData`"),
                ));
            };
            let begin = usize::try_from(*offset).ok().and_then(|offset| place.start.checked_add(offset));
            let Some(begin) = begin.filter(|begin| place.contains(begin)) else {
                let why = format!("the array `{name}` begins at offset {offset}, beyond the end of the file");
                return Err(document.fault(array.at, why));
            };
            let (bytes, at) = (&document.bytes[begin..], MeshLocation::Byte(begin as u64));
            match base64 {
                true => encoded(stream(document, bytes), at),
                false => {
                    let payload = Payload { document, bytes: Cow::Borrowed(bytes) };
                    payload
                        .numbers(kind)
                        .map_err(|why| MeshError::at(at, format!("in the array `{name}`, {why}")))
                }
            }
        }
    }
}

fn line(document: &Document<'_>, at: usize) -> MeshLocation {
    document.fault(at, "").place.unwrap_or(MeshLocation::Byte(at as u64))
}

fn text(document: &Document<'_>, begin: usize, bytes: &[u8], name: &str) -> Result<Vec<f64>, MeshError> {
    machine::check_memory(bytes.len() as u64 * 4)?;
    let words = bytes.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let number = |word: &[u8]| {
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| {
            let at = begin + (word.as_ptr() as usize - bytes.as_ptr() as usize);
            document.fault(at, format!("expected a number of the array `{name}`, found {}", quoted(word)))
        })
    };
    words.map(number).collect()
}

/// The bytes of an appended base64 array: from its begin to the begin of the next one, or to the end of all.
fn stream<'b>(document: &Document<'_>, bytes: &'b [u8]) -> &'b [u8] {
    let begin = document.bytes.len() - bytes.len();
    let start = document.appended.as_ref().map_or(0, |(place, _)| place.start);
    let arrays = document.pieces.iter().flat_map(|piece| &piece.arrays);
    let begins = arrays.filter_map(|array| match array.place {
        Place::Appended(offset) => usize::try_from(offset).ok().and_then(|offset| start.checked_add(offset)),
        _ => None,
    });
    let next = begins.filter(|next| *next > begin).min().unwrap_or(usize::MAX);
    let bytes = &bytes[..bytes.len().min(next - begin)];
    let end = bytes.iter().position(|byte| *byte == b'<');
    &bytes[..end.unwrap_or(bytes.len())]
}

/// The bytes of an array, with its header.
struct Payload<'d, 'b> {
    document: &'d Document<'b>,
    bytes: Cow<'d, [u8]>,
}

impl Payload<'_, '_> {
    /// Decodes base64. The header may be encoded apart from the rest, so padding may occur twice.
    fn decoded_base64(self) -> Result<Self, String> {
        const ENGINE: GeneralPurpose = STANDARD;
        let mut text: Vec<u8> = Vec::new();
        text.extend(self.bytes.iter().filter(|byte| !byte.is_ascii_whitespace()));
        let mut bytes = Vec::new();
        let mut rest = &text[..];
        while !rest.is_empty() {
            let padding = rest.iter().position(|&byte| byte == b'=').unwrap_or(rest.len());
            let end = padding.next_multiple_of(4).min(rest.len());
            let decoded =
                ENGINE.decode(&rest[..end]).map_err(|error| format!("the base64 is not valid: {error}"))?;
            bytes.extend(decoded);
            rest = &rest[end..];
        }
        Ok(Self { document: self.document, bytes: Cow::Owned(bytes) })
    }

    fn numbers(&self, kind: NumberType) -> Result<Vec<f64>, String> {
        let data = match self.document.compressor {
            Compressor::None => self.plain()?,
            compressor => Cow::Owned(self.decompressed(compressor)?),
        };
        let size = kind.bits() / 8;
        let amount = data.len() as u64 / size;
        check_memory(amount.saturating_mul(8))?;
        if amount * size != data.len() as u64 {
            return Err(format!(
                "{} bytes are no whole number of values of {size} bytes",
                count(data.len() as u64)
            ));
        }
        Ok(kind.numbers(&data, self.document.big_endian))
    }

    /// The numbers of the header.
    fn header(&self, first: usize, amount: usize) -> Result<Vec<u64>, String> {
        let size = self.document.header_size;
        let begin = first * size;
        let end = amount.checked_mul(size).and_then(|size| size.checked_add(begin));
        let bytes = end.and_then(|end| self.bytes.get(begin..end));
        let bytes =
            bytes.ok_or_else(|| format!("the header is longer than its {} bytes", self.bytes.len()))?;
        let number = |bytes: &[u8]| {
            let place = |at: usize| if self.document.big_endian { size - 1 - at } else { at };
            (0..size).fold(0, |number, at| number | u64::from(bytes[place(at)]) << (8 * at))
        };
        Ok(bytes.chunks_exact(size).map(number).collect())
    }

    /// Bytes after their number.
    fn plain(&self) -> Result<Cow<'_, [u8]>, String> {
        let size = self.header(0, 1)?[0];
        let rest = &self.bytes[self.document.header_size..];
        let bytes = usize::try_from(size).ok().and_then(|size| rest.get(..size));
        let (size, there) = (count(size), count(rest.len() as u64));
        bytes.map(Cow::Borrowed).ok_or_else(|| format!("its header states {size} bytes, and {there} follow"))
    }

    /// Compressed blocks after their number, the size of a block, that of the last one if it is smaller, and their
    /// sizes when compressed.
    fn decompressed(&self, compressor: Compressor) -> Result<Vec<u8>, String> {
        let blocks = self.header(0, 1)?[0];
        // Some programs end the header here then.
        if blocks == 0 {
            return Ok(Vec::new());
        }
        let head = self.header(1, 2)?;
        let (size, last) = (head[0], head[1]);
        let sizes = self.header(3, usize::try_from(blocks).map_err(|_| "it has too many blocks")?)?;
        let mut rest = &self.bytes[(3 + sizes.len()) * self.document.header_size..];
        let packed = sizes.iter().fold(0_u64, |sum, &size| sum.saturating_add(size));
        let whole = if last == 0 { blocks } else { blocks - 1 };
        let total = whole.saturating_mul(size).saturating_add(last);
        if packed > rest.len() as u64 {
            return Err(format!(
                "its header states {} bytes, and {} follow",
                count(packed),
                count(rest.len() as u64)
            ));
        }
        let ratio = if compressor == Compressor::Zlib { ZLIB_RATIO } else { LZ4_RATIO };
        if total > packed.saturating_mul(ratio) {
            let (packed, total) = (count(packed), count(total));
            return Err(format!("{packed} compressed bytes cannot hold the stated {total}"));
        }
        check_memory(total)?;
        let mut data = vec![0; total as usize];
        for (index, (block, packed)) in data.chunks_mut(size.max(1) as usize).zip(&sizes).enumerate() {
            let (bytes, next) = rest.split_at(*packed as usize);
            decompress(compressor, bytes, block)
                .map_err(|why| format!("block {index} cannot be decompressed: {why}"))?;
            rest = next;
        }
        Ok(data)
    }
}

fn decompress(compressor: Compressor, bytes: &[u8], block: &mut [u8]) -> Result<(), String> {
    match compressor {
        Compressor::Lz4 => {
            let size = lz4_flex::block::decompress_into(bytes, block).map_err(|error| error.to_string())?;
            let expected = block.len();
            (size == expected)
                .then_some(())
                .ok_or_else(|| format!("it has {size} bytes instead of {expected}"))
        }
        _ => flate2::read::ZlibDecoder::new(bytes).read_exact(block).map_err(|error| error.to_string()),
    }
}

fn check_memory(needed: u64) -> Result<(), String> {
    machine::check_memory(needed).map_err(|error| error.to_string())
}
