//! Runs kernels on the level of the processor.

use super::choice::{LevelName, level};
use super::portable::Portable;
use super::traits::{Level, SimdKernel};
#[cfg(target_arch = "x86_64")]
use super::x86;

/// Runs a kernel on [`level`].
#[inline]
pub fn dispatch<K: SimdKernel>(kernel: K) -> K::Output {
    match level() {
        #[cfg(target_arch = "x86_64")]
        LevelName::Avx2 => x86::run_avx2(kernel),
        #[cfg(target_arch = "x86_64")]
        LevelName::Avx512 => x86::run_avx512(kernel),
        _ => Portable::call(kernel),
    }
}

/// Runs a kernel for one ray on the [narrow level](Level::Narrow) of [`level`].
#[inline]
pub fn dispatch_narrow<K: SimdKernel>(kernel: K) -> K::Output {
    match level() {
        #[cfg(target_arch = "x86_64")]
        LevelName::Avx2 | LevelName::Avx512 => x86::run_avx2(kernel),
        _ => Portable::call(kernel),
    }
}

/// [`Level::prefetch`] for code without lanes.
#[inline(always)]
pub fn prefetch<T>(all: &[T], soon: usize) {
    #[cfg(target_arch = "x86_64")]
    x86::prefetch(all, soon);
    #[cfg(not(target_arch = "x86_64"))]
    Portable::prefetch(all, soon);
}
