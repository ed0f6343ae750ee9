//! Double-double numbers of about 106 bits: the unevaluated sum of two f64 (Dekker, *A floating-point technique for
//! extending the available precision*, 1971). The relative error of each operation is a few 2^-104.

use super::DVec3;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `high` + `low`, where `low` is at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug)]
pub struct Exact {
    pub high: f64,
    pub low: f64,
}

/// The sum of two numbers and its rounding error (Knuth).
fn two_sum(a: f64, b: f64) -> Exact {
    let high = a + b;
    let back = high - a;
    Exact { high, low: (a - (high - back)) + (b - back) }
}

/// The product of two numbers and its rounding error (Veltkamp's splitting).
fn two_product(a: f64, b: f64) -> Exact {
    let split = |v: f64| {
        let scaled = 134_217_729.0 * v;
        let high = scaled - (scaled - v);
        (high, v - high)
    };
    let (high, (p, q), (r, s)) = (a * b, split(a), split(b));
    Exact { high, low: ((p * r - high) + p * s + q * r) + q * s }
}

impl Exact {
    pub fn value(self) -> f64 {
        self.high + self.low
    }

    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::from(0.0);
        }
        // A step of Newton's method doubles the number of correct digits.
        let root = Self::from(self.high.sqrt());
        (root + self / root) * Self::from(0.5)
    }

    /// The number to an integer power.
    pub fn power(self, mut exponent: u32) -> Self {
        let (mut result, mut square) = (Self::from(1.0), self);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = result * square;
            }
            square = square * square;
            exponent >>= 1;
        }
        result
    }
}

impl PartialEq for Exact {
    fn eq(&self, other: &Self) -> bool {
        (*self - *other).high == 0.0
    }
}

impl PartialOrd for Exact {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        (*self - *other).high.partial_cmp(&0.0)
    }
}

impl From<f64> for Exact {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for Exact {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (sum, rest) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let sum = two_sum(sum.high, sum.low + rest.high);
        two_sum(sum.high, sum.low + rest.low)
    }
}

impl Neg for Exact {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Exact {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Exact {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Exact {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        two_sum(first, second) + Self::from(rest.high / other.high)
    }
}

/// A vector of double-double numbers.
#[derive(Clone, Copy, Debug)]
pub struct Vector(pub [Exact; 3]);

impl From<DVec3> for Vector {
    fn from(v: DVec3) -> Self {
        Self(v.to_array().map(Exact::from))
    }
}

impl Vector {
    pub fn dot(self, other: Self) -> Exact {
        let [a, b, c] = [0, 1, 2].map(|i| self.0[i] * other.0[i]);
        a + b + c
    }

    pub fn cross(self, other: Self) -> Self {
        let part = |i: usize, j: usize| self.0[i] * other.0[j] - self.0[j] * other.0[i];
        Self([part(1, 2), part(2, 0), part(0, 1)])
    }

    pub fn length(self) -> Exact {
        self.dot(self).sqrt()
    }

    pub fn scaled(self, by: Exact) -> Self {
        Self(self.0.map(|part| part * by))
    }

    pub fn value(self) -> DVec3 {
        DVec3::from_array(self.0.map(Exact::value))
    }
}

impl Add for Vector {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self([0, 1, 2].map(|i| self.0[i] + other.0[i]))
    }
}

impl Sub for Vector {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self([0, 1, 2].map(|i| self.0[i] - other.0[i]))
    }
}

/// The intersection of a line with a sphere.
pub struct SphereChord {
    /// Distance of the line from the centre.
    pub nearest: Exact,
    /// The line parameters of both intersections; `None` if the line misses the sphere.
    pub roots: Option<[Exact; 2]>,
}

/// Intersects a line with a sphere, measured from the line's point closest to the centre.
pub fn sphere_chord(center: DVec3, radius: f64, origin: DVec3, direction: DVec3) -> SphereChord {
    let (from, d) = (Vector::from(origin) - Vector::from(center), Vector::from(direction));
    let square = d.dot(d);
    let closest = -(from.dot(d) / square);
    let nearest = (from + d.scaled(closest)).length();
    let radius = Exact::from(radius);
    let rest = (radius - nearest) * (radius + nearest) / square;
    let roots = (rest.high >= 0.0).then(|| {
        let half = rest.sqrt();
        [closest - half, closest + half]
    });
    SphereChord { nearest, roots }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_sums_quotients_and_roots_have_their_digits() {
        let third = Exact::from(1.0) / Exact::from(3.0);
        let off = third * Exact::from(3.0) - Exact::from(1.0);
        assert!(off.value().abs() < 1e-31, "{off:?}");
        let two = Exact::from(2.0);
        assert!((two.sqrt() * two.sqrt() - two).value().abs() < 1e-31);
        // (1 + e)(1 - e) = 1 - e² for e = 2^-52.
        let e = f64::EPSILON;
        assert_eq!((Exact::from(1.0 + e) * Exact::from(1.0 - e) - Exact::from(1.0)).value(), -e * e);
        // The tenth power of the f64 nearest to 1.1, computed with integers.
        let known = Exact { high: 2.593_742_460_100_002_4, low: 0.0 };
        assert!((Exact::from(1.1).power(10) - known).value().abs() < 1e-15);
    }
}
