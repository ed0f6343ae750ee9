//! Sums over cells, two by two.
//!
//! A window is four cells around a corner: two of a row of cells, and two of the next one. So what is kept of a row of
//! cells are the sums of every two of them that are side by side. The sums of windows whose cells are the four of a
//! larger one are the sums of the larger cells.

use super::super::columns::{Columns, LANES};
use super::super::planes::COLUMN;
use super::moments;
use super::strip::{Lanes, Strip};
use crate::base::lanes::Real;
use std::mem::swap;

/// The sums of two rows of cells. Those of a cell and the one on its left are at the place of the former.
pub struct Pairs {
    pub above: Strip,
    pub below: Strip,
    pub columns: Columns,
    /// The sums of the last cell that was added.
    last: Vec<Lanes>,
    /// Of those of the last cell in a column, the ones of the last column of a block.
    border: Vec<f64>,
}

impl Pairs {
    pub fn new(columns: Columns, cell: usize, channels: usize) -> Self {
        let values = moments::count(channels);
        let [above, below] = [(); 2].map(|()| Strip::new(columns, COLUMN / cell, values));
        Self { above, below, columns, last: vec![Lanes::ZERO; values], border: vec![0.0; values] }
    }

    /// Empties the cells: there are none above the first row.
    pub fn clear(&mut self) {
        self.above.clear();
        self.below.clear();
    }

    /// Makes the row of cells below that above. All cells of the next one are to be added, block by block from left to
    /// right.
    pub fn start_row(&mut self) {
        swap(&mut self.above, &mut self.below);
        self.border.fill(0.0);
    }

    /// Where the sums of the next cell in the columns of a block go.
    #[inline(always)]
    pub fn next_cell(&mut self, block: usize, place: usize) -> NextCell<'_> {
        NextCell { pairs: self.below.at_mut(block, place), last: &mut self.last, is_first: place == 0 }
    }

    /// Ends a block: the first cells of its columns are beside the last ones of the columns before.
    #[inline(always)]
    pub fn end_block(&mut self, block: usize) {
        let pairs = self.below.at_mut(block, 0);
        for ((Lanes(pair), Lanes(last)), border) in pairs.iter_mut().zip(&self.last).zip(&mut self.border) {
            pair[0] += *border;
            for lane in 1..LANES {
                pair[lane] += last[lane - 1];
            }
            *border = last[LANES - 1];
        }
    }

    /// Ends a row: the last cells of the picture may be those of the last block. Beside them is none.
    #[inline(always)]
    pub fn end_row(&mut self) {
        let pairs = self.below.at_mut(self.columns.blocks(), 0);
        for (pair, border) in pairs.iter_mut().zip(&self.border) {
            *pair = Lanes::ZERO;
            // As any other pair: a sum, in which -0 becomes 0.
            pair.0[0] = *border + 0.0;
        }
    }
}

/// The sums of a cell in eight columns.
pub struct NextCell<'a> {
    pairs: &'a mut [Lanes],
    last: &'a mut [Lanes],
    is_first: bool,
}

impl NextCell<'_> {
    /// Adds one of its sums.
    #[inline(always)]
    pub fn add<F: Real>(&mut self, value: usize, sum: F) {
        let last = &mut self.last[value];
        let pair = if self.is_first { sum } else { last.get::<F>() + sum };
        self.pairs[value].set(pair);
        last.set(sum);
    }
}
