//! The seal of a PNG frame: a text chunk with its identity and a digest of all its bytes. The digest detects files
//! whose pixels were replaced. It is computed with zeros in the place of the digest itself.

use crate::base::digest::{Digest, Digester};
use png::text_metadata::{EncodableTextChunk, TEXtChunk};
use std::io;
use std::ops::Range;

/// The keyword of a frame's identity.
const IDENTITY: &str = "kinora:identity";

/// Hexadecimal digits of a digest.
const DIGITS: usize = 32;

/// Bytes of the PNG signature, before the first chunk.
const SIGNATURE: usize = 8;

/// The seal found in a file, after verification.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Seal {
    /// The file is not a PNG or has no seal.
    Missing,
    /// The file has an identity without a digest, because an older version wrote it.
    NoDigest(String),
    /// The file's bytes have changed since it was written.
    Broken,
    /// The file has this identity, and no byte has changed since it was written.
    Intact(String),
}

/// The text entry for a file that is not written yet, with zeros in place of the digest.
pub fn text(identity: Digest) -> (&'static str, String) {
    (IDENTITY, sealed(&identity.to_string(), Digest(0)))
}

fn sealed(identity: &str, digest: Digest) -> String {
    format!("{identity} {digest}")
}

/// Computes the digest of a complete file and writes it into the seal's chunk.
pub fn close(bytes: &mut [u8]) -> io::Result<()> {
    let missing = || io::Error::from(io::ErrorKind::InvalidData);
    let place = chunk_range(bytes).ok_or_else(missing)?;
    let text = text_in(&bytes[place.clone()]).ok_or_else(missing)?;
    let identity = text.split(' ').next().unwrap_or_default().to_owned();
    let chunk = chunk(&sealed(&identity, digest(bytes)))?;
    bytes.get_mut(place).filter(|old| old.len() == chunk.len()).ok_or_else(missing)?.copy_from_slice(&chunk);
    Ok(())
}

/// Verifies the seal of a file. This overwrites the digest in `bytes` with zeros.
pub fn verify(bytes: &mut [u8]) -> Seal {
    let Some(place) = chunk_range(bytes) else { return Seal::Missing };
    let Some(text) = text_in(&bytes[place.clone()]).map(str::to_owned) else { return Seal::Broken };
    let Some((identity, stored)) = text.split_once(' ') else {
        return if text.len() == DIGITS { Seal::NoDigest(text) } else { Seal::Broken };
    };
    let open = chunk(&sealed(identity, Digest(0))).ok().filter(|open| open.len() == place.len());
    // Comparing whole chunks also checks the chunk's checksum.
    let right = chunk(&text).is_ok_and(|chunk| chunk == bytes[place.clone()]);
    let Some(open) = open.filter(|_| right) else { return Seal::Broken };
    bytes[place].copy_from_slice(&open);
    if digest(bytes).to_string() == stored { Seal::Intact(identity.to_owned()) } else { Seal::Broken }
}

fn digest(bytes: &[u8]) -> Digest {
    let mut digester = Digester::new();
    digester.bytes(bytes);
    digester.finish()
}

/// The complete tEXt chunk with this text.
fn chunk(text: &str) -> io::Result<Vec<u8>> {
    let mut chunk = Vec::new();
    TEXtChunk::new(IDENTITY, text).encode(&mut chunk)?;
    Ok(chunk)
}

/// The position of the seal's chunk, which comes before the picture.
fn chunk_range(bytes: &[u8]) -> Option<Range<usize>> {
    let mut start = SIGNATURE;
    loop {
        // A chunk is its length, type, data and checksum.
        let (length, rest) = bytes.get(start..)?.split_first_chunk()?;
        let end = start.checked_add(u32::from_be_bytes(*length) as usize)?.checked_add(12)?;
        match rest.first_chunk()? {
            b"IDAT" | b"IEND" => return None,
            b"tEXt"
                if rest[4..].starts_with(IDENTITY.as_bytes()) && rest.get(4 + IDENTITY.len()) == Some(&0) =>
            {
                return (end <= bytes.len()).then_some(start..end);
            }
            _ => start = end,
        }
    }
}

/// The text in the seal's chunk.
fn text_in(chunk: &[u8]) -> Option<&str> {
    let text = chunk.get(8 + IDENTITY.len() + 1..chunk.len() - 4)?;
    str::from_utf8(text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode::picture::Picture;
    use crate::encode::png::encode;

    const NAME: Digest = Digest(7);

    fn verified(mut bytes: Vec<u8>) -> Seal {
        super::verify(&mut bytes)
    }

    fn frame(code: u8) -> Vec<u8> {
        let picture = Picture::opaque(3, 2, vec![code; 18]);
        let mut bytes = encode(&picture, &[("Title", "a".to_owned()), text(NAME)]).expect("bytes");
        close(&mut bytes).expect("a place");
        bytes
    }

    #[test]
    fn every_bit_is_sealed() {
        let bytes = frame(7);
        assert_eq!(verified(bytes.clone()), Seal::Intact(NAME.to_string()));
        image::load_from_memory(&bytes).expect("a PNG, with the right sums");
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1 << bit;
                assert!(
                    !matches!(verified(damaged), Seal::Intact(name) if name == NAME.to_string()),
                    "byte {at}"
                );
            }
        }
        assert!((0..bytes.len()).all(|end| !matches!(verified(bytes[..end].to_vec()), Seal::Intact(_))));
        assert_eq!(verified([&bytes[..], b"more"].concat()), Seal::Broken);
    }

    #[test]
    fn replaced_pixels_are_detected() {
        let (one, other) = (frame(7), frame(8));
        let place = chunk_range(&one).expect("a chunk");
        assert_eq!(place, chunk_range(&other).expect("a chunk"));
        let exchanged = [&one[..place.end], &other[place.end..]].concat();
        image::load_from_memory(&exchanged).expect("a PNG, with the right sums");
        assert_eq!(verified(exchanged), Seal::Broken);
    }

    #[test]
    fn files_without_a_digest_are_recognized() {
        let picture = Picture::opaque(1, 1, vec![0u8; 3]);
        let with = |text: &str| verified(encode(&picture, &[(IDENTITY, text.to_owned())]).expect("bytes"));
        assert_eq!(with(&NAME.to_string()), Seal::NoDigest(NAME.to_string()));
        assert_eq!(with("a"), Seal::Broken);
        assert_eq!(with(&format!("{NAME} 0")), Seal::Broken);
        assert_eq!(verified(encode(&picture, &[]).expect("bytes")), Seal::Missing);
        assert_eq!((verified(Vec::new()), verified(vec![0xff; 40])), (Seal::Missing, Seal::Missing));
    }
}
