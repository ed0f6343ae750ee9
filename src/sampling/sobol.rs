//! Four dimensions of Owen-scrambled Sobol points: those of `sobol_burley`, which goes through an index bit by bit, with
//! a look into a table for each byte instead.

use sobol_burley::parts::{
    Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev, sobol_int4_rev, u32_to_f32_norm,
};
use std::sync::LazyLock;

/// Points of indices, whose bits are reversed, with all bits but those of their highest or next byte clear. A point is
/// linear over its index' bits.
static POINTS: LazyLock<[[[u32; 4]; 256]; 2]> = LazyLock::new(|| {
    [24, 16].map(|shift| std::array::from_fn(|byte| sobol_int4_rev((byte as u32) << shift, 0).into()))
});

/// By which the crate scrambles indices, and dimensions.
const INDEX: u32 = 0x79c6_8e4a;
const DIMENSIONS: [u32; 4] = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8];
const SPREAD: u32 = 0x9c8f_2d3b;

/// `sobol_burley::sample_4d(sample, 0, seed)`, for samples below 2^16.
#[inline]
pub fn point(sample: u32, seed: u32) -> [f32; 4] {
    let index = owen_scramble_rev(sample.reverse_bits(), hash(seed ^ INDEX));
    let [high, low] = &*POINTS;
    let (high, low) = (high[(index >> 24) as usize], low[(index >> 16 & 0xff) as usize]);
    let point: [u32; 4] = std::array::from_fn(|dimension| high[dimension] ^ low[dimension]);
    let scramble = DIMENSIONS.map(|of| of ^ seed.wrapping_mul(SPREAD));
    owen_scramble_int4_rev(Int4::from(point), hash_int4(scramble.into())).reverse_bits().to_f32_norm()
}

/// [`point`] of eight, a row for each dimension. Loops over lanes, which compilers turn into what the processor has.
#[inline(always)]
pub fn points(samples: &[u32; 8], seeds: &[u32; 8]) -> [[f32; 8]; 4] {
    let [high, low] = &*POINTS;
    let mut dimensions = [[0; 8]; 4];
    let mut indices = [0; 8];
    for lane in 0..8 {
        indices[lane] = owen_scramble_rev(samples[lane].reverse_bits(), hash(seeds[lane] ^ INDEX));
    }
    for lane in 0..8 {
        let (high, low) =
            (&high[(indices[lane] >> 24) as usize], &low[(indices[lane] >> 16 & 0xff) as usize]);
        for (dimension, row) in dimensions.iter_mut().enumerate() {
            row[lane] = high[dimension] ^ low[dimension];
        }
    }
    let mut points = [[0.0; 8]; 4];
    for (dimension, row) in points.iter_mut().enumerate() {
        for lane in 0..8 {
            let scramble = hash(DIMENSIONS[dimension] ^ seeds[lane].wrapping_mul(SPREAD));
            row[lane] =
                u32_to_f32_norm(owen_scramble_rev(dimensions[dimension][lane], scramble).reverse_bits());
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_crate() {
        for seed in (0..64).map(|k: u32| k.wrapping_mul(0x9e37_79b9)) {
            for sample in (0..64).chain((64..1 << 16).step_by(97)) {
                let expected = sobol_burley::sample_4d(sample, 0, seed);
                assert_eq!(point(sample, seed), expected, "{sample} {seed}");
                let samples = std::array::from_fn(|lane| (sample + 5 * lane as u32) % (1 << 16));
                let seeds = std::array::from_fn(|lane| seed.rotate_left(lane as u32));
                let together = points(&samples, &seeds);
                for lane in 0..8 {
                    let expected = sobol_burley::sample_4d(samples[lane], 0, seeds[lane]);
                    assert_eq!(together.map(|row| row[lane]), expected, "{sample} {seed}, lane {lane}");
                }
            }
        }
    }
}
