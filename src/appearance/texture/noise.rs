//! Gradient noise: a smooth pseudorandom function of space.

use super::footprint::contrast;
use crate::base::math::DVec3;

/// Gradient noise (Perlin, *Improving Noise*, 2002) with another hash. Its values are in about -1..=1. They are 0 where
/// all coordinates are whole numbers.
pub fn noise(point: DVec3, seed: u32) -> f64 {
    let corner = point.floor();
    let inside = point - corner;
    let fade = inside * inside * inside * (inside * (inside * 6.0 - 15.0) + 10.0);
    let mut sum = 0.0;
    for i in 0..8 {
        let at = [i & 1, i >> 1 & 1, i >> 2].map(f64::from);
        let offset = DVec3::from_array(at);
        let weight = (offset * fade + (DVec3::ONE - offset) * (DVec3::ONE - fade)).element_product();
        sum += weight * along_gradient(hash(corner + offset, seed), inside - offset);
    }
    sum
}

/// The normalised sum of `octaves` octaves of noise, each with half the size and half the strength of the one before.
/// Octaves that are too small for a pixel of `width` units fade out.
pub fn fractal_noise(point: DVec3, octaves: u32, seed: u32, width: f64) -> f64 {
    sum(point, octaves, seed, width, |noise| noise)
}

/// [`fractal_noise`] of absolute values, which has sharp valleys (Perlin's turbulence); in 0..=1.
pub fn turbulence(point: DVec3, octaves: u32, seed: u32, width: f64) -> f64 {
    sum(point, octaves, seed, width, f64::abs)
}

fn sum(mut point: DVec3, octaves: u32, seed: u32, mut width: f64, of: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut strength, mut whole) = (0.0, 1.0, 0.0);
    for octave in 0..octaves {
        // Each octave has its own gradients. Otherwise all would agree near the origin.
        let left = strength * contrast(width);
        if left > 0.0 {
            sum += left * of(noise(point, seed.wrapping_add(octave)));
        }
        whole += strength;
        strength *= 0.5;
        point *= 2.0;
        width *= 2.0;
    }
    sum / whole
}

/// The dot product of `v` with one of the twelve directions to the midpoints of a cube's edges.
fn along_gradient(hash: u64, v: DVec3) -> f64 {
    let (a, b) = [(v.x, v.y), (v.y, v.z), (v.z, v.x)][(hash >> 2) as usize % 3];
    let sign = |bit: u64| if hash & bit == 0 { 1.0 } else { -1.0 };
    a * sign(1) + b * sign(2)
}

/// Hashes a point of whole coordinates, one coordinate after the other (the finalizer of splitmix64).
fn hash(corner: DVec3, seed: u32) -> u64 {
    corner.to_array().into_iter().fold(u64::from(seed), |hash, coordinate| {
        let mut z = hash.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ coordinate as i64 as u64;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn zero_at_whole_points_and_smooth_between() {
        let mut random = Random(3);
        for _ in 0..2000 {
            assert_eq!(noise(random.point(20.0).floor(), 5), 0.0);
            let (p, step) = (random.point(20.0), random.direction() * 1e-6);
            assert!((noise(p + step, 5) - noise(p, 5)).abs() < 1e-5);
        }
    }

    #[test]
    fn values_fill_their_range_and_no_more() {
        let mut random = Random(4);
        let values: Vec<_> = (0..20_000).map(|_| noise(random.point(500.0), 0)).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
        assert!(values.iter().all(|v| v.abs() <= 1.1), "bounded");
        assert!(mean.abs() < 0.01 && (0.2..0.35).contains(&square.sqrt()), "{mean} {}", square.sqrt());
    }

    #[test]
    fn neighbouring_cells_and_seeds_differ() {
        let middle = |x: f64, seed| noise(DVec3::new(x + 0.3, 0.4, 0.2), seed);
        let row: Vec<_> = (-50..50).map(|x| middle(f64::from(x), 0)).collect();
        assert!(row.iter().filter(|v| **v > 0.0).count().abs_diff(50) < 20);
        assert!((0..20).any(|seed| middle(0.0, seed) != middle(0.0, seed + 1)));
        assert_ne!(middle(-1.0, 0), middle(0.0, 0), "cells do not mirror at 0");
    }

    #[test]
    fn far_away_is_no_trouble() {
        for far in [1e15, 1e18, -1e30, 1e300] {
            assert!(fractal_noise(DVec3::new(far, -far, 0.5), 8, 1, 0.0).is_finite());
        }
    }
}
