//! The materials of a scene as tables, from which lanes gather the lobes of their surfaces.

use crate::appearance::material::{Highlight, Lobes, Material, PointLobes};
use crate::appearance::optics::Fresnel;
use crate::base::color::Rgb;
use crate::base::lanes::{Color, Lookup, Single};

/// The lobes of a material, and whatever else decides its shading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LobeSet(u16);

impl LobeSet {
    pub const DIFFUSE: Self = Self(1);
    pub const PHONG: Self = Self(1 << 1);
    pub const BLINN_PHONG: Self = Self(1 << 2);
    pub const MIRROR: Self = Self(1 << 3);
    /// The mirror is fuzzy. If textures vary its fuzz, it may be sharp at some points.
    pub const FUZZ: Self = Self(1 << 4);
    pub const MICROFACET: Self = Self(1 << 5);
    pub const TRANSPARENT: Self = Self(1 << 6);
    pub const REFRACTION: Self = Self(1 << 7);
    pub const EMISSION: Self = Self(1 << 8);
    pub const AMBIENT: Self = Self(1 << 9);
    pub const TEXTURED: Self = Self(1 << 10);
    /// Fresnel's formula of a boundary; neither bit means none.
    const EXACT: Self = Self(1 << 11);
    const SCHLICK: Self = Self(1 << 12);
    /// Textures turn the normals.
    pub const RELIEF: Self = Self(1 << 13);
    /// A clear coat over all other lobes.
    pub const COAT: Self = Self(1 << 14);
    /// Boundaries of microfacets, which may be sharp mirrors.
    pub const BOUNDARIES: Self = Self(Self::MICROFACET.0 | Self::COAT.0);

    pub const ALL: Self = Self(u16::MAX);
    /// Lobes that reflect light from light sources.
    pub const REFLECTS_LIGHTS: Self =
        Self(Self::DIFFUSE.0 | Self::PHONG.0 | Self::BLINN_PHONG.0 | Self::FUZZ.0 | Self::BOUNDARIES.0);
    /// Lobes that are sampled with a density.
    pub const SAMPLED: Self = Self(Self::DIFFUSE.0 | Self::FUZZ.0 | Self::BOUNDARIES.0);
    /// Lobes that transmit light.
    pub const PASSES: Self = Self(Self::TRANSPARENT.0 | Self::REFRACTION.0);

    pub fn of(material: &Material) -> Self {
        let Lobes { emission, ambient, diffuse, specular, mirror, .. } = &material.lobes;
        let Lobes { refraction, microfacet, coat, .. } = &material.lobes;
        let highlight = match material.highlight {
            Highlight::Phong => Self::PHONG,
            Highlight::BlinnPhong => Self::BLINN_PHONG,
        };
        let fresnel = match material.fresnel {
            Fresnel::Off => Self(0),
            Fresnel::Exact => Self::EXACT,
            Fresnel::Schlick => Self::SCHLICK,
        };
        let refracts = *refraction != Rgb::ZERO;
        [
            (*diffuse != Rgb::ZERO, Self::DIFFUSE),
            (*specular != Rgb::ZERO, highlight),
            (*mirror != Rgb::ZERO, Self::MIRROR),
            (material.lobes.is_fuzzy() && *mirror != Rgb::ZERO, Self::FUZZ),
            (*microfacet > 0.0, Self::MICROFACET),
            (coat.share > 0.0, Self::COAT),
            (material.is_transparent(), Self::TRANSPARENT),
            (refracts, Self::REFRACTION),
            (refracts, fresnel),
            (*emission != Rgb::ZERO, Self::EMISSION),
            (*ambient != Rgb::ZERO, Self::AMBIENT),
            (!material.textures.is_empty(), Self::TEXTURED),
            (material.has_relief(), Self::RELIEF),
        ]
        .into_iter()
        .filter(|(has, _)| *has)
        .fold(Self(0), |all, (_, one)| Self(all.0 | one.0))
    }

    /// Whether it has any of these.
    #[inline(always)]
    pub fn has(self, any: Self) -> bool {
        self.0 & any.0 != 0
    }

    /// Whether this is its only lobe that continues paths.
    #[inline(always)]
    pub fn is_only(self, one: Self) -> bool {
        let scatters = Self::DIFFUSE | Self::MIRROR | Self::FUZZ | Self::BOUNDARIES | Self::PASSES;
        self.0 & scatters.0 == one.0
    }

    #[inline(always)]
    pub fn fresnel(self) -> Fresnel {
        if self.has(Self::EXACT) {
            Fresnel::Exact
        } else if self.has(Self::SCHLICK) {
            Fresnel::Schlick
        } else {
            Fresnel::Off
        }
    }
}

impl std::ops::BitOr for LobeSet {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// A column of the table: a colour or a number for every material.
#[derive(Clone, Copy, Debug)]
pub struct Column(usize);

impl Column {
    pub const EMISSION: Self = Self(0);
    pub const AMBIENT: Self = Self(3);
    pub const DIFFUSE: Self = Self(6);
    pub const SPECULAR: Self = Self(9);
    pub const MIRROR: Self = Self(12);
    pub const TRANSPARENCY: Self = Self(15);
    pub const REFRACTION: Self = Self(18);
    pub const BASE: Self = Self(21);
    pub const FUZZ: Self = Self(24);
    pub const MICROFACET: Self = Self(25);
    pub const METALLIC: Self = Self(26);
    pub const ROUGHNESS: Self = Self(27);
    pub const COAT: Self = Self(28);
    pub const COAT_ROUGHNESS: Self = Self(29);
    pub const HOLE: Self = Self(30);
}

const COLUMNS: usize = 31;

/// The lobes of all materials, or those of the points in lanes if textures vary them.
#[derive(Clone, Debug, Default)]
pub struct LobeTable {
    /// Column after column, with one number per row.
    values: Vec<f32>,
    rows: usize,
}

impl LobeTable {
    pub fn new<'a>(all: impl ExactSizeIterator<Item = &'a Lobes>) -> Self {
        let rows = all.len();
        let mut table = Self { values: vec![0.0; COLUMNS * rows], rows };
        for (row, lobes) in all.enumerate() {
            table.write::<f32>(row, true, &PointLobes::splat(lobes), LobeSet::ALL);
        }
        table
    }

    /// Replaces rows from `first` on, one for each lane of a mask, as far as they are about the wanted lobes.
    #[inline(always)]
    pub fn write<S: Single>(&mut self, first: usize, mask: S::Mask, lobes: &PointLobes<S>, wanted: LobeSet) {
        let at = (first, mask);
        if wanted.has(LobeSet::EMISSION) {
            self.write_color(Column::EMISSION, at, lobes.emission);
        }
        if wanted.has(LobeSet::AMBIENT) {
            self.write_color(Column::AMBIENT, at, lobes.ambient);
        }
        if wanted.has(LobeSet::DIFFUSE) {
            self.write_color(Column::DIFFUSE, at, lobes.diffuse);
        }
        if wanted.has(LobeSet::PHONG | LobeSet::BLINN_PHONG) {
            self.write_color(Column::SPECULAR, at, lobes.specular);
        }
        if wanted.has(LobeSet::MIRROR) {
            self.write_color(Column::MIRROR, at, lobes.mirror);
        }
        if wanted.has(LobeSet::TRANSPARENT) {
            self.write_color(Column::TRANSPARENCY, at, lobes.transparency);
        }
        if wanted.has(LobeSet::REFRACTION) {
            self.write_color(Column::REFRACTION, at, lobes.refraction);
        }
        if wanted.has(LobeSet::FUZZ) {
            self.write_number(Column::FUZZ, at, lobes.fuzz);
        }
        if wanted.has(LobeSet::MICROFACET) {
            self.write_color(Column::BASE, at, lobes.base);
            self.write_number(Column::MICROFACET, at, lobes.microfacet);
            self.write_number(Column::METALLIC, at, lobes.metallic);
            self.write_number(Column::ROUGHNESS, at, lobes.roughness);
        }
        if wanted.has(LobeSet::COAT) {
            self.write_number(Column::COAT, at, lobes.coat.share);
            self.write_number(Column::COAT_ROUGHNESS, at, lobes.coat.roughness);
            self.write_number(Column::HOLE, at, lobes.coat.hole);
        }
    }

    #[inline(always)]
    fn write_color<S: Single>(&mut self, Column(red): Column, at: (usize, S::Mask), color: Color<S>) {
        self.write_number(Column(red), at, color.r);
        self.write_number(Column(red + 1), at, color.g);
        self.write_number(Column(red + 2), at, color.b);
    }

    #[inline(always)]
    fn write_number<S: Single>(&mut self, Column(column): Column, (first, mask): (usize, S::Mask), value: S) {
        let at = column * self.rows + first;
        S::select(mask, value, S::load(&self.values, at)).store(&mut self.values, at);
    }

    #[inline(always)]
    fn column(&self, column: usize) -> &[f32] {
        &self.values[column * self.rows..][..self.rows]
    }

    #[inline(always)]
    pub fn color<S: Single>(&self, column: Column, at: &Lookup) -> Color<S> {
        let Column(first) = column;
        Color::gather([self.column(first), self.column(first + 1), self.column(first + 2)], at)
    }

    #[inline(always)]
    pub fn number<S: Single>(&self, column: Column, at: &Lookup) -> S {
        S::gather(self.column(column.0), at)
    }
}
