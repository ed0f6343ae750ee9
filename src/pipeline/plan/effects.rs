//! Finds the effects that a film needs.

use crate::appearance::light::{Attenuation, Source};
use crate::appearance::material::{Lobes, Material};
use crate::appearance::texture::Texture;
use crate::base::color::Rgb;
use crate::camera::Projection;
use crate::film::LayerId;
use crate::pipeline::schedule::FrameState;
use crate::scene::{Primitive, Scene};

/// Names the effects in the order in which they are listed.
macro_rules! effects {
    ($($effect:ident $name:literal,)*) => {
        /// An effect of a scene. An effect that the scene does not need costs nothing.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum SceneEffect {
            $($effect,)*
        }

        impl SceneEffect {
            pub const ALL: &[Self] = &[$(Self::$effect,)*];

            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$effect => $name,)*
                }
            }
        }
    };
}

effects! {
    Perspective "perspective",
    Orthographic "orthographic",
    Lens "lens",
    MotionBlur "motion blur",
    RandomSamples "random samples",
    Shadows "shadows",
    Attenuation "attenuation",
    AreaLights "area lights",
    Ambient "ambient light",
    Environment "environment",
    Fog "fog",
    Emission "emission",
    Highlights "highlights",
    Mirror "mirror",
    Glossy "glossy lobes",
    Transparency "transparency",
    Refraction "refraction",
    Absorption "absorption",
    ClearShadows "transparency in shadows",
    Textures "textures",
    Patterns "patterns",
    VertexColors "vertex colours",
    Data "data",
    ShadingNormals "shading normals",
    Relief "relief",
}

/// The part of the scene that needs an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffectSource {
    Camera,
    Integrator,
    Background,
    Ambient,
    Fog,
    /// Index in the sequence, as for materials.
    Light(u32),
    Material(u32),
}

/// The effects of a film with these layers, each with the part of the scene that needs it.
pub fn scene_effects(scene: &Scene, state: &FrameState, lit: &[LayerId]) -> Vec<(SceneEffect, EffectSource)> {
    let mut found = Vec::new();
    camera(scene, state, &mut found);
    light(scene, lit, &mut found);
    for index in scene.geometry.materials() {
        let material = &scene.shading.materials[index as usize];
        found.extend(of_material(material).map(|effect| (effect, EffectSource::Material(index))));
        found.extend(of_textures(material).map(|effect| (effect, EffectSource::Material(index))));
    }
    let smooth = |primitive: &&Primitive| primitive.shape.meshes().iter().any(|mesh| mesh.is_smooth());
    if let Some(primitive) = scene.geometry.primitives.iter().find(smooth) {
        found.extend(
            primitive
                .materials()
                .next()
                .map(|index| (SceneEffect::ShadingNormals, EffectSource::Material(index))),
        );
    }
    found
}

fn camera(scene: &Scene, state: &FrameState, found: &mut Vec<(SceneEffect, EffectSource)>) {
    let projection = match scene.camera.projection {
        Projection::Perspective { .. } => SceneEffect::Perspective,
        Projection::Orthographic { .. } => SceneEffect::Orthographic,
    };
    found.push((projection, EffectSource::Camera));
    if scene.camera.lens.is_some() {
        found.push((SceneEffect::Lens, EffectSource::Camera));
    }
    if state.moments > 1 {
        found.push((SceneEffect::MotionBlur, EffectSource::Camera));
    }
    if state.random {
        found.push((SceneEffect::RandomSamples, random(scene, state)));
    }
}

/// The first part of the scene that needs random samples.
fn random(scene: &Scene, state: &FrameState) -> EffectSource {
    if state.moments > 1 || scene.camera.lens.is_some() {
        return EffectSource::Camera;
    }
    let rough = |index: &u32| scene.shading.materials[*index as usize].is_rough();
    let area = scene
        .lights()
        .find(|(_, light)| light.source.is_sampled())
        .map(|(index, _)| EffectSource::Light(index));
    let rough = || scene.geometry.materials().find(rough).map(EffectSource::Material);
    area.or_else(rough).unwrap_or(EffectSource::Integrator)
}

fn light(scene: &Scene, lit: &[LayerId], found: &mut Vec<(SceneEffect, EffectSource)>) {
    let shading = scene.shading;
    let on = |layer: LayerId| lit.contains(&layer);
    let used = || scene.geometry.materials().map(|index| &shading.materials[index as usize]);
    let lit_by_lights = used().any(|material| material.lobes.reflects_lights());
    for (index, light) in (0..).zip(&shading.lights) {
        if light.radiance == Rgb::ZERO || !on(light.layer) {
            continue;
        }
        if lit_by_lights && light.shadows {
            found.push((SceneEffect::Shadows, EffectSource::Light(index)));
        }
        let attenuation = match light.source {
            Source::Point { attenuation, .. } | Source::Spot { attenuation, .. } => attenuation,
            _ => Attenuation::default(),
        };
        if attenuation != Attenuation::default() {
            found.push((SceneEffect::Attenuation, EffectSource::Light(index)));
        }
        if light.source.is_sampled() {
            found.push((SceneEffect::AreaLights, EffectSource::Light(index)));
        }
    }
    if !shading.environment.is_black() && on(shading.environment.layer) {
        found.push((SceneEffect::Environment, EffectSource::Background));
    }
    let gathers = || used().any(|material| material.lobes.ambient != Rgb::ZERO);
    if shading.ambient.radiance != Rgb::ZERO && on(shading.ambient.layer) && gathers() {
        found.push((SceneEffect::Ambient, EffectSource::Ambient));
    }
    if shading.fog.is_some() {
        found.push((SceneEffect::Fog, EffectSource::Fog));
    }
}

/// The effects of a material's lobes.
fn of_material(material: &Material) -> impl Iterator<Item = SceneEffect> {
    let Lobes { emission, specular, mirror, refraction, microfacet, coat, .. } = material.lobes;
    let refracts = refraction != Rgb::ZERO;
    let all = [
        (SceneEffect::Emission, emission != Rgb::ZERO),
        (SceneEffect::Highlights, specular != Rgb::ZERO),
        (SceneEffect::Mirror, mirror != Rgb::ZERO),
        (SceneEffect::Glossy, material.is_rough() || microfacet > 0.0 || coat.share > 0.0),
        (SceneEffect::Transparency, material.is_transparent()),
        (SceneEffect::Refraction, refracts),
        (SceneEffect::Absorption, refracts && material.medium.absorption != Rgb::ZERO),
        (SceneEffect::ClearShadows, refracts || material.is_transparent()),
    ];
    all.into_iter().filter(|(_, on)| *on).map(|(effect, _)| effect)
}

/// The effects of a material's textures.
fn of_textures(material: &Material) -> impl Iterator<Item = SceneEffect> {
    fn note(paint: &Texture, found: &mut Vec<SceneEffect>) {
        match paint {
            Texture::Color(_) => {}
            Texture::VertexColor => found.push(SceneEffect::VertexColors),
            Texture::Data(_) => found.push(SceneEffect::Data),
            Texture::Image(_) => found.push(SceneEffect::Textures),
            Texture::Pattern(paint) => {
                found.push(SceneEffect::Patterns);
                note(&paint.first, found);
                note(&paint.second, found);
            }
            Texture::Product(paint) => {
                note(&paint.first, found);
                note(&paint.second, found);
            }
            Texture::Cutout(paint) => note(&paint.texture, found),
        }
    }
    let mut found = Vec::new();
    material.textures.iter().for_each(|(_, paint)| note(paint, &mut found));
    if material.has_relief() {
        found.push(SceneEffect::Relief);
    }
    found.into_iter()
}
