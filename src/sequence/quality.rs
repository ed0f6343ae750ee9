//! How much work goes into a picture.

use crate::base::digest::content;
use crate::film::filter::Filter;
use crate::sampling::Points;

/// What every sequence settles about the work per pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    pub integrator: Integrator,
    /// How often light may go from one surface to another on its way from its source to the eye: light of 0 bounces
    /// comes straight from its source to the surface that is seen.
    pub bounces: u32,
    /// How a pixel's samples are spread over it and its neighbours.
    pub filter: Filter,
    /// Samples per pixel along each axis of a regular grid, at least 1, where nothing is random.
    pub antialias: u32,
    /// Samples per pixel where a lens, an area light, motion blur, a rough surface or paths ask for random
    /// ones; at least 1.
    pub samples: u32,
    /// Samples are taken until this is reached, where they are random: then `samples` does not count.
    pub noise: Option<NoiseTarget>,
    /// Where random numbers come from.
    pub points: Points,
    /// Rays that would add less than this share to the picture are not followed. Whitted's integrator asks; paths
    /// end by roulette.
    pub threshold: f32,
    /// Upper limit of the radiance of one sample in each layer: none keeps every sample as it is.
    pub clamp: Option<f32>,
    /// Moments per frame at which motion is looked at while the shutter is open, at least 1.
    pub shutter_steps: u32,
    /// Whether light falls on smooth meshes as on the surfaces that they stand for, not as on their triangles.
    pub smooth_terminator: bool,
    /// Another seed gives other noise.
    pub seed: u32,
}

/// How good a picture is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseTarget {
    /// Root of the mean square of the frame's error as a share of its mean, above 0.
    pub error: f64,
    /// Samples of a pixel, at most.
    pub most: u32,
}

content!(struct NoiseTarget { error, most });

impl NoiseTarget {
    /// Samples of a pixel at most, unless something else is said.
    pub const MOST: u32 = 4096;
}

/// How light is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Integrator {
    /// Whitted's: at every surface the lights, and on along mirrors and through what is transparent.
    Whitted,
    /// Monte Carlo over paths of light.
    Path(PathSettings),
}

content!(
    enum Integrator {
        Whitted,
        Path(settings),
    }
);

/// More samples than these are asked for by mistake.
pub const MOST_SAMPLES: u32 = 1 << 24;

/// What only paths need to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSettings {
    /// Bounces after which dim paths may end at random; none lets every path run to its end.
    pub roulette: Option<u32>,
    /// Whether shadow rays pass what refracts, unbent. Light that refracted paths would find behind it is left
    /// out then, so that nothing counts twice.
    pub refractive_shadows: bool,
}

content!(struct PathSettings { roulette, refractive_shadows });

impl Integrator {
    /// Whether light is also found by what it shines on, so that it pays to know where it comes from.
    pub fn looks_for_lights(&self) -> bool {
        matches!(self, Self::Path(_))
    }

    /// Whether both are of the same kind, whatever their settings.
    pub fn is_like(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

impl Quality {
    /// How many surfaces may reflect or bend light between its source and the eye: one more than the bounces between
    /// them. A ray that starts behind the last of them only sees what gives off light.
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
            points: Points::Sobol,
            threshold: 1e-3,
            clamp: None,
            shutter_steps: 32,
            smooth_terminator: true,
            seed: 0,
        }
    }
}
