//! Prefetching into the cache.

use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};

/// [`super::Level::prefetch`].
#[inline(always)]
pub fn prefetch<T>(all: &[T], soon: usize) {
    let lines = size_of::<T>().div_ceil(64);
    let begin = all.as_ptr().wrapping_add(soon).cast::<i8>();
    for line in 0..lines {
        // SAFETY: every x86-64 processor has this hint. It has no effect on the program, whatever the address.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(begin.wrapping_add(64 * line)) };
    }
}
