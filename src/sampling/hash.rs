//! Hashing of integers.

use crate::base::lanes::Bits;

/// Hashes three numbers: a round of multiplications and shifts for each (the finalizer of MurmurHash3, Appleby 2011).
#[inline(always)]
pub fn hash(words: [u32; 3]) -> u32 {
    hash_lanes(words)
}

/// [`hash`] of each lane.
#[inline(always)]
pub fn hash_lanes<U: Bits>([a, b, c]: [U; 3]) -> U {
    hash_from(hash_start(a), [b, c])
}

/// The state of a hash after the first of its numbers. Hashes that start alike compute it once.
#[inline(always)]
pub fn hash_start<U: Bits>(first: U) -> U {
    mix(U::splat(0x9e37_79b9), first)
}

/// The hash that started with `state`, after two more numbers.
#[inline(always)]
pub fn hash_from<U: Bits>(state: U, [b, c]: [U; 2]) -> U {
    mix(mix(state, b), c)
}

#[inline(always)]
fn mix<U: Bits>(state: U, word: U) -> U {
    let rotated = state.shl::<13>().or(state.shr::<19>());
    let h = rotated.wrapping_mul(U::splat(5)).wrapping_add(U::splat(0xe654_6b64)).xor(word);
    let h = h.xor(h.shr::<16>()).wrapping_mul(U::splat(0x85eb_ca6b));
    let h = h.xor(h.shr::<13>()).wrapping_mul(U::splat(0xc2b2_ae35));
    h.xor(h.shr::<16>())
}
