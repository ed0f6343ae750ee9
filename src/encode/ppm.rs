//! Pictures as binary PPM (P6), 8 bits a channel.

use super::atomic::Aside;
use super::error::EncodeError;
use super::picture::Picture;
use image::codecs::pnm::{PnmEncoder, PnmSubtype, SampleEncoding};
use image::{ExtendedColorType, ImageEncoder};
use std::io;
use std::path::Path;

/// Writes the picture aside, for the place `path`.
pub fn write(path: &Path, picture: &Picture) -> Result<Aside, EncodeError> {
    let bytes = encode(picture).map_err(|error| EncodeError::write(path, error))?;
    Aside::holding(path, &bytes)
}

fn encode(picture: &Picture) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(picture.rgb.len() + 32);
    let encoder = PnmEncoder::new(&mut bytes).with_subtype(PnmSubtype::Pixmap(SampleEncoding::Binary));
    encoder
        .write_image(&picture.rgb, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(io::Error::other)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_and_the_rows() {
        let picture = Picture::opaque(2, 1, vec![255, 0, 10, 1, 2, 3]);
        assert_eq!(encode(&picture).expect("bytes"), b"P6\n2 1 255\n\xff\x00\x0a\x01\x02\x03");
    }
}
