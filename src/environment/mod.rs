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

use crate::color::Rgb;
use crate::digest::content;
use crate::film::LayerId;
use crate::math::{DMat3, DVec2, DVec3};
use crate::simd::{Lanes, Rows, Vector};
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
    /// Radiance from a direction, given as a unit vector in the world.
    pub fn radiance(&self, direction: DVec3) -> Rgb {
        self.sky.radiance(self.from_world * direction) * self.strength
    }

    /// [`Environment::radiance`] from eight directions: its red, green and blue.
    #[inline(always)]
    pub fn radiance_of_eight<L: Lanes>(&self, directions: &Rows) -> [[f32; 8]; 3] {
        let d = Vector::<L::Quad>::load(directions);
        let DMat3 { x_axis, y_axis, z_axis } = self.from_world;
        let d = Vector::splat(x_axis) * d.x + Vector::splat(y_axis) * d.y + Vector::splat(z_axis) * d.z;
        let mut radiance = self.sky.radiance_of_eight::<L>(d);
        for row in &mut radiance {
            *row = L::load(row).times(L::splat(self.strength)).store();
        }
        radiance
    }

    /// Whether it is certain that no light comes from anywhere.
    pub fn is_black(&self) -> bool {
        self.strength == 0.0 || self.sky == Sky::Constant(Rgb::ZERO)
    }

    /// A direction for two numbers in 0..1, likely where the sky is bright, and its density per steradian.
    /// `table` is that of this environment's sky.
    pub fn sample(&self, table: &SkyTable, u: DVec2) -> (DVec3, f64) {
        let (direction, pdf) = table.sample(u);
        (self.from_world.transpose() * direction, pdf)
    }

    /// The density per steradian with which [`Environment::sample`] gives a direction.
    pub fn pdf(&self, table: &SkyTable, direction: DVec3) -> f64 {
        table.pdf(self.from_world * direction)
    }
}
