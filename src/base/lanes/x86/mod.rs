//! Lanes in vector registers: the only unsafe code of the crate.
//!
//! Every function of `avx2` and `avx512` needs the features of its level. The lane types are private to these files,
//! and only [`run_avx2`] and [`run_avx512`] create values of them, after they have checked the features of the
//! processor.
#![allow(unsafe_code, reason = "intrinsics are unsafe where the processor may lack them")]

mod avx2;
mod avx512;
mod macros;
mod prefetch;
mod transpose;

pub use prefetch::prefetch;

use super::{Level, Portable, SimdKernel};

/// Whether the processor has the features of `avx2`. The result is cached, so a call costs a load.
#[inline]
pub fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

/// Whether the processor has the features of `avx512`.
#[inline]
pub fn has_avx512() -> bool {
    has_avx2()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
}

/// Runs a kernel with AVX2, or on the portable level if the processor lacks it.
#[inline]
pub fn run_avx2<K: SimdKernel>(kernel: K) -> K::Output {
    if !has_avx2() {
        return Portable::call(kernel);
    }
    // SAFETY: the processor has the features.
    unsafe { avx2::run(kernel) }
}

/// Runs a kernel with AVX-512, or on the portable level if the processor lacks it.
#[inline]
pub fn run_avx512<K: SimdKernel>(kernel: K) -> K::Output {
    if !has_avx512() {
        return Portable::call(kernel);
    }
    // SAFETY: the processor has the features.
    unsafe { avx512::run(kernel) }
}
