//! Eight f64 in two registers.

use super::{Avx2, F32x8, F64x8, Mask8, U32x8, halves};
use crate::base::lanes::x86::macros::row;
use crate::base::lanes::{Lookup, Mask, NEAR_ZERO, Real, Row, Select};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

row!(F64x8, f64, 0.0);

impl F64x8 {
    #[inline(always)]
    unsafe fn splat_register(value: f64) -> Self {
        Self([unsafe { _mm256_set1_pd(value) }; 2])
    }

    #[inline(always)]
    unsafe fn read(from: *const f64) -> Self {
        Self(unsafe { [_mm256_loadu_pd(from), _mm256_loadu_pd(from.add(4))] })
    }

    #[inline(always)]
    unsafe fn write(self, into: *mut f64) {
        unsafe {
            _mm256_storeu_pd(into, self.0[0]);
            _mm256_storeu_pd(into.add(4), self.0[1]);
        }
    }

    /// Writes the selected lanes first. `into` has room for eight.
    #[inline(always)]
    unsafe fn compressed(self, mask: Mask8, into: *mut f64) {
        unsafe {
            let bits = mask.bits();
            let first = (bits & 0xf).count_ones() as usize;
            _mm256_storeu_pd(into, compressed_half(self.0[0], bits & 0xf));
            _mm256_storeu_pd(into.add(first), compressed_half(self.0[1], bits >> 4 & 0xf));
        }
    }
}

/// Moves the selected ones of four f64 to the front.
#[inline(always)]
unsafe fn compressed_half(values: __m256d, bits: u32) -> __m256d {
    unsafe {
        let order = _mm256_loadu_si256(COMPRESS[bits as usize].as_ptr().cast());
        let values = _mm256_castpd_si256(values);
        _mm256_castsi256_pd(_mm256_permutevar8x32_epi32(values, order))
    }
}

/// For every set of four 64-bit lanes, the 32-bit halves of its lanes.
static COMPRESS: [[u32; 8]; 16] = {
    let mut orders = [[0; 8]; 16];
    let mut bits = 0;
    while bits < 16 {
        let (mut lane, mut at) = (0, 0);
        while lane < 4 {
            if bits >> lane & 1 == 1 {
                orders[bits][at] = 2 * lane;
                orders[bits][at + 1] = 2 * lane + 1;
                at += 2;
            }
            lane += 1;
        }
        bits += 1;
    }
    orders
};

impl Select<Mask8> for F64x8 {
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(unsafe {
            [_mm256_blendv_pd(no.0[0], yes.0[0], mask.0[0]), _mm256_blendv_pd(no.0[1], yes.0[1], mask.0[1])]
        })
    }
}

/// Implements operators of f64, half by half.
macro_rules! operators_of_halves {
    ($($trait:ident $method:ident $intrinsic:ident),* $(,)?) => {
        $(impl $trait for F64x8 {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(halves!($intrinsic(self, other)))
            }
        })*
    };
}

operators_of_halves!(Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);

impl Neg for F64x8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let sign = Self::splat(-0.0);
        Self(halves!(_mm256_xor_pd(self, sign)))
    }
}

/// Implements comparisons by a predicate.
macro_rules! comparisons {
    ($($method:ident $predicate:ident),* $(,)?) => {
        $(#[inline(always)]
        fn $method(self, other: Self) -> Mask8 {
            Mask8(unsafe {
                [
                    _mm256_cmp_pd::<$predicate>(self.0[0], other.0[0]),
                    _mm256_cmp_pd::<$predicate>(self.0[1], other.0[1]),
                ]
            })
        })*
    };
}

impl Real for F64x8 {
    type Level = Avx2;
    type F32 = F32x8;
    type U32 = U32x8;

    comparisons!(lt _CMP_LT_OQ, le _CMP_LE_OQ, eq _CMP_EQ_OQ);

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { [_mm256_sqrt_pd(self.0[0]), _mm256_sqrt_pd(self.0[1])] })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let sign = Self::splat(-0.0);
        Self(halves!(_mm256_andnot_pd(sign, self)))
    }

    #[inline(always)]
    fn floor(self) -> Self {
        Self(unsafe { [_mm256_floor_pd(self.0[0]), _mm256_floor_pd(self.0[1])] })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(halves!(_mm256_max_pd(self, other)))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(halves!(_mm256_min_pd(self, other)))
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let bit = Self::splat(-0.0);
        let (magnitude, sign) =
            (Self(halves!(_mm256_andnot_pd(bit, self))), Self(halves!(_mm256_and_pd(bit, sign))));
        Self(halves!(_mm256_or_pd(magnitude, sign)))
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        let exponent = Self::splat(f64::INFINITY);
        Self(halves!(_mm256_and_pd(exponent, self)))
    }

    #[inline(always)]
    fn exp2_whole(self) -> Self {
        Self(unsafe { [exp2_whole(self.0[0]), exp2_whole(self.0[1])] })
    }

    #[inline(always)]
    fn next_away(self, towards: Self) -> Self {
        Self([next_away(self.0[0], towards.0[0]), next_away(self.0[1], towards.0[1])])
    }

    #[inline(always)]
    fn is_negative(self) -> Mask8 {
        // Selections and `bits` read only the sign bit, but `!` needs all bits of a mask.
        let zero = unsafe { _mm256_setzero_si256() };
        Mask8(unsafe {
            [
                _mm256_castsi256_pd(_mm256_cmpgt_epi64(zero, _mm256_castpd_si256(self.0[0]))),
                _mm256_castsi256_pd(_mm256_cmpgt_epi64(zero, _mm256_castpd_si256(self.0[1]))),
            ]
        })
    }

    #[inline(always)]
    fn to_f32(self) -> F32x8 {
        F32x8(unsafe { _mm256_set_m128(_mm256_cvtpd_ps(self.0[1]), _mm256_cvtpd_ps(self.0[0])) })
    }

    #[inline(always)]
    fn to_u32(self) -> U32x8 {
        U32x8(unsafe { _mm256_set_m128i(_mm256_cvttpd_epi32(self.0[1]), _mm256_cvttpd_epi32(self.0[0])) })
    }
}

#[inline(always)]
unsafe fn exp2_whole(exponent: __m256d) -> __m256d {
    unsafe {
        let exponent = _mm256_cvtepi32_epi64(_mm256_cvtpd_epi32(exponent));
        let biased = _mm256_add_epi64(exponent, _mm256_set1_epi64x(1023));
        _mm256_castsi256_pd(_mm256_slli_epi64::<52>(biased))
    }
}

#[inline(always)]
fn next_away(value: __m256d, towards: __m256d) -> __m256d {
    unsafe {
        let (bits, zero) = (_mm256_castpd_si256(value), _mm256_setzero_pd());
        // -1 if the signs differ, a step towards zero; otherwise 1.
        let signs_differ = _mm256_xor_si256(bits, _mm256_castpd_si256(towards));
        let back = _mm256_cmpgt_epi64(_mm256_setzero_si256(), signs_differ);
        let next = _mm256_add_epi64(bits, _mm256_or_si256(back, _mm256_set1_epi64x(1)));
        let next = _mm256_castsi256_pd(next);
        // A step from next to zero may have gone past zero, which gives NaN.
        let (least, sign) = (_mm256_set1_pd(NEAR_ZERO), _mm256_set1_pd(-0.0));
        let tiny = _mm256_or_pd(
            _mm256_cmp_pd::<_CMP_LT_OQ>(_mm256_andnot_pd(sign, next), least),
            _mm256_cmp_pd::<_CMP_LT_OQ>(_mm256_andnot_pd(sign, value), least),
        );
        let away = _mm256_or_pd(least, _mm256_and_pd(sign, towards));
        let next = _mm256_blendv_pd(next, away, tiny);
        _mm256_blendv_pd(value, next, _mm256_cmp_pd::<_CMP_NEQ_OQ>(towards, zero))
    }
}
