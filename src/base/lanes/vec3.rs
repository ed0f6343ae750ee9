//! Vectors in lanes.

use super::{Lookup, Mask, Real, Row, Select};
use glam::{DMat3, DVec3};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// One vector per lane. The operations have the same order as those of glam's `DVec3`, so they round alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<F> {
    pub x: F,
    pub y: F,
    pub z: F,
}

impl From<DVec3> for Vec3<f64> {
    #[inline(always)]
    fn from(v: DVec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vec3<f64>> for DVec3 {
    #[inline(always)]
    fn from(v: Vec3<f64>) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl<F> Vec3<F> {
    #[inline(always)]
    pub fn new(x: F, y: F, z: F) -> Self {
        Self { x, y, z }
    }
}

impl<F: Real> Vec3<F> {
    #[inline(always)]
    pub fn splat(v: DVec3) -> Self {
        Self { x: F::splat(v.x), y: F::splat(v.y), z: F::splat(v.z) }
    }

    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(DVec3::ZERO)
    }

    /// The vector of one lane. It stores all lanes, so store once if many lanes are needed.
    #[inline(always)]
    pub fn lane(self, lane: usize) -> DVec3 {
        DVec3::new(self.x.to_array()[lane], self.y.to_array()[lane], self.z.to_array()[lane])
    }

    /// The vectors of eight lanes. Missing lanes repeat the last one.
    #[inline(always)]
    pub fn store(self) -> [DVec3; 8] {
        let (x, y, z) = (self.x.to_array(), self.y.to_array(), self.z.to_array());
        let mut all = [DVec3::ZERO; 8];
        for (lane, v) in all.iter_mut().enumerate() {
            let lane = lane.min(F::LANES - 1);
            *v = DVec3::new(x[lane], y[lane], z[lane]);
        }
        all
    }

    /// Vectors from three lists of coordinates.
    #[inline(always)]
    pub fn gather(from: [&[f64]; 3], at: &Lookup) -> Self {
        Self { x: F::gather(from[0], at), y: F::gather(from[1], at), z: F::gather(from[2], at) }
    }

    #[inline(always)]
    pub fn dot(self, other: Self) -> F {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - other.y * self.z,
            y: self.z * other.x - other.z * self.x,
            z: self.x * other.y - other.x * self.y,
        }
    }

    #[inline(always)]
    pub fn length_squared(self) -> F {
        self.dot(self)
    }

    #[inline(always)]
    pub fn length(self) -> F {
        self.dot(self).sqrt()
    }

    #[inline(always)]
    pub fn abs(self) -> Self {
        Self { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }
    }

    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self { x: self.x.max(other.x), y: self.y.max(other.y), z: self.z.max(other.z) }
    }

    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self { x: self.x.min(other.x), y: self.y.min(other.y), z: self.z.min(other.z) }
    }

    /// The largest coordinate.
    #[inline(always)]
    pub fn max_element(self) -> F {
        self.x.max(self.y).max(self.z)
    }

    #[inline(always)]
    pub fn mul_each(self, other: Self) -> Self {
        Self { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }

    /// The vector at length 1. A zero vector becomes NaN.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * (F::splat(1.0) / self.length())
    }

    /// The vector at length 1, or `other` in lanes whose vector has no direction.
    #[inline(always)]
    pub fn normalize_or(self, other: Self) -> Self {
        let per_length = F::splat(1.0) / self.length();
        let sound = F::splat(0.0).lt(per_length) & per_length.lt(F::splat(f64::INFINITY));
        Self::select(sound, self * per_length, other)
    }

    /// The lanes in which all coordinates are equal.
    #[inline(always)]
    pub fn eq(self, other: Self) -> F::Mask {
        self.x.eq(other.x) & self.y.eq(other.y) & self.z.eq(other.z)
    }

    /// The lanes in which a coordinate is not zero.
    #[inline(always)]
    pub fn is_not_zero(self) -> F::Mask {
        !self.eq(Self::zero())
    }

    /// The vectors, negated in the lanes of a mask.
    #[inline(always)]
    pub fn negate_where(self, mask: F::Mask) -> Self {
        Self::select(mask, -self, self)
    }
}

/// Multiplies a matrix and vectors, in glam's order of operations.
#[inline(always)]
pub fn transform_vector<F: Real>(matrix: &DMat3, v: Vec3<F>) -> Vec3<F> {
    Vec3::splat(matrix.x_axis) * v.x + Vec3::splat(matrix.y_axis) * v.y + Vec3::splat(matrix.z_axis) * v.z
}

impl<M: Mask, F: Row<Mask = M>> Select<M> for Vec3<F> {
    #[inline(always)]
    fn select(mask: M, yes: Self, no: Self) -> Self {
        Self {
            x: F::select(mask, yes.x, no.x),
            y: F::select(mask, yes.y, no.y),
            z: F::select(mask, yes.z, no.z),
        }
    }
}

impl<F: Real> Add for Vec3<F> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<F: Real> Sub for Vec3<F> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<F: Real> Mul<F> for Vec3<F> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: F) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<F: Real> Div<F> for Vec3<F> {
    type Output = Self;

    #[inline(always)]
    fn div(self, by: F) -> Self {
        Self { x: self.x / by, y: self.y / by, z: self.z / by }
    }
}

impl<F: Real> Neg for Vec3<F> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}
