//! Eight lanes in AVX-512 registers.

use super::macros::{level, methods, operators, row};
use crate::base::lanes::{
    Bits, LaneKernel, Level, Lookup, Mask, NEAR_ZERO, Real, Row, Select, SimdKernel, Single,
};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

#[derive(Clone, Copy)]
pub struct F64x8(__m512d);

#[derive(Clone, Copy)]
pub struct F32x8(__m256);

#[derive(Clone, Copy)]
pub struct U32x8(__m256i);

#[derive(Clone, Copy)]
pub struct Mask8(__mmask8);

// SAFETY of all following code: values of these types exist only if the processor has the features, see `super`.
// Pointers that are read or written point to as many numbers as a register holds: the length of slices is checked.

level!(Avx512, super::avx2::Avx2, "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt");

impl Mask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(if value { 0xff } else { 0 })
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits as u8)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self.0)
    }
}

impl BitAnd for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

row!(F64x8, f64, 0.0);
row!(F32x8, f32, 0.0);
row!(U32x8, u32, 0);

/// Implements memory access and selection by intrinsics.
macro_rules! memory {
    ($name:ident, $scalar:ty, $splat:expr, $load:ident, $store:ident, $blend:ident, $compress:ident) => {
        impl $name {
            #[inline(always)]
            unsafe fn splat_register(value: $scalar) -> Self {
                Self(unsafe { $splat(value) })
            }

            #[inline(always)]
            unsafe fn read(from: *const $scalar) -> Self {
                Self(unsafe { $load(from.cast()) })
            }

            #[inline(always)]
            unsafe fn write(self, into: *mut $scalar) {
                unsafe { $store(into.cast(), self.0) };
            }

            #[inline(always)]
            unsafe fn compressed(self, mask: Mask8, into: *mut $scalar) {
                unsafe { $store(into.cast(), $compress(mask.0, self.0)) };
            }
        }

        impl Select<Mask8> for $name {
            #[inline(always)]
            fn select(mask: Mask8, yes: Self, no: Self) -> Self {
                Self(unsafe { $blend(mask.0, no.0, yes.0) })
            }
        }
    };
}

memory!(
    F64x8,
    f64,
    _mm512_set1_pd,
    _mm512_loadu_pd,
    _mm512_storeu_pd,
    _mm512_mask_blend_pd,
    _mm512_maskz_compress_pd
);
memory!(
    F32x8,
    f32,
    _mm256_set1_ps,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_mask_blend_ps,
    _mm256_maskz_compress_ps
);
memory!(
    U32x8,
    u32,
    splat_u32,
    _mm256_loadu_si256,
    _mm256_storeu_si256,
    _mm256_mask_blend_epi32,
    _mm256_maskz_compress_epi32
);

#[inline(always)]
unsafe fn splat_u32(value: u32) -> __m256i {
    unsafe { _mm256_set1_epi32(value.cast_signed()) }
}

operators!(F64x8: Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd);
operators!(F32x8: Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);

impl Neg for F64x8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
    }
}

impl Neg for F32x8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_set1_ps(-0.0)) })
    }
}

impl Real for F64x8 {
    type Level = Avx512;
    type F32 = F32x8;
    type U32 = U32x8;

    methods!(max _mm512_max_pd, min _mm512_min_pd);

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm512_abs_pd(self.0) })
    }

    #[inline(always)]
    fn floor(self) -> Self {
        Self(unsafe { _mm512_roundscale_pd::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0) })
    }

    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        unsafe {
            let bit = _mm512_set1_pd(-0.0);
            Self(_mm512_or_pd(_mm512_andnot_pd(bit, self.0), _mm512_and_pd(bit, sign.0)))
        }
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self(unsafe { _mm512_and_pd(_mm512_set1_pd(f64::INFINITY), self.0) })
    }

    #[inline(always)]
    fn exp2_whole(self) -> Self {
        Self(unsafe { _mm512_scalef_pd(_mm512_set1_pd(1.0), self.0) })
    }

    #[inline(always)]
    fn next_away(self, towards: Self) -> Self {
        unsafe {
            let bits = _mm512_castpd_si512(self.0);
            // Step towards zero if the signs differ, and away from zero otherwise.
            let signs_differ = _mm512_xor_si512(bits, _mm512_castpd_si512(towards.0));
            let back = _mm512_movepi64_mask(signs_differ);
            let step = _mm512_mask_blend_epi64(back, _mm512_set1_epi64(1), _mm512_set1_epi64(-1));
            let next = Self(_mm512_castsi512_pd(_mm512_add_epi64(bits, step)));
            // A step from next to zero may have gone past zero, which gives NaN.
            let least = Self::splat(NEAR_ZERO);
            let tiny = next.abs().lt(least) | self.abs().lt(least);
            let next = Self::select(tiny, least.copysign(towards), next);
            let towards_something = Mask8(_mm512_cmp_pd_mask::<_CMP_NEQ_OQ>(towards.0, _mm512_setzero_pd()));
            Self::select(towards_something, next, self)
        }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn is_negative(self) -> Mask8 {
        Mask8(unsafe { _mm512_movepi64_mask(_mm512_castpd_si512(self.0)) })
    }

    #[inline(always)]
    fn to_f32(self) -> F32x8 {
        F32x8(unsafe { _mm512_cvtpd_ps(self.0) })
    }

    #[inline(always)]
    fn to_u32(self) -> U32x8 {
        U32x8(unsafe { _mm512_cvttpd_epi32(self.0) })
    }
}

impl Single for F32x8 {
    type F64 = F64x8;

    methods!(max _mm256_max_ps, min _mm256_min_ps);

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm256_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        Mask8(unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        Mask8(unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn to_f64(self) -> F64x8 {
        F64x8(unsafe { _mm512_cvtps_pd(self.0) })
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        Self(unsafe { _mm256_fmsub_ps(self.0, factor.0, term.0) })
    }
}

impl Bits for U32x8 {
    type F64 = F64x8;

    methods!(
        wrapping_add _mm256_add_epi32,
        wrapping_mul _mm256_mullo_epi32,
        and _mm256_and_si256,
        or _mm256_or_si256,
        xor _mm256_xor_si256,
    );

    #[inline(always)]
    fn shl<const N: i32>(self) -> Self {
        Self(unsafe { _mm256_slli_epi32::<N>(self.0) })
    }

    #[inline(always)]
    fn shr<const N: i32>(self) -> Self {
        Self(unsafe { _mm256_srli_epi32::<N>(self.0) })
    }

    #[inline(always)]
    fn reverse_bits(self) -> Self {
        Self(unsafe { super::avx2::reverse_bits(self.0) })
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        Mask8(unsafe { _mm256_cmpeq_epi32_mask(self.0, other.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        Mask8(unsafe { _mm256_cmplt_epu32_mask(self.0, other.0) })
    }

    #[inline(always)]
    fn to_f64(self) -> F64x8 {
        F64x8(unsafe { _mm512_cvtepu32_pd(self.0) })
    }
}
