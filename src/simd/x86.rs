//! Lanes in AVX registers: the only unsafe code there is.
//!
//! Every function here needs AVX2 and FMA. That holds because [`Avx`] is private to this file: lanes of its kind
//! come to be in [`run`] alone, which asks the processor first.
#![allow(unsafe_code, reason = "intrinsics are unsafe where the processor may lack them")]

use super::{Lanes, Numbers, Quad, Work};
use crate::math::NEAR_ZERO;
use std::arch::x86_64::*;

/// Whether the processor has what this file needs. The answer is remembered: asking is a load.
#[inline]
pub fn is_there() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

/// Does the work with AVX, or with portable lanes where there is none.
#[inline]
pub fn run<W: Work>(work: W) -> W::Output {
    if !is_there() {
        return work.run::<super::Portable>();
    }
    // SAFETY: the processor has both features.
    unsafe { with_avx(work) }
}

#[target_feature(enable = "avx2,fma")]
fn with_avx<W: Work>(work: W) -> W::Output {
    work.run::<Avx>()
}

#[inline(never)]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn with_avx_apart<W: Work>(work: W) -> W::Output {
    work.run::<Avx>()
}

/// [`Lanes::fetch`].
#[inline(always)]
pub fn fetch<T>(all: &[T], soon: usize) {
    let lines = size_of::<T>().div_ceil(64);
    let begin = all.as_ptr().wrapping_add(soon).cast::<i8>();
    for line in 0..lines {
        // SAFETY: every processor of this kind has the hint, and nothing comes of it, wherever it points.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(begin.wrapping_add(64 * line)) };
    }
}

#[derive(Clone, Copy)]
struct Avx(__m256);

#[derive(Clone, Copy)]
struct AvxQuad(__m256d);

// SAFETY of all that follows: there are lanes of this kind only where the processor has AVX2 and FMA, see above.
// What is read and written are arrays of eight f32, through pointers to whole ones that need no alignment.
/// What both can do, by their instructions.
macro_rules! numbers {
    ($name:ident, $scalar:ty, $count:literal, $splat:ident, $load:ident, $store:ident, $plus:ident, $minus:ident,
     $times:ident, $over:ident, $larger:ident, $smaller:ident, $without:ident) => {
        impl Numbers for $name {
            type Scalar = $scalar;
            type Row = [$scalar; $count];

            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                Self(unsafe { $splat(value) })
            }

            #[inline(always)]
            fn load(values: &Self::Row) -> Self {
                Self(unsafe { $load(values.as_ptr()) })
            }

            #[inline(always)]
            fn store(self) -> Self::Row {
                let mut values = [0.0; $count];
                unsafe { $store(values.as_mut_ptr(), self.0) };
                values
            }

            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                Self(unsafe { $plus(self.0, other.0) })
            }

            #[inline(always)]
            fn minus(self, other: Self) -> Self {
                Self(unsafe { $minus(self.0, other.0) })
            }

            #[inline(always)]
            fn times(self, other: Self) -> Self {
                Self(unsafe { $times(self.0, other.0) })
            }

            #[inline(always)]
            fn over(self, other: Self) -> Self {
                Self(unsafe { $over(self.0, other.0) })
            }

            // Of two numbers that compare neither way, the instructions take the second.
            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                Self(unsafe { $larger(self.0, other.0) })
            }

            #[inline(always)]
            fn smaller(self, other: Self) -> Self {
                Self(unsafe { $smaller(self.0, other.0) })
            }

            #[inline(always)]
            fn absolute(self) -> Self {
                Self(unsafe { $without($splat(-0.0), self.0) })
            }
        }
    };
}

numbers!(
    Avx,
    f32,
    8,
    _mm256_set1_ps,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_max_ps,
    _mm256_min_ps,
    _mm256_andnot_ps
);
numbers!(
    AvxQuad,
    f64,
    4,
    _mm256_set1_pd,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_div_pd,
    _mm256_max_pd,
    _mm256_min_pd,
    _mm256_andnot_pd
);

impl Lanes for Avx {
    type Quad = AvxQuad;

    #[inline(always)]
    fn pick(self, bits: u32, other: Self) -> Self {
        unsafe {
            let lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let chosen = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(bits as i32), lane), lane);
            Self(_mm256_blendv_ps(other.0, self.0, _mm256_castsi256_ps(chosen)))
        }
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        Self(unsafe { _mm256_fmadd_ps(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn times_minus(self, factor: Self, term: Self) -> Self {
        Self(unsafe { _mm256_fmsub_ps(self.0, factor.0, term.0) })
    }

    #[inline(always)]
    fn apart<W: Work>(work: W) -> W::Output {
        unsafe { with_avx_apart(work) }
    }

    #[inline(always)]
    fn fetch<T>(all: &[T], soon: usize) {
        fetch(all, soon);
    }

    #[inline(always)]
    fn below(self, other: Self) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) as u32 }
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)) as u32 }
    }
}

impl Quad for AvxQuad {
    type Mask = __m256d;

    #[inline(always)]
    fn root(self) -> Self {
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn negated(self) -> Self {
        Self(unsafe { _mm256_xor_pd(_mm256_set1_pd(-0.0), self.0) })
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self(unsafe { _mm256_and_pd(_mm256_set1_pd(f64::INFINITY), self.0) })
    }

    #[inline(always)]
    fn next_away(self, towards: Self) -> Self {
        unsafe {
            let (bits, zero) = (_mm256_castpd_si256(self.0), _mm256_setzero_pd());
            // -1 where the signs differ, which leads towards zero; 1 elsewhere.
            let apart = _mm256_xor_si256(bits, _mm256_castpd_si256(towards.0));
            let back = _mm256_cmpgt_epi64(_mm256_setzero_si256(), apart);
            let next = _mm256_add_epi64(bits, _mm256_or_si256(back, _mm256_set1_epi64x(1)));
            let next = Self(_mm256_castsi256_pd(next));
            // What is next to zero may have been stepped past it, which gives no number.
            let least = Self::splat(NEAR_ZERO);
            let tiny = Self::either(next.absolute().below(least), self.absolute().below(least));
            let next = least.signed_like(towards).pick(tiny, next);
            Self(_mm256_blendv_pd(self.0, next.0, _mm256_cmp_pd::<_CMP_NEQ_OQ>(towards.0, zero)))
        }
    }

    #[inline(always)]
    fn pick(self, chosen: __m256d, other: Self) -> Self {
        Self(unsafe { _mm256_blendv_pd(other.0, self.0, chosen) })
    }

    #[inline(always)]
    fn both(a: __m256d, b: __m256d) -> __m256d {
        unsafe { _mm256_and_pd(a, b) }
    }

    #[inline(always)]
    fn either(a: __m256d, b: __m256d) -> __m256d {
        unsafe { _mm256_or_pd(a, b) }
    }

    #[inline(always)]
    fn bits(chosen: __m256d) -> u32 {
        unsafe { _mm256_movemask_pd(chosen) as u32 }
    }

    #[inline(always)]
    fn choose(bits: u32) -> __m256d {
        unsafe {
            let lane = _mm256_setr_epi64x(1, 2, 4, 8);
            let chosen = _mm256_and_si256(_mm256_set1_epi64x(i64::from(bits)), lane);
            _mm256_castsi256_pd(_mm256_cmpeq_epi64(chosen, lane))
        }
    }

    #[inline(always)]
    fn at_most(self, other: Self) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0) }
    }

    #[inline(always)]
    fn signed_like(self, signs: Self) -> Self {
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Self(_mm256_or_pd(_mm256_andnot_pd(sign, self.0), _mm256_and_pd(sign, signs.0)))
        }
    }

    #[inline(always)]
    fn signs(self) -> u32 {
        unsafe { _mm256_movemask_pd(self.0) as u32 }
    }

    #[inline(always)]
    fn below(self, other: Self) -> __m256d {
        unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) }
    }

    #[inline(always)]
    fn narrow(self) -> [f32; 4] {
        let mut values = [0.0; 4];
        unsafe { _mm_storeu_ps(values.as_mut_ptr(), _mm256_cvtpd_ps(self.0)) };
        values
    }
}
