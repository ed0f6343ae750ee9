//! Transposition of eight rows of eight f32, which AVX2 and AVX-512 do alike.

use std::arch::x86_64::*;

/// [`super::Level::transpose`].
///
/// # Safety
///
/// The processor must have AVX.
#[inline(always)]
pub unsafe fn transpose(rows: [__m256; 8]) -> [__m256; 8] {
    let [a, b, c, d, e, f, g, h] = rows;
    unsafe {
        // Lanes 0 and 4 of two rows, then 1 and 5; 2 and 6, then 3 and 7.
        let (ab0, ab2) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let (cd0, cd2) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
        let (ef0, ef2) = (_mm256_unpacklo_ps(e, f), _mm256_unpackhi_ps(e, f));
        let (gh0, gh2) = (_mm256_unpacklo_ps(g, h), _mm256_unpackhi_ps(g, h));
        // One lane of four rows, and that four lanes behind it.
        let (ad0, ad1) = (low_halves(ab0, cd0), high_halves(ab0, cd0));
        let (ad2, ad3) = (low_halves(ab2, cd2), high_halves(ab2, cd2));
        let (eh0, eh1) = (low_halves(ef0, gh0), high_halves(ef0, gh0));
        let (eh2, eh3) = (low_halves(ef2, gh2), high_halves(ef2, gh2));
        [
            _mm256_permute2f128_ps::<0x20>(ad0, eh0),
            _mm256_permute2f128_ps::<0x20>(ad1, eh1),
            _mm256_permute2f128_ps::<0x20>(ad2, eh2),
            _mm256_permute2f128_ps::<0x20>(ad3, eh3),
            _mm256_permute2f128_ps::<0x31>(ad0, eh0),
            _mm256_permute2f128_ps::<0x31>(ad1, eh1),
            _mm256_permute2f128_ps::<0x31>(ad2, eh2),
            _mm256_permute2f128_ps::<0x31>(ad3, eh3),
        ]
    }
}

/// The lower two of every four lanes of both.
#[inline(always)]
unsafe fn low_halves(a: __m256, b: __m256) -> __m256 {
    unsafe { _mm256_shuffle_ps::<0b01_00_01_00>(a, b) }
}

/// The upper two of every four lanes of both.
#[inline(always)]
unsafe fn high_halves(a: __m256, b: __m256) -> __m256 {
    unsafe { _mm256_shuffle_ps::<0b11_10_11_10>(a, b) }
}
