//! Highlights of lights: Phong's and Blinn's.

use super::Bsdf;
use crate::lanes::{Color, Mask, Real, Row, Vec3};
use crate::material::Exponent;
use crate::math::DVec3;
use crate::trace::materials::LobeSet;

/// The exponents of highlights.
#[derive(Clone, Copy)]
pub enum Shininess<F: Real> {
    /// The same whole number in all lanes.
    Whole(u32),
    /// Whole numbers, and which lanes have them; and the exponents of the others.
    Mixed(F::U32, F::Mask, F),
}

impl<F: Real> Shininess<F> {
    /// Of all lanes; there is at least one.
    #[inline(always)]
    pub fn gather(exponents: impl Fn(usize) -> Exponent) -> Self {
        let first = exponents(0);
        let mut uniform = matches!(first, Exponent::Whole(_));
        for lane in 1..F::LANES {
            uniform &= exponents(lane) == first;
        }
        if let Exponent::Whole(n) = first
            && uniform
        {
            return Self::Whole(n);
        }
        let (mut whole, mut real, mut bits) = (F::U32::splat(0).to_array(), F::splat(0.0).to_array(), 0);
        for lane in 0..F::LANES {
            match exponents(lane) {
                Exponent::Whole(n) => (whole[lane], bits) = (n, bits | 1 << lane),
                Exponent::Real(n) => real[lane] = n,
            }
        }
        Self::Mixed(F::U32::from_array(whole), F::Mask::from_bits(bits), F::from_array(real))
    }

    /// Cosines raised to the exponents. Zero to the power of zero is zero: there is no highlight at or beyond a right
    /// angle, whatever the exponent.
    #[inline(always)]
    fn raise(&self, cosine: F) -> F {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let base = cosine.max(zero).min(one);
        let raised = match self {
            Self::Whole(n) => raise_by(base, *n),
            Self::Mixed(whole, is_whole, real) => {
                let (bases, exponents, whole) = (base.to_array(), real.to_array(), whole.to_array());
                let (is_whole, mut raised) = (is_whole.bits(), base.to_array());
                for lane in 0..F::LANES {
                    raised[lane] = match is_whole >> lane & 1 == 1 {
                        true => raise_by(bases[lane], whole[lane]),
                        false => libm::pow(bases[lane], exponents[lane]),
                    };
                }
                F::from_array(raised)
            }
        };
        F::select(zero.lt(cosine), raised, zero)
    }
}

/// Powers by repeated squaring, in the order of [`crate::math::power`].
#[inline(always)]
fn raise_by<F: Real>(base: F, exponent: u32) -> F {
    let (mut result, mut square, mut rest) = (F::splat(1.0), base, exponent);
    while rest > 0 {
        if rest & 1 == 1 {
            result = result * square;
        }
        square = square * square;
        rest >>= 1;
    }
    result
}

impl<F: Real> Bsdf<'_, F> {
    /// The highlight that a light in a direction has, where it is lit.
    #[inline(always)]
    pub(super) fn highlight(&self, to_light: Vec3<F>) -> Color<F::F32> {
        let cosine = match self.lobes.has(LobeSet::PHONG) {
            true => self.mirrored().dot(to_light),
            false => self.normal.dot((to_light + self.to_eye).normalize_or(Vec3::splat(DVec3::ZERO))),
        };
        self.specular * self.shininess.raise(cosine).to_f32()
    }
}
