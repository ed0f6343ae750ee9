//! Pictures as JPEG.

use super::picture::Picture;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use std::io;

/// Encodes a picture as a JPEG file. `quality` is 1..=100.
pub fn encode(picture: &Picture, quality: u8) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, quality);
    encoder
        .encode(&picture.rgb, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(io::Error::other)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn higher_quality_is_closer_and_larger() {
        let color = |i: u32| [(i % 40 * 5) as u8, (i / 40 * 6) as u8, 128];
        let picture = Picture::opaque(40, 37, (0..40 * 37).flat_map(color).collect());
        let with = |quality| {
            let bytes = encode(&picture, quality).expect("bytes");
            let found = image::load_from_memory(&bytes).expect("a JPEG").into_rgb8();
            assert_eq!(found.dimensions(), (40, 37));
            let off = found.into_raw().iter().zip(&picture.rgb).map(|(a, b)| a.abs_diff(*b)).max();
            (bytes.len(), off)
        };
        let (small, large) = (with(30), with(98));
        assert!(small.0 < large.0 && large.1 <= Some(6), "{small:?} {large:?}");
    }
}
