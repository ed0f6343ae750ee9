//! Eight f64 in two quads, and vectors of them: what eight rays have one each of.

use super::Quad;
use crate::math::{DVec3, Real, Vector3};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

/// Eight f64.
#[derive(Clone, Copy)]
pub struct Octo<Q>([Q; 2]);

impl<Q: Quad> Octo<Q> {
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self([Q::splat(value); 2])
    }

    #[inline(always)]
    pub fn load(values: &[f64; 8]) -> Self {
        let [a, b, c, d, e, f, g, h] = *values;
        Self([Q::load(&[a, b, c, d]), Q::load(&[e, f, g, h])])
    }

    #[inline(always)]
    pub fn store(self) -> [f64; 8] {
        let ([a, b, c, d], [e, f, g, h]) = (self.0[0].store(), self.0[1].store());
        [a, b, c, d, e, f, g, h]
    }

    #[inline(always)]
    pub fn root(self) -> Self {
        Self([self.0[0].root(), self.0[1].root()])
    }

    #[inline(always)]
    pub fn absolute(self) -> Self {
        Self([self.0[0].absolute(), self.0[1].absolute()])
    }

    /// The larger of each; `other` where `self` is not a number.
    #[inline(always)]
    pub fn larger(self, other: Self) -> Self {
        Self([self.0[0].larger(other.0[0]), self.0[1].larger(other.0[1])])
    }

    #[inline(always)]
    pub fn smaller(self, other: Self) -> Self {
        Self([self.0[0].smaller(other.0[0]), self.0[1].smaller(other.0[1])])
    }

    #[inline(always)]
    pub fn signed_like(self, signs: Self) -> Self {
        Self([self.0[0].signed_like(signs.0[0]), self.0[1].signed_like(signs.0[1])])
    }

    #[inline(always)]
    pub fn power_of_two(self) -> Self {
        Self([self.0[0].power_of_two(), self.0[1].power_of_two()])
    }

    /// [`crate::math::next_away`].
    #[inline(always)]
    pub fn next_away(self, towards: Self) -> Self {
        Self([self.0[0].next_away(towards.0[0]), self.0[1].next_away(towards.0[1])])
    }

    /// These in the lanes of a choice, others elsewhere.
    #[inline(always)]
    pub fn pick(self, chosen: Choice<Q>, other: Self) -> Self {
        Self([self.0[0].pick(chosen.0[0], other.0[0]), self.0[1].pick(chosen.0[1], other.0[1])])
    }

    /// A bit for each lane whose sign is negative.
    #[inline(always)]
    pub fn signs(self) -> u32 {
        self.0[0].signs() | self.0[1].signs() << 4
    }

    #[inline(always)]
    pub fn below(self, other: Self) -> Choice<Q> {
        Choice([self.0[0].below(other.0[0]), self.0[1].below(other.0[1])])
    }

    #[inline(always)]
    pub fn at_most(self, other: Self) -> Choice<Q> {
        Choice([self.0[0].at_most(other.0[0]), self.0[1].at_most(other.0[1])])
    }

    #[inline(always)]
    pub fn narrow(self) -> [f32; 8] {
        let ([a, b, c, d], [e, f, g, h]) = (self.0[0].narrow(), self.0[1].narrow());
        [a, b, c, d, e, f, g, h]
    }
}

impl<Q: Quad> Real for Octo<Q> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self::splat(value)
    }

    #[inline(always)]
    fn at_least(self, limit: f64, then: Self, or: Self) -> Self {
        then.pick(Self::splat(limit).at_most(self), or)
    }

    #[inline(always)]
    fn with_sign_of(self, sign: Self) -> Self {
        self.signed_like(sign)
    }
}

/// A choice among eight lanes.
#[derive(Clone, Copy)]
pub struct Choice<Q: Quad>([Q::Mask; 2]);

impl<Q: Quad> Choice<Q> {
    /// The lanes whose bits are set.
    #[inline(always)]
    pub fn of(bits: u32) -> Self {
        Self([Q::choose(bits), Q::choose(bits >> 4)])
    }

    /// A bit for each chosen lane, lane 0 the lowest.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        Q::bits(self.0[0]) | Q::bits(self.0[1]) << 4
    }
}

impl<Q: Quad> BitAnd for Choice<Q> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self([Q::both(self.0[0], other.0[0]), Q::both(self.0[1], other.0[1])])
    }
}

impl<Q: Quad> BitOr for Choice<Q> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self([Q::either(self.0[0], other.0[0]), Q::either(self.0[1], other.0[1])])
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $quads:ident) => {
        impl<Q: Quad> $trait for Octo<Q> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self([self.0[0].$quads(other.0[0]), self.0[1].$quads(other.0[1])])
            }
        }

        impl<Q: Quad> $trait for Vector<Q> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self { x: self.x.$name(other.x), y: self.y.$name(other.y), z: self.z.$name(other.z) }
            }
        }
    };
}

operator!(Add, add, plus);
operator!(Sub, sub, minus);
operator!(Mul, mul, times);
operator!(Div, div, over);

impl<Q: Quad> Neg for Octo<Q> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self([self.0[0].negated(), self.0[1].negated()])
    }
}

/// Eight vectors in memory: their x, y and z.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Rows(pub [[f64; 8]; 3]);

impl Rows {
    pub const ZERO: Self = Self([[0.0; 8]; 3]);

    pub fn of(vectors: &[DVec3; 8]) -> Self {
        Self([vectors.map(|v| v.x), vectors.map(|v| v.y), vectors.map(|v| v.z)])
    }

    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: DVec3) {
        let [x, y, z] = &mut self.0;
        (x[lane], y[lane], z[lane]) = (v.x, v.y, v.z);
    }

    #[inline]
    pub fn one(&self, lane: usize) -> DVec3 {
        let [x, y, z] = &self.0;
        DVec3::new(x[lane], y[lane], z[lane])
    }
}

/// Eight vectors. Operations are those of `glam`'s vectors, in the same order, so that they round alike.
#[derive(Clone, Copy)]
pub struct Vector<Q> {
    pub x: Octo<Q>,
    pub y: Octo<Q>,
    pub z: Octo<Q>,
}

impl<Q: Quad> Vector<Q> {
    #[inline(always)]
    pub fn splat(v: DVec3) -> Self {
        Self { x: Octo::splat(v.x), y: Octo::splat(v.y), z: Octo::splat(v.z) }
    }

    #[inline(always)]
    pub fn load(rows: &Rows) -> Self {
        Self { x: Octo::load(&rows.0[0]), y: Octo::load(&rows.0[1]), z: Octo::load(&rows.0[2]) }
    }

    #[inline(always)]
    pub fn store(self) -> Rows {
        Rows([self.x.store(), self.y.store(), self.z.store()])
    }

    #[inline(always)]
    pub fn dot(self, other: Self) -> Octo<Q> {
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
    pub fn equals(self, other: Self) -> Choice<Q> {
        let x = self.x.at_most(other.x) & other.x.at_most(self.x);
        let y = self.y.at_most(other.y) & other.y.at_most(self.y);
        x & y & self.z.at_most(other.z) & other.z.at_most(self.z)
    }

    #[inline(always)]
    pub fn length(self) -> Octo<Q> {
        self.dot(self).root()
    }

    #[inline(always)]
    pub fn absolute(self) -> Self {
        Self { x: self.x.absolute(), y: self.y.absolute(), z: self.z.absolute() }
    }

    /// At length 1, or `other` where there is no direction.
    #[inline(always)]
    pub fn normalized_or(self, other: Self) -> Self {
        let per_length = Octo::splat(1.0) / self.length();
        let sound = Octo::splat(0.0).below(per_length) & per_length.below(Octo::splat(f64::INFINITY));
        (self * per_length).pick(sound, other)
    }

    #[inline(always)]
    pub fn pick(self, chosen: Choice<Q>, other: Self) -> Self {
        let (x, y, z) = (self.x, self.y, self.z);
        Self { x: x.pick(chosen, other.x), y: y.pick(chosen, other.y), z: z.pick(chosen, other.z) }
    }

    #[inline(always)]
    pub fn along(self, axis: usize) -> Octo<Q> {
        match axis {
            0 => self.x,
            1 => self.y,
            _ => self.z,
        }
    }

    /// The axis along which those lanes whose bits are set are longest, the first of equal ones but for the last two, if
    /// it is the same for all.
    #[inline(always)]
    pub fn longest_axis(self, wanted: u32) -> Option<usize> {
        let d = self.absolute();
        let first = (d.y.at_most(d.x) & d.z.at_most(d.x)).bits() & wanted;
        let last = d.y.below(d.z).bits() & wanted & !first;
        match (first, last) {
            (first, _) if first == wanted => Some(0),
            (0, 0) => Some(1),
            (0, last) if last == wanted => Some(2),
            _ => None,
        }
    }

    /// The longest of each vector's coordinates.
    #[inline(always)]
    pub fn longest(self) -> Octo<Q> {
        let v = self.absolute();
        v.x.larger(v.y).larger(v.z)
    }
}

impl<Q: Quad> Vector3 for Vector<Q> {
    type Real = Octo<Q>;

    #[inline(always)]
    fn dot(self, other: Self) -> Octo<Q> {
        self.dot(other)
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        self.cross(other)
    }
}

impl<Q: Quad> Mul<Octo<Q>> for Vector<Q> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: Octo<Q>) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<Q: Quad> Div<Octo<Q>> for Vector<Q> {
    type Output = Self;

    #[inline(always)]
    fn div(self, by: Octo<Q>) -> Self {
        Self { x: self.x / by, y: self.y / by, z: self.z / by }
    }
}

impl<Q: Quad> Neg for Vector<Q> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}
