//! What a film calls for.

use crate::appearance::light::{Attenuation, Source};
use crate::appearance::material::{Lobes, Material};
use crate::appearance::texture::Paint;
use crate::base::color::Rgb;
use crate::camera::Projection;
use crate::film::LayerId;
use crate::geometry::shape::Shape;
use crate::pipeline::schedule::Look;
use crate::scene::{Primitive, Scene};

/// Names effects in the order in which they are told.
macro_rules! effects {
    ($($effect:ident $name:literal,)*) => {
        /// What a scene may call for. What it does not call for takes no work.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Effect {
            $($effect,)*
        }

        impl Effect {
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
    ShadingNormals "shading normals",
}

/// Who calls for an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Caller {
    Camera,
    Integrator,
    Background,
    Ambient,
    Fog,
    /// By its index in the sequence, as a material.
    Light(u32),
    Material(u32),
}

/// The effects of a film of these layers, each with who calls for it.
pub fn called_for(scene: &Scene, look: &Look, lit: &[LayerId]) -> Vec<(Effect, Caller)> {
    let mut found = Vec::new();
    camera(scene, look, &mut found);
    light(scene, lit, &mut found);
    for index in scene.geometry.materials() {
        let material = &scene.shading.materials[index as usize];
        found.extend(of_material(material).map(|effect| (effect, Caller::Material(index))));
        found.extend(painted(material).map(|effect| (effect, Caller::Material(index))));
    }
    let smooth = |primitive: &&Primitive| match &primitive.shape {
        Shape::Mesh(shape) => shape.is_smooth(),
        _ => false,
    };
    if let Some(primitive) = scene.geometry.primitives.iter().find(smooth) {
        found.extend(
            primitive.materials().next().map(|index| (Effect::ShadingNormals, Caller::Material(index))),
        );
    }
    found
}

fn camera(scene: &Scene, look: &Look, found: &mut Vec<(Effect, Caller)>) {
    let projection = match scene.camera.projection {
        Projection::Perspective { .. } => Effect::Perspective,
        Projection::Orthographic { .. } => Effect::Orthographic,
    };
    found.push((projection, Caller::Camera));
    if scene.camera.lens.is_some() {
        found.push((Effect::Lens, Caller::Camera));
    }
    if look.moments > 1 {
        found.push((Effect::MotionBlur, Caller::Camera));
    }
    if look.random {
        found.push((Effect::RandomSamples, random(scene, look)));
    }
}

/// Who asks for random samples first.
fn random(scene: &Scene, look: &Look) -> Caller {
    if look.moments > 1 || scene.camera.lens.is_some() {
        return Caller::Camera;
    }
    let rough = |index: &u32| scene.shading.materials[*index as usize].is_rough();
    let area =
        scene.lights().find(|(_, light)| light.source.is_sampled()).map(|(index, _)| Caller::Light(index));
    let rough = || scene.geometry.materials().into_iter().find(rough).map(Caller::Material);
    area.or_else(rough).unwrap_or(Caller::Integrator)
}

fn light(scene: &Scene, lit: &[LayerId], found: &mut Vec<(Effect, Caller)>) {
    let shading = scene.shading;
    let on = |layer: LayerId| lit.contains(&layer);
    let used = || scene.geometry.materials().into_iter().map(|index| &shading.materials[index as usize]);
    let lit_by_lights = used().any(|material| material.lobes.reflects_lights());
    for (index, light) in (0..).zip(&shading.lights) {
        if light.radiance == Rgb::ZERO || !on(light.layer) {
            continue;
        }
        if lit_by_lights {
            found.push((Effect::Shadows, Caller::Light(index)));
        }
        let attenuation = match light.source {
            Source::Point { attenuation, .. } | Source::Spot { attenuation, .. } => attenuation,
            _ => Attenuation::default(),
        };
        if attenuation != Attenuation::default() {
            found.push((Effect::Attenuation, Caller::Light(index)));
        }
        if light.source.is_sampled() {
            found.push((Effect::AreaLights, Caller::Light(index)));
        }
    }
    if !shading.environment.is_black() && on(shading.environment.layer) {
        found.push((Effect::Environment, Caller::Background));
    }
    let gathers = || used().any(|material| material.lobes.ambient != Rgb::ZERO);
    if shading.ambient.radiance != Rgb::ZERO && on(shading.ambient.layer) && gathers() {
        found.push((Effect::Ambient, Caller::Ambient));
    }
    if shading.fog.is_some() {
        found.push((Effect::Fog, Caller::Fog));
    }
}

/// The effects of a material's lobes.
fn of_material(material: &Material) -> impl Iterator<Item = Effect> {
    let Lobes { emission, specular, mirror, refraction, microfacet, .. } = material.lobes;
    let refracts = refraction != Rgb::ZERO;
    let all = [
        (Effect::Emission, emission != Rgb::ZERO),
        (Effect::Highlights, specular != Rgb::ZERO),
        (Effect::Mirror, mirror != Rgb::ZERO),
        (Effect::Glossy, material.is_rough() || microfacet > 0.0),
        (Effect::Transparency, material.is_clear()),
        (Effect::Refraction, refracts),
        (Effect::Absorption, refracts && material.medium.absorption != Rgb::ZERO),
        (Effect::ClearShadows, refracts || material.is_clear()),
    ];
    all.into_iter().filter(|(_, on)| *on).map(|(effect, _)| effect)
}

/// The effects of a material's paints.
fn painted(material: &Material) -> impl Iterator<Item = Effect> {
    fn note(paint: &Paint, found: &mut Vec<Effect>) {
        match paint {
            Paint::Color(_) => {}
            Paint::VertexColor => found.push(Effect::VertexColors),
            Paint::Image(_) => found.push(Effect::Textures),
            Paint::Pattern(paint) => {
                found.push(Effect::Patterns);
                note(&paint.first, found);
                note(&paint.second, found);
            }
        }
    }
    let mut found = Vec::new();
    material.paints.iter().for_each(|(_, paint)| note(paint, &mut found));
    found.into_iter()
}
