//! Lanes as arrays, which compilers turn into whatever there is.

use super::{Lanes, Quad, Work};
use crate::math::next_away;

/// Eight numbers in an array.
#[derive(Clone, Copy)]
pub struct Portable([f32; 8]);

impl Portable {
    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut values = self.0;
        values.iter_mut().zip(other.0).for_each(|(a, b)| *a = f(*a, b));
        Self(values)
    }

    #[inline(always)]
    fn bits(self, other: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        let mut bits = 0;
        for lane in 0..8 {
            bits |= u32::from(f(self.0[lane], other.0[lane])) << lane;
        }
        bits
    }
}

/// Four numbers in an array.
#[derive(Clone, Copy)]
pub struct PortableQuad([f64; 4]);

impl PortableQuad {
    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut values = self.0;
        values.iter_mut().zip(other.0).for_each(|(a, b)| *a = f(*a, b));
        Self(values)
    }

    #[inline(always)]
    fn lanes(self, other: Self, f: impl Fn(f64, f64) -> bool) -> u32 {
        (0..4).map(|lane| u32::from(f(self.0[lane], other.0[lane])) << lane).sum()
    }
}

impl Quad for PortableQuad {
    type Mask = u32;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }

    #[inline(always)]
    fn load(values: &[f64; 4]) -> Self {
        Self(*values)
    }

    #[inline(always)]
    fn store(self) -> [f64; 4] {
        self.0
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self.each(other, |a, b| a / b)
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.each(self, |a, _| a.sqrt())
    }

    #[inline(always)]
    fn negated(self) -> Self {
        self.each(self, |a, _| -a)
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        self.each(self, |a, _| f64::from_bits(a.to_bits() & 0x7ff0_0000_0000_0000))
    }

    #[inline(always)]
    fn next_away(self, towards: Self) -> Self {
        self.each(towards, next_away)
    }

    #[inline(always)]
    fn pick(self, chosen: u32, other: Self) -> Self {
        let mut values = other.0;
        for (lane, value) in values.iter_mut().enumerate() {
            if chosen >> lane & 1 == 1 {
                *value = self.0[lane];
            }
        }
        Self(values)
    }

    #[inline(always)]
    fn both(a: u32, b: u32) -> u32 {
        a & b
    }

    #[inline(always)]
    fn either(a: u32, b: u32) -> u32 {
        a | b
    }

    #[inline(always)]
    fn bits(chosen: u32) -> u32 {
        chosen
    }

    #[inline(always)]
    fn choose(bits: u32) -> u32 {
        bits & 0xf
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> u32 {
        self.lanes(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.each(other, |a, b| a + b)
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.each(other, |a, b| a - b)
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self.each(other, |a, b| a * b)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.each(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.each(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn absolute(self) -> Self {
        self.each(self, |a, _| a.abs())
    }

    #[inline(always)]
    fn signed_like(self, signs: Self) -> Self {
        self.each(signs, f64::copysign)
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        self.lanes(self, |a, _| a.is_sign_negative())
    }

    #[inline(always)]
    fn below(self, other: Self) -> u32 {
        self.lanes(other, |a, b| a < b)
    }

    #[inline(always)]
    fn narrow(self) -> [f32; 4] {
        self.0.map(|value| value as f32)
    }
}

impl Lanes for Portable {
    type Quad = PortableQuad;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self([value; 8])
    }

    #[inline(always)]
    fn load(values: &[f32; 8]) -> Self {
        Self(*values)
    }

    #[inline(always)]
    fn store(self) -> [f32; 8] {
        self.0
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.each(other, |a, b| a + b)
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.each(other, |a, b| a - b)
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self.each(other, |a, b| a * b)
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self.each(other, |a, b| a / b)
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        self.times(factor).plus(term)
    }

    #[inline(always)]
    fn times_minus(self, factor: Self, term: Self) -> Self {
        self.times(factor).minus(term)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.each(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.each(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn absolute(self) -> Self {
        self.each(self, |a, _| a.abs())
    }

    #[inline(always)]
    fn fetch<T>(_: &[T], _: usize) {}

    #[inline(never)]
    fn apart<W: Work>(work: W) -> W::Output {
        work.run::<Self>()
    }

    #[inline(always)]
    fn pick(self, bits: u32, other: Self) -> Self {
        let mut values = other.0;
        for (lane, value) in values.iter_mut().enumerate() {
            if bits >> lane & 1 == 1 {
                *value = self.0[lane];
            }
        }
        Self(values)
    }

    #[inline(always)]
    fn below(self, other: Self) -> u32 {
        self.bits(other, |a, b| a < b)
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> u32 {
        self.bits(other, |a, b| a <= b)
    }
}
