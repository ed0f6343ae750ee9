//! The lobes of a material at one point, as numbers.

use crate::base::color::Rgb;
use crate::base::digest::{Content, Digester};

/// Mirrors with less fuzz count as sharp. Their reflections spread over less than a tenth of a degree.
pub const MIN_FUZZ: f32 = 0.0008;

/// The strength of each lobe times its tint. A black lobe is absent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Content)]
#[warn(missing_docs)]
pub struct Lobes {
    /// Emitted radiance, for a layer weight of 1.
    pub emission: Rgb,
    /// Reflected fraction of the scene's ambient light.
    pub ambient: Rgb,
    /// Lambertian reflectance: a facing light of intensity 1 gives radiance `diffuse`.
    pub diffuse: Rgb,
    /// Radiance at the centre of the highlight of a light of intensity 1.
    pub specular: Rgb,
    /// Reflectance of the mirror.
    pub mirror: Rgb,
    /// Spread of the mirror's reflections, 0..=1.
    pub fuzz: f32,
    /// Share that is transmitted straight on.
    pub transparency: Rgb,
    /// Share that is refracted.
    pub refraction: Rgb,
    /// Strength of the metallic-roughness surface (the model of glTF 2.0), and its parameters, 0..=1.
    pub microfacet: f32,
    /// The colour of the metallic-roughness surface.
    pub base: Rgb,
    /// How metallic that surface is.
    pub metallic: f32,
    /// How rough that surface is.
    pub roughness: f32,
    /// The clear coat over all other lobes.
    pub coat: Coat,
}

/// A clear coat. All numbers are in 0..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[warn(missing_docs)]
pub struct Coat {
    /// How much of the surface it covers.
    pub share: f32,
    /// How rough it is.
    pub roughness: f32,
    /// The share of the point that is a hole in the surface, which textures cut; the coat leaves it open.
    pub hole: f32,
}

impl Coat {
    /// The reflectance of its boundary at normal incidence. Its index of refraction is 1.5: (0.5 / 2.5)².
    pub const REFLECTANCE: f32 = 0.04;
}

/// Lobes without a coat have the digest that they had before there was any.
impl Content for Coat {
    fn feed(&self, into: &mut Digester) {
        if self.share != 0.0 {
            (self.share, self.roughness).feed(into);
        }
    }
}

/// A lobe, or a parameter of one, that textures may vary over a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Content)]
pub enum TextureSlot {
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
    /// Coverage of the surface: the alpha of its base colour.
    Coverage,
    /// The height of the surface, which turns its normal.
    Height,
    /// Normals in the axes of u and v.
    Normal,
    /// The share of the clear coat.
    Coat,
    CoatRoughness,
}

impl TextureSlot {
    /// Whether it turns normals instead of multiplying a lobe.
    pub fn is_relief(self) -> bool {
        matches!(self, Self::Height | Self::Normal)
    }
}

#[warn(missing_docs)]
impl Lobes {
    /// Whether the mirror scatters visibly.
    pub fn is_fuzzy(&self) -> bool {
        self.fuzz >= MIN_FUZZ
    }

    /// Whether a scattering lobe reflects light from light sources.
    pub fn reflects_lights(&self) -> bool {
        let scatters = self.diffuse != Rgb::ZERO || self.specular != Rgb::ZERO || self.is_fuzzy();
        scatters || self.microfacet > 0.0 || self.coat.share > 0.0
    }
}
