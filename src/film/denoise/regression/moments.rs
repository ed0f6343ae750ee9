//! Sums over cells: all that least squares need to know of their pixels.

use super::super::guides::{FEATURES, Guides};
use super::light::LightRows;
use super::strip::Lanes;
use crate::base::lanes::Real;

/// Entries of a symmetric matrix over the features.
pub const PAIRS: usize = FEATURES * (FEATURES + 1) / 2;

/// The number of sums of a cell: the products of all pairs of features, the first of which is the number of pixels, and
/// for each channel of light the products with all features.
pub const fn count(channels: usize) -> usize {
    PAIRS + channels * FEATURES
}

/// Pixels of the smallest cells, as row and place in the cell.
const PIXELS: [(usize, usize); 4] = [(0, 0), (0, 1), (1, 0), (1, 1)];

/// Sums the pixels of one of the smallest cells in the columns of a block. The `light` is that of its two rows of
/// pixels.
#[inline(always)]
pub fn sum_pixels<F: Real>(
    guides: &Guides,
    light: &LightRows,
    (row, block, place): (usize, usize, usize),
    into: &mut [Lanes],
) {
    let mut features = [[Lanes::ZERO; FEATURES]; PIXELS.len()];
    for ((y, x), features) in PIXELS.iter().zip(&mut features) {
        if 2 * row + y < guides.height {
            let own = guides.features::<F>(2 * row + y, block, 2 * place + x);
            for feature in 0..FEATURES {
                features[feature].set(own[feature]);
            }
        }
    }
    let [a, b, c, d] = &features;
    let mut into = into.iter_mut();
    for one in 0..FEATURES {
        let (ones, twos) = ((a[one].get::<F>(), b[one].get::<F>()), (c[one].get::<F>(), d[one].get::<F>()));
        for (other, into) in (0..=one).zip(into.by_ref()) {
            let first = ones.0 * a[other].get::<F>() + ones.1 * b[other].get::<F>();
            let second = twos.0 * c[other].get::<F>() + twos.1 * d[other].get::<F>();
            into.set(first + second);
        }
    }
    for channel in 0..light.channels {
        let mut values = [F::splat(0.0); PIXELS.len()];
        for ((y, x), value) in PIXELS.iter().zip(&mut values) {
            *value = light.at(*y, channel, block, 2 * place + x);
        }
        for (feature, into) in (0..FEATURES).zip(into.by_ref()) {
            let first = a[feature].get::<F>() * values[0] + b[feature].get::<F>() * values[1];
            let second = c[feature].get::<F>() * values[2] + d[feature].get::<F>() * values[3];
            into.set(first + second);
        }
    }
}
