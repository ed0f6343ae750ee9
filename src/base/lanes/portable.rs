//! Eight lanes as arrays, which the compiler vectorizes for the target.

use super::next_away;
use super::{Bits, LaneKernel, Level, Lookup, Mask, Real, Row, Select, SimdKernel, Single};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// The level that every processor has.
#[derive(Clone, Copy)]
pub struct Portable;

#[derive(Clone, Copy)]
pub struct F64x8([f64; 8]);

#[derive(Clone, Copy)]
pub struct F32x8([f32; 8]);

#[derive(Clone, Copy)]
pub struct U32x8([u32; 8]);

/// All bits of a lane in the set are 1, so that selections need no branches.
#[derive(Clone, Copy)]
pub struct Mask8([u64; 8]);

impl Level for Portable {
    type Mask = Mask8;
    type F64 = F64x8;
    type F32 = F32x8;
    type U32 = U32x8;
    type Narrow = Self;

    #[inline(never)]
    fn call<K: SimdKernel>(kernel: K) -> K::Output {
        kernel.run::<Self>()
    }

    #[inline(never)]
    fn call_with<K: LaneKernel<Self>>(kernel: K) -> K::Output {
        kernel.run()
    }

    #[inline(always)]
    fn transpose(rows: [F32x8; 8]) -> [F32x8; 8] {
        per_lane(|lane| F32x8(per_lane(|row| rows[row].0[lane])))
    }

    #[inline(always)]
    fn prefetch<T>(_: &[T], _: usize) {}
}

/// What `f` computes for each lane. Written out, as the compiler unrolls loops late: with loops, the crate takes a tenth
/// longer to compile.
#[inline(always)]
fn per_lane<T>(f: impl Fn(usize) -> T) -> [T; 8] {
    [f(0), f(1), f(2), f(3), f(4), f(5), f(6), f(7)]
}

impl Mask8 {
    #[inline(always)]
    fn of(chosen: impl Fn(usize) -> bool) -> Self {
        Self(per_lane(|lane| u64::from(chosen(lane)).wrapping_neg()))
    }

    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        Self(per_lane(|lane| f(self.0[lane], other.0[lane])))
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([u64::from(value).wrapping_neg(); 8])
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self::of(|lane| bits >> lane & 1 == 1)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        let [a, b, c, d, e, f, g, h] = per_lane(|lane| (self.0[lane] as u32 & 1) << lane);
        a | b | c | d | e | f | g | h
    }
}

impl BitAnd for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        self.each(other, |a, b| a & b)
    }
}

impl BitOr for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        self.each(other, |a, b| a | b)
    }
}

impl Not for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        self.each(self, |a, _| !a)
    }
}

macro_rules! row {
    ($name:ident, $scalar:ty, $bits:ty, $to:expr, $from:expr) => {
        impl $name {
            #[inline(always)]
            fn each(self, other: Self, f: impl Fn($scalar, $scalar) -> $scalar) -> Self {
                Self(per_lane(|lane| f(self.0[lane], other.0[lane])))
            }

            #[inline(always)]
            fn compare(self, other: Self, f: impl Fn($scalar, $scalar) -> bool) -> Mask8 {
                Mask8::of(|lane| f(self.0[lane], other.0[lane]))
            }
        }

        impl Select<Mask8> for $name {
            #[inline(always)]
            fn select(mask: Mask8, yes: Self, no: Self) -> Self {
                Self(per_lane(|lane| {
                    let chosen = mask.0[lane] as $bits;
                    $from($to(yes.0[lane]) & chosen | $to(no.0[lane]) & !chosen)
                }))
            }
        }

        impl Row for $name {
            type Scalar = $scalar;
            type Mask = Mask8;
            type Array = [$scalar; 8];
            const LANES: usize = 8;

            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                Self([value; 8])
            }

            #[inline(always)]
            fn from_array(lanes: [$scalar; 8]) -> Self {
                Self(lanes)
            }

            #[inline(always)]
            fn to_array(self) -> [$scalar; 8] {
                self.0
            }

            #[inline(always)]
            fn load(from: &[$scalar], at: usize) -> Self {
                let mut lanes = [<$scalar>::default(); 8];
                lanes.copy_from_slice(&from[at..at + 8]);
                Self(lanes)
            }

            #[inline(always)]
            fn store(self, into: &mut [$scalar], at: usize) {
                into[at..at + 8].copy_from_slice(&self.0);
            }

            #[inline(always)]
            fn gather(from: &[$scalar], at: &Lookup) -> Self {
                Self(per_lane(|lane| from[at.at[lane] as usize]))
            }

            #[inline(always)]
            fn compress(self, mask: Mask8, into: &mut [$scalar], mut at: usize) {
                for lane in super::lanes(mask.bits()) {
                    into[at] = self.0[lane];
                    at += 1;
                }
            }
        }
    };
}

row!(F64x8, f64, u64, f64::to_bits, f64::from_bits);
row!(F32x8, f32, u32, f32::to_bits, f32::from_bits);
row!(U32x8, u32, u32, u32::from, u32::from);

macro_rules! arithmetic {
    ($name:ident) => {
        arithmetic!($name, Add, add, |a, b| a + b);
        arithmetic!($name, Sub, sub, |a, b| a - b);
        arithmetic!($name, Mul, mul, |a, b| a * b);
        arithmetic!($name, Div, div, |a, b| a / b);

        impl Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                self.each(self, |a, _| -a)
            }
        }
    };
    ($name:ident, $trait:ident, $method:ident, $operation:expr) => {
        impl $trait for $name {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.each(other, $operation)
            }
        }
    };
}

arithmetic!(F64x8);
arithmetic!(F32x8);

impl Real for F64x8 {
    type Level = Portable;
    type F32 = F32x8;
    type U32 = U32x8;

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.each(self, |a, _| a.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.each(self, |a, _| a.abs())
    }

    #[inline(always)]
    fn floor(self) -> Self {
        self.each(self, |a, _| a.floor())
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.each(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.each(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.each(sign, f64::copysign)
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        self.each(self, |a, _| Real::power_of_two(a))
    }

    #[inline(always)]
    fn exp2_whole(self) -> Self {
        self.each(self, |a, _| a.exp2_whole())
    }

    #[inline(always)]
    fn next_away(self, towards: Self) -> Self {
        self.each(towards, next_away)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a == b)
    }

    #[inline(always)]
    fn is_negative(self) -> Mask8 {
        self.compare(self, |a, _| a.is_sign_negative())
    }

    #[inline(always)]
    fn to_f32(self) -> F32x8 {
        F32x8(per_lane(|lane| self.0[lane] as f32))
    }

    #[inline(always)]
    fn to_u32(self) -> U32x8 {
        U32x8(per_lane(|lane| self.0[lane] as u32))
    }
}

impl Single for F32x8 {
    type F64 = F64x8;

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.each(self, |a, _| a.sqrt())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.each(self, |a, _| a.abs())
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.each(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.each(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn to_f64(self) -> F64x8 {
        F64x8(per_lane(|lane| f64::from(self.0[lane])))
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        self * factor - term
    }
}

impl Bits for U32x8 {
    type F64 = F64x8;

    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        self.each(other, u32::wrapping_add)
    }

    #[inline(always)]
    fn wrapping_mul(self, other: Self) -> Self {
        self.each(other, u32::wrapping_mul)
    }

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self.each(other, |a, b| a & b)
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self.each(other, |a, b| a | b)
    }

    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        self.each(other, |a, b| a ^ b)
    }

    #[inline(always)]
    fn shl<const N: i32>(self) -> Self {
        self.each(self, |a, _| a << N)
    }

    #[inline(always)]
    fn shr<const N: i32>(self) -> Self {
        self.each(self, |a, _| a >> N)
    }

    #[inline(always)]
    fn reverse_bits(self) -> Self {
        self.each(self, |a, _| a.reverse_bits())
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a == b)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn to_f64(self) -> F64x8 {
        F64x8(per_lane(|lane| f64::from(self.0[lane])))
    }
}
