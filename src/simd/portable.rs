//! Lanes as arrays, which compilers turn into whatever there is.

use super::{Lanes, Numbers, Quad, Work};
use crate::math::next_away;

/// Eight numbers in an array.
#[derive(Clone, Copy)]
pub struct Portable([f32; 8]);

/// Four numbers in an array.
#[derive(Clone, Copy)]
pub struct PortableQuad([f64; 4]);

/// What both can do.
macro_rules! numbers {
    ($name:ident, $scalar:ty, $count:literal) => {
        impl $name {
            #[inline(always)]
            fn each(self, other: Self, f: impl Fn($scalar, $scalar) -> $scalar) -> Self {
                let mut values = self.0;
                values.iter_mut().zip(other.0).for_each(|(a, b)| *a = f(*a, b));
                Self(values)
            }

            #[inline(always)]
            fn lanes(self, other: Self, f: impl Fn($scalar, $scalar) -> bool) -> u32 {
                (0..$count).map(|lane| u32::from(f(self.0[lane], other.0[lane])) << lane).sum()
            }

            #[inline(always)]
            fn picked(self, bits: u32, other: Self) -> Self {
                let mut values = other.0;
                for (lane, value) in values.iter_mut().enumerate() {
                    if bits >> lane & 1 == 1 {
                        *value = self.0[lane];
                    }
                }
                Self(values)
            }
        }

        impl Numbers for $name {
            type Scalar = $scalar;
            type Row = [$scalar; $count];

            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                Self([value; $count])
            }

            #[inline(always)]
            fn load(values: &Self::Row) -> Self {
                Self(*values)
            }

            #[inline(always)]
            fn store(self) -> Self::Row {
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
        }
    };
}

numbers!(Portable, f32, 8);
numbers!(PortableQuad, f64, 4);

impl Quad for PortableQuad {
    type Mask = u32;

    #[inline(always)]
    fn root(self) -> Self {
        self.each(self, |a, _| a.sqrt())
    }

    #[inline(always)]
    fn negated(self) -> Self {
        self.each(self, |a, _| -a)
    }

    #[inline(always)]
    fn signed_like(self, signs: Self) -> Self {
        self.each(signs, f64::copysign)
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
        self.picked(chosen, other)
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
    fn at_most(self, other: Self) -> u32 {
        self.lanes(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn narrow(self) -> [f32; 4] {
        self.0.map(|value| value as f32)
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
}

impl Lanes for Portable {
    type Quad = PortableQuad;

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        self.times(factor).plus(term)
    }

    #[inline(always)]
    fn times_minus(self, factor: Self, term: Self) -> Self {
        self.times(factor).minus(term)
    }

    #[inline(always)]
    fn pick(self, bits: u32, other: Self) -> Self {
        self.picked(bits, other)
    }

    #[inline(always)]
    fn below(self, other: Self) -> u32 {
        self.lanes(other, |a, b| a < b)
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> u32 {
        self.lanes(other, |a, b| a <= b)
    }

    #[inline(never)]
    fn apart<W: Work>(work: W) -> W::Output {
        work.run::<Self>()
    }

    #[inline(always)]
    fn fetch<T>(_: &[T], _: usize) {}
}
