//! Lanes in vector registers: the only unsafe code there is.
//!
//! Every function of `avx2` and `avx512` needs the features of its level. They are there, because the lane types are
//! private to these files: values of them come to be only below [`run_avx2`] and [`run_avx512`], which ask the
//! processor first.
#![allow(unsafe_code, reason = "intrinsics are unsafe where the processor may lack them")]

mod avx2;
mod avx512;

use super::{Level, Portable, SimdKernel};
use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};

/// Whether the processor has what `avx2` needs. The answer is remembered: asking is a load.
#[inline]
pub fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

/// Whether the processor has what `avx512` needs.
#[inline]
pub fn has_avx512() -> bool {
    has_avx2()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
}

/// Runs a kernel with AVX2, or without where the processor lacks it.
#[inline]
pub fn run_avx2<K: SimdKernel>(kernel: K) -> K::Output {
    if !has_avx2() {
        return Portable::call(kernel);
    }
    // SAFETY: the processor has the features.
    unsafe { avx2::run(kernel) }
}

/// Runs a kernel with AVX-512, or without where the processor lacks it.
#[inline]
pub fn run_avx512<K: SimdKernel>(kernel: K) -> K::Output {
    if !has_avx512() {
        return Portable::call(kernel);
    }
    // SAFETY: the processor has the features.
    unsafe { avx512::run(kernel) }
}

/// [`super::Level::prefetch`].
#[inline(always)]
pub fn prefetch<T>(all: &[T], soon: usize) {
    let lines = size_of::<T>().div_ceil(64);
    let begin = all.as_ptr().wrapping_add(soon).cast::<i8>();
    for line in 0..lines {
        // SAFETY: every processor of this kind has the hint, and nothing comes of it, wherever it points.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(begin.wrapping_add(64 * line)) };
    }
}

/// Operators of two rows by an intrinsic of two registers.
macro_rules! operators {
    ($name:ident: $($trait:ident $method:ident $intrinsic:ident),* $(,)?) => {
        $(impl $trait for $name {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        })*
    };
}

/// Methods of two rows by an intrinsic of two registers.
macro_rules! methods {
    ($($method:ident $intrinsic:ident),* $(,)?) => {
        $(#[inline(always)]
        fn $method(self, other: Self) -> Self {
            Self(unsafe { $intrinsic(self.0, other.0) })
        })*
    };
}

use {methods, operators};
