//! Reading PNG files: pictures, metadata, and whether a file can be kept.

use super::seal::{self, Seal};
use crate::base::digest::Digest;
use crate::base::files;
use crate::encode::disk::{Operation, attempt};
use crate::encode::error::EncodeError;
use crate::encode::file_state::FileState;
use crate::encode::picture::Picture;
use png::{BitDepth, ColorType, DecodeOptions, Decoder, Limits, Reader};
use std::io::{self, BufReader, Cursor};
use std::path::Path;

/// The last bytes of every PNG: an empty IEND chunk with its checksum.
const END: &[u8] = b"\0\0\0\0IEND\xae\x42\x60\x82";

/// Bytes of text and other chunks besides the picture, at most.
const MAX_OVERHEAD: u64 = 1 << 20;

/// Reads a picture of 8 bits per channel that [`encode`](super::encode) has written.
pub fn read(path: &Path) -> Result<Picture, EncodeError> {
    decode(path).map_err(|e| EncodeError::read(path, e))
}

fn decode(path: &Path) -> io::Result<Picture> {
    let (file, _) = attempt(Operation::Read, path, || files::open(path, u64::MAX))?;
    decode_from(BufReader::new(file))
}

/// [`read`] from the file's bytes.
pub fn decode_bytes(bytes: &[u8]) -> io::Result<Picture> {
    decode_from(Cursor::new(bytes))
}

fn decode_from(input: impl io::BufRead + io::Seek) -> io::Result<Picture> {
    let mut reader = Decoder::new(input).read_info()?;
    let info = reader.info();
    let alpha = info.color_type == ColorType::Rgba;
    if !(alpha || info.color_type == ColorType::Rgb) || info.bit_depth != BitDepth::Eight {
        return Err(io::Error::new(
            io::ErrorKind::InvalidData,
            "it is not the picture of 8 bits that was written",
        ));
    }
    let (width, height) = (info.width, info.height);
    let mut codes = vec![0; reader.output_buffer_size().ok_or(io::ErrorKind::InvalidData)?];
    reader.next_frame(&mut codes)?;
    if !alpha {
        return Ok(Picture::opaque(width, height, codes));
    }
    let pixels = codes.as_chunks::<4>().0;
    let rgb = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    Ok(Picture { width, height, rgb, alpha: Some(pixels.iter().map(|pixel| pixel[3]).collect()) })
}

/// The text chunks of a PNG file as keywords and values. Empty if it is not a PNG.
pub fn texts(path: &Path) -> Vec<(String, String)> {
    files::open(path, u64::MAX).map_or_else(|_| Vec::new(), |(file, _)| read_texts(BufReader::new(file)))
}

/// Like [`texts`], from the file's bytes.
pub fn texts_in(bytes: &[u8]) -> Vec<(String, String)> {
    read_texts(Cursor::new(bytes))
}

fn read_texts(input: impl io::BufRead + io::Seek) -> Vec<(String, String)> {
    Decoder::new(input).read_info().map_or_else(|_| Vec::new(), |reader| info_texts(&reader))
}

/// The width and height of a PNG file in pixels.
pub fn size_in(bytes: &[u8]) -> Option<(u32, u32)> {
    let reader = Decoder::new(Cursor::new(bytes)).read_info().ok()?;
    Some((reader.info().width, reader.info().height))
}

/// Whether a file begins with the PNG signature.
pub fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n")
}

fn info_texts<R: io::BufRead + io::Seek>(reader: &Reader<R>) -> Vec<(String, String)> {
    let info = reader.info();
    let latin = info.uncompressed_latin1_text.iter().map(|text| (text.keyword.clone(), text.text.clone()));
    let others = info.utf8_text.iter().filter_map(|text| Some((text.keyword.clone(), text.get_text().ok()?)));
    latin.chain(others).collect()
}

/// The state of a file that should hold the frame with this identity.
pub fn state(path: &Path, identity: Digest, size: (u32, u32)) -> FileState {
    let Ok(mut bytes) = read_bytes(path, size) else { return FileState::Stale };
    let is = |name: &str| name == identity.to_string();
    match seal::verify(&mut bytes) {
        Seal::Intact(name) if is(&name) => FileState::Current,
        Seal::NoDigest(name) if is(&name) => FileState::NoDigest,
        _ => FileState::Stale,
    }
}

/// Reads a file that should be a frame of this size. Fails if the file is too large for that.
pub fn read_bytes(path: &Path, (width, height): (u32, u32)) -> io::Result<Vec<u8>> {
    let pixels = u64::from(width) * u64::from(height);
    // An upper bound: slightly more than the picture without compression.
    let most = pixels * 8 + pixels / 8 + MAX_OVERHEAD;
    attempt(Operation::Read, path, || files::read(path, most))
}

/// Whether a file without a seal is a complete PNG: the checksums of its chunks and of the picture are right, and
/// nothing follows the end.
pub fn is_whole(bytes: &[u8]) -> bool {
    let mut options = DecodeOptions::default();
    options.set_ignore_checksums(false);
    options.set_skip_ancillary_crc_failures(false);
    let mut decoder = Decoder::new_with_options(Cursor::new(bytes), options);
    // The decoder stores text chunks before it checks their size.
    decoder.set_limits(Limits { bytes: MAX_OVERHEAD as usize });
    let Ok(mut reader) = decoder.read_info() else { return false };
    let Some(size) = reader.output_buffer_size() else { return false };
    let decoded = reader.next_frame(&mut vec![0; size]).and_then(|_| reader.finish());
    decoded.is_ok() && bytes.ends_with(END)
}
