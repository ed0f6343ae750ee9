//! Gradient noise: a smooth pseudorandom function of space (Perlin, *Improving Noise*, 2002), with another hash. Its values
//! are in about -1..=1. They are 0 where all coordinates are whole numbers.

use super::footprint::contrast;
use crate::base::lanes::{Level, Real, Row, SimdKernel, dispatch};
use crate::base::math::DVec3;

/// The normalised sum of `octaves` octaves of noise, each with half the size and half the strength of the one before.
/// Octaves that are too small for a pixel of `width` units fade out.
pub fn fractal_noise(point: DVec3, octaves: u32, seed: u32, width: f64) -> f64 {
    dispatch(Octaves { point, octaves, seed, width, is_turbulent: false })
}

/// [`fractal_noise`] of absolute values, which has sharp valleys (Perlin's turbulence); in 0..=1.
pub fn turbulence(point: DVec3, octaves: u32, seed: u32, width: f64) -> f64 {
    dispatch(Octaves { point, octaves, seed, width, is_turbulent: true })
}

/// A sum of octaves.
struct Octaves {
    point: DVec3,
    octaves: u32,
    seed: u32,
    width: f64,
    /// Whether absolute values are summed.
    is_turbulent: bool,
}

impl SimdKernel for Octaves {
    type Output = f64;

    #[inline(always)]
    fn run<L: Level>(self) -> f64 {
        let Self { mut point, octaves, seed, mut width, is_turbulent } = self;
        let (mut sum, mut strength, mut whole) = (0.0, 1.0, 0.0);
        for octave in 0..octaves {
            // Each octave has its own gradients. Otherwise all would agree near the origin.
            let left = strength * contrast(width);
            if left > 0.0 {
                let noise = at_corners::<L>(point, seed.wrapping_add(octave));
                sum += left * if is_turbulent { noise.abs() } else { noise };
            }
            whole += strength;
            strength *= 0.5;
            point *= 2.0;
            width *= 2.0;
        }
        sum / whole
    }
}

/// The offsets of the corners of a cell along each axis. The first corner is in lane 0.
const OFFSETS: [[f64; 8]; 3] = [
    [0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0],
    [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0],
    [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
];

/// Gradient noise at a point: the weighted sum over the eight corners of its cell, one in each lane.
#[inline(always)]
fn at_corners<L: Level>(point: DVec3, seed: u32) -> f64 {
    let splat = L::F64::splat;
    let (one, six, ten, fifteen) = (splat(1.0), splat(6.0), splat(10.0), splat(15.0));
    let (mut weight, mut hashes, mut away) = (one, [u64::from(seed); 8], [one; 3]);
    for axis in 0..3 {
        let (coordinate, offset) = (splat(point[axis]), L::F64::load(&OFFSETS[axis], 0));
        let corner = coordinate.floor();
        let inside = coordinate - corner;
        let fade = inside * inside * inside * (inside * (inside * six - fifteen) + ten);
        weight = weight * (offset * fade + (one - offset) * (one - fade));
        away[axis] = inside - offset;
        let corners = (corner + offset).to_array();
        // The first corner and the last one are on different sides along every axis.
        let ends = [corners[0] as i64 as u64, corners[7] as i64 as u64];
        for lane in 0..8 {
            hashes[lane] = hashed(hashes[lane], ends[lane >> axis & 1]);
        }
    }
    let mut gradients = [[0.0; 8]; 3];
    for lane in 0..8 {
        [gradients[0][lane], gradients[1][lane], gradients[2][lane]] = gradient(hashes[lane]);
    }
    let ([x, y, z], [u, v, w]) = (away, gradients);
    let along = x * L::F64::load(&u, 0) + y * L::F64::load(&v, 0) + z * L::F64::load(&w, 0);
    let parts = (weight * along).to_array();
    let mut sum = 0.0;
    for part in parts {
        sum += part;
    }
    sum
}

/// One of the twelve directions to the midpoints of a cube's edges. Without branches, so that compilers use lanes.
#[inline(always)]
fn gradient(hash: u64) -> [f64; 3] {
    let edge = modulo_3(hash >> 2);
    let (second, third) = ((edge & 1).wrapping_neg(), (edge >> 1).wrapping_neg());
    let (first, one) = (!(second | third), 1f64.to_bits());
    let (a, b) = (one | hash << 63, one | (hash >> 1) << 63);
    let (x, y, z) = ((a & first) | (b & third), (b & first) | (a & second), (b & second) | (a & third));
    [f64::from_bits(x), f64::from_bits(y), f64::from_bits(z)]
}

/// The remainder after division by 3. Powers of 4 leave 1, so the number's pieces are added until it is small.
#[inline(always)]
fn modulo_3(n: u64) -> u64 {
    let n = (n & 0xffff_ffff) + (n >> 32);
    let n = (n & 0xffff) + (n >> 16);
    let n = (n & 0xff) + (n >> 8);
    // It is at most 830 now, and the quotient is exact below 1025.
    n - 3 * ((n * 683) >> 11)
}

/// Hashes one more whole coordinate of a point (the finalizer of splitmix64).
#[inline(always)]
fn hashed(hash: u64, coordinate: u64) -> u64 {
    let mut z = hash.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ coordinate;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::lanes::tests::on_all_levels;
    use crate::testing::Random;

    fn noise(point: DVec3, seed: u32) -> f64 {
        fractal_noise(point, 1, seed, 0.0)
    }

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

    /// The definition, corner by corner.
    fn expected(point: DVec3, seed: u32) -> f64 {
        let corner = point.floor();
        let inside = point - corner;
        let fade = inside * inside * inside * (inside * (inside * 6.0 - 15.0) + 10.0);
        let mut sum = 0.0;
        for i in 0..8 {
            let offset = DVec3::from_array([i & 1, i >> 1 & 1, i >> 2].map(f64::from));
            let weight = (offset * fade + (DVec3::ONE - offset) * (DVec3::ONE - fade)).element_product();
            let coordinates = (corner + offset).to_array().map(|coordinate| coordinate as i64 as u64);
            let hash = coordinates.into_iter().fold(u64::from(seed), hashed);
            let v = inside - offset;
            let (a, b) = [(v.x, v.y), (v.y, v.z), (v.z, v.x)][((hash >> 2) % 3) as usize];
            let sign = |bit: u64| if hash & bit == 0 { 1.0 } else { -1.0 };
            sum += weight * (a * sign(1) + b * sign(2));
        }
        sum
    }

    #[test]
    fn corners_at_once_are_corners_one_by_one() {
        let mut random = Random(6);
        for _ in 0..20_000 {
            let reach = libm::pow(10.0, 12.0 * random.unit());
            let point = random.point(reach);
            let seed = (random.unit() * 4e9) as u32;
            for (level, found) in on_all_levels(|| noise(point, seed)) {
                assert_eq!(found, expected(point, seed), "{level:?} {point}");
            }
        }
    }

    #[test]
    fn far_away_is_no_trouble() {
        for far in [1e15, 1e18, -1e30, 1e300] {
            assert!(fractal_noise(DVec3::new(far, -far, 0.5), 8, 1, 0.0).is_finite());
        }
    }
}
