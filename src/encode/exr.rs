//! Films as OpenEXR: linear radiance in f32, without loss and without exposure or tone map.

use super::atomic::Aside;
use super::error::EncodeError;
use crate::film::Film;
use exr::error::{Error, UnitResult};
use exr::meta::attribute::{Chromaticities, LineOrder};
use exr::prelude::{Blocks, Compression, Encoding, Image, SpecificChannels, Vec2, WritableImage};
use std::io;
use std::path::Path;

/// 16 rows at a time, compressed as ZIP does; in order, as the frame's bytes may not depend on threads.
const ENCODING: Encoding = Encoding {
    compression: Compression::ZIP16,
    blocks: Blocks::ScanLines,
    line_order: LineOrder::Increasing,
};

/// The primaries and the white of sRGB (Rec. 709, D65) as CIE xy.
const SRGB: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// Writes the film's radiance as the file `path`, whole or not at all.
pub fn write(path: &Path, film: &Film) -> Result<(), EncodeError> {
    let mut aside = Aside::create(path)?;
    encode(film, &mut aside).map_err(|error| EncodeError::write(path, plain(error)))?;
    aside.commit()
}

/// Writes the channels R, G and B to `file`. The radiance is summed as it is written, so that no second copy of
/// the picture is held.
fn encode(film: &Film, file: &mut Aside) -> UnitResult {
    let size = Vec2(film.width as usize, film.height as usize);
    let radiance = |Vec2(x, y): Vec2<usize>| film.radiance_at(y * size.0 + x).into();
    let channels = SpecificChannels::rgb::<f32, f32, f32>(radiance);
    let mut image = Image::from_encoded_channels(size, ENCODING, channels);
    image.attributes.chromaticities = Some(SRGB);
    image.write().non_parallel().to_buffered(file)
}

/// The disk's own error where there is one: it knows what helps.
fn plain(error: Error) -> io::Error {
    match error {
        Error::Io(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use exr::prelude::read_first_rgba_layer_from_file;
    use std::fs;

    /// Two layers of all kinds of values, with a height that is no multiple of the rows of a block.
    fn film() -> Film {
        let mut film = Film::new(5, 37, vec![Rgb::ONE, Rgb::new(0.5, 2.0, 1e-3)]);
        for (i, value) in film.data.iter_mut().enumerate() {
            *value = Rgb::new(i as f32 * 0.37, 1.0 / (i as f32 + 1.0), libm::expf(i as f32 * 0.2));
        }
        film.data[4] = Rgb::new(-1.0, f32::INFINITY, f32::NAN);
        film
    }

    #[test]
    fn reads_back_the_radiance_to_the_last_bit() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.exr");
        let mut film = film();
        film.expose(3.0);
        write(&path, &film).expect("written");
        let image = read_first_rgba_layer_from_file(
            path,
            |size, _| vec![Rgb::ZERO; size.area()],
            |pixels, Vec2(x, y), (r, g, b, _): (f32, f32, f32, f32)| pixels[y * 5 + x] = Rgb::new(r, g, b),
        );
        let image = image.expect("an EXR file");
        let bits =
            |pixels: Vec<Rgb>| pixels.iter().map(|c| c.to_array().map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(image.layer_data.channel_data.pixels), bits(film.radiance().collect()));
        assert_eq!(image.attributes.display_window.size, Vec2(5, 37));
        assert_eq!(image.attributes.chromaticities, Some(SRGB));
    }

    #[test]
    fn the_bytes_are_always_the_same() {
        let dir = tempfile::tempdir().expect("a folder");
        let bytes = ["a.exr", "b.exr"].map(|name| {
            let path = dir.path().join(name);
            write(&path, &film()).expect("written");
            fs::read(path).expect("read")
        });
        assert_eq!(bytes[0], bytes[1]);
        // Magic number and version 2, a single part of scan lines.
        assert_eq!(bytes[0][..8], [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]);
    }
}
