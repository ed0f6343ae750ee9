//! The scene at one moment: packed, resolved, without names, defaults or entities.
//!
//! Everything keeps the file's order, so that whatever breaks a tie by index breaks it the same way always.

pub mod top_level;
mod content;
pub mod extract;
mod geometry;
#[cfg(test)]
mod lane_tests;
mod primitive;
mod surfaces;

pub use content::Digests;
pub use geometry::Geometry;
pub use primitive::{Finish, Placement, Primitive};
pub use surfaces::SurfaceTable;

use crate::appearance::environment::{Environment, SkyTable};
use crate::appearance::fog::Fog;
use crate::appearance::light::Light;
use crate::appearance::light_groups::glow::Glow;
use crate::appearance::material::Material;
use crate::base::color::Rgb;
use crate::camera::Camera;
use std::sync::Arc;

/// What surfaces look like and what lights them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shading {
    pub materials: Vec<Material>,
    pub lights: Vec<Light>,
    /// What rays see that hit nothing.
    pub environment: Environment,
    /// Where the environment is bright, if that differs from place to place.
    pub sky_table: Option<Arc<SkyTable>>,
    /// Light from everywhere.
    pub ambient: Glow,
    pub fog: Option<Fog>,
}

/// What each layer of the film is weighted with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Weights(pub Vec<Rgb>);

/// Everything that tracing a frame reads.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    pub geometry: &'a Geometry,
    pub shading: &'a Shading,
    pub weights: &'a Weights,
    pub camera: &'a Camera,
}

impl<'a> Scene<'a> {
    /// The lights that shine with a weight above 0, each with its index.
    pub fn lights(&self) -> impl Iterator<Item = (u32, &'a Light)> {
        let shines = |(_, light): &(u32, &Light)| {
            light.radiance != Rgb::ZERO && self.weights.0[light.layer.index()] != Rgb::ZERO
        };
        (0..).zip(&self.shading.lights).filter(shines)
    }
}
