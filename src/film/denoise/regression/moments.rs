//! Sums over cells: all that least squares need to know of their pixels.

use super::super::guides::{FEATURES, Guides};
use super::evaluate::ALONG;
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

/// The place of an entry of a lower triangular matrix.
pub const fn entry(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

const _: () = assert!(FEATURES == 10, "`for_features` names each feature");

/// Repeats a block for each of the features, with its number written out: loops over them are not unrolled otherwise.
macro_rules! for_features {
    ($feature:ident => $body:block) => {
        for_features!($feature => $body, 0 1 2 3 4 5 6 7 8 9)
    };
    ($feature:ident => $body:block, $($number:literal)*) => {
        $({
            let $feature: usize = $number;
            $body
        })*
    };
}

/// Where the sums of a cell go.
pub trait Sink {
    /// Takes one of the sums.
    fn take<F: Real>(&mut self, index: usize, sum: F);
}

/// Sums the pixels of one of the smallest cells in the columns of a block. The `light` is that of its two rows of
/// pixels. Each sum goes on while it is in a register.
#[inline(always)]
pub fn sum_pixels<F: Real>(
    guides: &Guides,
    light: &LightRows,
    (row, block, place): (usize, usize, usize),
    sink: &mut impl Sink,
) {
    let mut features = [[Lanes::ZERO; FEATURES]; PIXELS.len()];
    for ((y, x), features) in PIXELS.iter().zip(&mut features) {
        let y = 2 * row + y;
        if y < guides.height {
            let own = guides.pixels(y, block, 2 * place + x);
            for_features!(feature => {
                let number = match feature {
                    ALONG => own.get::<F>(0) * F::splat(y as f64),
                    _ => own.get::<F>(feature),
                };
                features[feature].set(number);
            });
        }
    }
    let [a, b, c, d] = &features;
    for_features!(one => {
        let (ones, twos) = ((a[one].get::<F>(), b[one].get::<F>()), (c[one].get::<F>(), d[one].get::<F>()));
        for_features!(other => {
            if other <= one {
                let first = ones.0 * a[other].get::<F>() + ones.1 * b[other].get::<F>();
                let second = twos.0 * c[other].get::<F>() + twos.1 * d[other].get::<F>();
                sink.take::<F>(entry(one, other), first + second);
            }
        });
    });
    for channel in 0..light.channels {
        let mut values = [F::splat(0.0); PIXELS.len()];
        for ((y, x), value) in PIXELS.iter().zip(&mut values) {
            *value = light.at(*y, channel, block, 2 * place + x);
        }
        for_features!(feature => {
            let first = a[feature].get::<F>() * values[0] + b[feature].get::<F>() * values[1];
            let second = c[feature].get::<F>() * values[2] + d[feature].get::<F>() * values[3];
            sink.take::<F>(PAIRS + channel * FEATURES + feature, first + second);
        });
    }
}
