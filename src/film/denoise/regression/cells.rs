//! Sums over cells, and over the windows that they make.
//!
//! A window is four cells around a corner: two of a row of cells, and two of the next one. So what is kept of a row of
//! cells are the sums of every two of them that are side by side. As soon as a cell is added, the window of which it is
//! the lower right one is complete, and its pair takes the place of the one above, which nothing needs any more. So
//! sums are in the first cache while they are used. The sums of windows whose cells are the four of a larger one are
//! the sums of the larger cells.

use super::super::columns::{Columns, LANES};
use super::super::guides::Guides;
use super::super::planes::COLUMN;
use super::light::LightRows;
use super::moments::{self, Sink, sum_pixels};
use super::strip::{Lanes, Strip};
use crate::base::lanes::Real;
use std::mem::swap;

/// The cells of a size. They are added row by row, block by block, and in the columns of a block from left to right.
pub struct Cells {
    pub columns: Columns,
    /// The sums of the next cell in the columns of a block, which is added.
    pub next: Vec<Lanes>,
    /// The sums of the last window that was completed.
    pub window: Vec<Lanes>,
    /// The sums of every two cells in the row above, and behind the last cell that was added in its own row. Those of a
    /// cell and the one on its left are at the place of the former.
    pairs: Strip,
    /// The sums of the last cell that was added.
    last: Vec<Lanes>,
    /// The sums of the first cells in the columns of the block.
    first: Vec<Lanes>,
    /// Of the sums of the last cells in the columns of the block before, those of its last column.
    border: Vec<f64>,
}

impl Cells {
    pub fn new(columns: Columns, cell: usize, channels: usize) -> Self {
        let values = moments::count(channels);
        let [next, window, last, first] = [(); 4].map(|()| vec![Lanes::ZERO; values]);
        let (pairs, border) = (Strip::new(columns, COLUMN / cell, values), vec![0.0; values]);
        Self { columns, next, window, pairs, last, first, border }
    }

    /// The cells in a column.
    pub fn of_column(&self) -> usize {
        self.pairs.entries
    }

    /// Empties the cells: there are none above the first row.
    pub fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Starts a row of cells.
    pub fn start_row(&mut self) {
        self.border.fill(0.0);
    }

    /// Adds the next cell. Returns whether that completes the window at its place. The one at the first place is
    /// completed with the block.
    #[inline(always)]
    pub fn add<F: Real>(&mut self, block: usize, place: usize) -> bool {
        if place == 0 {
            swap(&mut self.next, &mut self.first);
            self.last.copy_from_slice(&self.first);
            return false;
        }
        let Self { next, window, pairs, last, .. } = self;
        let mut following = Following { window, pairs: pairs.at_mut(block, place), last };
        for (index, next) in next.iter().enumerate() {
            following.take(index, next.get::<F>());
        }
        true
    }

    /// Adds the next one of the smallest cells, whose pixels are summed. Returns the same.
    #[inline(always)]
    pub fn add_pixels<F: Real>(
        &mut self,
        guides: &Guides,
        light: &LightRows,
        (row, block, place): (usize, usize, usize),
    ) -> bool {
        let Self { first, window, pairs, last, .. } = self;
        if place == 0 {
            sum_pixels::<F>(guides, light, (row, block, place), &mut First { first, last });
            return false;
        }
        let mut following = Following { window, pairs: pairs.at_mut(block, place), last };
        sum_pixels::<F>(guides, light, (row, block, place), &mut following);
        true
    }

    /// Ends a block, which completes the windows at the first places of its columns: their cells are beside the last
    /// ones of the columns before.
    #[inline(always)]
    pub fn end_block<F: Real>(&mut self, block: usize) {
        let pairs = self.pairs.at_mut(block, 0);
        let sums = self.first.iter().zip(&self.last).zip(&mut self.window).zip(&mut self.border);
        for (pair, (((first, Lanes(last)), window), border)) in pairs.iter_mut().zip(sums) {
            let mut before = [*border; LANES];
            before[1..].copy_from_slice(&last[..LANES - 1]);
            *border = last[LANES - 1];
            let below = Lanes(before).get::<F>() + first.get::<F>();
            window.set(pair.get::<F>() + below);
            pair.set(below);
        }
    }

    /// Ends a row, which completes the window behind its last block: no cells are on its right.
    #[inline(always)]
    pub fn end_row<F: Real>(&mut self) {
        let pairs = self.pairs.at_mut(self.columns.blocks(), 0);
        for (pair, (window, border)) in pairs.iter_mut().zip(self.window.iter_mut().zip(&self.border)) {
            let mut below = Lanes::ZERO;
            // As any other pair: a sum, in which -0 becomes 0.
            below.0[0] = *border + 0.0;
            window.set(pair.get::<F>() + below.get::<F>());
            *pair = below;
        }
    }
}

/// The first cell in the columns of a block.
struct First<'a> {
    first: &'a mut [Lanes],
    last: &'a mut [Lanes],
}

impl Sink for First<'_> {
    #[inline(always)]
    fn take<F: Real>(&mut self, index: usize, sum: F) {
        self.first[index].set(sum);
        self.last[index].set(sum);
    }
}

/// A cell behind another one.
struct Following<'a> {
    window: &'a mut [Lanes],
    pairs: &'a mut [Lanes],
    last: &'a mut [Lanes],
}

impl Sink for Following<'_> {
    #[inline(always)]
    fn take<F: Real>(&mut self, index: usize, sum: F) {
        let (last, pair) = (&mut self.last[index], &mut self.pairs[index]);
        let below = last.get::<F>() + sum;
        self.window[index].set(pair.get::<F>() + below);
        pair.set(below);
        last.set(sum);
    }
}
