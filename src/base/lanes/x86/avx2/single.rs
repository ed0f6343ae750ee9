//! Eight f32 in one register.

use super::{F32x8, F64x8, Mask8, U32x8};
use crate::base::lanes::x86::macros::{methods, operators, row};
use crate::base::lanes::{Lookup, Row, Select, Single};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

row!(F32x8, f32, 0.0);

impl F32x8 {
    #[inline(always)]
    unsafe fn splat_register(value: f32) -> Self {
        Self(unsafe { _mm256_set1_ps(value) })
    }

    #[inline(always)]
    unsafe fn read(from: *const f32) -> Self {
        Self(unsafe { _mm256_loadu_ps(from) })
    }

    #[inline(always)]
    unsafe fn write(self, into: *mut f32) {
        unsafe { _mm256_storeu_ps(into, self.0) };
    }

    #[inline(always)]
    unsafe fn compressed(self, mask: Mask8, into: *mut f32) {
        unsafe { U32x8(_mm256_castps_si256(self.0)).compressed(mask, into.cast()) }
    }
}

impl Select<Mask8> for F32x8 {
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm256_blendv_ps(no.0, yes.0, _mm256_castsi256_ps(mask.narrowed())) })
    }
}

operators!(F32x8: Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);

impl Neg for F32x8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_set1_ps(-0.0)) })
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
        unsafe { Mask8::widened(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0))) }
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        unsafe { Mask8::widened(_mm256_castps_si256(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0))) }
    }

    #[inline(always)]
    fn lt_bits(self, other: Self) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)).cast_unsigned() }
    }

    #[inline(always)]
    fn le_bits(self, other: Self) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)).cast_unsigned() }
    }

    #[inline(always)]
    fn to_f64(self) -> F64x8 {
        F64x8(unsafe {
            [
                _mm256_cvtps_pd(_mm256_castps256_ps128(self.0)),
                _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.0)),
            ]
        })
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
