//! What a PNG frame says of itself: its identity, and a digest of all its bytes, so that a file whose pixels were
//! exchanged is not taken for the frame. The text that holds both is digested with zeros in the digest's place.

use crate::base::digest::{Digest, Digester};
use png::text_metadata::{EncodableTextChunk, TEXtChunk};
use std::io;
use std::ops::Range;

/// The keyword of a frame's identity.
const IDENTITY: &str = "kinora:identity";

/// Digits of a digest.
const DIGITS: usize = 32;

/// Bytes before the first chunk.
const SIGNATURE: usize = 8;

/// What a file says of itself, and whether that is so.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Seal {
    /// It is no PNG, or does not say what it shows.
    None,
    /// It has an identity without a digest, as older versions wrote it.
    Open(String),
    /// It is not as it was written.
    Broken,
    /// Not a byte has changed since it was written.
    Whole(String),
}

/// The text for a file that is still to be written.
pub fn text(identity: Digest) -> (&'static str, String) {
    (IDENTITY, sealed(&identity.to_string(), Digest(0)))
}

fn sealed(identity: &str, digest: Digest) -> String {
    format!("{identity} {digest}")
}

/// Puts the digest of a file's bytes into its place.
pub fn close(bytes: &mut [u8]) -> io::Result<()> {
    let missing = || io::Error::from(io::ErrorKind::InvalidData);
    let place = place_in(bytes).ok_or_else(missing)?;
    let text = text_in(&bytes[place.clone()]).ok_or_else(missing)?;
    let identity = text.split(' ').next().unwrap_or_default().to_owned();
    let chunk = chunk(&sealed(&identity, digest(bytes)))?;
    bytes.get_mut(place).filter(|old| old.len() == chunk.len()).ok_or_else(missing)?.copy_from_slice(&chunk);
    Ok(())
}

/// What the bytes of a file say of themselves. Those of a sealed one are spent by it.
pub fn look(bytes: &mut [u8]) -> Seal {
    let Some(place) = place_in(bytes) else { return Seal::None };
    let Some(text) = text_in(&bytes[place.clone()]).map(str::to_owned) else { return Seal::Broken };
    let Some((identity, told)) = text.split_once(' ') else {
        return if text.len() == DIGITS { Seal::Open(text) } else { Seal::Broken };
    };
    let open = chunk(&sealed(identity, Digest(0))).ok().filter(|open| open.len() == place.len());
    // The sum of the chunk is that of its text, too.
    let right = chunk(&text).is_ok_and(|chunk| chunk == bytes[place.clone()]);
    let Some(open) = open.filter(|_| right) else { return Seal::Broken };
    bytes[place].copy_from_slice(&open);
    if digest(bytes).to_string() == told { Seal::Whole(identity.to_owned()) } else { Seal::Broken }
}

fn digest(bytes: &[u8]) -> Digest {
    let mut digester = Digester::new();
    digester.bytes(bytes);
    digester.finish()
}

/// The whole chunk that holds this text.
fn chunk(text: &str) -> io::Result<Vec<u8>> {
    let mut chunk = Vec::new();
    TEXtChunk::new(IDENTITY, text).encode(&mut chunk)?;
    Ok(chunk)
}

/// Where the chunk with the identity stands: before the picture.
fn place_in(bytes: &[u8]) -> Option<Range<usize>> {
    let mut start = SIGNATURE;
    loop {
        // Its length, its kind, its data, and their sum.
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

/// The text in such a chunk.
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

    fn look(mut bytes: Vec<u8>) -> Seal {
        super::look(&mut bytes)
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
        assert_eq!(look(bytes.clone()), Seal::Whole(NAME.to_string()));
        image::load_from_memory(&bytes).expect("a PNG, with the right sums");
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1 << bit;
                assert!(!matches!(look(damaged), Seal::Whole(name) if name == NAME.to_string()), "byte {at}");
            }
        }
        assert!((0..bytes.len()).all(|end| !matches!(look(bytes[..end].to_vec()), Seal::Whole(_))));
        assert_eq!(look([&bytes[..], b"more"].concat()), Seal::Broken);
    }

    #[test]
    fn exchanged_pixels_are_seen() {
        let (one, other) = (frame(7), frame(8));
        let place = place_in(&one).expect("a chunk");
        assert_eq!(place, place_in(&other).expect("a chunk"));
        let exchanged = [&one[..place.end], &other[place.end..]].concat();
        image::load_from_memory(&exchanged).expect("a PNG, with the right sums");
        assert_eq!(look(exchanged), Seal::Broken);
    }

    #[test]
    fn files_without_a_digest_are_told_apart() {
        let picture = Picture::opaque(1, 1, vec![0u8; 3]);
        let with = |text: &str| look(encode(&picture, &[(IDENTITY, text.to_owned())]).expect("bytes"));
        assert_eq!(with(&NAME.to_string()), Seal::Open(NAME.to_string()));
        assert_eq!(with("a"), Seal::Broken);
        assert_eq!(with(&format!("{NAME} 0")), Seal::Broken);
        assert_eq!(look(encode(&picture, &[]).expect("bytes")), Seal::None);
        assert_eq!((look(Vec::new()), look(vec![0xff; 40])), (Seal::None, Seal::None));
    }
}
