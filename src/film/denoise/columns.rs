//! How lanes lie over the picture: each lane is a column of pixels as wide as the largest cell.
//!
//! Pixel x of a row is at the place x % [`COLUMN`] of the column x / [`COLUMN`]. Numbers of the same place in eight
//! columns are neighbours in memory. So whatever the size of cells, eight of them at the same place in their columns
//! are summed, fitted and evaluated at once, and no lane has anything to do with another one.
//!
//! Eight columns are a block. In memory, a row is block by block, a block place by place, and a place number by number,
//! as far as there are several of each pixel. So what is worked on at once is in few pages, and read in its order.

use super::planes::COLUMN;
use crate::base::lanes::{Level, Row};

/// The lanes of a row of numbers.
pub const LANES: usize = 8;

/// The columns of a picture.
#[derive(Clone, Copy)]
pub struct Columns {
    pub count: usize,
    /// The columns with those that fill lanes, in which nothing is.
    pub padded: usize,
}

impl Columns {
    pub fn new(width: usize) -> Self {
        let count = width.div_ceil(COLUMN);
        Self { count, padded: count.next_multiple_of(LANES) }
    }

    /// The number of blocks.
    pub fn blocks(self) -> usize {
        self.padded / LANES
    }

    /// The pixels of all columns in a row.
    pub fn pixels(self) -> usize {
        COLUMN * self.count
    }

    /// The numbers of a row of pixels in lanes.
    pub fn of_row(self) -> usize {
        COLUMN * self.padded
    }

    /// Spreads a row of pixels, padded to whole columns, over lanes: as a number of each pixel, which has so many.
    /// Beside the columns, numbers are 0.
    #[inline(always)]
    pub fn spread<L: Level>(self, row: &[f32], (number, numbers): (usize, usize), into: &mut [f32]) {
        for block in 0..self.blocks() {
            let columns = row.as_chunks::<COLUMN>().0.iter().skip(block * LANES).take(LANES);
            for first in (0..COLUMN).step_by(LANES) {
                let mut pixels = [L::F32::splat(0.0); LANES];
                for (pixels, column) in pixels.iter_mut().zip(columns.clone()) {
                    *pixels = L::F32::load(column, first);
                }
                for (place, lanes) in L::transpose(pixels).into_iter().enumerate() {
                    lanes.store(into, ((block * COLUMN + first + place) * numbers + number) * LANES);
                }
            }
        }
    }
}

/// Eight pixels of each column of a block, from the place `first` on: a number of the pixels of the block, which have
/// so many.
#[inline(always)]
pub fn collect<L: Level>(block: &[f32], (number, numbers): (usize, usize), first: usize) -> [L::F32; LANES] {
    let mut lanes = [L::F32::splat(0.0); LANES];
    for (place, lanes) in lanes.iter_mut().enumerate() {
        *lanes = L::F32::load(block, ((first + place) * numbers + number) * LANES);
    }
    L::transpose(lanes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::lanes::{SimdKernel, dispatch};

    /// Spreads a row over lanes and collects it.
    struct Back<'a>(Columns, &'a [f32]);

    impl SimdKernel for Back<'_> {
        type Output = Vec<f32>;

        #[inline(always)]
        fn run<L: Level>(self) -> Vec<f32> {
            let Self(columns, row) = self;
            let mut lanes = vec![0.0; 3 * columns.of_row()];
            columns.spread::<L>(row, (1, 3), &mut lanes);
            assert_eq!(lanes[(3 * (COLUMN - 1) + 1) * LANES], row[COLUMN - 1]);
            let mut back = vec![f32::NAN; columns.of_row()];
            for (block, lanes) in lanes.chunks_exact(3 * COLUMN * LANES).enumerate() {
                for first in [0, LANES] {
                    for (lane, pixels) in collect::<L>(lanes, (1, 3), first).into_iter().enumerate() {
                        pixels.store(&mut back, (block * LANES + lane) * COLUMN + first);
                    }
                }
            }
            back
        }
    }

    #[test]
    fn rows_come_back_from_lanes() {
        for width in [1, 16, 17, 128, 300] {
            let columns = Columns::new(width);
            let row: Vec<f32> = (0..columns.pixels()).map(|x| x as f32).collect();
            let back = dispatch(Back(columns, &row));
            assert_eq!(back[..row.len()], row);
            assert!(back[row.len()..].iter().all(|number| *number == 0.0));
        }
    }
}
