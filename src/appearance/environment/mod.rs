//! Environments: the radiance that rays see if they hit nothing.

mod borders;
mod cube_map;
mod equirect;
mod sky;
mod distribution;
mod tracks;

pub use cube_map::{CubeMap, FACES, FacesError};
pub use distribution::EnvironmentDistribution;
pub use sky::Sky;
pub use tracks::{EnvironmentTracks, SkyTracks};

use crate::base::color::Rgb;
use crate::base::digest::Content;
use crate::base::lanes::{Color, Real, Row, Vec3, transform_vector};
use crate::base::math::DMat3;
use crate::film::LayerId;
use bevy_ecs::component::Component;

/// A sky around the world at one moment, without its keyed weight. Fading a sky changes only the weight of its layer.
#[derive(Clone, Component, Debug, PartialEq, Content)]
pub struct Environment {
    pub sky: Sky,
    /// Transforms world directions to sky directions: a rotation, possibly with a mirror.
    pub from_world: DMat3,
    /// Constant factor of the sky's radiance.
    pub strength: f32,
    /// The film layer of its light.
    pub layer: LayerId,
}

impl Default for Environment {
    /// A black sky.
    fn default() -> Self {
        let sky = Sky::Constant(Rgb::ZERO);
        Self { sky, from_world: DMat3::IDENTITY, strength: 1.0, layer: LayerId::CONSTANT }
    }
}

impl Environment {
    /// Radiance from directions, which are unit vectors in the world.
    #[inline(always)]
    pub fn radiance<F: Real>(&self, direction: Vec3<F>) -> Color<F::F32> {
        self.sky.radiance(transform_vector(&self.from_world, direction)) * F::F32::splat(self.strength)
    }

    /// Whether the environment is certainly black.
    pub fn is_black(&self) -> bool {
        self.strength == 0.0 || self.sky == Sky::Constant(Rgb::ZERO)
    }

    /// Samples directions, mostly towards bright parts of the sky, from two numbers in 0..1. Also gives their densities
    /// per steradian. `table` belongs to the sky of this environment.
    #[inline(always)]
    pub fn sample<F: Real>(&self, table: &EnvironmentDistribution, u: [F; 2]) -> (Vec3<F>, F) {
        let (direction, pdf) = table.sample(u);
        (transform_vector(&self.from_world.transpose(), direction), pdf)
    }

    /// The density per steradian of [`Environment::sample`].
    #[inline(always)]
    pub fn pdf<F: Real>(&self, table: &EnvironmentDistribution, direction: Vec3<F>) -> F {
        table.pdf(transform_vector(&self.from_world, direction))
    }
}
