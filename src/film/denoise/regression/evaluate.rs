//! Evaluates fits at pixels.

use super::super::columns::LANES;
use super::super::guides::{FEATURES, Guides, PixelFeatures};
use super::super::planes::COLUMN;
use super::strip::{Lanes, Strip};
use crate::base::lanes::{Real, Row};
use std::mem::swap;
use std::ops::Range;

/// The channels of a layer of light.
pub const CHANNELS: usize = 3;

/// The features that vary along a row of pixels: all but the last one.
pub const ALONG: usize = FEATURES - 1;

/// The fits of a layer to each channel along a row of pixels.
pub type Fit = [[Lanes; ALONG]; CHANNELS];

/// The rows of pixels in which fits are evaluated at once: those of windows are read once for both. Cells have as many,
/// or several times as many.
pub const ROWS: usize = 2;

/// The pixels of a row at which fits are evaluated at once, likewise.
const PIXELS: usize = 2;

/// The fitted light of a layer in one or two rows of pixels of a block, in lanes: the fits of the four windows around
/// each pixel, weighted as in bilinear interpolation. `fits` are those of the rows of windows above the pixels and
/// below, in cells of the side `cell`. `beside` is memory for the fits on the left of a cell and on its right.
#[inline(always)]
pub fn evaluate<F: Real>(
    guides: &Guides,
    (rows, block, cell): (&Range<usize>, usize, usize),
    fits: [&Strip; 2],
    layer: usize,
    beside: &mut [[Fit; ROWS]; 2],
    into: &mut [[f32; CHANNELS * COLUMN * LANES]; ROWS],
) {
    // Cells are powers of two, so a factor is as exact as a division.
    let size = 1.0 / cell as f64;
    let share_of = |place: usize| ((place & (cell - 1)) as f64 + 0.5) * size;
    let down = [share_of(rows.start), share_of(rows.start + 1)];
    let [mut left, mut right] = beside.each_mut();
    for entry in 0..=COLUMN / cell {
        let [above, below] = fits.map(|fits| &fits.at(block, entry)[layer * CHANNELS * FEATURES..]);
        interpolate::<F>(above, below, (rows.start, down), right);
        let first = entry.saturating_sub(1) * cell;
        for (y, (into, (left, right))) in rows.clone().zip(into.iter_mut().zip(left.iter().zip(&*right))) {
            for x in (first..entry * cell).step_by(PIXELS) {
                let features = [guides.pixels(y, block, x), guides.pixels(y, block, x + 1)];
                let [left, right] = [at::<F>(left, features), at::<F>(right, features)];
                for pixel in 0..PIXELS {
                    let across = F::splat(share_of(x + pixel));
                    for channel in 0..CHANNELS {
                        let (left, right) = (left[pixel][channel], right[pixel][channel]);
                        let light = left + (right - left) * across;
                        light.to_f32().store(into, ((x + pixel) * CHANNELS + channel) * LANES);
                    }
                }
            }
        }
        swap(&mut left, &mut right);
    }
}

/// The fits for pixels of row `y` and of the next one, between windows above and below, by the share of those below.
/// They are functions of the guides but the last one, which is the row: its part is in the constant.
#[inline(always)]
fn interpolate<F: Real>(
    above: &[Lanes],
    below: &[Lanes],
    (y, shares): (usize, [f64; ROWS]),
    into: &mut [Fit; ROWS],
) {
    let (above, below) = (above.as_chunks::<FEATURES>().0, below.as_chunks::<FEATURES>().0);
    for (channel, (above, below)) in above.iter().zip(below).enumerate().take(CHANNELS) {
        let mut constants = [F::splat(0.0); ROWS];
        for feature in 0..FEATURES {
            let first = above[feature].get::<F>();
            let difference = below[feature].get::<F>() - first;
            for row in 0..ROWS {
                let coefficient = first + difference * F::splat(shares[row]);
                match feature {
                    0 => constants[row] = coefficient,
                    ALONG => {
                        constants[row] = constants[row] + coefficient * F::splat((y + row) as f64);
                        into[row][channel][0].set(constants[row]);
                    }
                    _ => into[row][channel][feature].set(coefficient),
                }
            }
        }
    }
}

/// The values of the fits to all channels. The first feature is 1. All sums grow at once, as each of them waits for its
/// last addition.
#[inline(always)]
fn at<F: Real>(fits: &Fit, pixels: [PixelFeatures; PIXELS]) -> [[F; CHANNELS]; PIXELS] {
    let [red, green, blue] = fits;
    let mut sums = [[red[0].get::<F>(), green[0].get::<F>(), blue[0].get::<F>()]; PIXELS];
    for feature in 1..ALONG {
        let slopes = [red[feature].get::<F>(), green[feature].get::<F>(), blue[feature].get::<F>()];
        for (sums, pixel) in sums.iter_mut().zip(pixels) {
            let number = pixel.get::<F>(feature);
            for channel in 0..CHANNELS {
                sums[channel] = sums[channel] + slopes[channel] * number;
            }
        }
    }
    sums
}
