//! Least squares: fits the light of windows to their features.

use super::super::guides::{COUNT, FEATURES, POSITION};
use super::moments::{PAIRS, entry};
use super::strip::Lanes;
use crate::base::lanes::Real;

/// What is added to the variance of a guide in a window, so that guides which hardly vary in it have no influence: a
/// hundredth of the range of an albedo, squared. Positions have cells as their unit.
const RIDGE: f64 = 1e-4;

const _: () = assert!(COUNT == 9, "`for_guides` names each guide");

/// The entries of a lower triangular matrix over the guides.
pub type Factors = [Lanes; COUNT * (COUNT + 1) / 2];

/// Repeats a block for each of the guides, with its number written out. Arrays over the guides are in registers then,
/// which the compiler does not find in nested loops.
macro_rules! for_guides {
    ($guide:ident => $body:block) => {
        for_guides!($guide => $body, 0 1 2 3 4 5 6 7 8)
    };
    ($guide:ident => $body:block, $($number:literal)*) => {
        $({
            let $guide: usize = $number;
            $body
        })*
    };
}

/// Fits the light of the windows of a block to their features, each channel by a constant and slopes.
///
/// The covariances of the guides are decomposed to L D Lᵀ: that is Cholesky's decomposition without its roots. `lower`
/// is memory for L below its diagonal, which is 1.
#[inline(always)]
#[allow(unused_assignments, reason = "what the last repetitions assign is for those that do not follow")]
pub fn fit_window<F: Real>(sums: &[Lanes], cell: usize, lower: &mut Factors, fits: &mut [Lanes]) {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let Some((sums, products)) = sums.split_first_chunk::<PAIRS>() else { return };
    // 1 over the number of pixels, and 1 / D.
    let share = one / sums[0].get::<F>();
    let (mut means, mut inverses) = ([zero; COUNT], [zero; COUNT]);
    for_guides!(guide => { means[guide] = sums[entry(guide + 1, 0)].get::<F>() * share; });
    // The entries of L D in a row.
    let mut scaled = [zero; COUNT];
    for_guides!(row => {
        for_guides!(column => {
            if column <= row {
                let mut rest =
                    sums[entry(row + 1, column + 1)].get::<F>() * share - means[row] * means[column];
                if column == row {
                    let ridge = if row < POSITION { RIDGE } else { RIDGE * (cell * cell) as f64 };
                    // Rounding may make the variance of a large guide negative.
                    rest = rest.max(zero) + F::splat(ridge);
                }
                for_guides!(k => {
                    if k < column {
                        rest = rest - scaled[k] * lower[entry(column, k)].get::<F>();
                    }
                });
                if column < row {
                    scaled[column] = rest;
                    lower[entry(row, column)].set(rest * inverses[column]);
                } else {
                    // The ridge keeps the diagonal positive but for rounding.
                    inverses[row] = one / rest.max(F::splat(f64::EPSILON));
                }
            }
        });
    });
    let products = products.as_chunks::<FEATURES>().0;
    for (products, into) in products.iter().zip(fits.as_chunks_mut::<FEATURES>().0) {
        let light = products[0].get::<F>() * share;
        let mut fit = [zero; COUNT];
        for_guides!(row => {
            let mut rest = products[row + 1].get::<F>() * share - light * means[row];
            for_guides!(k => {
                if k < row {
                    rest = rest - fit[k] * lower[entry(row, k)].get::<F>();
                }
            });
            fit[row] = rest;
        });
        let mut constant = light;
        for_guides!(below => {
            let row = COUNT - 1 - below;
            let mut rest = fit[row] * inverses[row];
            for_guides!(k => {
                if k > row {
                    rest = rest - fit[k] * lower[entry(k, row)].get::<F>();
                }
            });
            fit[row] = rest;
            into[row + 1].set(rest);
            constant = constant - rest * means[row];
        });
        into[0].set(constant);
    }
}
