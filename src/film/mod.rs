//! The film: linear radiance of a frame in layers, and AOVs. The tracer fills it, the denoiser may filter it, and the
//! encoder develops it.
//!
//! In: samples of the tracer.
//! Out: weighted radiance, coverage and denoising features of each pixel.
//! May use: `base`, `sampling`.

mod aov;
pub mod denoise;
pub mod filter;
mod mix;
mod noise;
#[cfg(test)]
mod tests;

pub use aov::{AovSet, DenoisingFeatures};
pub use noise::{ErrorVariance, Noise, StratificationGain, Variances, Z_95};

use crate::base::color::Rgb;
use crate::base::digest::Content;
use denoise::RemainingError;
use std::sync::Arc;

/// The largest exposure, in stops up or down.
pub const MAX_STOPS: f64 = 40.0;

/// The index of a layer of the film. Layer 0 holds all light whose weight has no keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Content)]
#[warn(missing_docs)]
pub struct LayerId(pub u32);

#[warn(missing_docs)]
impl LayerId {
    /// The layer of all light whose weight has no keys.
    pub const CONSTANT: Self = Self(0);

    /// The place of the layer in lists of weights.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Linear radiance of one frame, in one layer per weight. Because light is linear, the picture is the sum of
/// `weights[l]` times layer l. So a frame that differs only in weights needs no rays.
#[derive(Clone, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Film {
    /// Pixels in a row.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
    /// One weight per layer of light. Layers are traced with weight 1. A layer of weight 0 is dark, whatever the film
    /// holds for it.
    pub weights: Vec<Rgb>,
    /// The factor of the displayed picture, above 0. It is not part of the radiance, and 1 after tracing.
    pub exposure: f32,
    /// The recorded AOVs.
    pub aovs: AovSet,
    /// The noise with the current weights, if it was measured.
    pub noise: Option<Noise>,
    /// The noise with each set of weights for which the film was sampled.
    pub noises: Arc<[Noise]>,
    /// The error with any weights, if the film was denoised.
    pub remaining: Option<Arc<RemainingError>>,
    /// Whether the run stopped before the film reached its target.
    pub unfinished: bool,
    /// The layers of light that were traced and are stored, ascending.
    pub held: Arc<[LayerId]>,
    /// The pixels, row by row from the top left. Each pixel has its layers of light and then those of the AOVs. Films
    /// that differ only in weights share the data.
    pub data: Arc<Vec<Rgb>>,
    /// The light before it was denoised, the layers of each pixel, if the AOVs ask for it.
    pub samples: Option<Arc<Vec<Rgb>>>,
}

/// The layers of light that are not dark, ascending.
pub fn lit(weights: &[Rgb]) -> impl Iterator<Item = LayerId> {
    (0..).zip(weights).filter(|(_, weight)| **weight != Rgb::ZERO).map(|(layer, _)| LayerId(layer))
}

#[warn(missing_docs)]
impl Film {
    /// A black film of light alone.
    pub fn new(width: u32, height: u32, weights: Vec<Rgb>) -> Self {
        Self::with_aovs(width, height, weights, AovSet::default())
    }

    /// A black film with the layers that are not dark, and AOVs.
    pub fn with_aovs(width: u32, height: u32, weights: Vec<Rgb>, aovs: AovSet) -> Self {
        let held: Arc<[LayerId]> = lit(&weights).collect();
        let pixels = width as usize * height as usize;
        let data = Arc::new(vec![Rgb::ZERO; pixels * (held.len() + aovs.layers())]);
        Self {
            width,
            height,
            weights,
            exposure: 1.0,
            aovs,
            noise: None,
            noises: Arc::default(),
            remaining: None,
            unfinished: false,
            held,
            data,
            samples: None,
        }
    }

    /// The data, for writing. Films that share it keep a copy.
    pub fn data_mut(&mut self) -> &mut [Rgb] {
        Arc::make_mut(&mut self.data).as_mut_slice()
    }

    /// The film with other weights. Layers that are not held must be dark.
    pub fn weighted_by(&self, weights: &[Rgb]) -> Self {
        let noise = self.remaining.as_ref().map(|remaining| remaining.of(weights));
        Self { weights: weights.to_vec(), noise, ..self.clone() }
    }

    /// The film with the set of weights number `weighting` among those for which it was sampled.
    pub fn shown_as(&self, weighting: usize, weights: &[Rgb]) -> Self {
        let film = self.weighted_by(weights);
        Self { noise: self.noises.get(weighting).copied().or(film.noise), ..film }
    }

    /// Makes the displayed picture `stops` brighter: see [`exposure`].
    pub fn expose(&mut self, stops: f64) {
        self.exposure = exposure(stops);
    }

    /// The number of values per pixel.
    pub fn layers(&self) -> usize {
        self.held.len() + self.aovs.layers()
    }

    /// The weighted sum of the layers of every pixel, row by row: in f64, in the order of the layers, rounded once.
    pub fn radiance(&self) -> impl Iterator<Item = Rgb> {
        self.data.chunks_exact(self.layers()).map(|pixel| self.weighted(pixel))
    }

    /// The weighted sum of the layers of one pixel, counted row by row.
    pub fn radiance_at(&self, pixel: usize) -> Rgb {
        self.weighted(self.pixel(pixel))
    }

    /// The weighted sum of the layers of one pixel before it was denoised. If no samples are kept, they are the picture.
    pub fn samples_at(&self, pixel: usize) -> Rgb {
        self.weighted(self.samples_of(pixel))
    }

    /// The layers of light of a pixel before it was denoised.
    fn samples_of(&self, pixel: usize) -> &[Rgb] {
        let lights = self.held.len();
        match &self.samples {
            Some(samples) => &samples[pixel * lights..][..lights],
            None => &self.pixel(pixel)[..lights],
        }
    }

    /// The part of the radiance of a pixel that comes from one layer of light.
    pub fn radiance_of(&self, pixel: usize, layer: usize) -> Rgb {
        let (id, weight) = (LayerId(layer as u32), self.weights[layer]);
        match self.held.binary_search(&id) {
            Ok(place) if weight != Rgb::ZERO => {
                (weight.as_dvec3() * self.pixel(pixel)[place].as_dvec3()).as_vec3()
            }
            _ => Rgb::ZERO,
        }
    }

    /// The alpha of a pixel: the fraction that hides the background, from 0 to 1. It is 1 unless coverage is recorded.
    /// The radiance of the pixel is premultiplied by alpha.
    pub fn alpha_at(&self, pixel: usize) -> f32 {
        let Some(layer) = self.aovs.coverage_layer(self.held.len()) else { return 1.0 };
        // The visible background may be tinted, but a picture has one alpha.
        let through = self.pixel(pixel)[layer.index()].element_sum() / 3.0;
        (1.0 - through).clamp(0.0, 1.0)
    }

    /// The denoising features of a pixel, if they are recorded.
    pub fn features_at(&self, pixel: usize) -> Option<DenoisingFeatures> {
        let first = self.aovs.features_layer(self.held.len())?.index();
        let [depth, normal, albedo] = *self.pixel(pixel)[first..].first_chunk()?;
        let hits = depth.y;
        Some(DenoisingFeatures {
            depth: (hits > 0.0).then_some(depth.x / hits),
            normal: normal.normalize_or_zero(),
            albedo,
        })
    }

    pub(crate) fn pixel(&self, pixel: usize) -> &[Rgb] {
        &self.data[pixel * self.layers()..][..self.layers()]
    }

    /// Skips dark layers: the picture does not need them, so they may hold any value, also an infinite one.
    fn weighted(&self, layers: &[Rgb]) -> Rgb {
        let mut sum = glam::DVec3::ZERO;
        for (id, layer) in self.held.iter().zip(layers) {
            let weight = self.weights[id.index()];
            if weight != Rgb::ZERO {
                sum += weight.as_dvec3() * layer.as_dvec3();
            }
        }
        sum.as_vec3()
    }
}

/// The factor of a picture that is `stops` brighter; each stop doubles it. Easings may overshoot [`MAX_STOPS`], so
/// `stops` is clamped.
pub fn exposure(stops: f64) -> f32 {
    libm::exp2(stops.clamp(-MAX_STOPS, MAX_STOPS)) as f32
}
