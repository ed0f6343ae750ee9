//! Films as OpenEXR: linear radiance, lossless as f32, without exposure or tone map.

use super::atomic::AtomicFile;
use super::error::EncodeError;
use super::metadata::{self, to_lines};
use super::settings::{ExrLayers, ExrSettings};
use crate::base::color::Rgb;
use crate::base::digest::Digest;
use crate::film::{DenoisingFeatures, Film};
use exr::error::{Error, UnitResult};
use exr::image::write::channels::WritableChannels;
use exr::meta::attribute::{AttributeValue, Chromaticities, LineOrder, Text};
use exr::prelude::f16;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, SpecificChannels,
    Vec2, WritableImage,
};
use std::io;
use std::path::Path;

mod half;
mod seal;

use half::HalfConverter;
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

/// The depth of pixels that hit nothing, as other renderers write it.
const NO_DEPTH: f32 = 1e10;

/// The name of the layer of normals.
pub const NORMAL: &str = "N";
/// The name of the layer of albedo.
pub const ALBEDO: &str = "albedo";

/// The metadata of a file.
#[derive(Clone, Debug, Default)]
pub struct ExrMetadata {
    pub identity: Option<Digest>,
    pub entries: Vec<metadata::TextEntry>,
}

/// Writes the film's radiance to the file `path`, which is not committed yet. `names` are the names of the film's light
/// groups. Also returns the number of values that were too large for half floats.
pub fn write(
    path: &Path,
    film: &Film,
    settings: ExrSettings,
    names: &[String],
    metadata: &ExrMetadata,
) -> Result<(AtomicFile, u64), EncodeError> {
    let mut file = AtomicFile::create(path)?;
    let converter = HalfConverter::default();
    let halves = settings.half.then_some(&converter);
    let written = match settings.layers.any() {
        true => write_layers(film, settings.layers, halves, names, metadata, &mut file),
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

/// Writes the picture and the requested layers, whose channels are named `LAYER.R` and so on.
fn write_layers(
    film: &Film,
    layers: ExrLayers,
    halves: Option<&HalfConverter>,
    names: &[String],
    metadata: &ExrMetadata,
    file: &mut AtomicFile,
) -> UnitResult {
    let pixels = film.width as usize * film.height as usize;
    let builder = ChannelBuilder { film, pixels, halves };
    let mut list = builder.colors("", |pixel| film.radiance_at(pixel));
    if film.aovs.coverage {
        list.push(builder.channel("A".to_owned(), halves, |pixel| film.alpha_at(pixel)));
    }
    if layers.lights {
        for (layer, name) in names.iter().enumerate().take(film.weights.len()) {
            list.extend(builder.colors(&format!("{name}."), |pixel| film.radiance_of(pixel, layer)));
        }
    }
    list.extend(builder.guides(layers));
    let channels = AnyChannels::sort(list.into());
    image(film, channels, metadata).write().non_parallel().to_buffered(file)
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

/// Makes channels from a film.
struct ChannelBuilder<'a> {
    film: &'a Film,
    pixels: usize,
    /// Converts colours to 16-bit floats, if set. Depth and normals are never converted.
    halves: Option<&'a HalfConverter>,
}

impl ChannelBuilder<'_> {
    fn channel(
        &self,
        name: String,
        halves: Option<&HalfConverter>,
        value: impl Fn(usize) -> f32,
    ) -> AnyChannel<FlatSamples> {
        let values = (0..self.pixels).map(value);
        let samples = match halves {
            Some(halves) => FlatSamples::F16(values.map(|value| halves.half(value)).collect()),
            None => FlatSamples::F32(values.collect()),
        };
        AnyChannel::new(Text::from(name.as_str()), samples)
    }

    /// The channels R, G and B of a colour, with a prefix.
    fn colors(&self, prefix: &str, color: impl Fn(usize) -> Rgb) -> Vec<AnyChannel<FlatSamples>> {
        let channel =
            |(axis, letter)| self.channel(format!("{prefix}{letter}"), self.halves, |p| color(p)[axis]);
        ["R", "G", "B"].into_iter().enumerate().map(channel).collect()
    }

    fn guides(&self, layers: ExrLayers) -> Vec<AnyChannel<FlatSamples>> {
        let none = DenoisingFeatures { depth: None, normal: Rgb::ZERO, albedo: Rgb::ZERO };
        let at = |pixel| self.film.features_at(pixel).unwrap_or(none);
        let mut list = Vec::new();
        if layers.depth {
            list.push(self.channel("Z".to_owned(), None, |pixel| at(pixel).depth.unwrap_or(NO_DEPTH)));
        }
        if layers.normal {
            let axis =
                |(axis, letter)| self.channel(format!("{NORMAL}.{letter}"), None, |p| at(p).normal[axis]);
            list.extend(["X", "Y", "Z"].into_iter().enumerate().map(axis));
        }
        if layers.albedo {
            list.extend(self.colors(&format!("{ALBEDO}."), |pixel| at(pixel).albedo));
        }
        list
    }
}

/// The I/O error inside, if there is one, because its kind selects the advice in the message.
fn cause(error: Error) -> io::Error {
    match error {
        Error::Io(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::AovSet;
    use exr::prelude::read_first_rgba_layer_from_file;
    use std::fs;

    /// Two layers with values of all kinds. The height is not a multiple of the rows of a block.
    fn film() -> Film {
        let mut film = Film::new(5, 37, vec![Rgb::ONE, Rgb::new(0.5, 2.0, 1e-3)]);
        for (i, value) in film.data_mut().iter_mut().enumerate() {
            *value = Rgb::new(i as f32 * 0.37, 1.0 / (i as f32 + 1.0), libm::expf(i as f32 * 0.2));
        }
        film.data_mut()[4] = Rgb::new(-1.0, f32::INFINITY, f32::NAN);
        film
    }

    #[test]
    fn reads_back_the_radiance_to_the_last_bit() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.exr");
        let mut film = film();
        film.expose(3.0);
        write(&path, &film, ExrSettings::default(), &[], &ExrMetadata::default())
            .and_then(|(file, _)| file.commit())
            .expect("written");
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

    /// Every channel of a file by its name, as f32.
    fn channels(path: &Path) -> Vec<(String, Vec<f32>)> {
        let image = exr::prelude::read_first_flat_layer_from_file(path).expect("an EXR file");
        let list = image.layer_data.channel_data.list;
        list.into_iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
    }

    #[test]
    fn layers_of_light_add_up_to_the_picture_and_guides_stand_beside_it() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.exr");
        let extras = AovSet { coverage: true, features: true };
        let mut film = Film::with_aovs(3, 2, vec![Rgb::ONE, Rgb::new(0.5, 2.0, 0.0)], extras);
        for (i, value) in film.data_mut().iter_mut().enumerate() {
            *value = Rgb::new(i as f32, 0.5, 0.25) / 32.0;
        }
        // The first pixel hits nothing.
        film.data_mut()[3..6].fill(Rgb::ZERO);
        let layers = ExrLayers { lights: true, depth: true, normal: true, albedo: true };
        let names = ["constant".to_owned(), "key".to_owned()];
        write(
            &path,
            &film,
            ExrSettings { layers, ..ExrSettings::default() },
            &names,
            &ExrMetadata::default(),
        )
        .and_then(|(file, _)| file.commit())
        .expect("written");
        let found = channels(&path);
        let order: Vec<_> = found.iter().map(|(name, _)| name.as_str()).collect();
        let expected = [
            "A",
            "B",
            "G",
            "N.X",
            "N.Y",
            "N.Z",
            "R",
            "Z",
            "albedo.B",
            "albedo.G",
            "albedo.R",
            "constant.B",
            "constant.G",
            "constant.R",
            "key.B",
            "key.G",
            "key.R",
        ];
        assert_eq!(order, expected);
        let value = |name: &str, pixel: usize| {
            found.iter().find(|(found, _)| found == name).map(|(_, values)| values[pixel]).expect(name)
        };
        for pixel in 0..6 {
            for channel in ["R", "G", "B"] {
                let parts = ["constant", "key"].map(|layer| value(&format!("{layer}.{channel}"), pixel));
                assert_eq!(value(channel, pixel), parts[0] + parts[1]);
            }
            assert_eq!(value("A", pixel), film.alpha_at(pixel));
        }
        assert_eq!((value("Z", 0), value("N.X", 0)), (NO_DEPTH, 0.0));
        assert_eq!(Some(value("Z", 1)), film.features_at(1).and_then(|features| features.depth));
    }

    #[test]
    fn half_floats_hold_their_largest_for_what_is_larger() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.exr");
        for (coverage, lights) in [(false, false), (true, false), (false, true)] {
            let extras = AovSet { coverage, features: false };
            let mut film = Film::with_aovs(2, 1, vec![Rgb::ONE], extras);
            film.data_mut()[0] = Rgb::new(65_519.0, 65_520.0, f32::INFINITY);
            let layers = ExrLayers { lights, ..ExrLayers::default() };
            let settings = ExrSettings { half: true, layers, ..ExrSettings::default() };
            let names = ["constant".to_owned()];
            let (file, clipped) =
                write(&path, &film, settings, &names, &ExrMetadata::default()).expect("written");
            file.commit().expect("written");
            assert_eq!(clipped, if lights { 4 } else { 2 });
            for (name, values) in channels(&path) {
                let expected = if name == "A" { film.alpha_at(0) } else { 65_504.0 };
                assert_eq!(values[0], expected, "{name}");
            }
        }
    }

    #[test]
    fn half_floats_are_half_as_fine() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.exr");
        for coverage in [false, true] {
            let extras = AovSet { coverage, features: false };
            let mut film = Film::with_aovs(2, 1, vec![Rgb::ONE], extras);
            film.data_mut()[0] = Rgb::new(0.1, 1.0, 1000.3);
            write(
                &path,
                &film,
                ExrSettings { half: true, ..ExrSettings::default() },
                &[],
                &ExrMetadata::default(),
            )
            .and_then(|(file, _)| file.commit())
            .expect("written");
            let found = channels(&path);
            assert_eq!(found.len(), if coverage { 4 } else { 3 });
            let color: Vec<f32> = found.iter().rev().take(3).map(|(_, values)| values[0]).collect();
            let expected = [0.1, 1.0, 1000.3].map(|value| f16::from_f32(value).to_f32());
            assert_eq!([color[0], color[1], color[2]], expected);
        }
    }

    #[test]
    fn the_bytes_are_always_the_same() {
        let dir = tempfile::tempdir().expect("a folder");
        let bytes = ["a.exr", "b.exr"].map(|name| {
            let path = dir.path().join(name);
            write(&path, &film(), ExrSettings::default(), &[], &ExrMetadata::default())
                .and_then(|(file, _)| file.commit())
                .expect("written");
            fs::read(path).expect("read")
        });
        assert_eq!(bytes[0], bytes[1]);
        // Magic number and version 2, a single part of scan lines.
        assert_eq!(bytes[0][..8], [0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]);
    }
}
