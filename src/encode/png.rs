//! Pictures as PNG with 8 or 16 bits per channel and optional alpha. The settings favour speed over size.

use super::metadata::TextEntry;
use super::picture::{Code, Picture};
use crate::base::digest::Digest;
use std::borrow::Cow;
use std::io;

mod read;
mod seal;
mod underlay;

pub use read::{decode_bytes, is_png, is_whole, read, read_bytes, size_in, state, texts, texts_in};
pub use seal::{Seal, verify};
pub use underlay::{clean_identity, restore, underlay};

/// Codes of a bit depth that PNG supports. PNG is big-endian.
pub trait PngCode: Code {
    const DEPTH: png::BitDepth;

    fn bytes(codes: &[Self]) -> Cow<'_, [u8]>;
}

impl PngCode for u8 {
    const DEPTH: png::BitDepth = png::BitDepth::Eight;

    fn bytes(codes: &[Self]) -> Cow<'_, [u8]> {
        Cow::Borrowed(codes)
    }
}

impl PngCode for u16 {
    const DEPTH: png::BitDepth = png::BitDepth::Sixteen;

    fn bytes(codes: &[Self]) -> Cow<'_, [u8]> {
        codes.iter().flat_map(|code| code.to_be_bytes()).collect()
    }
}

/// Encodes a picture as a PNG file with these text chunks.
pub fn encode<C: PngCode>(picture: &Picture<C>, texts: &[TextEntry]) -> io::Result<Vec<u8>> {
    encode_over(picture, texts, None)
}

/// [`encode`] with what is below the annotations.
pub fn encode_over<C: PngCode>(
    picture: &Picture<C>,
    texts: &[TextEntry],
    below: Option<&[u8]>,
) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(picture.rgb.len() / 3 + 1024);
    let mut encoder = png::Encoder::new(&mut bytes, picture.width, picture.height);
    encoder.set_color(if picture.alpha.is_some() { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(C::DEPTH);
    // A rendered frame of 800x800 pixels takes 1.7 ms and 125 kB. A fixed filter may give 350 kB. `Balanced` takes
    // 31 ms and 85 kB.
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    for (keyword, text) in texts {
        // A tEXt chunk is limited to Latin-1.
        match text.chars().all(|c| c <= '\u{ff}') {
            true => encoder.add_text_chunk((*keyword).to_owned(), text.clone())?,
            false => encoder.add_itxt_chunk((*keyword).to_owned(), text.clone())?,
        }
    }
    let mut writer = encoder.write_header()?;
    if let Some(below) = below {
        writer.write_chunk(underlay::UNDERLAY, below)?;
    }
    match picture.alpha {
        Some(_) => writer.write_image_data(&C::bytes(&picture.interleaved()))?,
        None => writer.write_image_data(&C::bytes(&picture.rgb))?,
    }
    writer.finish()?;
    Ok(bytes)
}

/// Encodes a frame as a PNG file with metadata, identity, digest, and what is below its annotations.
pub fn sealed<C: PngCode>(
    picture: &Picture<C>,
    mut texts: Vec<TextEntry>,
    identity: Option<Digest>,
    below: Option<&[u8]>,
) -> io::Result<Vec<u8>> {
    let Some(identity) = identity else { return encode(picture, &texts) };
    texts.push(seal::text(identity));
    let mut bytes = encode_over(picture, &texts, below)?;
    seal::close(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::time::Rate;
    use crate::encode::metadata::frame_entries;
    use crate::encode::{FrameInfo, FrameKey, SequenceInfo, write_png};
    use ::png::Decoder;
    use image::DynamicImage;
    use std::path::Path;

    fn codes<C: Code>(count: u32) -> Vec<C> {
        (0..count).map(|i| C::of(f64::from(i * 37 % 256) / 255.0)).collect()
    }

    #[test]
    fn written_pngs_are_read_back() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.png");
        let picture = Picture::opaque(5, 7, codes(5 * 7 * 3));
        write_png(&path, &picture).expect("written");
        assert_eq!(read(&path).expect("read"), picture);
    }

    #[test]
    fn alpha_and_sixteen_bits_are_read_by_others() {
        let load = |bytes: Vec<u8>| image::load_from_memory(&bytes).expect("a PNG");
        let plain: Picture<u8> = Picture::opaque(5, 7, codes(5 * 7 * 3));
        let clear = Picture { alpha: Some(codes(5 * 7)), ..plain };
        let deep: Picture<u16> = Picture::opaque(5, 7, codes(5 * 7 * 3));
        let deep_clear = Picture { alpha: Some(codes(5 * 7)), ..deep.clone() };
        let DynamicImage::ImageRgba8(found) = load(encode(&clear, &[]).expect("bytes")) else {
            panic!("no RGBA")
        };
        assert_eq!(found.into_raw(), clear.interleaved());
        let DynamicImage::ImageRgb16(found) = load(encode(&deep, &[]).expect("bytes")) else {
            panic!("no RGB16")
        };
        assert_eq!(found.into_raw(), deep.rgb);
        let DynamicImage::ImageRgba16(found) = load(encode(&deep_clear, &[]).expect("bytes")) else {
            panic!("no RGBA16")
        };
        assert_eq!(found.into_raw(), deep_clear.interleaved());
    }

    #[test]
    fn a_frame_holds_its_metadata() {
        let sequence = SequenceInfo {
            name: "Ente→".into(),
            frames: 48,
            seed: 7,
            samples: 64,
            antialias: 2,
            ..SequenceInfo::default()
        };
        let rate = Rate::new(30_000, 1001).expect("a rate");
        let info = FrameInfo { sequence: &sequence, frame: 12, rate };
        let texts = frame_entries(&info, Some(&FrameKey { random: true, ..FrameKey::default() }));
        let bytes = encode(&Picture::opaque(1, 1, vec![0u8; 3]), &texts).expect("bytes");
        let reader = Decoder::new(io::Cursor::new(bytes)).read_info().expect("a PNG");
        let found = reader.info();
        let texts: Vec<_> = found.uncompressed_latin1_text.iter().map(|t| (&*t.keyword, &*t.text)).collect();
        assert_eq!(texts[0], ("Software", concat!("Kinora ", env!("CARGO_PKG_VERSION"))));
        assert_eq!(
            texts[1..4],
            [("kinora:frame", "12"), ("kinora:frames", "48"), ("kinora:time", "1001/2500")]
        );
        assert_eq!(texts[4..], [("kinora:seed", "7"), ("kinora:samples", "64")]);
        assert_eq!(found.utf8_text[0].get_text().expect("text"), "Ente→");
        // If nothing is random, the grid's samples matter instead.
        let texts = frame_entries(&info, Some(&FrameKey::default()));
        assert_eq!(texts[5..], [("kinora:antialias", "2".to_owned())]);
        assert_eq!(frame_entries(&info, None).len(), 5);
    }

    #[test]
    fn a_missing_file_is_named() {
        let message = read(Path::new("no/such.png")).expect_err("missing").to_string();
        assert!(message.contains("no/such.png"), "{message}");
    }
}
