//! How lanes lie over the picture: each lane is a column of pixels as wide as the largest cell.
//!
//! Pixel x of a row is at the place x % [`COLUMN`] of the column x / [`COLUMN`]. Numbers of the same place in eight
//! columns are neighbours in memory. So whatever the size of cells, eight of them at the same place in their columns
//! are summed, fitted and evaluated at once, and no lane has anything to do with another one.
//!
//! Eight columns are a block. In memory, a row is block by block, a block place by place, and a place number by number,
//! as far as there are several of each pixel. So what is worked on at once is in few pages, and read in its order.

use super::planes::COLUMN;

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
    #[inline(always)]
    pub fn spread(self, row: &[f32], (number, numbers): (usize, usize), into: &mut [f32]) {
        for (column, pixels) in row.as_chunks::<COLUMN>().0.iter().enumerate() {
            let into = &mut into[first_of(column, numbers) + number * LANES..][..step(numbers)];
            for (place, pixel) in pixels.iter().enumerate() {
                into[place * numbers * LANES] = *pixel;
            }
        }
    }

    /// Collects a number of each pixel of a row from lanes.
    #[inline(always)]
    pub fn collect(self, from: &[f32], (number, numbers): (usize, usize), row: &mut [f32]) {
        for (column, pixels) in row.as_chunks_mut::<COLUMN>().0.iter_mut().enumerate() {
            let from = &from[first_of(column, numbers) + number * LANES..][..step(numbers)];
            for (place, pixel) in pixels.iter_mut().enumerate() {
                *pixel = from[place * numbers * LANES];
            }
        }
    }
}

/// The index of the first number of a column's first pixel.
#[inline(always)]
fn first_of(column: usize, numbers: usize) -> usize {
    column / LANES * LANES * COLUMN * numbers + column % LANES
}

/// From a number of a column's first pixel to behind that of its last one.
#[inline(always)]
fn step(numbers: usize) -> usize {
    (COLUMN - 1) * numbers * LANES + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_from_lanes() {
        for width in [1, 16, 17, 128, 300] {
            let columns = Columns::new(width);
            let row: Vec<f32> = (0..columns.pixels()).map(|x| x as f32).collect();
            let (mut lanes, mut back) = (vec![0.0; 3 * columns.of_row()], vec![0.0; row.len()]);
            columns.spread(&row, (1, 3), &mut lanes);
            assert_eq!(lanes[(3 * (COLUMN - 1) + 1) * LANES], 15.0);
            columns.collect(&lanes, (1, 3), &mut back);
            assert_eq!(back, row);
        }
    }
}
