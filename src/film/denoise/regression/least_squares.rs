//! Least squares: fits the light of windows to their features.

use super::super::guides::{COUNT, FEATURES, POSITION};
use super::moments::PAIRS;
use super::strip::Lanes;
use crate::base::lanes::Real;

/// What is added to the variance of a guide in a window, so that guides which hardly vary in it have no influence: a
/// hundredth of the range of an albedo, squared. Positions have cells as their unit.
const RIDGE: f64 = 1e-4;

/// The place of an entry of a lower triangular matrix.
const fn entry(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// The entries of a lower triangular matrix over the guides.
pub type Factors = [Lanes; COUNT * (COUNT + 1) / 2];

/// Repeats a block for each of the guides, with its number as a constant. Arrays over the guides are in registers then,
/// which the compiler does not find in nested loops.
macro_rules! for_guides {
    ($guide:ident => $body:block) => {
        for_guides!($guide => $body, 0 1 2 3 4 5 6 7 8)
    };
    ($guide:ident => $body:block, $($number:literal)*) => {
        $({
            const $guide: usize = $number;
            $body
        })*
    };
}

/// Fits the light of the windows of a block to their features, each channel by a constant and slopes.
///
/// The covariances of the guides are decomposed to L D Lᵀ: that is Cholesky's decomposition without its roots. `lower`
/// is memory for L below its diagonal, which is 1.
#[inline(always)]
pub fn fit_window<F: Real>(sums: &[Lanes], cell: usize, lower: &mut Factors, fits: &mut [Lanes]) {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let Some((sums, products)) = sums.split_first_chunk::<PAIRS>() else { return };
    // 1 over the number of pixels, and 1 / D.
    let share = one / sums[0].get::<F>();
    let (mut means, mut inverses) = ([zero; COUNT], [zero; COUNT]);
    for_guides!(GUIDE => { means[GUIDE] = sums[entry(GUIDE + 1, 0)].get::<F>() * share; });
    // The entries of L D in a row.
    let mut scaled = [zero; COUNT];
    for_guides!(ROW => {
        for_guides!(COLUMN => {
            if COLUMN <= ROW {
                let mut rest =
                    sums[entry(ROW + 1, COLUMN + 1)].get::<F>() * share - means[ROW] * means[COLUMN];
                if COLUMN == ROW {
                    let ridge = if ROW < POSITION { RIDGE } else { RIDGE * (cell * cell) as f64 };
                    // Rounding may make the variance of a large guide negative.
                    rest = rest.max(zero) + F::splat(ridge);
                }
                for_guides!(K => {
                    if K < COLUMN {
                        rest = rest - scaled[K] * lower[entry(COLUMN, K)].get::<F>();
                    }
                });
                if COLUMN < ROW {
                    scaled[COLUMN] = rest;
                    lower[entry(ROW, COLUMN)].set(rest * inverses[COLUMN]);
                } else {
                    // The ridge keeps the diagonal positive but for rounding.
                    inverses[ROW] = one / rest.max(F::splat(f64::EPSILON));
                }
            }
        });
    });
    let products = products.as_chunks::<FEATURES>().0;
    for (products, into) in products.iter().zip(fits.as_chunks_mut::<FEATURES>().0) {
        let light = products[0].get::<F>() * share;
        let mut fit = [zero; COUNT];
        for_guides!(ROW => {
            let mut rest = products[ROW + 1].get::<F>() * share - light * means[ROW];
            for_guides!(K => {
                if K < ROW {
                    rest = rest - fit[K] * lower[entry(ROW, K)].get::<F>();
                }
            });
            fit[ROW] = rest;
        });
        let mut constant = light;
        for_guides!(BELOW => {
            const ROW: usize = COUNT - 1 - BELOW;
            let mut rest = fit[ROW] * inverses[ROW];
            for_guides!(K => {
                if K > ROW {
                    rest = rest - fit[K] * lower[entry(K, ROW)].get::<F>();
                }
            });
            fit[ROW] = rest;
            into[ROW + 1].set(rest);
            constant = constant - rest * means[ROW];
        });
        into[0].set(constant);
    }
}
