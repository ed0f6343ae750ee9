//! Exponents of highlights, and cosines raised to them.

use crate::appearance::material::Exponent;
use crate::base::lanes::{Mask, Real, Row};
use crate::base::math::power;

/// The exponents in all lanes.
#[derive(Clone, Copy)]
pub enum Shininess<F: Real> {
    /// The same whole number in all lanes.
    Whole(u32),
    /// Whole exponents, the lanes that have them, and the exponents of the other lanes.
    Mixed(F::U32, F::Mask, F),
}

impl<F: Real> Shininess<F> {
    /// Gathers the exponents of all lanes.
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

    /// Raises cosines to the exponents. 0⁰ is 0 here: at or beyond a right angle there is no highlight, whatever the
    /// exponent.
    #[inline(always)]
    pub fn raise(&self, cosine: F) -> F {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let base = cosine.max(zero).min(one);
        let raised = match self {
            Self::Whole(n) => power(base, *n),
            Self::Mixed(whole, is_whole, real) => {
                let (bases, exponents, whole) = (base.to_array(), real.to_array(), whole.to_array());
                let (is_whole, mut raised) = (is_whole.bits(), base.to_array());
                for lane in 0..F::LANES {
                    raised[lane] = match is_whole >> lane & 1 == 1 {
                        true => power(bases[lane], whole[lane]),
                        false => libm::pow(bases[lane], exponents[lane]),
                    };
                }
                F::from_array(raised)
            }
        };
        F::select(zero.lt(cosine), raised, zero)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::math::exact::Exact;

    fn raised(cosine: f64, exponent: Exponent) -> f64 {
        Shininess::<f64>::gather(|_| exponent).raise(cosine)
    }

    #[test]
    fn sh_02_highlights_end_at_a_right_angle() {
        assert_eq!(raised(0.0, Exponent::new(0.0)), 0.0);
        assert_eq!(raised(-0.1, Exponent::new(50.5)), 0.0);
        assert_eq!(raised(0.5, Exponent::new(0.0)), 1.0);
        assert_eq!(raised(1.0 + f64::EPSILON, Exponent::new(1e6)), 1.0);
    }

    #[test]
    fn whole_and_real_exponents_agree() {
        for n in [1.0, 2.0, 32.0, 1000.0] {
            let (whole, real) = (raised(0.97, Exponent::new(n)), raised(0.97, Exponent::Real(n)));
            assert!((whole / real - 1.0).abs() < 1e-12, "{n}");
        }
    }

    /// (f) 0.99999^(10^6), against twice the precision: x^n multiplies the rounding error of x by n, and adds no more.
    #[test]
    fn sh_02_sharp_highlights_keep_their_digits() {
        let exact = Exact::from(0.999_99).power(1_000_000).value();
        assert!((exact / 4.539_765_98e-5 - 1.0).abs() < 1e-8);
        let found = raised(0.999_99, Exponent::new(1e6));
        assert!((found / exact - 1.0).abs() <= 1e-9, "{found:e} instead of {exact:e}");
        for (n, cosine) in [(1.0, 0.3), (7.0, 0.9), (1024.0, 0.999), (1025.0, 0.999), (1e7, 0.999_999_9)] {
            let exact = Exact::from(cosine).power(n as u32).value();
            assert!((raised(cosine, Exponent::new(n)) / exact - 1.0).abs() <= 1e-12, "{cosine}^{n}");
        }
    }
}
