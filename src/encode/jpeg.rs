//! Pictures as JPEG: small, and not without loss.

use super::picture::Picture;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use std::io;

/// Pixels along a side, at most.
const LONGEST: u32 = 65_535;

/// What keeps pictures of this size from being JPEGs.
pub fn limit((width, height): (u32, u32)) -> Option<&'static str> {
    (width.max(height) > LONGEST).then_some("a JPEG ends at 65535x65535")
}

/// The picture as the bytes of a JPEG file. `quality` goes from 1 to 100.
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
    fn the_picture_comes_back_nearly_and_quality_costs() {
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

    #[test]
    fn sides_have_a_limit() {
        assert_eq!(limit((65_535, 1)), None);
        assert!(limit((1, 65_536)).is_some());
    }
}
