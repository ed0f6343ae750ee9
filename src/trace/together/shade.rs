//! Eight points of surfaces, and what they reflect, as `super::super::shade` has it for one.

use super::super::tracer::Tracer;
use super::everywhere;
use super::paint::{Beams, Eye};
use crate::bvh::Hits;
use crate::color::Rgb;
use crate::material::{Exponent, Highlight, Material};
use crate::math::DVec3;
use crate::shape::{Rays, Surface, Surfaces, lanes};
use crate::simd::{Choice, Lanes, Octo, Rows, Vector};

/// Eight colours.
#[derive(Clone, Copy)]
pub struct Color<L> {
    pub r: L,
    pub g: L,
    pub b: L,
}

impl<L: Lanes> Color<L> {
    #[inline(always)]
    pub fn splat(color: Rgb) -> Self {
        Self { r: L::splat(color.x), g: L::splat(color.y), b: L::splat(color.z) }
    }

    #[inline(always)]
    pub fn of(colors: &[Rgb; 8]) -> Self {
        let mut rows = [[0.0; 8]; 3];
        for (lane, color) in colors.iter().enumerate() {
            (rows[0][lane], rows[1][lane], rows[2][lane]) = (color.x, color.y, color.z);
        }
        Self::load(&rows)
    }

    #[inline(always)]
    pub fn load([r, g, b]: &[[f32; 8]; 3]) -> Self {
        Self { r: L::load(r), g: L::load(g), b: L::load(b) }
    }

    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        Self { r: self.r.times(other.r), g: self.g.times(other.g), b: self.b.times(other.b) }
    }

    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Self { r: self.r.plus(other.r), g: self.g.plus(other.g), b: self.b.plus(other.b) }
    }

    #[inline(always)]
    pub fn scaled(self, factor: L) -> Self {
        Self { r: self.r.times(factor), g: self.g.times(factor), b: self.b.times(factor) }
    }

    #[inline(always)]
    pub fn pick(self, bits: u32, other: Self) -> Self {
        Self { r: self.r.pick(bits, other.r), g: self.g.pick(bits, other.g), b: self.b.pick(bits, other.b) }
    }

    #[inline(always)]
    pub fn largest(self) -> L {
        self.r.larger(self.g.larger(self.b))
    }

    /// A bit for each that is not black; none of them has a component below 0.
    #[inline(always)]
    pub fn not_black(self) -> u32 {
        L::splat(0.0).below(self.largest())
    }

    pub fn one(self, lane: usize) -> Rgb {
        Rgb::new(self.r.store()[lane], self.g.store()[lane], self.b.store()[lane])
    }
}

/// Eight points of surfaces, turned towards where their rays came from.
pub struct Reflectors<L: Lanes> {
    pub surfaces: Surfaces,
    pub ambient: Color<L>,
    pub mirror: Color<L>,
    /// A bit for each with a mirror, or that shines by itself.
    pub mirrors: u32,
    pub emissive: u32,
    /// A bit for each that is painted: its colours come later.
    pub painted: u32,
    pub materials: [u32; 8],
    /// In which a mirror shows what it does.
    pub mirrored: Vector<L::Quad>,
    pub(super) diffuse: Color<L>,
    pub(super) specular: Color<L>,
    /// The normals to shade with.
    normal: Vector<L::Quad>,
    to_eye: Vector<L::Quad>,
    pub(super) shines: Shines,
}

/// The highlights of eight points.
#[derive(Clone, Copy)]
pub(super) struct Shines {
    pub any: u32,
    /// A bit for each by Blinn and Phong.
    blinn: u32,
    exponents: Exponents,
}

#[derive(Clone, Copy)]
enum Exponents {
    /// The same whole number for all.
    Whole(u32),
    Mixed([Exponent; 8]),
}

impl<L: Lanes> Reflectors<L> {
    /// The surfaces that rays meet, of which there is at least one; those at places are known already.
    #[inline(always)]
    pub fn of(
        tracer: &Tracer,
        rays: &Rays,
        hits: &Hits,
        places: &[(usize, Surface)],
        beams: Option<&Beams>,
    ) -> Self {
        let (mut found, mut rest) = Self::next(tracer, rays, hits, hits.at.met);
        while rest != 0 {
            let wanted = rest;
            let more;
            (more, rest) = Self::next(tracer, rays, hits, wanted);
            found = more.pick(wanted & !rest, found);
        }
        for (lane, surface) in places {
            found.surfaces.set(*lane, surface);
        }
        if let Some(beams) = beams.filter(|_| found.painted != 0) {
            found.paint(&Eye { tracer, rays, hits, beams });
        }
        found.turn(rays);
        found
    }

    /// What those among `wanted` meet that meet the same as the first, and those that are left.
    #[inline(always)]
    fn next(tracer: &Tracer, rays: &Rays, hits: &Hits, wanted: u32) -> (Self, u32) {
        let index = hits.primitives[wanted.trailing_zeros() as usize & 7];
        let mut same = 0;
        for (lane, other) in hits.primitives.iter().enumerate() {
            same |= u32::from(*other == index) << lane;
        }
        let same = same & wanted;
        let primitive = &tracer.scene.geometry.primitives[index as usize];
        let material = primitive.material(0).unwrap_or_default();
        let surfaces = primitive.surface_together::<L>(rays, &hits.at, same);
        let found = Self::with(&tracer.scene.shading.materials[material as usize], material, surfaces, same);
        (found, wanted & !same)
    }

    #[inline(always)]
    fn with(material: &Material, index: u32, surfaces: Surfaces, bits: u32) -> Self {
        let nowhere = everywhere(DVec3::ZERO);
        let lobes = &material.lobes;
        let specular = Color::splat(lobes.specular);
        let has = |color: Rgb| if color == Rgb::ZERO { 0 } else { bits };
        let exponents = match material.shininess {
            Exponent::Whole(n) => Exponents::Whole(n),
            other @ Exponent::Real(_) => Exponents::Mixed([other; 8]),
        };
        let blinn = if material.highlight == Highlight::BlinnPhong { bits } else { 0 };
        Self {
            surfaces,
            ambient: Color::splat(lobes.ambient),
            mirror: Color::splat(lobes.mirror),
            mirrors: has(lobes.mirror),
            emissive: has(lobes.emission),
            painted: if material.paints.is_empty() { 0 } else { bits },
            materials: [index; 8],
            mirrored: nowhere,
            diffuse: Color::splat(lobes.diffuse),
            specular,
            normal: nowhere,
            to_eye: nowhere,
            shines: Shines { any: has(lobes.specular), blinn, exponents },
        }
    }

    /// These where their bits are set, others elsewhere.
    #[inline(always)]
    fn pick(self, bits: u32, other: Self) -> Self {
        let mut materials = other.materials;
        lanes(bits).for_each(|lane| materials[lane] = self.materials[lane]);
        Self {
            surfaces: picked::<L>(&self.surfaces, bits, &other.surfaces),
            ambient: self.ambient.pick(bits, other.ambient),
            mirror: self.mirror.pick(bits, other.mirror),
            mirrors: self.mirrors | other.mirrors,
            emissive: self.emissive | other.emissive,
            painted: self.painted | other.painted,
            materials,
            diffuse: self.diffuse.pick(bits, other.diffuse),
            specular: self.specular.pick(bits, other.specular),
            shines: Shines {
                any: self.shines.any | other.shines.any,
                blinn: self.shines.blinn | other.shines.blinn,
                exponents: self.shines.exponents.pick(bits, other.shines.exponents),
            },
            ..self
        }
    }

    /// Turns the surfaces to where the rays came from.
    #[inline(always)]
    fn turn(&mut self, rays: &Rays) {
        let zero = Octo::splat(0.0);
        let direction = Vector::load(&rays.direction);
        let (normal, shading) = (Vector::load(&self.surfaces.normal), Vector::load(&self.surfaces.shading));
        let outside = normal.dot(direction).at_most(zero);
        let (normal, shading) = (normal.pick(outside, -normal), shading.pick(outside, -shading));
        (self.surfaces.normal, self.surfaces.shading) = (normal.store(), shading.store());
        self.to_eye = -direction;
        self.normal = shading.pick(zero.below(shading.dot(self.to_eye)), normal);
        self.mirrored = direction - self.normal * (Octo::splat(2.0) * self.normal.dot(direction));
    }

    /// The shares of light from these directions that the surfaces send back, and a bit for each among `wanted` that
    /// sends some.
    #[inline(always)]
    pub fn reflected(&self, to_light: Vector<L::Quad>, wanted: u32) -> (Color<L>, u32) {
        let zero = Octo::splat(0.0);
        let cosine = self.normal.dot(to_light);
        let above = zero.below(Vector::load(&self.surfaces.normal).dot(to_light));
        let lit = wanted & (zero.below(cosine) & above).bits();
        if lit == 0 {
            return (self.diffuse, 0);
        }
        let mut share = self.diffuse.scaled(L::load(&cosine.narrow()));
        if self.shines.any & lit != 0 {
            let highlight = L::load(&self.highlight(to_light).narrow());
            share = share.plus(self.specular.scaled(highlight));
        }
        (share, lit & share.not_black())
    }

    #[inline(always)]
    fn highlight(&self, to_light: Vector<L::Quad>) -> Octo<L::Quad> {
        let Shines { blinn, exponents, .. } = &self.shines;
        let mut cosine = self.mirrored.dot(to_light);
        if *blinn != 0 {
            let half = (to_light + self.to_eye).normalized_or(everywhere(DVec3::ZERO));
            cosine = self.normal.dot(half).pick(Choice::of(*blinn), cosine);
        }
        let (zero, one) = (Octo::splat(0.0), Octo::splat(1.0));
        let Exponents::Whole(n) = exponents else { return self.raised_one_by_one(cosine) };
        let (mut result, mut square, mut rest) = (one, cosine.smaller(one), *n);
        while rest > 0 {
            if rest & 1 == 1 {
                result = result * square;
            }
            square = square * square;
            rest >>= 1;
        }
        result.pick(zero.below(cosine), zero)
    }

    #[inline(never)]
    fn raised_one_by_one(&self, cosine: Octo<L::Quad>) -> Octo<L::Quad> {
        let mut values = cosine.store();
        for (lane, value) in values.iter_mut().enumerate() {
            *value = self.shines.exponents.one(lane).raise(*value);
        }
        Octo::load(&values)
    }
}

/// Surfaces where their bits are set, others elsewhere.
#[inline(always)]
fn picked<L: Lanes>(these: &Surfaces, bits: u32, others: &Surfaces) -> Surfaces {
    Surfaces {
        point: picked_rows::<L>(&these.point, bits, &others.point),
        error: picked_rows::<L>(&these.error, bits, &others.error),
        normal: picked_rows::<L>(&these.normal, bits, &others.normal),
        shading: picked_rows::<L>(&these.shading, bits, &others.shading),
    }
}

#[inline(always)]
fn picked_rows<L: Lanes>(these: &Rows, bits: u32, others: &Rows) -> Rows {
    Vector::<L::Quad>::load(these).pick(Choice::of(bits), Vector::load(others)).store()
}

impl Exponents {
    fn one(&self, lane: usize) -> Exponent {
        match self {
            Self::Whole(n) => Exponent::Whole(*n),
            Self::Mixed(each) => each[lane],
        }
    }

    #[inline(always)]
    fn pick(self, bits: u32, other: Self) -> Self {
        match (self, other) {
            (Self::Whole(a), Self::Whole(b)) if a == b => self,
            _ => {
                let mut each = [Exponent::Whole(0); 8];
                for (lane, value) in each.iter_mut().enumerate() {
                    *value = if bits >> lane & 1 == 1 { self.one(lane) } else { other.one(lane) };
                }
                Self::Mixed(each)
            }
        }
    }
}
