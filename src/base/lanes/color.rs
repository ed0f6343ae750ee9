//! Colours in lanes.

use super::{Lookup, Mask, Row, Select, Single};
use glam::Vec3 as Rgb;
use std::ops::{Add, Div, Mul, Sub};

/// One linear colour per lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color<S> {
    pub r: S,
    pub g: S,
    pub b: S,
}

impl From<Rgb> for Color<f32> {
    #[inline(always)]
    fn from(color: Rgb) -> Self {
        Self { r: color.x, g: color.y, b: color.z }
    }
}

impl From<Color<f32>> for Rgb {
    #[inline(always)]
    fn from(color: Color<f32>) -> Self {
        Self::new(color.r, color.g, color.b)
    }
}

impl<S: Single> Color<S> {
    #[inline(always)]
    pub fn splat(color: Rgb) -> Self {
        Self { r: S::splat(color.x), g: S::splat(color.y), b: S::splat(color.z) }
    }

    /// The same value in all channels.
    #[inline(always)]
    pub fn grey(value: S) -> Self {
        Self { r: value, g: value, b: value }
    }

    #[inline(always)]
    pub fn black() -> Self {
        Self::grey(S::splat(0.0))
    }

    /// Colours from three lists of channels.
    #[inline(always)]
    pub fn gather(from: [&[f32]; 3], at: &Lookup) -> Self {
        Self { r: S::gather(from[0], at), g: S::gather(from[1], at), b: S::gather(from[2], at) }
    }

    /// Consecutive colours from index `at` of three lists of channels on.
    #[inline(always)]
    pub fn load(from: [&[f32]; 3], at: usize) -> Self {
        Self { r: S::load(from[0], at), g: S::load(from[1], at), b: S::load(from[2], at) }
    }

    /// Stores consecutive colours from index `at` of three lists of channels on.
    #[inline(always)]
    pub fn store(self, into: &mut [&mut [f32]; 3], at: usize) {
        let [red, green, blue] = into;
        self.r.store(red, at);
        self.g.store(green, at);
        self.b.store(blue, at);
    }

    /// The sum of the channels.
    #[inline(always)]
    pub fn element_sum(self) -> S {
        self.r + self.g + self.b
    }

    #[inline(always)]
    pub fn dot(self, other: Self) -> S {
        self.r * other.r + self.g * other.g + self.b * other.b
    }

    #[inline(always)]
    pub fn length_squared(self) -> S {
        self.dot(self)
    }

    /// The colour of one lane. It stores all lanes, so store once if many lanes are needed.
    #[inline(always)]
    pub fn lane(self, lane: usize) -> Rgb {
        Rgb::new(self.r.to_array()[lane], self.g.to_array()[lane], self.b.to_array()[lane])
    }

    #[inline(always)]
    pub fn max_element(self) -> S {
        self.r.max(self.g.max(self.b))
    }

    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self { r: self.r.max(other.r), g: self.g.max(other.g), b: self.b.max(other.b) }
    }

    /// The lanes that are not black. No channel may be negative.
    #[inline(always)]
    pub fn is_lit(self) -> S::Mask {
        S::splat(0.0).lt(self.max_element())
    }

    /// From this colour at 0 to `other` at 1, rounded like glam's `lerp`.
    #[inline(always)]
    pub fn lerp(self, other: Self, share: S) -> Self {
        self * (S::splat(1.0) - share) + other * share
    }
}

impl<M: Mask, S: Row<Mask = M>> Select<M> for Color<S> {
    #[inline(always)]
    fn select(mask: M, yes: Self, no: Self) -> Self {
        Self {
            r: S::select(mask, yes.r, no.r),
            g: S::select(mask, yes.g, no.g),
            b: S::select(mask, yes.b, no.b),
        }
    }
}

impl<S: Single> Add for Color<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { r: self.r + other.r, g: self.g + other.g, b: self.b + other.b }
    }
}

impl<S: Single> Sub for Color<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { r: self.r - other.r, g: self.g - other.g, b: self.b - other.b }
    }
}

impl<S: Single> Mul for Color<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { r: self.r * other.r, g: self.g * other.g, b: self.b * other.b }
    }
}

impl<S: Single> Mul<S> for Color<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: S) -> Self {
        Self { r: self.r * factor, g: self.g * factor, b: self.b * factor }
    }
}

impl<S: Single> Div<S> for Color<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, by: S) -> Self {
        Self { r: self.r / by, g: self.g / by, b: self.b / by }
    }
}
