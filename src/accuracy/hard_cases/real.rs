//! Numbers of any precision, so that a formula is written once and tried in f32, in f64 and in twice that.

use crate::accuracy::exact::Exact;
use crate::base::math::DVec3;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number with the operations that every precision rounds correctly, or nearly so.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The number nearest to an f64.
    fn of(value: f64) -> Self;

    /// The f64 nearest to the number.
    fn wide(self) -> f64;

    /// The square root.
    fn root(self) -> Self;

    fn zero() -> Self {
        Self::of(0.0)
    }

    fn one() -> Self {
        Self::of(1.0)
    }

    fn absolute(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }

    fn larger(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    fn smaller(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
}

impl Real for Exact {
    fn of(value: f64) -> Self {
        Self::from(value)
    }

    fn wide(self) -> f64 {
        self.value()
    }

    fn root(self) -> Self {
        self.sqrt()
    }
}

/// A number that computers have.
pub trait Machine: Real {
    /// Half the distance from 1 to the next number.
    const ROUNDOFF: f64;

    fn sine(self) -> Self;
    fn cosine(self) -> Self;
    fn arc_cosine(self) -> Self;
    fn arc_tangent(y: Self, x: Self) -> Self;
    fn exponential(self) -> Self;
    /// exp(x) - 1.
    fn growth(self) -> Self;
    fn cube_root(self) -> Self;
    fn whole_part(self) -> Self;
    /// The next number in the direction of another one's sign.
    fn next_towards(self, sign: Self) -> Self;
}

macro_rules! machine {
    ($number:ty, $sin:path, $cos:path, $acos:path, $atan2:path, $exp:path, $expm1:path, $cbrt:path) => {
        impl Real for $number {
            #[inline]
            fn of(value: f64) -> Self {
                value as Self
            }

            #[inline]
            fn wide(self) -> f64 {
                f64::from(self)
            }

            #[inline]
            fn root(self) -> Self {
                self.sqrt()
            }
        }

        impl Machine for $number {
            const ROUNDOFF: f64 = <$number>::EPSILON as f64 / 2.0;

            fn sine(self) -> Self {
                $sin(self)
            }

            fn cosine(self) -> Self {
                $cos(self)
            }

            fn arc_cosine(self) -> Self {
                $acos(self)
            }

            fn arc_tangent(y: Self, x: Self) -> Self {
                $atan2(y, x)
            }

            fn exponential(self) -> Self {
                $exp(self)
            }

            fn growth(self) -> Self {
                $expm1(self)
            }

            fn cube_root(self) -> Self {
                $cbrt(self)
            }

            fn whole_part(self) -> Self {
                self.floor()
            }

            fn next_towards(self, sign: Self) -> Self {
                if sign > 0.0 {
                    self.next_up()
                } else if sign < 0.0 {
                    self.next_down()
                } else {
                    self
                }
            }
        }
    };
}

machine!(f32, libm::sinf, libm::cosf, libm::acosf, libm::atan2f, libm::expf, libm::expm1f, libm::cbrtf);
machine!(f64, libm::sin, libm::cos, libm::acos, libm::atan2, libm::exp, libm::expm1, libm::cbrt);

/// A vector.
#[derive(Clone, Copy, Debug)]
pub struct V<R>(pub [R; 3]);

impl<R: Real> V<R> {
    pub fn of(v: DVec3) -> Self {
        Self(v.to_array().map(R::of))
    }

    pub fn wide(self) -> DVec3 {
        DVec3::from_array(self.0.map(R::wide))
    }

    /// The same numbers in another precision.
    pub fn to<S: Real>(self) -> V<S> {
        V(self.0.map(|part| S::of(part.wide())))
    }

    #[inline]
    pub fn dot(self, other: Self) -> R {
        self.0[0] * other.0[0] + self.0[1] * other.0[1] + self.0[2] * other.0[2]
    }

    #[inline]
    pub fn cross(self, other: Self) -> Self {
        let part = |i: usize, j: usize| self.0[i] * other.0[j] - self.0[j] * other.0[i];
        Self([part(1, 2), part(2, 0), part(0, 1)])
    }

    #[inline]
    pub fn length(self) -> R {
        self.dot(self).root()
    }

    #[inline]
    pub fn unit(self) -> Self {
        self * (R::one() / self.length())
    }
}

impl<R: Real> Add for V<R> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1], self.0[2] + other.0[2]])
    }
}

impl<R: Real> Sub for V<R> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self([self.0[0] - other.0[0], self.0[1] - other.0[1], self.0[2] - other.0[2]])
    }
}

impl<R: Real> Mul<R> for V<R> {
    type Output = Self;

    #[inline]
    fn mul(self, by: R) -> Self {
        Self([self.0[0] * by, self.0[1] * by, self.0[2] * by])
    }
}
