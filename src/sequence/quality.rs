//! Quality settings: the work per pixel.

use crate::base::digest::Content;
use crate::film::denoise::samples_of_audit;
use crate::film::filter::Filter;
use crate::sampling::{SamplerKind, hash};

/// The quality settings of a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
#[warn(missing_docs)]
pub struct Quality {
    /// The algorithm.
    pub integrator: Integrator,
    /// Maximum number of reflections between surfaces on a path from a light to the eye. With 0 bounces, light travels
    /// straight from its source to the visible surface.
    pub bounces: u32,
    /// Reconstruction filter.
    pub filter: Filter,
    /// Samples per pixel along each axis of a regular grid, at least 1. Applies if nothing is random.
    pub antialias: u32,
    /// Samples per pixel, at least 1, if a lens, an area light, motion blur, a rough surface or path tracing needs
    /// random samples.
    pub samples: u32,
    /// Target error for random samples. Replaces `samples`.
    pub noise: Option<NoiseTarget>,
    /// The sampler of random numbers.
    pub points: SamplerKind,
    /// Whitted integrator only: rays with a min contribution to the picture are not traced. Paths end by Russian
    /// roulette instead.
    pub threshold: f32,
    /// Upper limit of a sample's radiance in each layer. None keeps all samples unchanged.
    pub clamp: Option<f32>,
    /// Moments per frame at which motion is sampled while the shutter is open, at least 1.
    pub shutter_steps: u32,
    /// Whether smooth meshes are lit up to the terminator of the surface that they approximate, instead of that of
    /// their triangles.
    pub smooth_terminator: bool,
    /// The seed of random numbers.
    pub seed: u32,
    /// Whether each frame has random numbers of its own. Otherwise all have the same ones, so noise stays in its place
    /// where nothing changes.
    pub vary_noise: bool,
    /// Which samples frames share.
    pub reuse: SampleReuse,
    /// Whether films of random samples are denoised.
    pub denoise: Denoise,
}

/// Whether films of random samples are denoised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Content)]
pub enum Denoise {
    /// Films are what was sampled.
    #[default]
    Off,
    /// Films are filtered where this lowers their error, with the samples of neighbours in time unless frames have a target
    /// error.
    Auto,
    /// Films are filtered where this lowers their error, each by itself.
    Alone,
}

#[warn(missing_docs)]
impl Denoise {
    /// The mode of single pictures, whose neighbours would be traced for them alone.
    pub fn of_stills(self) -> Self {
        if self == Self::Auto { Self::Alone } else { self }
    }
}

/// Which samples frames share. Sharing changes where samples lie, so it changes pictures within their error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SampleReuse {
    /// Each frame has its own samples.
    #[default]
    Off,
    /// Frames of one scene share samples if their camera stays in its place, zooms and turns.
    Zoom,
}

/// A target error for adaptive sampling.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct NoiseTarget {
    /// Root mean square error of the frame as a share of its mean, above 0.
    pub error: f64,
    /// Maximum samples per pixel.
    pub most: u32,
}

#[warn(missing_docs)]
impl NoiseTarget {
    /// Default of the maximum samples per pixel.
    pub const MOST: u32 = 4096;
}

/// The light transport algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub enum Integrator {
    /// Whitted's ray tracing: direct light at every surface, plus mirror reflection and transmission.
    Whitted,
    /// Monte Carlo path tracing.
    Path(PathSettings),
}

/// Maximum number of samples; more would be a mistake.
pub const MAX_SAMPLES: u32 = 1 << 24;

/// Distinguishes the seeds of frames from other numbers that are hashed with the seed.
const FRAME_SEED: u32 = 0x4652_414d;

/// Settings of the path tracer.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
#[warn(missing_docs)]
pub struct PathSettings {
    /// Bounces after which dim paths may end at random. None disables Russian roulette.
    pub roulette: Option<u32>,
    /// Whether shadow rays pass refracting surfaces without bending. Refracted paths then ignore the light behind
    /// these surfaces, so that it does not count twice.
    pub refractive_shadows: bool,
}

#[warn(missing_docs)]
impl Integrator {
    /// Whether the integrator samples lights (next-event estimation).
    pub fn samples_lights(&self) -> bool {
        matches!(self, Self::Path(_))
    }

    /// Whether both are of the same kind, regardless of settings.
    pub fn same_kind(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

#[warn(missing_docs)]
impl Quality {
    /// Whether views from one point share samples. With a target error, the number of samples of a frame depends on its
    /// own light, so frames share none; and a denoised frame needs independent samples of its own.
    pub fn shares_views(&self) -> bool {
        self.reuse == SampleReuse::Zoom && self.noise.is_none() && self.denoise == Denoise::Off
    }

    /// Whether the samples of neighbours in time help to denoise a frame. With a target error, the number of samples of a
    /// frame depends on its own light.
    pub fn uses_neighbors(&self) -> bool {
        self.denoise == Denoise::Auto && self.noise.is_none()
    }

    /// The settings of a frame: with noise that varies, its seed is one of its own.
    pub fn of_frame(&self, frame: u32) -> Self {
        match self.vary_noise {
            true => Self { seed: hash([self.seed, frame, FRAME_SEED]), ..*self },
            false => *self,
        }
    }

    /// Samples per pixel that are traced for a picture of so many, where something is random.
    pub fn traced_samples(&self, picture: u32) -> u32 {
        match self.denoise {
            Denoise::Off => picture,
            // Both halves have as many samples.
            Denoise::Auto | Denoise::Alone => {
                let picture = picture.next_multiple_of(2);
                picture + 2 * samples_of_audit(picture)
            }
        }
    }

    /// Maximum number of surfaces on a path between a light and the eye: one more than the bounces between them. A ray
    /// that leaves the last one only sees emitters.
    pub fn surfaces(&self) -> u32 {
        self.bounces + 1
    }
}

impl Default for PathSettings {
    fn default() -> Self {
        Self { roulette: Some(3), refractive_shadows: false }
    }
}

impl Default for Quality {
    fn default() -> Self {
        Self {
            integrator: Integrator::Whitted,
            bounces: 5,
            filter: Filter::PIXEL,
            antialias: 2,
            samples: 64,
            noise: None,
            points: SamplerKind::Sobol,
            threshold: 1e-3,
            clamp: None,
            shutter_steps: 32,
            smooth_terminator: true,
            seed: 0,
            vary_noise: false,
            reuse: SampleReuse::Off,
            denoise: Denoise::Off,
        }
    }
}
