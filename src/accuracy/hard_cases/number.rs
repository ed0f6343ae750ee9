//! Numbers of any precision, so that a formula is written once and evaluated in f32, in f64 and in double-double
//! arithmetic.

use crate::base::math::DVec3;
use crate::base::math::exact::Exact;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number with the operations that every precision rounds correctly, or almost so.
pub trait Number:
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
    fn sqrt(self) -> Self;

    fn zero() -> Self {
        Self::of(0.0)
    }

    fn one() -> Self {
        Self::of(1.0)
    }

    fn abs(self) -> Self {
        if self < Self::zero() { -self } else { self }
    }

    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
}

impl Number for Exact {
    fn of(value: f64) -> Self {
        Self::from(value)
    }

    fn wide(self) -> f64 {
        self.value()
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }
}

/// A floating-point number of the processor: f32 or f64.
pub trait Float: Number {
    /// Half the distance from 1 to the next number.
    const ROUNDOFF: f64;

    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn acos(self) -> Self;
    fn exp(self) -> Self;
    fn cbrt(self) -> Self;
    fn floor(self) -> Self;
    /// The next number in the direction of the sign of another number.
    fn next_towards(self, sign: Self) -> Self;
}

macro_rules! float {
    ($number:ty, $sin:path, $cos:path, $acos:path, $exp:path, $cbrt:path) => {
        impl Number for $number {
            #[inline]
            fn of(value: f64) -> Self {
                value as Self
            }

            #[inline]
            fn wide(self) -> f64 {
                f64::from(self)
            }

            #[inline]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
        }

        impl Float for $number {
            const ROUNDOFF: f64 = <$number>::EPSILON as f64 / 2.0;

            fn sin(self) -> Self {
                $sin(self)
            }

            fn cos(self) -> Self {
                $cos(self)
            }

            fn acos(self) -> Self {
                $acos(self)
            }

            fn exp(self) -> Self {
                $exp(self)
            }

            fn cbrt(self) -> Self {
                $cbrt(self)
            }

            fn floor(self) -> Self {
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

float!(f32, libm::sinf, libm::cosf, libm::acosf, libm::expf, libm::cbrtf);
float!(f64, libm::sin, libm::cos, libm::acos, libm::exp, libm::cbrt);

/// A vector.
#[derive(Clone, Copy, Debug)]
pub struct Vector3<R>(pub [R; 3]);

impl<R: Number> Vector3<R> {
    pub fn of(v: DVec3) -> Self {
        Self(v.to_array().map(R::of))
    }

    pub fn wide(self) -> DVec3 {
        DVec3::from_array(self.0.map(R::wide))
    }

    /// The same numbers in another precision.
    pub fn to<S: Number>(self) -> Vector3<S> {
        Vector3(self.0.map(|part| S::of(part.wide())))
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
        self.dot(self).sqrt()
    }

    #[inline]
    pub fn unit(self) -> Self {
        self * (R::one() / self.length())
    }
}

impl<R: Number> Add for Vector3<R> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1], self.0[2] + other.0[2]])
    }
}

impl<R: Number> Sub for Vector3<R> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self([self.0[0] - other.0[0], self.0[1] - other.0[1], self.0[2] - other.0[2]])
    }
}

impl<R: Number> Mul<R> for Vector3<R> {
    type Output = Self;

    #[inline]
    fn mul(self, by: R) -> Self {
        Self([self.0[0] * by, self.0[1] * by, self.0[2] * by])
    }
}
