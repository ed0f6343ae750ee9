//! PNG files back into pictures, and what they tell.

use super::seal::{self, Seal};
use crate::base::digest::Digest;
use crate::base::files;
use crate::encode::disk::{Operation, attempt};
use crate::encode::error::EncodeError;
use crate::encode::job::Job;
use crate::encode::keep::Held;
use crate::encode::picture::Picture;
use png::{BitDepth, ColorType, DecodeOptions, Decoder, Limits, Reader};
use std::io::{self, BufReader, Cursor};
use std::path::Path;

/// How every PNG ends: an empty chunk, with its sum.
const END: &[u8] = b"\0\0\0\0IEND\xae\x42\x60\x82";

/// Bytes of texts and other chunks beside the picture, at most.
const BESIDES: u64 = 1 << 20;

/// Reads back a picture of 8 bits that [`encode`](super::encode) has made.
pub fn read(path: &Path) -> Result<Picture, EncodeError> {
    decode(path).map_err(|e| EncodeError::read(path, e))
}

fn decode(path: &Path) -> io::Result<Picture> {
    let (file, _) = attempt(Operation::Read, path, || files::open(path, u64::MAX))?;
    let mut reader = Decoder::new(BufReader::new(file)).read_info()?;
    let info = reader.info();
    let alpha = info.color_type == ColorType::Rgba;
    if !(alpha || info.color_type == ColorType::Rgb) || info.bit_depth != BitDepth::Eight {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "it is no picture of 8 bits any more"));
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

/// The texts of a PNG file, by their keywords; none of what is no PNG.
pub fn texts(path: &Path) -> Vec<(String, String)> {
    files::open(path, u64::MAX).map_or_else(|_| Vec::new(), |(file, _)| told_in(BufReader::new(file)))
}

/// The same of its bytes.
pub fn texts_in(bytes: &[u8]) -> Vec<(String, String)> {
    told_in(Cursor::new(bytes))
}

fn told_in(input: impl io::BufRead + io::Seek) -> Vec<(String, String)> {
    Decoder::new(input).read_info().map_or_else(|_| Vec::new(), |reader| told(&reader))
}

/// Width and height of a PNG, by its bytes.
pub fn size_in(bytes: &[u8]) -> Option<(u32, u32)> {
    let reader = Decoder::new(Cursor::new(bytes)).read_info().ok()?;
    Some((reader.info().width, reader.info().height))
}

/// Whether a file begins as PNGs do.
pub fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n")
}

fn told<R: io::BufRead + io::Seek>(reader: &Reader<R>) -> Vec<(String, String)> {
    let info = reader.info();
    let latin = info.uncompressed_latin1_text.iter().map(|text| (text.keyword.clone(), text.text.clone()));
    let others = info.utf8_text.iter().filter_map(|text| Some((text.keyword.clone(), text.get_text().ok()?)));
    latin.chain(others).collect()
}

/// What there is of the frame with this identity in a file.
pub fn holds(path: &Path, identity: Digest, job: &Job) -> Held {
    let Ok(mut bytes) = bytes_of(path, job.size) else { return Held::Stale };
    let is = |name: &str| name == identity.to_string();
    match seal::look(&mut bytes) {
        Seal::Whole(name) if is(&name) => Held::Right,
        Seal::Open(name) if is(&name) => Held::Unsealed,
        _ => Held::Stale,
    }
}

/// The bytes of a file that may be a frame of this size.
pub fn bytes_of(path: &Path, (width, height): (u32, u32)) -> io::Result<Vec<u8>> {
    let pixels = u64::from(width) * u64::from(height);
    // A little more than the picture without compression.
    let most = pixels * 8 + pixels / 8 + BESIDES;
    attempt(Operation::Read, path, || files::read(path, most))
}

/// Whether a file that is not sealed is a whole PNG: all sums of its chunks and of the picture are right, and nothing
/// comes after its end.
pub fn check(bytes: &[u8]) -> bool {
    let mut options = DecodeOptions::default();
    options.set_ignore_checksums(false);
    options.set_skip_ancillary_crc_failures(false);
    let mut decoder = Decoder::new_with_options(Cursor::new(bytes), options);
    // Texts are held before the size is known to be right.
    decoder.set_limits(Limits { bytes: BESIDES as usize });
    let Ok(mut reader) = decoder.read_info() else { return false };
    let Some(size) = reader.output_buffer_size() else { return false };
    let decoded = reader.next_frame(&mut vec![0; size]).and_then(|_| reader.finish());
    decoded.is_ok() && bytes.ends_with(END)
}
