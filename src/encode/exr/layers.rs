//! The layers of an EXR file: light groups, depth, normals and albedo.

use super::half::HalfConverter;
use super::{ExrMetadata, image};
use crate::base::color::Rgb;
use crate::encode::annotation_layer::{ANNOTATIONS, AnnotationLayer};
use crate::encode::atomic::AtomicFile;
use crate::encode::settings::ExrLayers;
use crate::film::{DenoisingFeatures, Film};
use exr::error::UnitResult;
use exr::meta::attribute::Text;
use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, WritableImage};

/// The depth of pixels that hit nothing, as other renderers write it.
pub const NO_DEPTH: f32 = 1e10;

/// The name of the layer of normals.
pub const NORMAL: &str = "N";
/// The name of the layer of albedo.
pub const ALBEDO: &str = "albedo";

/// The name of the layer of light before it was denoised.
pub const SAMPLES: &str = "samples";

/// The layers besides the picture.
pub struct ExtraLayers<'a> {
    pub requested: ExrLayers,
    /// Names of the light groups.
    pub names: &'a [String],
    pub annotations: Option<&'a AnnotationLayer>,
}

/// Writes the picture and the other layers, whose channels are named `LAYER.R` and so on.
pub fn write_layers(
    film: &Film,
    layers: &ExtraLayers,
    halves: Option<&HalfConverter>,
    metadata: &ExrMetadata,
    file: &mut AtomicFile,
) -> UnitResult {
    let ExtraLayers { requested: layers, names, annotations } = *layers;
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
    if layers.samples {
        list.extend(builder.colors(&format!("{SAMPLES}."), |pixel| film.samples_at(pixel)));
    }
    list.extend(builder.feature_channels(layers));
    if let Some(drawn) = annotations {
        let channel = |(part, letter)| {
            builder.channel(format!("{ANNOTATIONS}.{letter}"), halves, |pixel| drawn.linear(pixel)[part])
        };
        list.extend(["R", "G", "B", "A"].into_iter().enumerate().map(channel));
    }
    let channels = AnyChannels::sort(list.into());
    image(film, channels, metadata).write().non_parallel().to_buffered(file)
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

    fn feature_channels(&self, layers: ExrLayers) -> Vec<AnyChannel<FlatSamples>> {
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
