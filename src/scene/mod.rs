//! The scene at one moment: packed, resolved, without names, defaults or entities.
//!
//! Everything keeps the file's order, so that whatever breaks a tie by index breaks it the same way always.

pub mod extract;
mod primitive;

pub use primitive::{Placement, Primitive};

use crate::camera::Camera;
use crate::color::Rgb;
use crate::environment::Environment;
use crate::light::{Glow, Light};
use crate::material::Material;

/// All that can be seen, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Geometry {
    pub primitives: Vec<Primitive>,
}

/// What surfaces look like and what lights them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shading {
    pub materials: Vec<Material>,
    pub lights: Vec<Light>,
    /// What rays that hit nothing see.
    pub background: Environment,
    /// Light from everywhere.
    pub ambient: Glow,
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
