//! Evaluates fits at pixels.

use super::super::columns::LANES;
use super::super::guides::{FEATURES, Guides};
use super::super::planes::COLUMN;
use super::strip::Strip;
use crate::base::lanes::{Real, Row};

/// The channels of a layer of light.
const CHANNELS: usize = 3;

/// The features that vary along a row of pixels: all but the last one.
const ALONG: usize = FEATURES - 1;

/// The fit of a layer along a row of pixels.
type Fit<F> = [[F; ALONG]; CHANNELS];

/// The fitted light of a layer in a row of pixels, in lanes: the fits of the four windows around each pixel, weighted
/// as in bilinear interpolation. `fits` are those of the rows of windows above the pixels and below.
#[inline(always)]
pub fn evaluate<F: Real>(guides: &Guides, y: usize, fits: [&Strip; 2], layer: usize, into: &mut [f32]) {
    let [above, _] = fits;
    let (columns, cell) = (above.columns, COLUMN / above.places);
    for column in (0..columns.padded).step_by(LANES) {
        let mut left = between::<F>(fits, layer, above.at(0) + column, y);
        for place in 0..above.places {
            let right = between::<F>(fits, layer, above.after(place) + column, y);
            for x in place * cell..(place + 1) * cell {
                let (features, across) = (guides.features::<F>(y, x, column), share_of(x, cell));
                for channel in 0..CHANNELS {
                    let (left, right) = (at(&left[channel], &features), at(&right[channel], &features));
                    let light = left + (right - left) * F::splat(across);
                    light.to_f32().store(into, (channel * COLUMN + x) * columns.padded + column);
                }
            }
            left = right;
        }
    }
}

/// The weight of the window at the far end of the cell in which a pixel lies.
fn share_of(position: usize, cell: usize) -> f64 {
    ((position % cell) as f64 + 0.5) / cell as f64
}

/// The fit for pixels of row `y` between the windows above and below at the same index. It is a function of the guides
/// but the last one, which is the row: its part is in the constant.
#[inline(always)]
fn between<F: Real>([above, below]: [&Strip; 2], layer: usize, at: usize, y: usize) -> Fit<F> {
    let share = F::splat(share_of(y, COLUMN / above.places));
    let mut fit = [[share; ALONG]; CHANNELS];
    for (channel, fit) in fit.iter_mut().enumerate() {
        let mut at = at + (layer * CHANNELS + channel) * FEATURES * above.stride;
        for feature in 0..FEATURES {
            let (first, second) = (F::load(&above.numbers, at), F::load(&below.numbers, at));
            let coefficient = first + (second - first) * share;
            match feature < ALONG {
                true => fit[feature] = coefficient,
                false => fit[0] = fit[0] + coefficient * F::splat(y as f64),
            }
            at += above.stride;
        }
    }
    fit
}

/// The value of a fit. The first feature is 1.
#[inline(always)]
fn at<F: Real>(fit: &[F; ALONG], features: &[F; FEATURES]) -> F {
    let mut sum = fit[0];
    for feature in 1..ALONG {
        sum = sum + fit[feature] * features[feature];
    }
    sum
}
