//! The numbers of an array: text, base64 or raw bytes, maybe compressed in blocks.

use super::document::{Array, Compressor, Document, Place};
use crate::base::machine;
use crate::base::units::count;
use crate::geometry::mesh::{MeshError, MeshLocation};
use crate::import::lines::{parsed, quoted};
use crate::import::vtk::number::NumberType;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::borrow::Cow;
use std::io::Read;

/// The largest factors by which the compressors make data smaller.
const ZLIB_RATIO: u64 = 1032;
const LZ4_RATIO: u64 = 255;

/// An array whose numbers are not read yet, but counted.
pub struct EncodedArray<'d, 'b> {
    array: &'d Array,
    kind: NumberType,
    content: EncodedContent<'d, 'b>,
}

enum EncodedContent<'d, 'b> {
    /// The words of a text.
    Text(Text<'d, 'b>),
    Bytes(Payload<'d, 'b>),
}

impl<'d, 'b> EncodedArray<'d, 'b> {
    /// Finds the bytes of an array, and decodes base64. Nothing is decompressed yet.
    pub fn open(document: &'d Document<'b>, array: &'d Array, kind: NumberType) -> Result<Self, MeshError> {
        let content = match &array.place {
            Place::Text(place) => {
                let text = Text { document, begin: place.start, bytes: &document.bytes[place.clone()] };
                EncodedContent::Text(text)
            }
            Place::Base64(place) => {
                let payload = Payload::new(document, &document.bytes[place.clone()], None);
                EncodedContent::Bytes(payload.decoded_base64().map_err(|why| payload.fault(array, why))?)
            }
            Place::Appended(offset) => EncodedContent::Bytes(Payload::appended(document, array, *offset)?),
        };
        Ok(Self { array, kind, content })
    }

    /// The number of its numbers, as its words or its header state it.
    pub fn amount(&self) -> Result<u64, MeshError> {
        match &self.content {
            EncodedContent::Text(text) => Ok(text.words().count() as u64),
            EncodedContent::Bytes(payload) => {
                payload.amount(self.kind).map_err(|why| payload.fault(self.array, why))
            }
        }
    }

    /// All numbers.
    pub fn numbers(&self) -> Result<Vec<f64>, MeshError> {
        machine::check_memory(self.amount()?.saturating_mul(8))?;
        match &self.content {
            EncodedContent::Text(text) => text.numbers(&self.array.name),
            EncodedContent::Bytes(payload) => {
                payload.numbers(self.kind).map_err(|why| payload.fault(self.array, why))
            }
        }
    }
}

/// The text of an array, which begins at a byte of the file.
struct Text<'d, 'b> {
    document: &'d Document<'b>,
    begin: usize,
    bytes: &'b [u8],
}

impl<'b> Text<'_, 'b> {
    fn words(&self) -> impl Iterator<Item = &'b [u8]> + use<'b> {
        self.bytes.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
    }

    fn numbers(&self, name: &str) -> Result<Vec<f64>, MeshError> {
        let number = |word: &[u8]| {
            parsed(word).ok_or_else(|| {
                let at = self.begin + (word.as_ptr() as usize - self.bytes.as_ptr() as usize);
                let why = format!("expected a number of the array `{name}`, found {}", quoted(word));
                self.document.fault(at, why)
            })
        };
        self.words().map(number).collect()
    }
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
    /// The place of appended bytes in the file.
    appended_at: Option<usize>,
}

/// What the header of compressed data states.
struct Blocks {
    /// The size of a block and of all blocks in bytes.
    size: u64,
    total: u64,
    /// The sizes of the blocks when compressed.
    packed: Vec<u64>,
}

impl<'d, 'b> Payload<'d, 'b> {
    fn new(document: &'d Document<'b>, bytes: &'d [u8], appended_at: Option<usize>) -> Self {
        Self { document, bytes: Cow::Borrowed(bytes), appended_at }
    }

    /// The bytes at an offset of the appended data.
    fn appended(document: &'d Document<'b>, array: &Array, offset: u64) -> Result<Self, MeshError> {
        let name = &array.name;
        let Some((place, base64)) = &document.appended else {
            let why = format!("the array `{name}` is appended, but there is no `AppendedData`");
            return Err(document.fault(array.at, why));
        };
        let begin = usize::try_from(offset).ok().and_then(|offset| place.start.checked_add(offset));
        let Some(begin) = begin.filter(|begin| place.contains(begin)) else {
            let why = format!("the array `{name}` begins at offset {offset}, beyond the end of the file");
            return Err(document.fault(array.at, why));
        };
        let bytes = &document.bytes[begin..];
        match base64 {
            true => {
                let payload = Self::new(document, stream(document, bytes), Some(begin));
                payload.decoded_base64().map_err(|why| payload.fault(array, why))
            }
            false => Ok(Self::new(document, bytes, Some(begin))),
        }
    }

    /// An error in an array, at its appended byte or at the line of its element.
    fn fault(&self, array: &Array, why: String) -> MeshError {
        let why = format!("in the array `{}`, {why}", array.name);
        match self.appended_at {
            Some(byte) => MeshError::at(MeshLocation::Byte(byte as u64), why),
            None => self.document.fault(array.at, why),
        }
    }

    /// Decodes base64. The header may be encoded apart from the rest, so padding may occur twice.
    fn decoded_base64(&self) -> Result<Self, String> {
        // The text without blanks, and the bytes.
        check_memory(self.bytes.len() as u64 * 2)?;
        let mut text: Vec<u8> = Vec::with_capacity(self.bytes.len());
        text.extend(self.bytes.iter().filter(|byte| !byte.is_ascii_whitespace()));
        let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
        let mut rest = &text[..];
        while !rest.is_empty() {
            // Up to the end of the group of four that holds the first padding.
            let padding = rest.iter().position(|&byte| byte == b'=');
            let end = padding.map_or(rest.len(), |at| (at + 1).next_multiple_of(4).min(rest.len()));
            let decoded = STANDARD.decode_vec(&rest[..end], &mut bytes);
            decoded.map_err(|error| format!("the base64 is not valid: {error}"))?;
            rest = &rest[end..];
        }
        Ok(Self { bytes: Cow::Owned(bytes), ..*self })
    }

    /// The number of numbers that the header states.
    fn amount(&self, kind: NumberType) -> Result<u64, String> {
        let bytes = match self.document.compressor {
            Compressor::None => self.plain()?.len() as u64,
            compressor => self.blocks(compressor)?.total,
        };
        let size = kind.bits() / 8;
        match bytes.is_multiple_of(size) {
            true => Ok(bytes / size),
            false => Err(format!("{} bytes are no whole number of values of {size} bytes", count(bytes))),
        }
    }

    fn numbers(&self, kind: NumberType) -> Result<Vec<f64>, String> {
        let data = match self.document.compressor {
            Compressor::None => Cow::Borrowed(self.plain()?),
            compressor => Cow::Owned(self.decompressed(compressor)?),
        };
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
    fn plain(&self) -> Result<&[u8], String> {
        let size = self.header(0, 1)?[0];
        let rest = &self.bytes[self.document.header_size..];
        let bytes = usize::try_from(size).ok().and_then(|size| rest.get(..size));
        let (size, there) = (count(size), count(rest.len() as u64));
        bytes.ok_or_else(|| format!("its header states {size} bytes, and {there} follow"))
    }

    /// The header of compressed blocks: their number, the size of a block, that of the last one if it is smaller, and
    /// their sizes when compressed.
    fn blocks(&self, compressor: Compressor) -> Result<Blocks, String> {
        let blocks = self.header(0, 1)?[0];
        // Some programs end the header here then.
        if blocks == 0 {
            return Ok(Blocks { size: 1, total: 0, packed: Vec::new() });
        }
        let head = self.header(1, 2)?;
        let (size, last) = (head[0], head[1]);
        let packed = self.header(3, usize::try_from(blocks).map_err(|_| "it has too many blocks")?)?;
        let rest = self.bytes.len() - (3 + packed.len()) * self.document.header_size;
        let packed_size = packed.iter().fold(0_u64, |sum, &size| sum.saturating_add(size));
        let whole = if last == 0 { blocks } else { blocks - 1 };
        let total = whole.saturating_mul(size).saturating_add(last);
        if packed_size > rest as u64 {
            let (stated, rest) = (count(packed_size), count(rest as u64));
            return Err(format!("its header states {stated} bytes, and {rest} follow"));
        }
        let ratio = if compressor == Compressor::Zlib { ZLIB_RATIO } else { LZ4_RATIO };
        if total > packed_size.saturating_mul(ratio) {
            let (packed, total) = (count(packed_size), count(total));
            return Err(format!("{packed} compressed bytes cannot hold the stated {total}"));
        }
        if size == 0 || last > size {
            let (size, last) = (count(size), count(last));
            return Err(format!("its header states blocks of {size} bytes, and a last one of {last}"));
        }
        Ok(Blocks { size, total, packed })
    }

    fn decompressed(&self, compressor: Compressor) -> Result<Vec<u8>, String> {
        let Blocks { size, total, packed } = self.blocks(compressor)?;
        check_memory(total)?;
        let mut rest = &self.bytes[self.bytes.len().min((3 + packed.len()) * self.document.header_size)..];
        let mut data = vec![0; total as usize];
        for (index, (block, packed)) in data.chunks_mut(size as usize).zip(&packed).enumerate() {
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
        _ => {
            let mut decoder = flate2::read::ZlibDecoder::new(bytes);
            decoder.read_exact(block).map_err(|error| error.to_string())?;
            // Reading to the end checks the sum of the data, too.
            let more = decoder.read(&mut [0]).map_err(|error| error.to_string())?;
            let size = block.len();
            if more == 0 { Ok(()) } else { Err(format!("it has more than the {size} bytes of a block")) }
        }
    }
}

fn check_memory(needed: u64) -> Result<(), String> {
    machine::check_memory(needed).map_err(|error| error.to_string())
}
