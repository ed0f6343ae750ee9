//! Sums over cells: all that least squares need to know of their pixels.

use super::super::columns::LANES;
use super::super::guides::{FEATURES, Guides};
use super::light::LightRows;
use super::strip::Strip;
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

/// Sums the pixels of a row of the smallest cells. The `light` is that of its two rows of pixels.
#[inline(always)]
pub fn sum_pixels<F: Real>(guides: &Guides, light: &LightRows, row: usize, cells: &mut Strip) {
    let columns = cells.columns;
    for place in 0..cells.places {
        for column in (0..columns.padded).step_by(LANES) {
            let mut features = [[F::splat(0.0); FEATURES]; PIXELS.len()];
            for ((y, x), features) in PIXELS.iter().zip(&mut features) {
                *features = guides.features(2 * row + y, 2 * place + x, column);
            }
            let [a, b, c, d] = &features;
            let mut into = cells.at(place) + column;
            for one in 0..FEATURES {
                for other in 0..=one {
                    let sum =
                        (a[one] * a[other] + b[one] * b[other]) + (c[one] * c[other] + d[one] * d[other]);
                    sum.store(&mut cells.numbers, into);
                    into += cells.stride;
                }
            }
            for channel in 0..light.channels {
                let mut values = [F::splat(0.0); PIXELS.len()];
                for ((y, x), value) in PIXELS.iter().zip(&mut values) {
                    *value = light.at(*y, channel, 2 * place + x, column);
                }
                for feature in 0..FEATURES {
                    let first = a[feature] * values[0] + b[feature] * values[1];
                    let second = c[feature] * values[2] + d[feature] * values[3];
                    (first + second).store(&mut cells.numbers, into);
                    into += cells.stride;
                }
            }
        }
    }
}

/// Sums two rows of cells to one of cells of twice the side.
#[inline(always)]
pub fn sum_cells<F: Real>([above, below]: [&Strip; 2], into: &mut Strip) {
    for value in 0..into.numbers.len() / into.stride {
        for place in 0..into.places {
            for column in (0..into.columns.padded).step_by(LANES) {
                let [left, right] =
                    [2 * place, 2 * place + 1].map(|place| value * above.stride + above.at(place) + column);
                let sum = (F::load(&above.numbers, left) + F::load(&above.numbers, right))
                    + (F::load(&below.numbers, left) + F::load(&below.numbers, right));
                let at = value * into.stride + into.at(place) + column;
                sum.store(&mut into.numbers, at);
            }
        }
    }
}
