//! The fits of one size of cells, row by row.

use super::super::columns::Columns;
use super::super::guides::{FEATURES, Guides};
use super::super::planes::{COLUMN, Planes};
use super::evaluate::evaluate;
use super::least_squares::fit_windows;
use super::moments;
use super::strip::Strip;
use crate::base::lanes::Real;
use std::mem::swap;
use std::ops::Range;

/// Cells of one size.
pub struct Scale {
    /// The side of a cell, in pixels.
    cell: usize,
    /// The sums of the last row of cells and of the one before.
    pub above: Strip,
    pub below: Strip,
    /// The fits of the last row of windows and of the one before.
    fits: [Strip; 2],
    /// The fitted light of a layer in a row of pixels, in lanes.
    row: Vec<f32>,
}

impl Scale {
    pub fn new(columns: Columns, cell: usize, channels: usize) -> Self {
        let cells = Strip::new(columns, COLUMN / cell, moments::count(channels));
        let fits = Strip::new(columns, COLUMN / cell, channels * FEATURES);
        Self {
            cell,
            above: cells.clone(),
            below: cells,
            fits: [fits.clone(), fits],
            row: vec![0.0; 3 * columns.of_row()],
        }
    }

    /// Fits the windows whose lower cells are the row of cells `row`, in `below`, and evaluates the fits at the pixels
    /// of the row of cells above it, as far as they are in `rows`.
    #[inline(always)]
    pub fn fit<F: Real>(
        &mut self,
        guides: &Guides,
        bounds: &[Planes; 2],
        row: usize,
        rows: &Range<usize>,
        into: &mut [f32],
    ) {
        let top = row * self.cell;
        if top + self.cell <= rows.start || top >= rows.end + self.cell {
            return;
        }
        let [above, below] = &mut self.fits;
        swap(above, below);
        fit_windows::<F>([&self.above, &self.below], self.cell, below);
        let [Planes { width, stride, count, .. }, _] = *bounds;
        let columns = self.above.columns;
        for y in rows.start.max(top.saturating_sub(self.cell))..rows.end.min(top) {
            let line = &mut into[(y - rows.start) * count * stride..];
            for layer in 0..count / 3 {
                evaluate::<F>(guides, y, [above, below], layer, &mut self.row);
                for (channel, row) in (3 * layer..).zip(self.row.chunks_exact(columns.of_row())) {
                    let into = &mut line[channel * stride..][..stride];
                    columns.collect(row, into);
                    // Without the padding, which stays zero.
                    let [least, most] = bounds.each_ref().map(|bound| bound.row(channel, y - rows.start));
                    let bounds = least.iter().zip(most).take(width);
                    into[width..].fill(0.0);
                    for (light, (least, most)) in into.iter_mut().zip(bounds) {
                        *light = light.max(*least).min(*most);
                    }
                }
            }
        }
    }

    /// Empties the cells: there are none above the first row.
    pub fn clear(&mut self) {
        self.above.numbers.fill(0.0);
        self.below.numbers.fill(0.0);
    }

    /// Makes the row of cells below that above, and returns the one below, whose sums are to be overwritten.
    pub fn next_row(&mut self) -> &mut Strip {
        swap(&mut self.above, &mut self.below);
        &mut self.below
    }
}
