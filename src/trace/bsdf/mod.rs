//! How a surface scatters light: the sum of its lobes, a file each.
//!
//! What a surface scatters is counted in shares: π times its bidirectional reflectance times the cosine of the
//! light's angle, so that a facing light of radiance 1 on a surface of diffuse 1 gives radiance 1.

mod boundary;
mod diffuse;
mod fuzzy;
mod highlight;
mod metallic;
mod sample;
#[cfg(test)]
mod tests;

pub use boundary::Boundary;
pub use highlight::Shininess;
pub use sample::BsdfSample;

use super::materials::{Column, LobeSet, LobeTable};
use crate::appearance::optics::reflect;
use crate::base::lanes::{Color, Lookup, Real, Row, Select, Single, Vec3, out_of_line};
use crate::geometry::shape::LaneSurface;
use crate::sampling::Frame;
use metallic::Metallic;

/// The lobes of a point of a surface in each lane.
#[derive(Clone, Copy)]
pub struct Bsdf<'a, F: Real> {
    /// The lobes that any lane may have.
    pub lobes: LobeSet,
    /// Turned towards the eye.
    pub surface: &'a LaneSurface<F>,
    /// Unit vectors.
    pub to_eye: Vec3<F>,
    /// To shade with: the smooth one, unless it faces away from the eye.
    pub normal: Vec3<F>,
    /// Around that normal, turned as the eye's is.
    frame: Frame<F>,
    pub diffuse: Color<F::F32>,
    specular: Color<F::F32>,
    shininess: Shininess<F>,
    pub mirror: Color<F::F32>,
    fuzz: F::F32,
    pub transparency: Color<F::F32>,
    pub refraction: Color<F::F32>,
    metallic: Metallic<F>,
}

/// Rows of a table, for materials that have these lobes.
struct Rows<'a> {
    lobes: LobeSet,
    table: &'a LobeTable,
    at: &'a Lookup,
}

impl Rows<'_> {
    /// The colours of a lobe; black if no material has it.
    #[inline(always)]
    fn color<S: Single>(&self, lobe: LobeSet, column: Column) -> Color<S> {
        if self.lobes.has(lobe) { self.table.color(column, self.at) } else { Color::black() }
    }
}

/// The shares of light that a surface sends to the eye, by what they count in fog.
#[derive(Clone, Copy, Debug)]
pub struct Reflected<S> {
    /// Gathered by the diffuse lobe and from below the boundary of a metallic-roughness surface.
    pub diffuse: Color<S>,
    /// Shown by a fuzzy mirror or small ones.
    pub glossy: Color<S>,
    /// Of lights alone.
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
        if bsdf.lobes.has(LobeSet::PHONG | LobeSet::BLINN_PHONG) {
            reflected.highlight = bsdf.highlight(to_light);
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
    /// Of rows of a table. The frame is around the direction to the eye; others are made of it only for samples.
    #[inline(always)]
    pub fn gather(
        lobes: LobeSet,
        (table, at): (&LobeTable, &Lookup),
        shininess: Shininess<F>,
        ior: F,
        (surface, eye, is_sampled): (&'a LaneSurface<F>, &Frame<F>, bool),
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
            // Without samples, its other axes are of no use.
            frame: match is_sampled && lobes.has(LobeSet::SAMPLED) {
                true => eye.turned_to(normal),
                false => Frame { z: normal, ..*eye },
            },
            diffuse: rows.color(LobeSet::DIFFUSE, Column::DIFFUSE),
            specular: rows.color(highlights, Column::SPECULAR),
            shininess,
            mirror: rows.color(LobeSet::MIRROR, Column::MIRROR),
            fuzz: if lobes.has(LobeSet::FUZZ) { table.number(Column::FUZZ, at) } else { F::F32::splat(0.0) },
            transparency: rows.color(LobeSet::TRANSPARENT, Column::TRANSPARENCY),
            refraction: rows.color(LobeSet::REFRACTION, Column::REFRACTION),
            metallic,
        }
    }

    /// The direction in which a mirror shows the eye what it does.
    #[inline(always)]
    pub fn mirrored(&self) -> Vec3<F> {
        reflect(-self.to_eye, self.normal)
    }

    /// Lanes in which light from a direction falls on what is seen.
    #[inline(always)]
    pub fn is_lit_from(&self, direction: Vec3<F>) -> F::Mask {
        let zero = F::splat(0.0);
        let above = zero.lt(self.surface.normal.dot(direction)) | self.surface.smoothly_faces(direction);
        zero.lt(self.normal.dot(direction)) & above
    }

    /// The shares of the light from a direction (a unit vector) that the surface sends to the eye. Black where the
    /// light is behind the surface: then there is no highlight either.
    #[inline(always)]
    pub fn reflected(&self, to_light: Vec3<F>) -> Reflected<F::F32> {
        reflected(self, to_light)
    }

    /// Lanes in which a ray in a direction leaves the surface behind itself: a smooth normal may bend one that should
    /// pass back to the side that it came from.
    #[inline(always)]
    pub fn passes(&self, direction: Vec3<F>) -> F::Mask {
        self.surface.normal.dot(direction).lt(F::splat(0.0))
    }
}

impl<S: Single> Reflected<S> {
    /// What is scattered, where fog lets this share of light pass.
    #[inline(always)]
    pub fn scattered(&self, clear: S) -> Color<S> {
        self.diffuse + self.glossy * clear
    }
}
