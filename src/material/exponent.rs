//! Highlights: their shape and their exponent.

use crate::digest::content;
use crate::math::power;

/// The shape of the highlight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Highlight {
    /// (R·L)^n with the mirrored line of sight R (Phong 1975).
    #[default]
    Phong,
    /// (N·H)^n with the half vector H between light and eye (Blinn 1977).
    BlinnPhong,
}

content!(
    enum Highlight {
        Phong,
        BlinnPhong,
    }
);

/// The exponent of a highlight, at least 0. Whole numbers are raised by multiplications.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exponent {
    Whole(u32),
    Real(f64),
}

content!(
    enum Exponent {
        Whole(n),
        Real(n),
    }
);

impl Exponent {
    /// The largest whole exponent that is raised by multiplications: up to here a power's relative error
    /// stays below that of the angle's cosine.
    const LARGEST_WHOLE: f64 = 1024.0;

    pub fn new(n: f64) -> Self {
        if n.fract() == 0.0 && (0.0..=Self::LARGEST_WHOLE).contains(&n) {
            Self::Whole(n as u32)
        } else {
            Self::Real(n)
        }
    }

    /// `cosine`^n for a cosine in 0..=1. Zero to the power of zero is zero: there is no highlight at or
    /// beyond a right angle, whatever the exponent.
    pub fn raise(self, cosine: f64) -> f64 {
        if cosine <= 0.0 {
            return 0.0;
        }
        let cosine = cosine.min(1.0);
        match self {
            Self::Whole(n) => power(cosine, n),
            Self::Real(n) => libm::pow(cosine, n),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sh_02_highlights_end_at_a_right_angle() {
        assert_eq!(Exponent::new(0.0).raise(0.0), 0.0);
        assert_eq!(Exponent::new(50.5).raise(-0.1), 0.0);
        assert_eq!(Exponent::new(0.0).raise(0.5), 1.0);
        assert_eq!(Exponent::new(1e6).raise(1.0 + f64::EPSILON), 1.0);
    }

    #[test]
    fn whole_and_real_exponents_agree() {
        for n in [1.0, 2.0, 32.0, 1000.0] {
            let (whole, real) = (Exponent::new(n).raise(0.97), Exponent::Real(n).raise(0.97));
            assert!((whole / real - 1.0).abs() < 1e-12, "{n}");
        }
    }
}
