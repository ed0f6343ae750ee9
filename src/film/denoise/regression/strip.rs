//! Rows of sums and fits in lanes.

use super::super::columns::{Columns, LANES};
use crate::base::lanes::Real;

/// A number of each column of a block. Rows of lanes that begin at a line of the cache are read at once.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub struct Lanes(pub [f64; LANES]);

impl Lanes {
    pub const ZERO: Self = Self([0.0; LANES]);

    #[inline(always)]
    pub fn get<F: Real>(&self) -> F {
        F::load(&self.0, 0)
    }

    #[inline(always)]
    pub fn set<F: Real>(&mut self, numbers: F) {
        numbers.store(&mut self.0, 0);
    }
}

/// Several numbers for each of some entries in a column, for a row of columns.
pub struct Strip {
    /// Entries of a column.
    pub entries: usize,
    /// Numbers of an entry.
    values: usize,
    numbers: Vec<Lanes>,
}

impl Strip {
    /// Zeros. There is one more block than the columns have.
    pub fn new(columns: Columns, entries: usize, values: usize) -> Self {
        let blocks = columns.blocks() + 1;
        Self { entries, values, numbers: vec![Lanes::ZERO; blocks * entries * values] }
    }

    /// The numbers of an entry in the columns of a block.
    #[inline(always)]
    pub fn at(&self, block: usize, entry: usize) -> &[Lanes] {
        &self.numbers[self.index(block, entry)..][..self.values]
    }

    #[inline(always)]
    pub fn at_mut(&mut self, block: usize, entry: usize) -> &mut [Lanes] {
        let first = self.index(block, entry);
        &mut self.numbers[first..][..self.values]
    }

    #[inline(always)]
    fn index(&self, block: usize, entry: usize) -> usize {
        (block * self.entries + entry) * self.values
    }

    /// Copies the first entries of the columns of a block to the last ones of the columns before them.
    #[inline(always)]
    pub fn copy_back(&mut self, block: usize) {
        let last = self.entries - 1;
        let [first, own] = [0, last].map(|entry| self.index(block, entry));
        for value in 0..self.values {
            let Lanes(from) = self.numbers[first + value];
            if block > 0 {
                let before = self.index(block - 1, last);
                self.numbers[before + value].0[LANES - 1] = from[0];
            }
            self.numbers[own + value].0[..LANES - 1].copy_from_slice(&from[1..]);
        }
    }

    pub fn clear(&mut self) {
        self.numbers.fill(Lanes::ZERO);
    }
}
