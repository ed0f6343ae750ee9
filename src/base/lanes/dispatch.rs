//! Runs kernels on the level of the processor.

#[cfg(all(target_arch = "x86_64", not(feature = "portable-only")))]
use super::choice::{LevelName, level};
use super::portable::Portable;
use super::traits::{Level, SimdKernel};
#[cfg(all(target_arch = "x86_64", not(feature = "portable-only")))]
use super::x86;

/// Runs a kernel on [`level`](super::level).
#[inline]
pub fn dispatch<K: SimdKernel>(kernel: K) -> K::Output {
    #[cfg(all(target_arch = "x86_64", not(feature = "portable-only")))]
    match level() {
        LevelName::Avx2 => return x86::run_avx2(kernel),
        LevelName::Avx512 => return x86::run_avx512(kernel),
        LevelName::Portable => {}
    }
    Portable::call(kernel)
}

/// Runs a kernel for one ray on the [narrow level](Level::Narrow) of [`level`](super::level).
#[inline]
pub fn dispatch_narrow<K: SimdKernel>(kernel: K) -> K::Output {
    #[cfg(all(target_arch = "x86_64", not(feature = "portable-only")))]
    match level() {
        LevelName::Avx2 | LevelName::Avx512 => return x86::run_avx2(kernel),
        LevelName::Portable => {}
    }
    Portable::call(kernel)
}

/// [`Level::prefetch`] for code without lanes.
#[inline(always)]
pub fn prefetch<T>(all: &[T], soon: usize) {
    #[cfg(all(target_arch = "x86_64", not(feature = "portable-only")))]
    x86::prefetch(all, soon);
    #[cfg(any(not(target_arch = "x86_64"), feature = "portable-only"))]
    Portable::prefetch(all, soon);
}
