//! Sampling of the BSDF: chooses a lobe in proportion to its strength, then a direction of that lobe.

use super::glossy::GlossySample;
use super::{Boundary, Bsdf};
use crate::base::lanes::{Color, Mask, Real, Row, Select, Single, Vec3};
use crate::trace::materials::LobeSet;
use std::f64::consts::PI;

/// The probability of each lobe; 0 if it is absent.
#[derive(Clone, Copy)]
pub struct LobeProbabilities<F> {
    diffuse: F,
    /// The boundary of a metallic-roughness surface.
    glossy: F,
    /// The clear coat.
    coat: F,
    mirror: F,
    transparent: F,
    refracted: F,
}

/// Sampled directions.
#[derive(Clone, Copy)]
pub struct BsdfSample<F: Real> {
    /// Unit vector.
    pub direction: Vec3<F>,
    /// Factors of the path's throughput, by lobes that are diffuse and by the others.
    pub diffuse: Color<F::F32>,
    pub specular: Color<F::F32>,
    /// The density per steradian of the direction over all lobes that may give it. It is 0 for a delta distribution.
    pub pdf: F,
    /// Lanes whose lobe has a density.
    pub is_scattered: F::Mask,
    /// Lanes whose lobe is a delta distribution: mirrored, transmitted straight on, or refracted.
    pub is_mirrored: F::Mask,
    pub is_transmitted: F::Mask,
    pub is_refracted: F::Mask,
}

impl<F: Real> BsdfSample<F> {
    /// Lanes whose paths continue.
    #[inline(always)]
    pub fn continues(&self) -> F::Mask {
        self.is_scattered | self.is_mirrored | self.is_transmitted | self.is_refracted
    }
}

impl<F: Real> Bsdf<'_, F> {
    #[inline(always)]
    pub fn probabilities(&self) -> LobeProbabilities<F> {
        let zero = F::splat(0.0);
        let (mut diffuse, mut glossy, mut coat) = (zero, zero, zero);
        if self.lobes.has(LobeSet::DIFFUSE) {
            diffuse = strength::<F>(self.diffuse);
        }
        if self.lobes.has(LobeSet::MICROFACET) {
            let fresnel = self.metallic.fresnel(self.normal.dot(self.to_eye));
            diffuse = diffuse + strength::<F>(self.metallic.below() * self.metallic.strength);
            glossy = strength::<F>(fresnel * self.metallic.strength);
        }
        if self.lobes.has(LobeSet::COAT) {
            coat = (F::F32::splat(1.0) - self.coat.passed(self.normal.dot(self.to_eye))).to_f64();
        }
        let (mirror, transparent) = (strength::<F>(self.mirror), strength::<F>(self.transparency));
        let refracted = strength::<F>(self.refraction);
        let sum = diffuse + glossy + coat + mirror + transparent + refracted;
        let per_sum = F::select(zero.lt(sum), F::splat(1.0) / sum, zero);
        LobeProbabilities {
            diffuse: diffuse * per_sum,
            glossy: glossy * per_sum,
            coat: coat * per_sum,
            mirror: mirror * per_sum,
            transparent: transparent * per_sum,
            refracted: refracted * per_sum,
        }
    }

    /// The density per steradian of [`Bsdf::sample`], without delta distributions.
    #[inline(always)]
    pub fn pdf(&self, probabilities: &LobeProbabilities<F>, direction: Vec3<F>) -> F {
        let mut pdf = F::splat(0.0);
        if self.lobes.has(LobeSet::DIFFUSE | LobeSet::MICROFACET) {
            pdf = probabilities.diffuse * self.diffuse_pdf(direction);
        }
        if self.lobes.has(LobeSet::MICROFACET) {
            pdf = pdf + probabilities.glossy * self.metallic.pdf(self.to_eye, &self.frame, direction);
        }
        if self.lobes.has(LobeSet::COAT) {
            pdf = pdf + probabilities.coat * self.coat.pdf(self.to_eye, &self.frame, direction);
        }
        if self.lobes.has(LobeSet::FUZZ) {
            pdf = pdf + probabilities.mirror * self.fuzzy_pdf(direction);
        }
        pdf
    }

    /// Samples directions from four numbers in 0..1. `u` and `v` choose the direction, `choice` the lobe, and `w` is
    /// the third number of fuzzy mirrors.
    #[inline(always)]
    pub fn sample(&self, boundary: &Boundary<F>, [u, v, choice, w]: [F; 4]) -> BsdfSample<F> {
        let (zero, no) = (F::splat(0.0), F::Mask::splat(false));
        let probabilities = self.probabilities();
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
            let chosen = take(&mut rest, &mut left, probabilities.diffuse);
            sample.direction = Vec3::select(chosen, self.diffuse_sample(u, v), sample.direction);
            sample.is_scattered = chosen;
        }
        if self.lobes.has(LobeSet::MICROFACET) {
            let chosen = take(&mut rest, &mut left, probabilities.glossy);
            sample.reflect(self, chosen, &self.glossy_sample(u, v), probabilities.glossy);
        }
        if self.lobes.has(LobeSet::COAT) {
            let chosen = take(&mut rest, &mut left, probabilities.coat);
            sample.reflect(self, chosen, &self.coat_sample(u, v), probabilities.coat);
        }
        if self.lobes.has(LobeSet::MIRROR) {
            let chosen = take(&mut rest, &mut left, probabilities.mirror);
            let mut sharp = chosen;
            if self.lobes.has(LobeSet::FUZZ) {
                let fuzzy = chosen & self.is_fuzzy();
                sample.direction = Vec3::select(fuzzy, self.fuzzy_sample([u, v, w]), sample.direction);
                sample.is_scattered = sample.is_scattered | fuzzy;
                sharp = chosen & !fuzzy;
            }
            sample.mirror(self, sharp, self.mirror / probabilities.mirror.to_f32());
        }
        if self.lobes.has(LobeSet::TRANSPARENT) {
            let chosen = take(&mut rest, &mut left, probabilities.transparent);
            let share = self.transparency / probabilities.transparent.to_f32();
            sample.direction = Vec3::select(chosen, -self.to_eye, sample.direction);
            sample.specular = Color::select(chosen, share, sample.specular);
            sample.is_transmitted = chosen;
        }
        if self.refracts() {
            // The last lobe also gets what rounding has left over.
            let chosen = left & zero.lt(probabilities.refracted);
            let met = self.boundary_sample(boundary, rest / probabilities.refracted);
            let share = met.share / probabilities.refracted.to_f32();
            let passes = chosen & met.passes;
            sample.direction = Vec3::select(passes, met.direction, sample.direction);
            sample.specular = Color::select(passes, share, sample.specular);
            sample.is_refracted = passes;
            sample.mirror(self, chosen & !met.passes, share);
        }
        if self.lobes.has(LobeSet::SAMPLED) {
            self.weigh(&probabilities, &mut sample);
        }
        sample
    }

    /// Divides by the density of all lobes if several may give the direction.
    #[inline(always)]
    fn weigh(&self, probabilities: &LobeProbabilities<F>, sample: &mut BsdfSample<F>) {
        let zero = F::splat(0.0);
        let pdf = self.pdf(probabilities, sample.direction);
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
    /// Sets a reflection at a microfacet in the lanes of a mask, or the ideal reflection where the surface is smooth.
    #[inline(always)]
    fn reflect(&mut self, bsdf: &Bsdf<F>, mask: F::Mask, drawn: &GlossySample<F>, probability: F) {
        self.direction = Vec3::select(mask, drawn.direction, self.direction);
        self.is_scattered = self.is_scattered | (mask & !drawn.is_smooth & drawn.is_drawn);
        self.mirror(bsdf, mask & drawn.is_smooth, drawn.share / probability.to_f32());
    }

    /// Sets the ideal reflection in the lanes of a mask.
    #[inline(always)]
    fn mirror(&mut self, bsdf: &Bsdf<F>, mask: F::Mask, share: Color<F::F32>) {
        self.direction = Vec3::select(mask, bsdf.mirrored(), self.direction);
        self.specular = Color::select(mask, share, self.specular);
        self.is_mirrored = self.is_mirrored | mask;
    }
}

/// Chooses a lobe in the lanes whose number is below its probability. Rescales the numbers of both groups, so that they
/// are uniform again.
#[inline(always)]
fn take<F: Real>(rest: &mut F, left: &mut F::Mask, probability: F) -> F::Mask {
    let chosen = *left & rest.lt(probability);
    *rest = F::select(chosen, *rest / probability, *rest - probability);
    *left = *left & !chosen;
    chosen
}

/// The weight of a lobe in the choice.
#[inline(always)]
fn strength<F: Real>(color: Color<F::F32>) -> F {
    color.max_element().to_f64()
}
