//! What formulas can be computed with in any number of lanes: numbers and vectors, each operation rounded by itself.

use super::DVec3;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// An f64, or a row of them.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    fn of(value: f64) -> Self;

    /// `then` where `self` is at least `limit`, otherwise `or`.
    fn at_least(self, limit: f64, then: Self, or: Self) -> Self;

    /// This magnitude with the sign of another number.
    fn with_sign_of(self, sign: Self) -> Self;
}

/// A vector, or a row of them. Operations round as those of `glam` do.
pub trait Vector3:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Self::Real, Output = Self> + Neg<Output = Self>
{
    type Real: Real;

    fn dot(self, other: Self) -> Self::Real;

    fn cross(self, other: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn at_least(self, limit: f64, then: Self, or: Self) -> Self {
        if self >= limit { then } else { or }
    }

    #[inline(always)]
    fn with_sign_of(self, sign: Self) -> Self {
        self.copysign(sign)
    }
}

impl Vector3 for DVec3 {
    type Real = f64;

    #[inline(always)]
    fn dot(self, other: Self) -> f64 {
        self.dot(other)
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        self.cross(other)
    }
}
