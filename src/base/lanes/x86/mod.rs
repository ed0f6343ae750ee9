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

/// A level: its type, and kernels compiled for its features.
macro_rules! level {
    ($name:ident, $narrow:ty, $features:literal) => {
        #[derive(Clone, Copy)]
        pub struct $name;

        /// Runs a kernel on this level.
        #[target_feature(enable = $features)]
        pub fn run<K: SimdKernel>(kernel: K) -> K::Output {
            kernel.run::<$name>()
        }

        #[inline(never)]
        #[target_feature(enable = $features)]
        fn run_apart<K: SimdKernel>(kernel: K) -> K::Output {
            kernel.run::<$name>()
        }

        #[inline(never)]
        #[target_feature(enable = $features)]
        fn run_lanes_apart<K: LaneKernel<$name>>(kernel: K) -> K::Output {
            kernel.run()
        }

        impl Level for $name {
            type Mask = Mask8;
            type F64 = F64x8;
            type F32 = F32x8;
            type U32 = U32x8;
            type Narrow = $narrow;

            #[inline(always)]
            fn call<K: SimdKernel>(kernel: K) -> K::Output {
                unsafe { run_apart(kernel) }
            }

            #[inline(always)]
            fn call_with<K: LaneKernel<Self>>(kernel: K) -> K::Output {
                unsafe { run_lanes_apart(kernel) }
            }

            #[inline(always)]
            fn prefetch<T>(all: &[T], soon: usize) {
                crate::base::lanes::x86::prefetch(all, soon);
            }
        }
    };
}

/// Rows of a type that can `read` and `write` eight numbers, has a `splat_register`, and writes chosen lanes `compressed`.
macro_rules! row {
    ($name:ident, $scalar:ty, $zero:expr) => {
        impl Row for $name {
            type Scalar = $scalar;
            type Mask = Mask8;
            type Array = [$scalar; 8];
            const LANES: usize = 8;

            #[inline(always)]
            fn splat(value: $scalar) -> Self {
                unsafe { Self::splat_register(value) }
            }

            #[inline(always)]
            fn from_array(lanes: [$scalar; 8]) -> Self {
                unsafe { Self::read(lanes.as_ptr()) }
            }

            #[inline(always)]
            fn to_array(self) -> [$scalar; 8] {
                let mut lanes = [$zero; 8];
                unsafe { self.write(lanes.as_mut_ptr()) };
                lanes
            }

            #[inline(always)]
            fn load(from: &[$scalar], at: usize) -> Self {
                let from = &from[at..at + 8];
                unsafe { Self::read(from.as_ptr()) }
            }

            #[inline(always)]
            fn store(self, into: &mut [$scalar], at: usize) {
                let into = &mut into[at..at + 8];
                unsafe { self.write(into.as_mut_ptr()) };
            }

            #[inline(always)]
            fn gather(from: &[$scalar], at: &Lookup) -> Self {
                assert!((at.last as usize) < from.len());
                if at.is_run {
                    return unsafe { Self::read(from.as_ptr().add(at.at[0] as usize)) };
                }
                if at.is_same {
                    return Self::splat(from[at.at[0] as usize]);
                }
                let one = |lane: usize| unsafe { *from.get_unchecked(at.at[lane] as usize) };
                Self::from_array([one(0), one(1), one(2), one(3), one(4), one(5), one(6), one(7)])
            }

            #[inline(always)]
            fn compress(self, mask: Mask8, into: &mut [$scalar], at: usize) {
                let into = &mut into[at..at + 8];
                unsafe { self.compressed(mask, into.as_mut_ptr()) };
            }
        }
    };
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

use {level, methods, operators, row};
