//! The BSDF of a surface: the sum of its lobes, one file per lobe.
//!
//! Values are shares: π times the bidirectional reflectance times the cosine of the light's angle. So a facing light of
//! radiance 1 on a surface of diffuse 1 gives radiance 1.

mod boundary;
mod diffuse;
mod fuzzy;
mod glossy;
mod highlight;
mod metallic;
mod relief;
mod sample;
mod shininess;
#[cfg(test)]
mod tests;

pub use boundary::Boundary;
pub use glossy::GlossySample;
pub use sample::BsdfSample;
pub use shininess::Shininess;

use super::materials::{Column, LobeSet, LobeTable};
use crate::appearance::optics::reflect;
use crate::base::lanes::{Color, Lookup, Real, Row, Select, Single, Vec3, out_of_line};
use crate::geometry::shape::LaneSurface;
use crate::sampling::{FrameAxes, LocalFrame};
use metallic::Metallic;

/// The lobes at a point of a surface, in each lane.
#[derive(Clone, Copy)]
pub struct Bsdf<'a, F: Real> {
    /// The lobes that any lane may have.
    pub lobes: LobeSet,
    /// The surface, turned towards the eye.
    pub surface: &'a LaneSurface<F>,
    /// Unit vector towards the eye.
    pub to_eye: Vec3<F>,
    /// The shading normal: the smooth normal, unless it faces away from the eye.
    pub normal: Vec3<F>,
    /// The frame around the shading normal, with the axes of the eye's frame.
    frame: LocalFrame<F>,
    pub diffuse: Color<F::F32>,
    specular: Color<F::F32>,
    shininess: Shininess<F>,
    pub mirror: Color<F::F32>,
    fuzz: F::F32,
    pub transparency: Color<F::F32>,
    pub refraction: Color<F::F32>,
    metallic: Metallic<F>,
    /// The clear coat. All other lobes are what is left of them below it.
    coat: Metallic<F>,
}

/// The share of light that a coat of this strength lets pass at an angle of this cosine.
#[inline(always)]
pub fn passed_by_coat<F: Real>(strength: F::F32, cosine: F) -> F::F32 {
    Metallic::<F>::coat(strength, F::F32::splat(0.0)).passed(cosine)
}

/// What passes straight through a coated surface: of the share that passes without the coat, `hole` does not meet it.
#[inline(always)]
pub fn passed_through<S: Single>(transparency: Color<S>, passed: S, hole: S) -> Color<S> {
    transparency * passed + Color::grey(hole * (S::splat(1.0) - passed))
}

/// Rows of a lobe table, for materials with these lobes.
struct Rows<'a> {
    lobes: LobeSet,
    table: &'a LobeTable,
    at: &'a Lookup,
}

impl Rows<'_> {
    /// The colours of a lobe. Black if none of the materials has it.
    #[inline(always)]
    fn color<S: Single>(&self, lobe: LobeSet, column: Column) -> Color<S> {
        if self.lobes.has(lobe) { self.table.color(column, self.at) } else { Color::black() }
    }
}

/// The shares of light that a surface reflects to the eye, by their behaviour in fog.
#[derive(Clone, Copy, Debug)]
pub struct Reflected<S> {
    /// Reflected by the diffuse lobe, and by the base below the boundary of a metallic-roughness surface.
    pub diffuse: Color<S>,
    /// Reflected by a fuzzy mirror, by microfacets or by the coat.
    pub glossy: Color<S>,
    /// The highlight, which only light sources have.
    pub highlight: Color<S>,
}

out_of_line! {
    fn reflected<'k, F>(bsdf: &'k Bsdf<'k, F>, to_light: Vec3<F>) -> Reflected<F::F32> {
        let black = Color::black();
        let mut reflected = Reflected { diffuse: black, glossy: black, highlight: black };
        if bsdf.lobes.has(LobeSet::DIFFUSE) {
            reflected.diffuse = bsdf.diffuse_share(to_light);
        }
        if bsdf.lobes.has(LobeSet::FUZZ) {
            reflected.glossy = bsdf.fuzzy_share(to_light);
        }
        if bsdf.lobes.has(LobeSet::MICROFACET) {
            let (below, glossy) = bsdf.metallic.share(bsdf.to_eye, &bsdf.frame, to_light);
            reflected.diffuse = reflected.diffuse + below;
            reflected.glossy = reflected.glossy + glossy;
        }
        if bsdf.lobes.has(LobeSet::COAT) {
            let (_, glossy) = bsdf.coat.share(bsdf.to_eye, &bsdf.frame, to_light);
            reflected.glossy = reflected.glossy + glossy;
        }
        if bsdf.lobes.has(LobeSet::PHONG | LobeSet::BLINN_PHONG) {
            reflected.highlight = bsdf.highlight(to_light);
        }
        if bsdf.lobes.has(LobeSet::RELIEF) {
            let share = bsdf.relief_shadow(to_light);
            reflected = Reflected {
                diffuse: reflected.diffuse * share,
                glossy: reflected.glossy * share,
                highlight: reflected.highlight * share,
            };
        }
        let lit = bsdf.is_lit_from(to_light);
        Reflected {
            diffuse: Color::select(lit, reflected.diffuse, black),
            glossy: Color::select(lit, reflected.glossy, black),
            highlight: Color::select(lit, reflected.highlight, black),
        }
    }
}

impl<'a, F: Real> Bsdf<'a, F> {
    /// Gathers the lobes but the coat from rows of a table; [`Bsdf::cover`] adds that. `eye` holds the axes around the
    /// direction to the eye. Frames around normals are built only if samples need them.
    #[inline(always)]
    pub fn gather(
        lobes: LobeSet,
        (table, at): (&LobeTable, &Lookup),
        shininess: Shininess<F>,
        ior: F,
        (surface, eye, is_sampled): (&'a LaneSurface<F>, &FrameAxes<F>, bool),
    ) -> Self {
        let to_eye = eye.z;
        let faces = F::splat(0.0).lt(surface.shading.dot(to_eye));
        let rows = Rows { lobes, table, at };
        let highlights = LobeSet::PHONG | LobeSet::BLINN_PHONG;
        let metallic = match lobes.has(LobeSet::MICROFACET) {
            true => Metallic::gather(table, at, ior),
            false => Metallic::none(),
        };
        let normal = Vec3::select(faces, surface.shading, surface.normal);
        Self {
            lobes,
            surface,
            to_eye,
            normal,
            // Without samples, the other axes are not used.
            frame: match is_sampled && lobes.has(LobeSet::SAMPLED) {
                true => eye.rotated_to(normal),
                false => LocalFrame { z: normal, ..LocalFrame::identity() },
            },
            diffuse: rows.color(LobeSet::DIFFUSE, Column::DIFFUSE),
            specular: rows.color(highlights, Column::SPECULAR),
            shininess,
            mirror: rows.color(LobeSet::MIRROR, Column::MIRROR),
            fuzz: if lobes.has(LobeSet::FUZZ) { table.number(Column::FUZZ, at) } else { F::F32::splat(0.0) },
            transparency: rows.color(LobeSet::TRANSPARENT, Column::TRANSPARENCY),
            refraction: rows.color(LobeSet::REFRACTION, Column::REFRACTION),
            metallic,
            coat: Metallic::none(),
        }
    }

    /// Lays the coat over all lobes, if materials have one. It takes the light from them that it reflects to the eye as a
    /// smooth surface (`KHR_materials_clearcoat`, "layering").
    #[inline(always)]
    pub fn cover(&mut self, table: &LobeTable, at: &Lookup) {
        if !self.lobes.has(LobeSet::COAT) {
            return;
        }
        let [share, roughness, hole] =
            [Column::COAT, Column::COAT_ROUGHNESS, Column::HOLE].map(|column| table.number(column, at));
        let coat = Metallic::coat(share, roughness);
        let passed = coat.passed(self.normal.dot(self.to_eye));
        let surface = F::F32::splat(1.0) - hole;
        self.coat = coat;
        self.coat.strength = coat.strength * surface;
        self.metallic.strength = self.metallic.strength * passed;
        self.transparency = passed_through(self.transparency, passed, hole);
        let Self { diffuse, specular, mirror, refraction, .. } = self;
        for lobe in [diffuse, specular, mirror, refraction] {
            *lobe = *lobe * passed;
        }
    }

    /// The direction of the ideal reflection of the eye.
    #[inline(always)]
    pub fn mirrored(&self) -> Vec3<F> {
        reflect(-self.to_eye, self.normal)
    }

    /// Lanes in which light from a direction reaches the visible side.
    #[inline(always)]
    pub fn is_lit_from(&self, direction: Vec3<F>) -> F::Mask {
        let zero = F::splat(0.0);
        let above = zero.lt(self.surface.normal.dot(direction)) | self.surface.smoothly_faces(direction);
        zero.lt(self.normal.dot(direction)) & above
    }

    /// The shares of light from a direction (a unit vector) that the surface reflects to the eye. All are black,
    /// highlights included, if the light is behind the surface.
    #[inline(always)]
    pub fn reflected(&self, to_light: Vec3<F>) -> Reflected<F::F32> {
        reflected(self, to_light)
    }

    /// Lanes in which a ray in a direction passes to the far side of the surface. A smooth normal may bend a refracted
    /// ray back to the near side.
    #[inline(always)]
    pub fn passes(&self, direction: Vec3<F>) -> F::Mask {
        self.surface.normal.dot(direction).lt(F::splat(0.0))
    }
}

impl<S: Single> Reflected<S> {
    /// The scattered share, if fog transmits the share `transmittance`.
    #[inline(always)]
    pub fn scattered(&self, transmittance: S) -> Color<S> {
        self.diffuse + self.glossy * transmittance
    }
}
