//! AOVs: what a film records besides light.

use super::LayerId;
use crate::base::color::Rgb;
use glam::Vec3;

/// The AOVs (arbitrary output variables) that a film records besides light. Others are neither traced nor stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[warn(missing_docs)]
pub struct AovSet {
    /// How much of the background is visible in each pixel. The film then omits light that camera rays receive from
    /// the background directly.
    pub coverage: bool,
    /// Denoising features: depth, normal and albedo of the first visible surface.
    pub features: bool,
    /// Guides of the denoiser: closeness, normal and albedo of the first surface that scatters light, seen through
    /// mirrors and glass. Finished films have none.
    pub guides: bool,
    /// Whether denoised films keep their samples, in [`Film::samples`](super::Film::samples).
    pub samples: bool,
}

/// The number of layers of the denoising features: [depth, hits, 0], normal and albedo.
const FEATURES: usize = 3;

/// The number of layers of the guides: [1 / distance, hits, 0], normal and albedo.
pub const GUIDES: usize = 3;

#[warn(missing_docs)]
impl AovSet {
    /// What a picture needs besides light: coverage if its background is transparent.
    pub fn of_picture(transparent: bool) -> Self {
        Self { coverage: transparent, ..Self::default() }
    }

    /// The number of their layers. They follow the layers of light.
    pub fn layers(self) -> usize {
        let features = if self.features { FEATURES } else { 0 };
        usize::from(self.coverage) + features + if self.guides { GUIDES } else { 0 }
    }

    /// The layer of the visible background, after `lights` layers of light.
    pub fn coverage_layer(self, lights: usize) -> Option<LayerId> {
        self.coverage.then_some(LayerId(lights as u32))
    }

    /// The first layer of the denoising features.
    pub fn features_layer(self, lights: usize) -> Option<LayerId> {
        self.features.then_some(LayerId((lights + usize::from(self.coverage)) as u32))
    }

    /// The first layer of the guides, which are the last layers, after `lights` layers of light.
    pub fn guides_layer(self, lights: usize) -> Option<LayerId> {
        self.guides.then(|| LayerId((lights + self.layers() - GUIDES) as u32))
    }
}

/// The first visible surface of a pixel, as the mean over its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct DenoisingFeatures {
    /// Distance from the camera along its line of sight; `None` if no sample hits anything.
    pub depth: Option<f32>,
    /// The unit normal in world space; zero if no sample hits anything.
    pub normal: Vec3,
    /// The fraction of light that the surface reflects and transmits, over all its lobes.
    pub albedo: Rgb,
}
