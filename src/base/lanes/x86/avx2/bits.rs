//! Eight u32 in one register.

use super::{F64x8, Mask8, U32x8};
use crate::base::lanes::x86::macros::{methods, row};
use crate::base::lanes::{Bits, Lookup, Mask, Row, Select};
use std::arch::x86_64::*;

row!(U32x8, u32, 0);

impl U32x8 {
    #[inline(always)]
    unsafe fn splat_register(value: u32) -> Self {
        Self(unsafe { _mm256_set1_epi32(value.cast_signed()) })
    }

    #[inline(always)]
    unsafe fn read(from: *const u32) -> Self {
        Self(unsafe { _mm256_loadu_si256(from.cast()) })
    }

    #[inline(always)]
    unsafe fn write(self, into: *mut u32) {
        unsafe { _mm256_storeu_si256(into.cast(), self.0) };
    }

    #[inline(always)]
    pub(super) unsafe fn compressed(self, mask: Mask8, into: *mut u32) {
        unsafe {
            // Make a byte of all ones for each selected lane, then extract the indices of these lanes, one byte each.
            let chosen = _pdep_u64(u64::from(mask.bits()), 0x0101_0101_0101_0101).wrapping_mul(0xff);
            let order = _pext_u64(0x0706_0504_0302_0100, chosen);
            let order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(order.cast_signed()));
            _mm256_storeu_si256(into.cast(), _mm256_permutevar8x32_epi32(self.0, order));
        }
    }
}

impl Select<Mask8> for U32x8 {
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm256_blendv_epi8(no.0, yes.0, mask.narrowed()) })
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
        Self(unsafe { reverse_bits(self.0) })
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        unsafe { Mask8::widened(_mm256_cmpeq_epi32(self.0, other.0)) }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        unsafe {
            // AVX2 has signed comparisons only. Flipping the top bits maps unsigned order to signed order.
            let half = _mm256_set1_epi32(i32::MIN);
            let (a, b) = (_mm256_xor_si256(self.0, half), _mm256_xor_si256(other.0, half));
            Mask8::widened(_mm256_cmpgt_epi32(b, a))
        }
    }

    #[inline(always)]
    fn to_f64(self) -> F64x8 {
        F64x8(unsafe {
            [to_f64(_mm256_castsi256_si128(self.0)), to_f64(_mm256_extracti128_si256::<1>(self.0))]
        })
    }
}

#[inline(always)]
unsafe fn to_f64(values: __m128i) -> __m256d {
    unsafe {
        // Put the number into the last bits of 2^52, then subtract 2^52.
        let shift = _mm256_set1_pd(4_503_599_627_370_496.0);
        let bits = _mm256_or_si256(_mm256_cvtepu32_epi64(values), _mm256_castpd_si256(shift));
        _mm256_sub_pd(_mm256_castsi256_pd(bits), shift)
    }
}

/// The bits of each number in reverse order.
#[inline(always)]
pub unsafe fn reverse_bits(value: __m256i) -> __m256i {
    unsafe {
        // Reverse the bytes, then both halves of every byte by a table.
        let bytes = _mm256_setr_epi8(
            3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12, 3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15,
            14, 13, 12,
        );
        let reversed = _mm256_setr_epi8(
            0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15, 0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3,
            11, 7, 15,
        );
        let halves = _mm256_set1_epi8(0xf);
        let value = _mm256_shuffle_epi8(value, bytes);
        let low = _mm256_shuffle_epi8(reversed, _mm256_and_si256(value, halves));
        let high = _mm256_shuffle_epi8(reversed, _mm256_and_si256(_mm256_srli_epi16::<4>(value), halves));
        _mm256_or_si256(_mm256_slli_epi16::<4>(low), high)
    }
}
