//! How lanes lie over the picture: each lane is a column of pixels as wide as the largest cell.
//!
//! Pixel x of a row is at the place x % [`COLUMN`] of the column x / [`COLUMN`]. Numbers of the same place in eight
//! columns are neighbours in memory. So whatever the size of cells, eight of them at the same place in their columns
//! are summed, fitted and evaluated at once, and no lane has anything to do with another one.

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

    /// The pixels of all columns in a row.
    pub fn pixels(self) -> usize {
        COLUMN * self.count
    }

    /// The numbers of a row of pixels in lanes.
    pub fn of_row(self) -> usize {
        COLUMN * self.padded
    }

    /// Spreads a row of pixels, padded to whole columns, over lanes.
    pub fn spread(self, row: &[f32], into: &mut [f32]) {
        for (column, pixels) in row.chunks_exact(COLUMN).enumerate() {
            for (place, pixel) in pixels.iter().enumerate() {
                into[place * self.padded + column] = *pixel;
            }
        }
    }

    /// Collects a row of pixels from lanes.
    pub fn collect(self, from: &[f32], row: &mut [f32]) {
        for (column, pixels) in row.chunks_mut(COLUMN).enumerate() {
            for (place, pixel) in pixels.iter_mut().enumerate() {
                *pixel = from[place * self.padded + column];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_from_lanes() {
        for width in [1, 16, 17, 128, 300] {
            let columns = Columns::new(width);
            let row: Vec<f32> = (0..columns.pixels()).map(|x| x as f32).collect();
            let (mut lanes, mut back) = (vec![0.0; columns.of_row()], vec![0.0; row.len()]);
            columns.spread(&row, &mut lanes);
            assert_eq!(lanes[columns.padded * (COLUMN - 1)], 15.0);
            columns.collect(&lanes, &mut back);
            assert_eq!(back, row);
        }
    }
}
