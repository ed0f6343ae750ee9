//! Highlights: their shape and their exponent.

use crate::base::digest::Content;

/// The formula of the highlight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Content)]
pub enum Highlight {
    /// (R·L)^n, with the mirrored line of sight R (Phong 1975).
    #[default]
    Phong,
    /// (N·H)^n, with the half vector H between light and eye (Blinn 1977).
    BlinnPhong,
}

/// The exponent of a highlight, at least 0. Powers of whole exponents use multiplications.
#[derive(Clone, Copy, Debug, PartialEq, Content)]
pub enum Exponent {
    Whole(u32),
    Real(f64),
}

impl Exponent {
    /// The largest whole exponent that uses multiplications. Up to here, the relative error of a power stays below that
    /// of the cosine.
    const LARGEST_WHOLE: f64 = 1024.0;

    pub fn new(n: f64) -> Self {
        if n.fract() == 0.0 && (0.0..=Self::LARGEST_WHOLE).contains(&n) {
            Self::Whole(n as u32)
        } else {
            Self::Real(n)
        }
    }
}
