//! Pictures as PPM with 8 bits per channel: binary (P6) or ASCII (P3).

use super::picture::Picture;
use image::codecs::pnm::{PnmEncoder, PnmSubtype, SampleEncoding};
use image::{ExtendedColorType, ImageEncoder};
use std::io;

/// Encodes a picture as a PPM file.
pub fn encode(picture: &Picture, ascii: bool) -> io::Result<Vec<u8>> {
    // In ASCII, a number has up to three digits and a separator.
    let each = if ascii { 4 } else { 1 };
    let mut bytes = Vec::with_capacity(picture.rgb.len() * each + 32);
    let samples = if ascii { SampleEncoding::Ascii } else { SampleEncoding::Binary };
    let encoder = PnmEncoder::new(&mut bytes).with_subtype(PnmSubtype::Pixmap(samples));
    encoder
        .write_image(&picture.rgb, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(io::Error::other)?;
    if ascii {
        // Another picture may follow on the standard output.
        bytes.push(b'\n');
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_and_the_rows() {
        let picture = Picture::opaque(2, 1, vec![255, 0, 10, 1, 2, 3]);
        assert_eq!(encode(&picture, false).expect("bytes"), b"P6\n2 1 255\n\xff\x00\x0a\x01\x02\x03");
        let text = String::from_utf8(encode(&picture, true).expect("bytes")).expect("ASCII");
        let words: Vec<_> = text.split_ascii_whitespace().collect();
        assert_eq!(words, ["P3", "2", "1", "255", "255", "0", "10", "1", "2", "3"]);
    }

    /// The PPM format limits lines to 70 characters.
    #[test]
    fn lines_of_ascii_are_short() {
        let picture = Picture::opaque(40, 3, (0..360u16).map(|k| (k % 256) as u8).collect());
        let text = String::from_utf8(encode(&picture, true).expect("bytes")).expect("ASCII");
        assert!(text.lines().all(|line| line.len() <= 70) && text.ends_with('\n'), "{text}");
        let decoded = image::load_from_memory(text.as_bytes()).expect("a PPM").into_rgb8();
        assert_eq!(decoded.into_raw(), picture.rgb);
    }
}
