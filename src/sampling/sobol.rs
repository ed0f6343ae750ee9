//! Four dimensions of Owen-scrambled Sobol points, in lanes. The points are those of the crate `sobol_burley`. That
//! crate processes an index bit by bit; this module computes the first two dimensions of all bits at once, and looks up
//! one table entry per byte for the others.

use crate::base::lanes::{Bits, Real, Row};
use sobol_burley::parts::sobol_int4_rev;
use std::sync::LazyLock;

/// The last two dimensions of the points of bit-reversed indices in which only the highest byte, or only the next byte,
/// is not zero. Points are linear over the bits of the index, so the points of the bytes combine by exclusive or.
static POINTS: LazyLock<[[[u32; 2]; 256]; 2]> = LazyLock::new(|| {
    [24, 16].map(|shift| {
        std::array::from_fn(|byte| {
            let [_, _, third, fourth] = sobol_int4_rev((byte as u32) << shift, 0).into();
            [third, fourth]
        })
    })
});

/// The constants by which the crate scrambles indices and dimensions.
const INDEX: u32 = 0x79c6_8e4a;
const DIMENSIONS: [u32; 4] = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8];
const SPREAD: u32 = 0x9c8f_2d3b;

/// The first N dimensions, in 0..1, of the points of samples below 2^16: those of `sobol_burley::sample_4d(sample, 0,
/// seed)`, with all 32 bits of each.
#[inline(always)]
pub fn point<F: Real, const N: usize>(sample: F::U32, seed: F::U32) -> [F; N] {
    let index = owen_scrambled(sample.reverse_bits(), mixed(seed.xor(F::U32::splat(INDEX))));
    let spread = seed.wrapping_mul(F::U32::splat(SPREAD));
    let mut point = [F::splat(0.0); N];
    for dimension in 0..N {
        let row = match dimension {
            0 => radical_inverse(index),
            1 => pascal(index),
            _ => looked_up::<F>(index, dimension - 2),
        };
        let scramble = mixed(spread.xor(F::U32::splat(DIMENSIONS[dimension])));
        point[dimension] = in_unit_interval(owen_scrambled(row, scramble).reverse_bits());
    }
    point
}

/// The first dimension of the points of bit-reversed indices, bit-reversed: the radical inverse of van der Corput.
#[inline(always)]
fn radical_inverse<U: Bits>(index: U) -> U {
    index.reverse_bits().and(U::splat(0xffff))
}

/// The second dimension of the points of bit-reversed indices, bit-reversed: the product of the index and Pascal's triangle
/// modulo 2. Bit j is the exclusive or of those bits k of the index for which the binomial coefficient of k over j is odd:
/// by Lucas, those k that contain all bits of j. The step by s adds bit j + s to bit j wherever j lacks s, so after the
/// steps by 1, 2, 4 and 8, bit j is the sum over all k that contain j.
#[inline(always)]
fn pascal<U: Bits>(index: U) -> U {
    let n = radical_inverse(index);
    let n = n.xor(n.shr::<1>().and(U::splat(0x5555)));
    let n = n.xor(n.shr::<2>().and(U::splat(0x3333)));
    let n = n.xor(n.shr::<4>().and(U::splat(0x0f0f)));
    n.xor(n.shr::<8>())
}

/// One of the last two dimensions of the points of bit-reversed indices, bit-reversed.
#[inline(always)]
fn looked_up<F: Real>(index: F::U32, dimension: usize) -> F::U32 {
    let ([high, low], index) = (&*POINTS, index.to_array());
    let mut row = F::U32::splat(0).to_array();
    for lane in 0..F::LANES {
        let index = index[lane];
        row[lane] = high[(index >> 24) as usize][dimension] ^ low[(index >> 16 & 0xff) as usize][dimension];
    }
    F::U32::from_array(row)
}

/// Converts 32 bits to a number in 0..1.
#[inline(always)]
pub fn in_unit_interval<F: Real>(bits: F::U32) -> F {
    bits.to_f64() * F::splat(1.0 / 4_294_967_296.0)
}

/// Owen scrambling of a bit-reversed number by a well-mixed seed (`owen_scramble_rev` of `sobol_burley`, after Laine
/// and Karras 2011).
#[inline(always)]
fn owen_scrambled<U: Bits>(reversed: U, scramble: U) -> U {
    let n = reversed.xor(reversed.wrapping_mul(U::splat(0x3d20_adea)));
    let n = n.wrapping_add(scramble);
    let n = n.wrapping_mul(scramble.shr::<16>().or(U::splat(1)));
    let n = n.xor(n.wrapping_mul(U::splat(0x0552_6c56)));
    n.xor(n.wrapping_mul(U::splat(0x53a2_2864)))
}

/// Hashes a number: `lowbias32` of Wellons 2018, after an exclusive or that keeps 0 from mapping to 0.
#[inline(always)]
fn mixed<U: Bits>(n: U) -> U {
    let n = n.xor(U::splat(0xe6fe_3beb));
    let n = n.xor(n.shr::<16>()).wrapping_mul(U::splat(0x7feb_352d));
    let n = n.xor(n.shr::<15>()).wrapping_mul(U::splat(0x846c_a68b));
    n.xor(n.shr::<16>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_crate() {
        for seed in (0..64).map(|k: u32| k.wrapping_mul(0x9e37_79b9)) {
            for sample in (0..64).chain((64..1 << 16).step_by(97)) {
                let expected = sobol_burley::sample_4d(sample, 0, seed).map(f64::from);
                let found: [f64; 4] = point::<f64, 4>(sample, seed);
                for (found, expected) in found.into_iter().zip(expected) {
                    // The crate drops the last nine bits.
                    assert!((expected..expected + 1.0 / 8_388_608.0).contains(&found), "{sample} {seed}");
                }
            }
        }
    }
}
