//! Environments: what rays that hit nothing see.

mod cube_map;
mod equirect;
mod sky;
mod table;
mod tracks;

pub use cube_map::{CubeMap, FACES, FacesError};
pub use sky::Sky;
pub use table::SkyTable;
pub use tracks::{EnvironmentTracks, SkyTracks};

use crate::base::color::Rgb;
use crate::base::digest::content;
use crate::base::lanes::{Color, Real, Row, Vec3, turned};
use crate::base::math::DMat3;
use crate::film::LayerId;
use bevy_ecs::component::Component;

/// A sky around the world at one moment, without what keys weight: fading it touches its layer's weight alone.
#[derive(Clone, Component, Debug, PartialEq)]
pub struct Environment {
    pub sky: Sky,
    /// The sky's directions from the world's: a rotation, or one that mirrors as well.
    pub from_world: DMat3,
    /// Factor of all the sky's radiance.
    pub strength: f32,
    /// Where its light is collected.
    pub layer: LayerId,
}

content!(struct Environment { sky, from_world, strength, layer });

impl Default for Environment {
    /// No light from anywhere.
    fn default() -> Self {
        let sky = Sky::Constant(Rgb::ZERO);
        Self { sky, from_world: DMat3::IDENTITY, strength: 1.0, layer: LayerId::CONSTANT }
    }
}

impl Environment {
    /// Radiance from directions, given as unit vectors in the world.
    #[inline(always)]
    pub fn radiance<F: Real>(&self, direction: Vec3<F>) -> Color<F::F32> {
        self.sky.radiance(turned(&self.from_world, direction)) * F::F32::splat(self.strength)
    }

    /// Whether it is certain that no light comes from anywhere.
    pub fn is_black(&self) -> bool {
        self.strength == 0.0 || self.sky == Sky::Constant(Rgb::ZERO)
    }

    /// Directions for two numbers in 0..1, likely where the sky is bright, and their densities per steradian.
    /// `table` is that of this environment's sky.
    #[inline(always)]
    pub fn sample<F: Real>(&self, table: &SkyTable, u: [F; 2]) -> (Vec3<F>, F) {
        let (direction, pdf) = table.sample(u);
        (turned(&self.from_world.transpose(), direction), pdf)
    }

    /// The density per steradian with which [`Environment::sample`] gives directions.
    #[inline(always)]
    pub fn pdf<F: Real>(&self, table: &SkyTable, direction: Vec3<F>) -> F {
        table.pdf(turned(&self.from_world, direction))
    }
}
