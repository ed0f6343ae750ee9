//! Sources of light that can be sampled.

use super::evaluate::Face;
use crate::appearance::environment::{Environment, EnvironmentDistribution};
use crate::appearance::light::Light;
use crate::appearance::material::MaterialBinding;
use crate::appearance::texture::TextureInputs;
use crate::base::color::Rgb;
use crate::film::LayerId;
use crate::geometry::ray_kinds::RayKind;
use crate::scene::{Finish, Scene};

/// A source of light.
#[derive(Clone, Copy, Debug)]
pub enum SampledEmitter<'a> {
    /// The light of this index in the scene, and its face.
    Light(u32, Light, Face),
    /// The primitive of this index, which emits, and what its textures read.
    Object(u32, TextureInputs),
    Sky(&'a EnvironmentDistribution),
}

impl SampledEmitter<'_> {
    /// Whether its light comes from more than one direction, so that sampling it takes random numbers.
    pub(super) fn is_sampled(&self) -> bool {
        match self {
            Self::Light(_, light, _) => light.source.is_sampled(),
            Self::Object(..) | Self::Sky(_) => true,
        }
    }

    /// Whether objects block its light.
    pub(super) fn casts_shadows(&self) -> bool {
        match self {
            Self::Light(_, light, _) => light.shadows,
            Self::Object(..) | Self::Sky(_) => true,
        }
    }
}

/// All sources of a scene with their layers, in a fixed order: lights, and, if `emitters` is set, other emitters that
/// can be sampled.
pub(super) fn sources<'a>(
    scene: &'a Scene<'a>,
    environment: Option<&'a Environment>,
    emitters: bool,
) -> Vec<(LayerId, SampledEmitter<'a>)> {
    let shading = scene.shading;
    let lights = scene
        .lights()
        .map(|(index, light)| (light.layer, SampledEmitter::Light(index, *light, Face::of_light(light))));
    if !emitters {
        return lights.collect();
    }
    let shines = |index: u32| {
        let material = &shading.materials[index as usize];
        let is_weighted = scene.weights.0[material.emission_layer.index()] != Rgb::ZERO;
        (is_weighted && material.lobes.emission != Rgb::ZERO).then_some(material.emission_layer)
    };
    let some_shine = scene.geometry.materials().any(|index| shines(index).is_some());
    let finishes = if some_shine { scene.geometry.finishes() } else { &[] };
    let objects = (0..).zip(finishes).filter_map(|(index, finish)| {
        // Paths find meshes of several materials only by chance: these have no single emission from which to sample
        // points.
        let &Finish::Material(MaterialBinding::One(material)) = finish else { return None };
        let layer = shines(material)?;
        // Light that no scattered ray can find arrives nowhere.
        let primitive = &scene.geometry.primitives[index as usize];
        let has_area = primitive.has_area() && primitive.rays.has(RayKind::Scattered);
        let inputs = shading.materials[material as usize].texture_inputs();
        has_area.then_some((layer, SampledEmitter::Object(index, inputs)))
    });
    let sky = environment.zip(shading.sky_table.as_deref());
    let sky = sky.map(|(environment, table)| (environment.layer, SampledEmitter::Sky(table)));
    lights.chain(objects).chain(sky).collect()
}
