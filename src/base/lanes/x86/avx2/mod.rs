//! Eight lanes in AVX2 registers: one register for f32, two for f64.

mod bits;
mod double;
mod single;

pub use bits::reverse_bits;

use super::macros::level;
use crate::base::lanes::{LaneKernel, Level, Mask, SimdKernel};
use std::arch::x86_64::*;
use std::ops::{BitAnd, BitOr, Not};

// SAFETY of all following code: values of these types exist only if the processor has the features, see `super`.
// Pointers that are read or written point to as many numbers as a register holds: the length of slices is checked.

level!(Avx2, Avx2, "avx2,fma,bmi1,bmi2,lzcnt,popcnt");

/// Lanes 0 to 3 and lanes 4 to 7.
#[derive(Clone, Copy)]
pub struct F64x8([__m256d; 2]);

#[derive(Clone, Copy)]
pub struct F32x8(__m256);

#[derive(Clone, Copy)]
pub struct U32x8(__m256i);

/// All bits of a lane in the set are 1, like the results of f64 comparisons.
#[derive(Clone, Copy)]
pub struct Mask8([__m256d; 2]);

impl Mask8 {
    /// From the result of an f32 or u32 comparison.
    #[inline(always)]
    unsafe fn widened(mask: __m256i) -> Self {
        unsafe {
            let low = _mm256_cvtepi32_epi64(_mm256_castsi256_si128(mask));
            let high = _mm256_cvtepi32_epi64(_mm256_extracti128_si256::<1>(mask));
            Self([_mm256_castsi256_pd(low), _mm256_castsi256_pd(high)])
        }
    }

    /// For a selection of f32 or u32.
    #[inline(always)]
    unsafe fn narrowed(self) -> __m256i {
        unsafe {
            let (low, high) = (_mm256_castpd_ps(self.0[0]), _mm256_castpd_ps(self.0[1]));
            // The even halves of both: lanes 0, 1, 4, 5, 2, 3, 6, 7.
            let mixed = _mm256_castps_si256(_mm256_shuffle_ps::<0b10_00_10_00>(low, high));
            _mm256_permute4x64_epi64::<0b11_01_10_00>(mixed)
        }
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([unsafe { _mm256_castsi256_pd(_mm256_set1_epi64x(-i64::from(value))) }; 2])
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        unsafe {
            let bits = _mm256_set1_epi64x(i64::from(bits));
            let (low, high) = (_mm256_setr_epi64x(1, 2, 4, 8), _mm256_setr_epi64x(16, 32, 64, 128));
            Self([all_bits_of(bits, low), all_bits_of(bits, high)])
        }
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        unsafe { (_mm256_movemask_pd(self.0[0]) | _mm256_movemask_pd(self.0[1]) << 4).cast_unsigned() }
    }
}

/// All ones in the lanes of `bits` that contain the bits of `of`.
#[inline(always)]
unsafe fn all_bits_of(bits: __m256i, of: __m256i) -> __m256d {
    unsafe { _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(bits, of), of)) }
}

/// Applies an intrinsic of two registers to both halves.
macro_rules! halves {
    ($intrinsic:ident($a:expr, $b:expr)) => {
        unsafe { [$intrinsic($a.0[0], $b.0[0]), $intrinsic($a.0[1], $b.0[1])] }
    };
}

impl BitAnd for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(halves!(_mm256_and_pd(self, other)))
    }
}

impl BitOr for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(halves!(_mm256_or_pd(self, other)))
    }
}

impl Not for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        let all = Self::splat(true);
        Self(halves!(_mm256_xor_pd(self, all)))
    }
}

use halves;
