//! The fits of one size of cells, row by row.

use super::super::columns::{Columns, LANES, collect};
use super::super::guides::{FEATURES, Guides};
use super::super::planes::{COLUMN, Planes};
use super::cells::Cells;
use super::evaluate::{ALONG, CHANNELS, Fit, ROWS, evaluate};
use super::least_squares::{Factors, fit_window};
use super::light::LightRows;
use super::strip::{Lanes, Strip};
use crate::base::lanes::{Level, Real, Row, Single};
use std::ops::Range;

/// Cells of one size.
pub struct Scale {
    /// The side of a cell, in pixels.
    cell: usize,
    /// The sums of the cells.
    pub cells: Cells,
    /// The fits of the last row of windows and of the one before.
    fits: [Strip; 2],
    /// Whether anything needs the fits of this row of windows.
    is_fitted: bool,
    /// Memory for the fit of a window.
    factors: Factors,
    /// Memory for the fits on both sides of a cell, in two rows of pixels.
    beside: [[Fit; ROWS]; 2],
    /// The fitted light of a layer in two rows of pixels of a block, in lanes.
    block: [[f32; CHANNELS * COLUMN * LANES]; ROWS],
}

impl Scale {
    pub fn new(columns: Columns, cell: usize, channels: usize) -> Self {
        let entries = COLUMN / cell + 1;
        Self {
            cell,
            cells: Cells::new(columns, cell, channels),
            fits: [(); 2].map(|()| Strip::new(columns, entries, channels * FEATURES)),
            is_fitted: false,
            factors: [Lanes::ZERO; _],
            beside: [[[[Lanes::ZERO; ALONG]; CHANNELS]; ROWS]; 2],
            block: [[0.0; CHANNELS * COLUMN * LANES]; ROWS],
        }
    }

    /// Starts a row of cells, and the row of windows whose lower cells they are. The fits of the pixels in `rows` are
    /// needed.
    pub fn start_row(&mut self, row: usize, rows: &Range<usize>) {
        self.cells.start_row();
        let top = row * self.cell;
        self.is_fitted = top + self.cell > rows.start && top < rows.end + self.cell;
        if self.is_fitted {
            self.fits.reverse();
        }
    }

    /// Adds the next cell, and fits the window that it completes. Returns whether there is one.
    #[inline(always)]
    pub fn add<F: Real>(&mut self, block: usize, place: usize) -> bool {
        let is_complete = self.cells.add::<F>(block, place);
        if is_complete {
            self.fit::<F>(block, place);
        }
        is_complete
    }

    /// Adds the next one of the smallest cells, whose pixels are summed, likewise.
    #[inline(always)]
    pub fn add_pixels<F: Real>(
        &mut self,
        guides: &Guides,
        light: &LightRows,
        (row, block, place): (usize, usize, usize),
    ) -> bool {
        let is_complete = self.cells.add_pixels::<F>(guides, light, (row, block, place));
        if is_complete {
            self.fit::<F>(block, place);
        }
        is_complete
    }

    /// Ends a block of the row.
    #[inline(always)]
    pub fn end_block<F: Real>(&mut self, block: usize) {
        self.cells.end_block::<F>(block);
        self.fit::<F>(block, 0);
        self.fits[1].copy_back(block);
    }

    /// Ends the row.
    #[inline(always)]
    pub fn end_row<F: Real>(&mut self) {
        self.cells.end_row::<F>();
        let Columns { count, .. } = self.cells.columns;
        // The last window of a row may be the first one of a column that the picture no longer has.
        if count.is_multiple_of(LANES) {
            let behind = self.cells.columns.blocks();
            self.fit::<F>(behind, 0);
            self.fits[1].copy_back(behind);
        }
    }

    /// Fits the last window that was completed, if that is needed. Windows have the places of their lower right cells.
    #[inline(always)]
    fn fit<F: Real>(&mut self, block: usize, place: usize) {
        let Self { cell, cells, fits: [_, fits], is_fitted, factors, .. } = self;
        if *is_fitted {
            fit_window::<F>(&cells.window, *cell, factors, fits.at_mut(block, place));
        }
    }

    /// Evaluates the fits at the pixels of the row of cells above `row`, as far as they are in `rows`.
    #[inline(always)]
    pub fn evaluate<L: Level>(
        &mut self,
        guides: &Guides,
        bounds: &[Planes; 2],
        (row, rows): (usize, &Range<usize>),
        into: &mut [f32],
    ) {
        let top = row * self.cell;
        let [Planes { width, stride, count, .. }, _] = *bounds;
        let Self { cell, fits: [above, below], beside, block: lanes, .. } = self;
        let needed = rows.start.max(top.saturating_sub(*cell))..rows.end.min(top);
        for first in needed.clone().step_by(ROWS) {
            let pair = first..needed.end.min(first + ROWS);
            let lines = &mut into[(first - rows.start) * count * stride..][..pair.len() * count * stride];
            for layer in 0..count / CHANNELS {
                for block in 0..self.cells.columns.blocks() {
                    evaluate::<L::F64>(guides, (&pair, block, *cell), [above, below], layer, beside, lanes);
                    let lines = lines.chunks_exact_mut(count * stride);
                    for (y, (lanes, line)) in pair.clone().zip(lanes.iter().zip(lines)) {
                        for channel in 0..CHANNELS {
                            let plane = CHANNELS * layer + channel;
                            let bounds = bounds.each_ref().map(|bound| bound.row(plane, y % bound.height));
                            let into = &mut line[plane * stride..][..stride];
                            bound::<L>((lanes, channel), block, bounds, into);
                        }
                    }
                }
            }
            // Beside the picture, light is zero.
            lines.chunks_exact_mut(stride).for_each(|into| into[width..].fill(0.0));
        }
    }
}

/// Collects a channel of a block, and keeps it between the bounds of its pixels.
#[inline(always)]
fn bound<L: Level>(
    (lanes, channel): (&[f32], usize),
    block: usize,
    [least, most]: [&[f32]; 2],
    into: &mut [f32],
) {
    for first in (0..COLUMN).step_by(LANES) {
        for (lane, light) in collect::<L>(lanes, (channel, CHANNELS), first).into_iter().enumerate() {
            let x = (block * LANES + lane) * COLUMN + first;
            if x < into.len() {
                let bounded = light.max(L::F32::load(least, x)).min(L::F32::load(most, x));
                bounded.store(into, x);
            }
        }
    }
}
