//! Evaluates fits at pixels.

use super::super::columns::LANES;
use super::super::guides::{FEATURES, Guides};
use super::super::planes::COLUMN;
use super::strip::{Lanes, Strip};
use crate::base::lanes::{Real, Row};

/// The channels of a layer of light.
pub const CHANNELS: usize = 3;

/// The features that vary along a row of pixels: all but the last one.
pub const ALONG: usize = FEATURES - 1;

/// The fits of a layer to each channel along a row of pixels.
pub type Fit = [[Lanes; ALONG]; CHANNELS];

/// The fitted light of a layer in a row of pixels of a block, in lanes: the fits of the four windows around each pixel,
/// weighted as in bilinear interpolation. `fits` are those of the rows of windows above the pixels and below. `between`
/// is memory for a fit for each of their entries.
#[inline(always)]
pub fn evaluate<F: Real>(
    guides: &Guides,
    (y, block): (usize, usize),
    fits: [&Strip; 2],
    layer: usize,
    between: &mut [Fit],
    into: &mut [f32; CHANNELS * COLUMN * LANES],
) {
    let cell = COLUMN / (between.len() - 1);
    for (entry, between) in between.iter_mut().enumerate() {
        let [above, below] = fits.map(|fits| &fits.at(block, entry)[layer * CHANNELS * FEATURES..]);
        interpolate::<F>(above, below, (y, cell), between);
    }
    for (place, [left, right]) in between.array_windows().enumerate() {
        for x in place * cell..(place + 1) * cell {
            let (features, across) = (guides.features::<F>(y, block, x), share_of(x, cell));
            for channel in 0..CHANNELS {
                let (left, right) = (at(&left[channel], &features), at(&right[channel], &features));
                let light = left + (right - left) * F::splat(across);
                light.to_f32().store(into, (x * CHANNELS + channel) * LANES);
            }
        }
    }
}

/// The weight of the window at the far end of the cell in which a pixel lies.
fn share_of(position: usize, cell: usize) -> f64 {
    ((position % cell) as f64 + 0.5) / cell as f64
}

/// The fits for pixels of row `y` between windows above and below. They are functions of the guides but the last one,
/// which is the row: its part is in the constant.
#[inline(always)]
fn interpolate<F: Real>(above: &[Lanes], below: &[Lanes], (y, cell): (usize, usize), into: &mut Fit) {
    let share = F::splat(share_of(y, cell));
    let (above, below) = (above.as_chunks::<FEATURES>().0, below.as_chunks::<FEATURES>().0);
    for (fit, (above, below)) in into.iter_mut().zip(above.iter().zip(below)) {
        let mut constant = share;
        for feature in 0..FEATURES {
            let (first, second) = (above[feature].get::<F>(), below[feature].get::<F>());
            let coefficient = first + (second - first) * share;
            match feature {
                0 => constant = coefficient,
                ALONG => constant = constant + coefficient * F::splat(y as f64),
                _ => fit[feature].set(coefficient),
            }
        }
        fit[0].set(constant);
    }
}

/// The value of a fit to a channel. The first feature is 1.
#[inline(always)]
fn at<F: Real>(fit: &[Lanes; ALONG], features: &[F; FEATURES]) -> F {
    let mut sum = fit[0].get::<F>();
    for feature in 1..ALONG {
        sum = sum + fit[feature].get::<F>() * features[feature];
    }
    sum
}
