//! One lane: the scalar types themselves.

use super::next_away;
use super::{Bits, Lookup, Mask, Portable, Real, Row, Select, Single};

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        bits & 1 == 1
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

macro_rules! row {
    ($scalar:ty) => {
        impl Select<bool> for $scalar {
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
        }

        impl Row for $scalar {
            type Scalar = $scalar;
            type Mask = bool;
            type Array = [$scalar; 1];
            const LANES: usize = 1;

            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                value
            }

            #[inline(always)]
            fn from_array([value]: [$scalar; 1]) -> Self {
                value
            }

            #[inline(always)]
            fn to_array(self) -> [$scalar; 1] {
                [self]
            }

            #[inline(always)]
            fn load(from: &[$scalar], at: usize) -> Self {
                from[at]
            }

            #[inline(always)]
            fn store(self, into: &mut [$scalar], at: usize) {
                into[at] = self;
            }

            #[inline(always)]
            fn gather(from: &[$scalar], at: &Lookup) -> Self {
                from[at.lane(0) as usize]
            }

            #[inline(always)]
            fn compress(self, mask: bool, into: &mut [$scalar], at: usize) {
                if mask {
                    into[at] = self;
                }
            }
        }
    };
}

row!(f64);
row!(f32);
row!(u32);

impl Real for f64 {
    type Level = Portable;
    type F32 = f32;
    type U32 = u32;

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn floor(self) -> Self {
        f64::floor(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        f64::copysign(self, sign)
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        f64::from_bits(self.to_bits() & 0x7ff0_0000_0000_0000)
    }

    #[inline(always)]
    fn exp2_whole(self) -> Self {
        f64::from_bits(((self as i64 + 1023) as u64) << 52)
    }

    #[inline(always)]
    fn next_away(self, towards: Self) -> Self {
        next_away(self, towards)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }

    #[inline(always)]
    fn is_negative(self) -> bool {
        self.is_sign_negative()
    }

    #[inline(always)]
    fn to_f32(self) -> f32 {
        self as f32
    }

    #[inline(always)]
    fn to_u32(self) -> u32 {
        self as u32
    }
}

impl Single for f32 {
    type F64 = f64;

    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
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

impl Bits for u32 {
    type F64 = f64;

    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        u32::wrapping_add(self, other)
    }

    #[inline(always)]
    fn wrapping_mul(self, other: Self) -> Self {
        u32::wrapping_mul(self, other)
    }

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self | other
    }

    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        self ^ other
    }

    #[inline(always)]
    fn shl<const N: i32>(self) -> Self {
        self << N
    }

    #[inline(always)]
    fn shr<const N: i32>(self) -> Self {
        self >> N
    }

    #[inline(always)]
    fn reverse_bits(self) -> Self {
        u32::reverse_bits(self)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}
