//! The lobes of materials at points, in lanes.

use super::lobes::{Coat, Lobes, TextureSlot};
use crate::base::lanes::{Color, Single};

/// [`Lobes`] at a point in each lane.
#[derive(Clone, Copy)]
pub struct PointLobes<S> {
    pub emission: Color<S>,
    pub ambient: Color<S>,
    pub diffuse: Color<S>,
    pub specular: Color<S>,
    pub mirror: Color<S>,
    pub fuzz: S,
    pub transparency: Color<S>,
    pub refraction: Color<S>,
    pub microfacet: S,
    pub base: Color<S>,
    pub metallic: S,
    pub roughness: S,
    pub coat: PointCoat<S>,
}

/// A [`Coat`] at a point in each lane.
#[derive(Clone, Copy)]
pub struct PointCoat<S> {
    pub share: S,
    pub roughness: S,
    pub hole: S,
}

impl<S: Single> PointLobes<S> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat(lobes: &Lobes) -> Self {
        let Coat { share, roughness, hole } = lobes.coat;
        Self {
            emission: Color::splat(lobes.emission),
            ambient: Color::splat(lobes.ambient),
            diffuse: Color::splat(lobes.diffuse),
            specular: Color::splat(lobes.specular),
            mirror: Color::splat(lobes.mirror),
            fuzz: S::splat(lobes.fuzz),
            transparency: Color::splat(lobes.transparency),
            refraction: Color::splat(lobes.refraction),
            microfacet: S::splat(lobes.microfacet),
            base: Color::splat(lobes.base),
            metallic: S::splat(lobes.metallic),
            roughness: S::splat(lobes.roughness),
            coat: PointCoat { share: S::splat(share), roughness: S::splat(roughness), hole: S::splat(hole) },
        }
    }

    /// Multiplies a slot by colours. Scalar slots use the mean of the channels.
    #[inline(always)]
    pub fn tint(&mut self, slot: TextureSlot, color: Color<S>) {
        let (grey, one) = (color.element_sum() / S::splat(3.0), S::splat(1.0));
        match slot {
            TextureSlot::Emission => self.emission = self.emission * color,
            TextureSlot::Ambient => self.ambient = self.ambient * color,
            TextureSlot::Diffuse => self.diffuse = self.diffuse * color,
            TextureSlot::Specular => self.specular = self.specular * color,
            TextureSlot::Mirror => self.mirror = self.mirror * color,
            TextureSlot::Fuzz => self.fuzz = (self.fuzz * grey).min(one),
            TextureSlot::Transparency => self.transparency = self.transparency * color,
            TextureSlot::Refraction => self.refraction = self.refraction * color,
            TextureSlot::Base => self.base = self.base * color,
            TextureSlot::Metallic => self.metallic = (self.metallic * grey).min(one),
            TextureSlot::Roughness => self.roughness = (self.roughness * grey).min(one),
            TextureSlot::Coat => self.coat.share = (self.coat.share * grey).min(one),
            TextureSlot::CoatRoughness => self.coat.roughness = (self.coat.roughness * grey).min(one),
            // Coverage scales all lobes: see [`PointLobes::with_coverage`].
            TextureSlot::Coverage => {}
            // Relief turns normals.
            TextureSlot::Height | TextureSlot::Normal => {}
        }
    }

    /// The lobes of surfaces that cover only these fractions. The rest lets light pass straight on.
    #[inline(always)]
    pub fn with_coverage(self, share: S) -> Self {
        let one = S::splat(1.0);
        Self {
            emission: self.emission * share,
            ambient: self.ambient * share,
            diffuse: self.diffuse * share,
            specular: self.specular * share,
            mirror: self.mirror * share,
            transparency: self.transparency * share + Color::grey(one - share),
            refraction: self.refraction * share,
            microfacet: self.microfacet * share,
            coat: PointCoat { hole: one - share * (one - self.coat.hole), ..self.coat },
            ..self
        }
    }
}
