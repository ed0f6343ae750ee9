//! Where a path goes on from a surface: one lobe is drawn by its strength, then a direction in it.

use super::{Boundary, Bsdf};
use crate::base::lanes::{Color, Mask, Real, Row, Select, Single, Vec3};
use crate::trace::materials::LobeSet;
use std::f64::consts::PI;

/// The probabilities with which lobes are drawn; 0 for those that are absent.
#[derive(Clone, Copy)]
pub struct LobeChances<F> {
    diffuse: F,
    /// The boundary of a metallic-roughness surface.
    glossy: F,
    mirror: F,
    transparent: F,
    refracted: F,
}

/// How paths go on.
#[derive(Clone, Copy)]
pub struct BsdfSample<F: Real> {
    /// Unit vector.
    pub direction: Vec3<F>,
    /// What the path's throughput is multiplied with, for what diffuse lobes gather and for what others show.
    pub diffuse: Color<F::F32>,
    pub specular: Color<F::F32>,
    /// Density per steradian of the direction, by all lobes that may give it; 0 where there was no choice.
    pub pdf: F,
    /// Lanes in which it is drawn from a lobe with a density.
    pub is_scattered: F::Mask,
    /// In which there was one direction: a mirror's, straight on, or bent.
    pub is_mirrored: F::Mask,
    pub is_transmitted: F::Mask,
    pub is_refracted: F::Mask,
}

impl<F: Real> BsdfSample<F> {
    /// Lanes whose paths go on.
    #[inline(always)]
    pub fn goes_on(&self) -> F::Mask {
        self.is_scattered | self.is_mirrored | self.is_transmitted | self.is_refracted
    }
}

impl<F: Real> Bsdf<'_, F> {
    #[inline(always)]
    pub fn chances(&self) -> LobeChances<F> {
        let zero = F::splat(0.0);
        let (mut diffuse, mut glossy) = (zero, zero);
        if self.lobes.has(LobeSet::DIFFUSE) {
            diffuse = strength::<F>(self.diffuse);
        }
        if self.lobes.has(LobeSet::MICROFACET) {
            let fresnel = self.metallic.fresnel(self.normal.dot(self.to_eye));
            diffuse = diffuse + strength::<F>(self.metallic.below() * self.metallic.strength);
            glossy = strength::<F>(fresnel * self.metallic.strength);
        }
        let (mirror, transparent) = (strength::<F>(self.mirror), strength::<F>(self.transparency));
        let refracted = strength::<F>(self.refraction);
        let sum = diffuse + glossy + mirror + transparent + refracted;
        let per_sum = F::select(zero.lt(sum), F::splat(1.0) / sum, zero);
        LobeChances {
            diffuse: diffuse * per_sum,
            glossy: glossy * per_sum,
            mirror: mirror * per_sum,
            transparent: transparent * per_sum,
            refracted: refracted * per_sum,
        }
    }

    /// The density per steradian with which [`Bsdf::sample`] gives a direction, but for those without a choice.
    #[inline(always)]
    pub fn pdf(&self, chances: &LobeChances<F>, direction: Vec3<F>) -> F {
        let mut pdf = F::splat(0.0);
        if self.lobes.has(LobeSet::DIFFUSE | LobeSet::MICROFACET) {
            pdf = chances.diffuse * self.diffuse_pdf(direction);
        }
        if self.lobes.has(LobeSet::MICROFACET) {
            pdf = pdf + chances.glossy * self.metallic.pdf(self.to_eye, &self.frame, direction);
        }
        if self.lobes.has(LobeSet::FUZZ) {
            pdf = pdf + chances.mirror * self.fuzzy_pdf(direction);
        }
        pdf
    }

    /// The next directions, for four numbers in 0..1: the first two are for the direction, the third for the lobe.
    #[inline(always)]
    pub fn sample(&self, boundary: &Boundary<F>, [u, v, choice, w]: [F; 4]) -> BsdfSample<F> {
        let (zero, no) = (F::splat(0.0), F::Mask::splat(false));
        let chances = self.chances();
        let mut sample = BsdfSample {
            direction: self.to_eye,
            diffuse: Color::black(),
            specular: Color::black(),
            pdf: zero,
            is_scattered: no,
            is_mirrored: no,
            is_transmitted: no,
            is_refracted: no,
        };
        let (mut rest, mut left) = (choice, F::Mask::splat(true));
        if self.lobes.has(LobeSet::DIFFUSE | LobeSet::MICROFACET) {
            let falls = take(&mut rest, &mut left, chances.diffuse);
            sample.direction = Vec3::select(falls, self.diffuse_sample(u, v), sample.direction);
            sample.is_scattered = falls;
        }
        if self.lobes.has(LobeSet::MICROFACET) {
            let falls = take(&mut rest, &mut left, chances.glossy);
            let drawn = self.glossy_sample(u, v);
            sample.direction = Vec3::select(falls, drawn.direction, sample.direction);
            sample.is_scattered = sample.is_scattered | (falls & !drawn.is_smooth & drawn.is_drawn);
            sample.mirror(self, falls & drawn.is_smooth, drawn.share / chances.glossy.to_f32());
        }
        if self.lobes.has(LobeSet::MIRROR) {
            let falls = take(&mut rest, &mut left, chances.mirror);
            let mut sharp = falls;
            if self.lobes.has(LobeSet::FUZZ) {
                let fuzzy = falls & self.is_fuzzy();
                sample.direction = Vec3::select(fuzzy, self.fuzzy_sample([u, v, w]), sample.direction);
                sample.is_scattered = sample.is_scattered | fuzzy;
                sharp = falls & !fuzzy;
            }
            sample.mirror(self, sharp, self.mirror / chances.mirror.to_f32());
        }
        if self.lobes.has(LobeSet::TRANSPARENT) {
            let falls = take(&mut rest, &mut left, chances.transparent);
            let share = self.transparency / chances.transparent.to_f32();
            sample.direction = Vec3::select(falls, -self.to_eye, sample.direction);
            sample.specular = Color::select(falls, share, sample.specular);
            sample.is_transmitted = falls;
        }
        if self.refracts() {
            // What rounding leaves over falls to the last lobe.
            let falls = left & zero.lt(chances.refracted);
            let met = self.boundary_sample(boundary, rest / chances.refracted);
            let share = met.share / chances.refracted.to_f32();
            let passes = falls & met.passes;
            sample.direction = Vec3::select(passes, met.direction, sample.direction);
            sample.specular = Color::select(passes, share, sample.specular);
            sample.is_refracted = passes;
            sample.mirror(self, falls & !met.passes, share);
        }
        if self.lobes.has(LobeSet::DIFFUSE | LobeSet::MICROFACET | LobeSet::FUZZ) {
            self.weigh(&chances, &mut sample);
        }
        sample
    }

    /// Weighs directions that more than one lobe may have given by all of them.
    #[inline(always)]
    fn weigh(&self, chances: &LobeChances<F>, sample: &mut BsdfSample<F>) {
        let zero = F::splat(0.0);
        let pdf = self.pdf(chances, sample.direction);
        let reflected = self.reflected(sample.direction);
        let seen = reflected.scattered(F::F32::splat(1.0)).is_lit();
        let drawn = sample.is_scattered & zero.lt(pdf) & seen;
        let each = (F::splat(1.0) / (F::splat(PI) * pdf)).to_f32();
        sample.diffuse = Color::select(drawn, reflected.diffuse * each, sample.diffuse);
        sample.specular = Color::select(drawn, reflected.glossy * each, sample.specular);
        sample.pdf = F::select(drawn, pdf, zero);
        sample.is_scattered = drawn;
    }
}

impl<F: Real> BsdfSample<F> {
    /// A mirror's reflection in the lanes of a mask.
    #[inline(always)]
    fn mirror(&mut self, bsdf: &Bsdf<F>, mask: F::Mask, share: Color<F::F32>) {
        self.direction = Vec3::select(mask, bsdf.mirrored(), self.direction);
        self.specular = Color::select(mask, share, self.specular);
        self.is_mirrored = self.is_mirrored | mask;
    }
}

/// Which of the numbers that are left fall to a lobe: what is left of them is uniform again.
#[inline(always)]
fn take<F: Real>(rest: &mut F, left: &mut F::Mask, chance: F) -> F::Mask {
    let falls = *left & rest.lt(chance);
    *rest = F::select(falls, *rest / chance, *rest - chance);
    *left = *left & !falls;
    falls
}

/// By what lobes are drawn.
#[inline(always)]
fn strength<F: Real>(color: Color<F::F32>) -> F {
    color.max_element().to_f64()
}
