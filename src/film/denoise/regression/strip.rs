//! Rows of cells and windows in lanes.

use super::super::columns::{Columns, LANES};

/// Several numbers for each cell or window of a row of them.
#[derive(Clone)]
pub struct Strip {
    pub columns: Columns,
    /// The cells of a column.
    pub places: usize,
    /// The distance of numbers of the same cell.
    pub stride: usize,
    pub numbers: Vec<f64>,
}

/// The numbers before and after those of a place: cells beside the picture are empty.
const MARGIN: usize = LANES;

impl Strip {
    /// Zeros: so many `values` for each of `places` cells in a column.
    pub fn new(columns: Columns, places: usize, values: usize) -> Self {
        // Without the last summand, the values of a cell may all compete for the same lines of the cache.
        let stride = places * (columns.padded + 2 * MARGIN) + LANES;
        Self { columns, places, stride, numbers: vec![0.0; stride * values] }
    }

    /// The index of the first value of the cell at a place of the first column.
    #[inline(always)]
    pub fn at(&self, place: usize) -> usize {
        place * (self.columns.padded + 2 * MARGIN) + MARGIN
    }

    /// That of the cell before it: at the left end of a column, it is the last one of the column before.
    #[inline(always)]
    pub fn before(&self, place: usize) -> usize {
        if place == 0 { self.at(self.places - 1) - 1 } else { self.at(place - 1) }
    }

    /// That of the cell after it.
    #[inline(always)]
    pub fn after(&self, place: usize) -> usize {
        if place + 1 == self.places { self.at(0) + 1 } else { self.at(place + 1) }
    }
}
