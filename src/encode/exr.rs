//! Films as OpenEXR: linear radiance, lossless as f32, without exposure or tone map.

use super::annotation_layer::AnnotationLayer;
use super::atomic::AtomicFile;
use super::error::EncodeError;
use super::metadata::{self, to_lines};
use super::settings::ExrSettings;
use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::film::Film;
use exr::error::{Error, UnitResult};
use exr::image::write::channels::WritableChannels;
use exr::meta::attribute::{AttributeValue, Chromaticities, LineOrder, Text};
use exr::prelude::f16;
use exr::prelude::{Blocks, Compression, Encoding, Image, Layer, SpecificChannels, Vec2, WritableImage};
use std::io;
use std::path::Path;

mod half;
mod layers;
mod seal;
#[cfg(test)]
mod tests;

use half::HalfConverter;
pub use layers::{ALBEDO, NORMAL, SAMPLES};
use layers::{ExtraLayers, write_layers};
pub use seal::{state, texts};

/// ZIP compression of blocks of 16 rows. Blocks are in order, because the file's bytes must not depend on threads.
const ENCODING: Encoding = Encoding {
    compression: Compression::ZIP16,
    blocks: Blocks::ScanLines,
    line_order: LineOrder::Increasing,
};

/// The primaries and the white point of sRGB (Rec. 709, D65) as CIE xy.
const SRGB: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// The metadata of a file.
#[derive(Clone, Debug, Default)]
pub struct ExrMetadata {
    pub identity: Option<Digest>,
    pub entries: Vec<metadata::TextEntry>,
}

/// Writes the film's radiance to the file `path`, which is not committed yet. `names` are the names of the film's light
/// groups, and `annotations` are what is drawn over it. Also returns the number of values that were too large for half
/// floats.
pub fn write(
    path: &Path,
    film: &Film,
    settings: ExrSettings,
    (names, annotations): (&[String], Option<&AnnotationLayer>),
    metadata: &ExrMetadata,
) -> Result<(AtomicFile, u64), EncodeError> {
    let mut file = AtomicFile::create(path)?;
    let converter = HalfConverter::default();
    let halves = settings.half.then_some(&converter);
    let written = match settings.layers.any() || annotations.is_some() {
        true => {
            let layers = ExtraLayers { requested: settings.layers, names, annotations };
            write_layers(film, &layers, halves, metadata, &mut file)
        }
        false => write_radiance(film, halves, metadata, &mut file),
    };
    written.map_err(|error| EncodeError::write(path, cause(error)))?;
    if metadata.identity.is_some() {
        seal::close(&mut file).map_err(|error| EncodeError::write(path, error))?;
    }
    Ok((file, converter.clipped()))
}

/// Writes the channels R, G and B, and A if the film has coverage. Radiance is summed over the light groups as it is
/// written, so that memory holds no second copy of the picture.
fn write_radiance(
    film: &Film,
    halves: Option<&HalfConverter>,
    metadata: &ExrMetadata,
    file: &mut AtomicFile,
) -> UnitResult {
    let width = film.width as usize;
    let at = |Vec2(x, y): Vec2<usize>| y * width + x;
    let color = |place| film.radiance_at(at(place));
    let alpha = |place| film.alpha_at(at(place));
    match (film.aovs.coverage, halves) {
        (false, None) => {
            let channels = SpecificChannels::rgb::<f32, f32, f32>(|place| color(place).into());
            image(film, channels, metadata).write().non_parallel().to_buffered(file)
        }
        (false, Some(halves)) => {
            let short = |place| color(place).to_array().map(|value| halves.half(value)).into();
            let channels = SpecificChannels::rgb::<f16, f16, f16>(short);
            image(film, channels, metadata).write().non_parallel().to_buffered(file)
        }
        (true, None) => {
            let pixel = |place| {
                let Rgb { x, y, z } = color(place);
                (x, y, z, alpha(place))
            };
            let channels = SpecificChannels::rgba::<f32, f32, f32, f32>(pixel);
            image(film, channels, metadata).write().non_parallel().to_buffered(file)
        }
        (true, Some(halves)) => {
            let pixel = |place| {
                let Rgb { x, y, z } = color(place);
                let [r, g, b, a] = [x, y, z, alpha(place)].map(|value| halves.half(value));
                (r, g, b, a)
            };
            let channels = SpecificChannels::rgba::<f16, f16, f16, f16>(pixel);
            image(film, channels, metadata).write().non_parallel().to_buffered(file)
        }
    }
}

/// An image of these channels with the file's attributes.
fn image<'c, C: WritableChannels<'c> + 'c>(
    film: &Film,
    channels: C,
    metadata: &ExrMetadata,
) -> Image<Layer<C>> {
    let size = Vec2(film.width as usize, film.height as usize);
    let mut image = Image::from_encoded_channels(size, ENCODING, channels);
    image.attributes.chromaticities = Some(SRGB);
    // Each of the two hash maps holds one attribute, because the order of several would differ between runs.
    let seal = metadata.identity.map(|identity| (Text::from(seal::IDENTITY), seal::open(identity)));
    image.attributes.other.extend(seal);
    let text = Text::new_or_none(to_lines(&metadata.entries)).filter(|_| !metadata.entries.is_empty());
    let text = text.map(|text| (Text::from(seal::METADATA), AttributeValue::Text(text)));
    image.layer_data.attributes.other.extend(text);
    image
}

/// The I/O error inside, if there is one, because its kind selects the advice in the message.
fn cause(error: Error) -> io::Error {
    match error {
        Error::Io(error) => error,
        other => io::Error::other(other),
    }
}
