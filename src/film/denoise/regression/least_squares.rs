//! Least squares: fits the light of windows to their features.

use super::super::columns::LANES;
use super::super::guides::{COUNT, FEATURES, POSITION};
use super::moments::PAIRS;
use super::strip::Strip;
use crate::base::lanes::Real;

/// What is added to the variance of a guide in a window, so that guides which hardly vary in it have no influence: a
/// hundredth of the range of an albedo, squared. Positions have cells as their unit.
const RIDGE: f64 = 1e-4;

/// The place of an entry of a lower triangular matrix.
const fn entry(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// The fits of a row of windows, each of four cells around a corner. The windows have the places of their lower right
/// cells.
#[inline(always)]
pub fn fit_windows<F: Real>([above, below]: [&Strip; 2], cell: usize, fits: &mut Strip) {
    for place in 0..above.places {
        // The last window of a row may be the first one of a column that the picture no longer has.
        let columns = above.columns.count + usize::from(place == 0);
        for column in (0..columns).step_by(LANES) {
            let cells = [above.before(place) + column, above.at(place) + column];
            let mut sums = [F::splat(0.0); PAIRS];
            for (value, sum) in sums.iter_mut().enumerate() {
                *sum = sum_window([above, below], cells, value);
            }
            let equations = NormalEquations::new(&sums, cell);
            let mut into = fits.at(place) + column;
            let values = fits.numbers.len() / fits.stride;
            for first in (0..values).step_by(FEATURES) {
                let mut products = [F::splat(0.0); FEATURES];
                for (feature, product) in products.iter_mut().enumerate() {
                    *product = sum_window([above, below], cells, PAIRS + first + feature);
                }
                for coefficient in equations.solve(&products) {
                    coefficient.store(&mut fits.numbers, into);
                    into += fits.stride;
                }
            }
        }
    }
}

/// A sum over the pixels of a window.
#[inline(always)]
fn sum_window<F: Real>([above, below]: [&Strip; 2], [left, right]: [usize; 2], value: usize) -> F {
    let at = value * above.stride;
    (F::load(&above.numbers, at + left) + F::load(&above.numbers, at + right))
        + (F::load(&below.numbers, at + left) + F::load(&below.numbers, at + right))
}

/// The normal equations of a window: the covariances of the guides, decomposed to L D Lᵀ. That is Cholesky's
/// decomposition without its roots.
struct NormalEquations<F> {
    /// 1 over the number of pixels.
    share: F,
    means: [F; COUNT],
    /// L below its diagonal, which is 1.
    lower: [F; COUNT * (COUNT + 1) / 2],
    /// 1 / D.
    inverses: [F; COUNT],
}

impl<F: Real> NormalEquations<F> {
    #[inline(always)]
    fn new(sums: &[F; PAIRS], cell: usize) -> Self {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let share = one / sums[0];
        let mut means = [zero; COUNT];
        for guide in 0..COUNT {
            means[guide] = sums[entry(guide + 1, 0)] * share;
        }
        let (mut lower, mut inverses) = ([zero; COUNT * (COUNT + 1) / 2], [zero; COUNT]);
        for row in 0..COUNT {
            // The entries of L D in this row.
            let mut scaled = [zero; COUNT];
            for column in 0..=row {
                let mut rest = sums[entry(row + 1, column + 1)] * share - means[row] * means[column];
                if column == row {
                    let ridge = if row < POSITION { RIDGE } else { RIDGE * (cell * cell) as f64 };
                    // Rounding may make the variance of a large guide negative.
                    rest = rest.max(zero) + F::splat(ridge);
                }
                for k in 0..column {
                    rest = rest - scaled[k] * lower[entry(column, k)];
                }
                if column < row {
                    scaled[column] = rest;
                    lower[entry(row, column)] = rest * inverses[column];
                } else {
                    // The ridge keeps the diagonal positive but for rounding.
                    inverses[row] = one / rest.max(F::splat(f64::EPSILON));
                }
            }
        }
        Self { share, means, lower, inverses }
    }

    /// The fit to a channel of light, whose products with the features are summed: the constant and the slopes.
    #[inline(always)]
    fn solve(&self, products: &[F; FEATURES]) -> [F; FEATURES] {
        let light = products[0] * self.share;
        let mut fit = [light; FEATURES];
        for row in 0..COUNT {
            let mut rest = products[row + 1] * self.share - light * self.means[row];
            for k in 0..row {
                rest = rest - fit[k + 1] * self.lower[entry(row, k)];
            }
            fit[row + 1] = rest;
        }
        for row in (0..COUNT).rev() {
            let mut rest = fit[row + 1] * self.inverses[row];
            for k in row + 1..COUNT {
                rest = rest - fit[k + 1] * self.lower[entry(k, row)];
            }
            fit[row + 1] = rest;
            fit[0] = fit[0] - rest * self.means[row];
        }
        fit
    }
}
