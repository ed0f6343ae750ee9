//! The fields of a material in a file, before defaults apply.

use crate::appearance::material::{Highlight, LobeTracks, MaterialTracks, ReliefTracks, ScalarTextureTracks};
use crate::appearance::optics::Fresnel;
use crate::appearance::texture::TextureTracks;
use crate::base::color::Rgb;
use crate::track::Animated;
use std::rc::Rc;

/// The materials of a mesh with their names: one for each slot, then one for triangles without a material.
pub type MeshMaterials = Rc<[(String, MaterialDescription)]>;

/// The fields of a material that a file gives. The default material gives the others.
#[derive(Clone, Default)]
pub struct MaterialDescription {
    pub color: Option<TextureTracks>,
    /// What cuts holes by its alpha. It multiplies the colour.
    pub mask: Option<TextureTracks>,
    pub emission: LobeDescription,
    pub ambient: LobeDescription,
    pub diffuse: LobeDescription,
    pub specular: LobeDescription,
    pub mirror: LobeDescription,
    pub fuzz: Option<ScalarTextureTracks>,
    pub transparency: LobeDescription,
    pub refraction: LobeDescription,
    pub microfacet: Option<Animated<f64>>,
    pub metallic: Option<ScalarTextureTracks>,
    pub roughness: Option<ScalarTextureTracks>,
    pub coat: Option<ScalarTextureTracks>,
    pub coat_roughness: Option<ScalarTextureTracks>,
    pub shininess: Option<Animated<f64>>,
    pub highlight: Option<Highlight>,
    pub fresnel: Option<Fresnel>,
    pub ior: Option<Animated<f64>>,
    pub absorption: Option<Animated<Rgb>>,
    pub priority: Option<i32>,
    pub relief: Option<ReliefTracks>,
}

/// The fields of a lobe that a file gives.
#[derive(Clone, Default)]
pub struct LobeDescription {
    pub strength: Option<Animated<f64>>,
    pub tint: Option<TextureTracks>,
}

impl LobeDescription {
    /// A lobe of this strength in the colour of the material.
    pub fn of_strength(strength: f64) -> Self {
        Self { strength: Some(strength.into()), tint: None }
    }
}

impl MaterialDescription {
    /// A material without any lobe.
    pub fn bare() -> Self {
        let none = LobeDescription::of_strength(0.0);
        Self {
            emission: none.clone(),
            ambient: none.clone(),
            diffuse: none.clone(),
            specular: none.clone(),
            mirror: none.clone(),
            transparency: none.clone(),
            refraction: none,
            microfacet: Some(0.0.into()),
            coat: Some(ScalarTextureTracks::Constant(0.0.into())),
            ..Self::default()
        }
    }

    /// Resolves the material. Absent fields come from the file's default material, then from Kinora's defaults.
    pub fn over(&self, default: &Self) -> MaterialTracks {
        let base = self.color.clone().or_else(|| default.color.clone());
        let base = base.unwrap_or(Rgb::splat(0.8).into());
        let base = match &self.mask {
            Some(mask) => TextureTracks::Product(Box::new([base, mask.clone()])),
            None => base,
        };
        let white = TextureTracks::from(Rgb::ONE);
        let lobe = |own: fn(&Self) -> &LobeDescription, strength: f64, tint: &TextureTracks| {
            let (own, other) = (own(self), own(default));
            let given = own.strength.clone().or_else(|| other.strength.clone());
            let tinted = own.tint.clone().or_else(|| other.tint.clone());
            LobeTracks {
                strength: given.unwrap_or(strength.into()),
                tint: tinted.unwrap_or_else(|| tint.clone()),
            }
        };
        let level = |own: fn(&Self) -> &Option<ScalarTextureTracks>, otherwise: f64| {
            own(self)
                .clone()
                .or_else(|| own(default).clone())
                .unwrap_or(ScalarTextureTracks::Constant(otherwise.into()))
        };
        let value = |own: fn(&Self) -> &Option<Animated<f64>>, otherwise: f64| {
            own(self).clone().or_else(|| own(default).clone()).unwrap_or(otherwise.into())
        };
        MaterialTracks {
            emission: lobe(|given| &given.emission, 0.0, &base),
            ambient: lobe(|given| &given.ambient, 0.1, &base),
            diffuse: lobe(|given| &given.diffuse, 0.9, &base),
            specular: lobe(|given| &given.specular, 0.0, &white),
            mirror: lobe(|given| &given.mirror, 0.0, &white),
            fuzz: level(|given| &given.fuzz, 0.0),
            transparency: lobe(|given| &given.transparency, 0.0, &white),
            refraction: lobe(|given| &given.refraction, 0.0, &white),
            microfacet: value(|given| &given.microfacet, 0.0),
            metallic: level(|given| &given.metallic, 0.0),
            roughness: level(|given| &given.roughness, 0.0),
            coat: level(|given| &given.coat, 0.0),
            coat_roughness: level(|given| &given.coat_roughness, 0.0),
            shininess: value(|given| &given.shininess, 32.0),
            highlight: self.highlight.or(default.highlight).unwrap_or_default(),
            fresnel: self.fresnel.or(default.fresnel).unwrap_or_default(),
            ior: value(|given| &given.ior, 1.5),
            absorption: self
                .absorption
                .clone()
                .or_else(|| default.absorption.clone())
                .unwrap_or(Rgb::ZERO.into()),
            priority: self.priority.or(default.priority).unwrap_or(0),
            relief: self.relief.clone().or_else(|| default.relief.clone()),
            base,
        }
    }
}
