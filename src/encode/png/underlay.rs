//! What is below the annotations of a PNG: a chunk with the pixels that they cover. So a later run can draw other
//! annotations without rendering the frame again.
//!
//! The chunk holds the identity that the frame has without annotations, and compressed with zlib: the number of runs of
//! pixels, where each begins and how long it is, and the codes of their pixels.

use crate::base::digest::Digest;
use crate::encode::picture::Picture;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use png::chunk::ChunkType;
use std::io::{self, Read, Write};

/// Ancillary, private, and not to be copied by programs that change the picture.
pub const UNDERLAY: ChunkType = ChunkType(*b"knUL");

/// Bytes of an identity.
const IDENTITY: usize = 16;
/// Bytes of the PNG signature.
const SIGNATURE: usize = 8;

/// The content of the chunk: where `annotated` differs from `clean`, which has this identity.
pub fn underlay(clean: &Picture, annotated: &Picture, identity: Digest) -> io::Result<Vec<u8>> {
    let runs = differences(clean, annotated);
    let mut content = Vec::new();
    content.extend((runs.len() as u32).to_be_bytes());
    for number in runs.as_flattened() {
        content.extend((*number as u32).to_be_bytes());
    }
    for [start, length] in runs {
        content.extend(&clean.rgb[3 * start..3 * (start + length)]);
        if let Some(alpha) = &clean.alpha {
            content.extend(&alpha[start..start + length]);
        }
    }
    // As a whole, because each write clears the buffer of the encoder.
    let mut encoder = ZlibEncoder::new(identity.0.to_be_bytes().to_vec(), Compression::fast());
    encoder.write_all(&content)?;
    encoder.finish()
}

/// The runs of pixels in which two pictures of a size differ: where they begin, and their lengths.
fn differences(one: &Picture, other: &Picture) -> Vec<[usize; 2]> {
    let (a, b) = (one.rgb.as_chunks::<3>().0, other.rgb.as_chunks::<3>().0);
    let alpha = |picture: &Picture, pixel: usize| picture.alpha.as_ref().map(|alpha| alpha[pixel]);
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for pixel in 0..a.len().min(b.len()) {
        if a[pixel] == b[pixel] && alpha(one, pixel) == alpha(other, pixel) {
            continue;
        }
        match runs.last_mut().filter(|[start, length]| start + length == pixel) {
            Some([_, length]) => *length += 1,
            None => runs.push([pixel, 1]),
        }
    }
    runs
}

/// The identity without annotations that a PNG file states.
pub fn clean_identity(file: &[u8]) -> Option<Digest> {
    let (identity, _) = chunk(file)?.split_first_chunk::<IDENTITY>()?;
    Some(Digest(u128::from_be_bytes(*identity)))
}

/// Restores the picture of a file below its annotations. None if the file does not hold it.
pub fn restore(file: &[u8], mut picture: Picture) -> Option<Picture> {
    let (_, compressed) = chunk(file)?.split_first_chunk::<IDENTITY>()?;
    let pixels = picture.rgb.len() / 3;
    let mut reader = ZlibDecoder::new(compressed);
    let mut number = || -> Option<usize> {
        let mut bytes = [0; 4];
        reader.read_exact(&mut bytes).ok()?;
        Some(u32::from_be_bytes(bytes) as usize)
    };
    let count = number().filter(|count| *count <= pixels)?;
    let runs = (0..count).map(|_| Some([number()?, number()?])).collect::<Option<Vec<_>>>()?;
    for [start, length] in runs {
        let end = start.checked_add(length).filter(|end| *end <= pixels)?;
        reader.read_exact(&mut picture.rgb[3 * start..3 * end]).ok()?;
        if let Some(alpha) = &mut picture.alpha {
            reader.read_exact(&mut alpha[start..end]).ok()?;
        }
    }
    Some(picture)
}

/// The content of the chunk in a file.
fn chunk(file: &[u8]) -> Option<&[u8]> {
    let mut rest = file.get(SIGNATURE..)?;
    loop {
        // A chunk is its length, type, data and checksum.
        let (length, after) = rest.split_first_chunk::<4>()?;
        let (kind, after) = after.split_first_chunk::<4>()?;
        let length = u32::from_be_bytes(*length) as usize;
        let data = after.get(..length)?;
        match kind {
            kind if *kind == UNDERLAY.0 => return Some(data),
            b"IDAT" | b"IEND" => return None,
            _ => rest = after.get(length.checked_add(4)?..)?,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode::png::{decode_bytes, encode_over};

    #[test]
    fn what_is_below_is_restored() {
        for alpha in [None, Some(vec![200u8; 600])] {
            let rgb: Vec<u8> = (0..1800u32).map(|i| (i * 7 % 256) as u8).collect();
            let clean = Picture { width: 30, height: 20, rgb, alpha };
            let mut drawn = clean.clone();
            drawn.rgb[300..450].fill(9);
            drawn.rgb[1799] ^= 1;
            if let Some(alpha) = &mut drawn.alpha {
                alpha[7] = 3;
            }
            let below = underlay(&clean, &drawn, Digest(77)).expect("bytes");
            let file = encode_over(&drawn, &[], Some(&below)).expect("a file");
            assert_eq!(decode_bytes(&file).expect("a picture"), drawn);
            assert_eq!(clean_identity(&file), Some(Digest(77)));
            assert_eq!(restore(&file, drawn.clone()), Some(clean));
            // Damage leads to no panic.
            for at in 0..file.len() {
                let mut damaged = file.clone();
                damaged[at] ^= 0x55;
                let _ = restore(&damaged, drawn.clone());
            }
            let plain = encode_over(&drawn, &[], None).expect("a file");
            assert_eq!((clean_identity(&plain), restore(&plain, drawn)), (None, None));
        }
    }
}
