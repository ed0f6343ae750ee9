//! The fits of one size of cells, row by row.

use super::super::columns::{Columns, LANES};
use super::super::guides::{FEATURES, Guides};
use super::super::planes::{COLUMN, Planes};
use super::cells::Pairs;
use super::evaluate::{ALONG, CHANNELS, Fit, evaluate};
use super::least_squares::{fit_windows, sum_windows};
use super::strip::{Lanes, Strip};
use crate::base::lanes::Real;
use std::ops::Range;

/// Cells of one size.
pub struct Scale {
    /// The side of a cell, in pixels.
    cell: usize,
    /// The sums of the last row of cells and of the one before.
    pub cells: Pairs,
    /// The fits of the last row of windows and of the one before.
    fits: [Strip; 2],
    /// The fits along a row of pixels in a block.
    between: Vec<Fit>,
    /// The fitted light of a layer in a row of pixels, in lanes.
    row: Vec<[f32; CHANNELS * COLUMN * LANES]>,
}

impl Scale {
    pub fn new(columns: Columns, cell: usize, channels: usize) -> Self {
        let entries = COLUMN / cell + 1;
        Self {
            cell,
            cells: Pairs::new(columns, cell, channels),
            fits: [(); 2].map(|()| Strip::new(columns, entries, channels * FEATURES)),
            between: vec![[[Lanes::ZERO; ALONG]; CHANNELS]; entries],
            row: vec![[0.0; CHANNELS * COLUMN * LANES]; columns.blocks()],
        }
    }

    /// Fits the windows whose lower cells are the row of cells `row`, which are added, and evaluates the fits at the
    /// pixels of the row of cells above it, as far as they are in `rows`. Sums over windows that are cells of the
    /// `next` size are added to these.
    #[inline(always)]
    pub fn fit<F: Real>(
        &mut self,
        guides: &Guides,
        bounds: &[Planes; 2],
        (row, rows): (usize, &Range<usize>),
        into: &mut [f32],
        next: Option<&mut Self>,
    ) {
        if let Some(next) = next {
            sum_windows::<F>(&self.cells, &mut next.cells);
        }
        let top = row * self.cell;
        if top + self.cell <= rows.start || top >= rows.end + self.cell {
            return;
        }
        self.fits.reverse();
        fit_windows::<F>(&self.cells, self.cell, &mut self.fits[1]);
        let [Planes { width, stride, count, .. }, _] = *bounds;
        let (columns, [above, below]) = (self.cells.columns, &self.fits);
        for y in rows.start.max(top.saturating_sub(self.cell))..rows.end.min(top) {
            let line = &mut into[(y - rows.start) * count * stride..];
            for layer in 0..count / CHANNELS {
                for (block, into) in self.row.iter_mut().enumerate() {
                    evaluate::<F>(guides, (y, block), [above, below], layer, &mut self.between, into);
                }
                for channel in 0..CHANNELS {
                    let plane = CHANNELS * layer + channel;
                    let into = &mut line[plane * stride..][..stride];
                    columns.collect(self.row.as_flattened(), (channel, CHANNELS), into);
                    // Without the padding, which stays zero.
                    let [least, most] = bounds.each_ref().map(|bound| bound.row(plane, y - rows.start));
                    let bounds = least.iter().zip(most).take(width);
                    into[width..].fill(0.0);
                    for (light, (least, most)) in into.iter_mut().zip(bounds) {
                        *light = light.max(*least).min(*most);
                    }
                }
            }
        }
    }
}
