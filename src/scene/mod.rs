//! The scene at one moment: packed and resolved, without names, defaults or entities.
//!
//! In: the entities of the world, which `extract` packs. Out: geometry, shading, weights and the tree over the
//! primitives, for `trace`.
//!
//! Uses `base`, `film`, `camera`, `geometry`, `appearance`; in `extract` also `world`. Everything keeps the order of
//! the file, so ties by index are always decided the same way.

pub mod top_level;
mod content;
pub mod extract;
mod geometry;
mod hash_tree;
mod hit;
mod instance_transform;
mod journal;
#[cfg(test)]
mod lane_tests;
pub mod movers;
mod primitive;
mod surfaces;

pub use content::Digests;
pub use geometry::Geometry;
pub use hit::Hit;
pub use instance_transform::InstanceTransform;
pub use primitive::{Finish, Primitive};

use crate::appearance::environment::{Environment, EnvironmentDistribution};
use crate::appearance::fog::Fog;
use crate::appearance::light::Light;
use crate::appearance::light_groups::GroupRadiance;
use crate::appearance::material::Material;
use crate::base::color::Rgb;
use crate::camera::Camera;
use std::sync::Arc;

/// Materials and light sources.
#[derive(Clone, Debug, Default, PartialEq)]
#[warn(missing_docs)]
pub struct Shading {
    /// The materials, to which primitives refer by index.
    pub materials: Vec<Material>,
    /// The lights. Those that are primitives are in the geometry, too.
    pub lights: Vec<Light>,
    /// The radiance of rays that hit nothing.
    pub environment: Environment,
    /// The distribution of the environment's brightness, if it is not constant.
    pub sky_table: Option<Arc<EnvironmentDistribution>>,
    /// Constant light from all directions.
    pub ambient: GroupRadiance,
    /// What absorbs and scatters light everywhere.
    pub fog: Option<Fog>,
}

/// The weight of each layer of the film.
#[derive(Clone, Debug, Default, PartialEq)]
#[warn(missing_docs)]
pub struct Weights(pub Vec<Rgb>);

/// All inputs of the tracer for one frame.
#[derive(Clone, Copy, Debug)]
#[warn(missing_docs)]
pub struct Scene<'a> {
    /// The shapes.
    pub geometry: &'a Geometry,
    /// Materials and light sources.
    pub shading: &'a Shading,
    /// The weight of each layer of the film.
    pub weights: &'a Weights,
    /// The eye.
    pub camera: &'a Camera,
}

#[warn(missing_docs)]
impl<'a> Scene<'a> {
    /// The lights with a weight above 0, each with its index.
    pub fn lights(&self) -> impl Iterator<Item = (u32, &'a Light)> {
        let shines = |(_, light): &(u32, &Light)| {
            light.radiance != Rgb::ZERO && self.weights.0[light.layer.index()] != Rgb::ZERO
        };
        (0..).zip(&self.shading.lights).filter(shines)
    }
}
