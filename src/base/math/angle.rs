//! Angles in degrees, with exact sines and cosines at quarter turns.

use super::DVec2;
use crate::base::time::Fraction;

/// An angle in degrees, the unit of files. In degrees, whole turns are integers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[warn(missing_docs)]
pub struct Angle(pub f64);

#[warn(missing_docs)]
impl Angle {
    /// The angle as an exact remainder in 0..360 degrees.
    pub fn wrapped(self) -> Self {
        let rest = self.0 % 360.0;
        Self(if rest < 0.0 { rest + 360.0 } else { rest })
    }

    /// The angle in radians.
    pub fn radians(self) -> f64 {
        self.0 * (std::f64::consts::PI / 180.0)
    }

    /// The angle of so many radians.
    pub fn from_radians(radians: f64) -> Self {
        Self(radians * (180.0 / std::f64::consts::PI))
    }

    /// `turns` times a fraction, as an angle. It is reduced to one turn before its only rounding.
    pub fn turns(turns: f64, of: Fraction) -> Self {
        Self(360.0 * ((turns * of.num) % of.den / of.den))
    }

    /// Interpolates between two angles: (a·den + (b - a)·num) / den. For whole degrees and turns, results that differ
    /// by whole turns are equal bit for bit after [`Angle::wrapped`], because the remainder by 360·den precedes the
    /// only division.
    pub fn mix(self, other: Self, s: Fraction) -> Self {
        let scaled = self.0 * s.den + (other.0 - self.0) * s.num;
        Self((scaled % (360.0 * s.den)) / s.den)
    }

    /// (cosine, sine). Exact at every quarter turn. Angles that differ by whole turns give the same bits.
    pub fn cos_sin(self) -> DVec2 {
        let degrees = self.wrapped().0;
        // Reduce to -45..=45 degrees around the nearest quarter turn. The subtraction is exact.
        let quarter = (degrees / 90.0 + 0.5).floor();
        let rest = Self(degrees - 90.0 * quarter).radians();
        let (c, s) = (libm::cos(rest), libm::sin(rest));
        match quarter as u32 % 4 {
            0 => DVec2::new(c, s),
            1 => DVec2::new(-s, c),
            2 => DVec2::new(-c, -s),
            _ => DVec2::new(s, -c),
        }
    }

    /// The tangent of half the angle: for a field of view, half the height of the picture at distance 1.
    pub fn half_tangent(self) -> f64 {
        libm::tan(self.radians() * 0.5)
    }
}

impl std::ops::Add for Angle {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let expect = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
        for k in -40..40 {
            let (c, s) = expect[i32::rem_euclid(k, 4) as usize];
            assert_eq!(Angle(f64::from(k) * 90.0).cos_sin(), DVec2::new(c, s), "{k} quarter turns");
        }
    }

    #[test]
    fn agrees_with_the_radian_functions() {
        for k in -7200..7200 {
            let angle = Angle(f64::from(k) * 0.1);
            let exact = DVec2::new(libm::cos(angle.radians()), libm::sin(angle.radians()));
            assert!((angle.cos_sin() - exact).length() < 3e-15, "{angle:?}");
        }
    }

    #[test]
    fn ca_01_keyed_turns_close_bit_for_bit() {
        // 3 turns over 7·3 frames: no binary fraction represents thirds and sevenths.
        let at = |k: u32| {
            let s = Fraction { num: f64::from(k), den: 21.0 };
            Angle(10.0).mix(Angle(10.0 + 3.0 * 360.0), s).cos_sin()
        };
        for k in 0..7 {
            assert_eq!(at(k), at(k + 7));
            assert_eq!(at(k), at(k + 14));
        }
    }
}
