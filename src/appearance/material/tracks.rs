//! Materials over time.

use super::{Coat, Exponent, Highlight, Lobes, Material, Medium, TextureSlot};
use crate::appearance::light_groups::GroupWeight;
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::relief::ReliefStrength;
use crate::appearance::texture::{DataTexture, ImageTextureTracks, Texture, TextureTracks};
use crate::base::color::Rgb;
use crate::base::time::Time;
use crate::film::LayerId;
use crate::track::Animated;
use bevy_ecs::component::Component;

/// A lobe over time: a strength of at least 0, times a tint.
#[derive(Clone, Debug, PartialEq)]
pub struct LobeTracks {
    pub strength: Animated<f64>,
    pub tint: TextureTracks,
}

/// A number in 0..=1 over time, which a texture may vary over the surface.
#[derive(Clone, Debug, PartialEq)]
pub enum ScalarTextureTracks {
    Constant(Animated<f64>),
    Textured(TextureTracks),
}

impl LobeTracks {
    fn is_keyed(&self) -> bool {
        self.strength.is_keyed() || self.tint.is_keyed()
    }
}

impl ScalarTextureTracks {
    /// A factor that an image multiplies, if there is one.
    pub fn scaled(image: Option<ImageTextureTracks>, factor: f64) -> Self {
        match image {
            Some(image) => {
                let tint = Rgb::splat(factor as f32).into();
                Self::Textured(TextureTracks::Image(Box::new(ImageTextureTracks { tint, ..image })))
            }
            None => Self::Constant(factor.into()),
        }
    }

    fn is_keyed(&self) -> bool {
        match self {
            Self::Constant(value) => value.is_keyed(),
            Self::Textured(texture) => texture.is_keyed(),
        }
    }
}

/// A material over time.
#[derive(Clone, Component, Debug, PartialEq)]
pub struct MaterialTracks {
    pub emission: LobeTracks,
    pub ambient: LobeTracks,
    pub diffuse: LobeTracks,
    pub specular: LobeTracks,
    pub mirror: LobeTracks,
    pub fuzz: ScalarTextureTracks,
    pub transparency: LobeTracks,
    pub refraction: LobeTracks,
    pub microfacet: Animated<f64>,
    /// The base colour. Its alpha is the coverage of the surface.
    pub base: TextureTracks,
    pub metallic: ScalarTextureTracks,
    pub roughness: ScalarTextureTracks,
    pub coat: ScalarTextureTracks,
    pub coat_roughness: ScalarTextureTracks,
    pub highlight: Highlight,
    pub shininess: Animated<f64>,
    pub fresnel: Fresnel,
    pub ior: Animated<f64>,
    pub absorption: Animated<Rgb>,
    pub priority: i32,
    pub relief: Option<ReliefTracks>,
}

/// What turns the normals of a surface over time.
#[derive(Clone, Debug, PartialEq)]
pub enum ReliefTracks {
    /// Heights: the texture's mean of red, green and blue times a depth in units of the shape, of any sign.
    Bump { height: TextureTracks, depth: Animated<f64> },
    /// A map of normals, and a factor of their components along the surface.
    NormalMap { map: TextureTracks, strength: Animated<f64> },
}

impl ReliefTracks {
    fn parts(&self) -> (TextureSlot, &TextureTracks, &Animated<f64>) {
        match self {
            Self::Bump { height, depth } => (TextureSlot::Height, height, depth),
            Self::NormalMap { map, strength } => (TextureSlot::Normal, map, strength),
        }
    }

    fn texture_mut(&mut self) -> &mut TextureTracks {
        match self {
            Self::Bump { height: texture, .. } | Self::NormalMap { map: texture, .. } => texture,
        }
    }

    fn is_keyed(&self) -> bool {
        let (_, texture, strength) = self.parts();
        texture.is_keyed() || strength.is_keyed()
    }
}

/// Minimum index of refraction. An easing may overshoot below it.
const MIN_IOR: f64 = 1e-3;

impl MaterialTracks {
    /// The material at a moment. Its emission goes to the layer `emission_layer`.
    pub fn at(&self, time: Time, emission_layer: LayerId) -> Material {
        let mut textures = TextureCollector(Vec::new());
        let mut lobe =
            |slot, lobe: &LobeTracks| textures.over(slot, &lobe.tint, time) * level(&lobe.strength, time);
        let mut lobes = Lobes {
            ambient: lobe(TextureSlot::Ambient, &self.ambient),
            diffuse: lobe(TextureSlot::Diffuse, &self.diffuse),
            specular: lobe(TextureSlot::Specular, &self.specular),
            mirror: lobe(TextureSlot::Mirror, &self.mirror),
            transparency: lobe(TextureSlot::Transparency, &self.transparency),
            refraction: lobe(TextureSlot::Refraction, &self.refraction),
            ..Lobes::default()
        };
        lobes.emission = match &self.emission.tint {
            TextureTracks::Color(_) => self.emission_split().0,
            texture => textures.over(TextureSlot::Emission, texture, time) * self.emission_split().0,
        };
        lobes.microfacet = level(&self.microfacet, time);
        lobes.base = textures.over(TextureSlot::Base, &self.base, time);
        textures.coverage(&self.base, time);
        lobes.fuzz = textures.level(TextureSlot::Fuzz, &self.fuzz, time);
        lobes.metallic = textures.level(TextureSlot::Metallic, &self.metallic, time);
        lobes.roughness = textures.level(TextureSlot::Roughness, &self.roughness, time);
        lobes.coat.share = textures.level(TextureSlot::Coat, &self.coat, time);
        lobes.coat.roughness = textures.level(TextureSlot::CoatRoughness, &self.coat_roughness, time);
        textures.0.retain_mut(|(slots, _)| {
            slots.retain(|slot| !is_absent(*slot, &lobes));
            !slots.is_empty()
        });
        // Parameters of absent lobes get default values, so that they do not change the digest.
        let (shines, refracts) = (lobes.specular != Rgb::ZERO, lobes.refraction != Rgb::ZERO);
        lobes.fuzz = if lobes.mirror == Rgb::ZERO { 0.0 } else { lobes.fuzz };
        if lobes.microfacet == 0.0 {
            (lobes.base, lobes.metallic, lobes.roughness) = (Rgb::ZERO, 0.0, 0.0);
        }
        lobes.coat = if lobes.coat.share == 0.0 { Coat::default() } else { lobes.coat };
        let relief = self.relief.as_ref().map_or(ReliefStrength(0.0), |relief| textures.relief(relief, time));
        Material {
            lobes,
            relief,
            textures: textures.0,
            emission_layer,
            highlight: if shines { self.highlight } else { Highlight::default() },
            shininess: Exponent::new(if shines { self.shininess.at(time).max(0.0) } else { 0.0 }),
            fresnel: if refracts { self.fresnel } else { Fresnel::default() },
            medium: self.medium(refracts, lobes.microfacet > 0.0, time),
        }
    }

    /// Whether any part has keys.
    pub fn is_keyed(&self) -> bool {
        // All fields are named, so that none can be forgotten.
        let Self {
            emission,
            ambient,
            diffuse,
            specular,
            mirror,
            fuzz,
            transparency,
            refraction,
            microfacet,
            base,
            metallic,
            roughness,
            coat,
            coat_roughness,
            highlight: _,
            shininess,
            fresnel: _,
            ior,
            absorption,
            priority: _,
            relief,
        } = self;
        let lobes = [emission, ambient, diffuse, specular, mirror, transparency, refraction];
        let scalars = [fuzz, metallic, roughness, coat, coat_roughness];
        let numbers = [microfacet, shininess, ior];
        lobes.into_iter().any(LobeTracks::is_keyed)
            || scalars.into_iter().any(ScalarTextureTracks::is_keyed)
            || numbers.into_iter().any(Animated::is_keyed)
            || base.is_keyed()
            || absorption.is_keyed()
            || relief.as_ref().is_some_and(ReliefTracks::is_keyed)
    }

    /// Calls `visit` with every texture that shows data.
    pub fn each_data(&mut self, visit: &mut impl FnMut(&mut DataTexture)) {
        let Self { emission, ambient, diffuse, specular, mirror, transparency, refraction, .. } = self;
        let lobes = [emission, ambient, diffuse, specular, mirror, transparency, refraction];
        lobes.into_iter().for_each(|lobe| lobe.tint.each_data(visit));
        self.base.each_data(visit);
        self.relief.iter_mut().for_each(|relief| relief.texture_mut().each_data(visit));
        let levels = [&mut self.fuzz, &mut self.metallic, &mut self.roughness];
        for level in levels.into_iter().chain([&mut self.coat, &mut self.coat_roughness]) {
            if let ScalarTextureTracks::Textured(texture) = level {
                texture.each_data(visit);
            }
        }
    }

    /// The medium inside the surface. Refraction needs all of it, the metallic-roughness lobe only the index of
    /// refraction.
    fn medium(&self, refracts: bool, mirrors: bool, time: Time) -> Medium {
        let ior = if refracts || mirrors { self.ior.at(time).max(MIN_IOR) } else { Medium::EMPTY.ior };
        if !refracts {
            return Medium { ior, ..Medium::EMPTY };
        }
        Medium { ior, absorption: self.absorption.at(time).max(Rgb::ZERO), priority: self.priority }
    }

    /// The constant factor of emission without its texture, and the keyed weight.
    pub fn emission_split(&self) -> (Rgb, GroupWeight) {
        let white = Animated::Constant(Rgb::ONE);
        let tint = if let TextureTracks::Color(color) = &self.emission.tint { color } else { &white };
        GroupWeight::split(&true.into(), &self.emission.strength, tint)
    }
}

/// A strength of at least 0. An easing may overshoot below 0.
fn level(strength: &Animated<f64>, time: Time) -> f32 {
    strength.at(time).max(0.0) as f32
}

/// Whether a slot is zero whatever its texture. Such a texture is not evaluated.
fn is_absent(slot: TextureSlot, lobes: &Lobes) -> bool {
    match slot {
        TextureSlot::Emission => lobes.emission == Rgb::ZERO,
        TextureSlot::Ambient => lobes.ambient == Rgb::ZERO,
        TextureSlot::Diffuse => lobes.diffuse == Rgb::ZERO,
        TextureSlot::Specular => lobes.specular == Rgb::ZERO,
        TextureSlot::Mirror => lobes.mirror == Rgb::ZERO,
        TextureSlot::Fuzz => lobes.fuzz == 0.0 || lobes.mirror == Rgb::ZERO,
        TextureSlot::Transparency => lobes.transparency == Rgb::ZERO,
        TextureSlot::Refraction => lobes.refraction == Rgb::ZERO,
        TextureSlot::Base | TextureSlot::Metallic | TextureSlot::Roughness => lobes.microfacet == 0.0,
        TextureSlot::Coat | TextureSlot::CoatRoughness => lobes.coat.share == 0.0,
        TextureSlot::Coverage | TextureSlot::Height | TextureSlot::Normal => false,
    }
}

/// The textures so far, each with its slots.
struct TextureCollector(Vec<(Vec<TextureSlot>, Texture)>);

impl TextureCollector {
    /// The constant factor of a slot. Records its texture if it varies over the surface.
    fn over(&mut self, slot: TextureSlot, tint: &TextureTracks, time: Time) -> Rgb {
        self.note(slot, tint.at(time))
    }

    fn note(&mut self, slot: TextureSlot, texture: Texture) -> Rgb {
        if let Some(color) = texture.constant() {
            return color;
        }
        match self.0.iter_mut().find(|(_, known)| *known == texture) {
            Some((slots, _)) => slots.push(slot),
            None => self.0.push((vec![slot], texture)),
        }
        Rgb::ONE
    }

    /// Records the coverage of the surface if its base colour has alpha.
    fn coverage(&mut self, base: &TextureTracks, time: Time) {
        let texture = base.at(time);
        if texture.has_alpha() {
            self.note(TextureSlot::Coverage, texture);
        }
    }

    /// Records the texture of a relief. Returns its strength; 0 if nothing is raised.
    fn relief(&mut self, relief: &ReliefTracks, time: Time) -> ReliefStrength {
        let (slot, texture, strength) = relief.parts();
        let (texture, strength) = (texture.at(time).opaque(), strength.at(time));
        // Heights that are the same everywhere turn no normal; normals that are, may.
        if strength == 0.0 || slot == TextureSlot::Height && texture.constant().is_some() {
            return ReliefStrength(0.0);
        }
        self.0.push((vec![slot], texture));
        ReliefStrength(strength)
    }

    fn level(&mut self, slot: TextureSlot, tracks: &ScalarTextureTracks, time: Time) -> f32 {
        match tracks {
            ScalarTextureTracks::Constant(value) => level(value, time).min(1.0),
            // Scalars ignore alpha.
            ScalarTextureTracks::Textured(texture) => {
                (self.note(slot, texture.at(time).opaque()).element_sum() / 3.0).min(1.0)
            }
        }
    }
}
