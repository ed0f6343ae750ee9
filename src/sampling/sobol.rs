//! Four dimensions of Owen-scrambled Sobol points: those of `sobol_burley`, which goes through an index bit by bit, with
//! a look into a table for each byte instead.

use sobol_burley::parts::{Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev, sobol_int4_rev};
use std::sync::LazyLock;

/// Points of indices, whose bits are reversed, with all bits but those of their highest or next byte clear. A point is
/// linear over its index' bits.
static POINTS: LazyLock<[[[u32; 4]; 256]; 2]> = LazyLock::new(|| {
    [24, 16].map(|shift| std::array::from_fn(|byte| sobol_int4_rev((byte as u32) << shift, 0).into()))
});

/// `sobol_burley::sample_4d(sample, 0, seed)`, for samples below 2^16.
#[inline]
pub fn point(sample: u32, seed: u32) -> [f32; 4] {
    let index = owen_scramble_rev(sample.reverse_bits(), hash(seed ^ 0x79c6_8e4a));
    let [high, low] = &*POINTS;
    let (high, low) = (high[(index >> 24) as usize], low[(index >> 16 & 0xff) as usize]);
    let point: [u32; 4] = std::array::from_fn(|dimension| high[dimension] ^ low[dimension]);
    // As the crate scrambles its dimensions.
    let scramble = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8]
        .map(|of: u32| of ^ seed.wrapping_mul(0x9c8f_2d3b));
    owen_scramble_int4_rev(Int4::from(point), hash_int4(scramble.into())).reverse_bits().to_f32_norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_crate() {
        for seed in (0..64).map(|k: u32| k.wrapping_mul(0x9e37_79b9)) {
            for sample in (0..64).chain((64..1 << 16).step_by(97)) {
                assert_eq!(point(sample, seed), sobol_burley::sample_4d(sample, 0, seed), "{sample} {seed}");
            }
        }
    }
}
