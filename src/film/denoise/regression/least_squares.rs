//! Least squares: fits the light of windows to their features.

use super::super::columns::LANES;
use super::super::guides::{COUNT, FEATURES, POSITION};
use super::cells::Pairs;
use super::moments::PAIRS;
use super::strip::{Lanes, Strip};
use crate::base::lanes::Real;

/// What is added to the variance of a guide in a window, so that guides which hardly vary in it have no influence: a
/// hundredth of the range of an albedo, squared. Positions have cells as their unit.
const RIDGE: f64 = 1e-4;

/// The place of an entry of a lower triangular matrix.
const fn entry(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// Fits the windows between two rows of cells, into an entry for each place of a column and one for the first place of
/// the next one. Windows have the places of their lower right cells.
#[inline(always)]
pub fn fit_windows<F: Real>(pairs: &Pairs, cell: usize, fits: &mut Strip) {
    let columns = pairs.columns;
    let mut lower = [Lanes::ZERO; COUNT * (COUNT + 1) / 2];
    // The last window of a row may be the first one of a column that the picture no longer has.
    for block in 0..(columns.count + 1).div_ceil(LANES) {
        let places = if block < columns.blocks() { pairs.above.entries } else { 1 };
        for place in 0..places {
            let sums = [pairs.above.at(block, place), pairs.below.at(block, place)];
            fit_window::<F>(sums, cell, &mut lower, fits.at_mut(block, place));
        }
        fits.copy_back(block);
    }
}

/// Adds the sums of windows between two rows of cells that are cells of twice the size.
#[inline(always)]
pub fn sum_windows<F: Real>(pairs: &Pairs, next: &mut Pairs) {
    next.start_row();
    for block in 0..pairs.columns.blocks() {
        for place in 0..next.below.entries {
            let [above, below] = [&pairs.above, &pairs.below].map(|row| row.at(block, 2 * place + 1));
            let mut cell = next.next_cell(block, place);
            for (value, (above, below)) in above.iter().zip(below).enumerate() {
                cell.add(value, above.get::<F>() + below.get::<F>());
            }
        }
        next.end_block(block);
    }
    next.end_row();
}

/// A sum over the pixels of a window, which are those of two pairs of cells.
#[inline(always)]
fn sum<F: Real>([above, below]: [&[Lanes]; 2], value: usize) -> F {
    above[value].get::<F>() + below[value].get::<F>()
}

/// Fits the light of the windows of a block to their features, each channel by a constant and slopes.
///
/// The covariances of the guides are decomposed to L D Lᵀ: that is Cholesky's decomposition without its roots. `lower`
/// is memory for L below its diagonal, which is 1.
#[inline(always)]
fn fit_window<F: Real>(
    sums: [&[Lanes]; 2],
    cell: usize,
    lower: &mut [Lanes; COUNT * (COUNT + 1) / 2],
    fits: &mut [Lanes],
) {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    // 1 over the number of pixels, and 1 / D.
    let share = one / sum::<F>(sums, 0);
    let (mut means, mut inverses) = ([zero; COUNT], [zero; COUNT]);
    for (guide, mean) in means.iter_mut().enumerate() {
        *mean = sum::<F>(sums, entry(guide + 1, 0)) * share;
    }
    // The entries of L D in a row.
    let mut scaled = [zero; COUNT];
    for row in 0..COUNT {
        for column in 0..=row {
            let mut rest = sum::<F>(sums, entry(row + 1, column + 1)) * share - means[row] * means[column];
            if column == row {
                let ridge = if row < POSITION { RIDGE } else { RIDGE * (cell * cell) as f64 };
                // Rounding may make the variance of a large guide negative.
                rest = rest.max(zero) + F::splat(ridge);
            }
            for k in 0..column {
                rest = rest - scaled[k] * lower[entry(column, k)].get::<F>();
            }
            if column < row {
                scaled[column] = rest;
                lower[entry(row, column)].set(rest * inverses[column]);
            } else {
                // The ridge keeps the diagonal positive but for rounding.
                inverses[row] = one / rest.max(F::splat(f64::EPSILON));
            }
        }
    }
    let mut fit = [zero; FEATURES];
    for (channel, into) in fits.as_chunks_mut::<FEATURES>().0.iter_mut().enumerate() {
        let products = PAIRS + channel * FEATURES;
        let light = sum::<F>(sums, products) * share;
        for row in 0..COUNT {
            let mut rest = sum::<F>(sums, products + row + 1) * share - light * means[row];
            for k in 0..row {
                rest = rest - fit[k + 1] * lower[entry(row, k)].get::<F>();
            }
            fit[row + 1] = rest;
        }
        let mut constant = light;
        for row in (0..COUNT).rev() {
            let mut rest = fit[row + 1] * inverses[row];
            for k in row + 1..COUNT {
                rest = rest - fit[k + 1] * lower[entry(k, row)].get::<F>();
            }
            fit[row + 1] = rest;
            into[row + 1].set(rest);
            constant = constant - rest * means[row];
        }
        into[0].set(constant);
    }
}
