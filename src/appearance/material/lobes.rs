//! The lobes of a material at one point, as numbers.

use crate::base::color::Rgb;
use crate::base::digest::content;

/// Mirrors of less fuzz are sharp: their reflections are spread over less than a tenth of a degree.
pub const SHARP: f32 = 0.0008;

/// How much of each lobe there is: strength times tint. Black means that the lobe is absent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lobes {
    /// Radiance that the surface gives off by itself, as if its layer's weight were 1.
    pub emission: Rgb,
    /// Reflected share of the scene's ambient light.
    pub ambient: Rgb,
    /// Lambertian reflectance: a facing light of intensity 1 gives radiance `diffuse`.
    pub diffuse: Rgb,
    /// Radiance at the centre of the highlight of a light of intensity 1.
    pub specular: Rgb,
    /// Reflected share of what a mirror shows.
    pub mirror: Rgb,
    /// How far the mirror scatters, 0..=1.
    pub fuzz: f32,
    /// Share that passes unbent.
    pub transparency: Rgb,
    /// Share that passes bent.
    pub refraction: Rgb,
    /// Share of the metallic-roughness surface (the model of glTF 2.0), and its parameters, 0..=1.
    pub microfacet: f32,
    pub base: Rgb,
    pub metallic: f32,
    pub roughness: f32,
}

content!(struct Lobes {
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
});

/// A lobe, or a parameter of one, that paint may vary over a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    Emission,
    Ambient,
    Diffuse,
    Specular,
    Mirror,
    Fuzz,
    Transparency,
    Refraction,
    Base,
    Metallic,
    Roughness,
    /// How much of the surface is there: the alpha of its paint.
    Coverage,
}

content!(
    enum Slot {
        Emission,
        Ambient,
        Diffuse,
        Specular,
        Mirror,
        Fuzz,
        Transparency,
        Refraction,
        Base,
        Metallic,
        Roughness,
        Coverage,
    }
);

impl Lobes {
    /// Multiplies a slot by a colour; a slot that is one number by the colour's mean.
    pub fn tint(&mut self, slot: Slot, color: Rgb) {
        let grey = color.element_sum() / 3.0;
        match slot {
            Slot::Emission => self.emission *= color,
            Slot::Ambient => self.ambient *= color,
            Slot::Diffuse => self.diffuse *= color,
            Slot::Specular => self.specular *= color,
            Slot::Mirror => self.mirror *= color,
            Slot::Fuzz => self.fuzz = (self.fuzz * grey).min(1.0),
            Slot::Transparency => self.transparency *= color,
            Slot::Refraction => self.refraction *= color,
            Slot::Base => self.base *= color,
            Slot::Metallic => self.metallic = (self.metallic * grey).min(1.0),
            Slot::Roughness => self.roughness = (self.roughness * grey).min(1.0),
            // A share of them all: `covering`.
            Slot::Coverage => {}
        }
    }

    /// The lobes of a surface of which only this share is there: past the rest, light goes straight on.
    pub fn covering(self, share: f32) -> Self {
        Self {
            emission: self.emission * share,
            ambient: self.ambient * share,
            diffuse: self.diffuse * share,
            specular: self.specular * share,
            mirror: self.mirror * share,
            transparency: self.transparency * share + (1.0 - share),
            refraction: self.refraction * share,
            microfacet: self.microfacet * share,
            ..self
        }
    }

    /// Whether the mirror scatters as far as can be seen.
    pub fn is_fuzzy(&self) -> bool {
        self.fuzz >= SHARP
    }

    /// Whether a light can be seen by its reflection in the lobes that scatter.
    pub fn reflects_lights(&self) -> bool {
        self.diffuse != Rgb::ZERO || self.specular != Rgb::ZERO || self.microfacet > 0.0 || self.is_fuzzy()
    }
}
