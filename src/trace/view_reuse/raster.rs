//! The cells of a picture: its pixels, and those around it that the filter reaches.

use super::view::MappedPosition;
use crate::film::filter::Filter;
use std::ops::Range;

/// The size of pictures, and of the margin that samples of their pixels may lie in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Raster {
    width: i32,
    height: i32,
    margin: i32,
}

/// A rectangle of cells. A cell is the square of a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellBlock {
    pub columns: Range<i32>,
    pub rows: Range<i32>,
}

impl Raster {
    pub fn new((width, height): (u32, u32), filter: Filter) -> Self {
        let margin = ((filter.width - 1.0) / 2.0).max(0.0).ceil() as i32;
        Self { width: width as i32, height: height as i32, margin }
    }

    /// A raster of at most `side` pixels along each axis, for the same views.
    pub fn reduced(&self, side: i32) -> Self {
        let largest = self.width.max(self.height);
        let scaled = |length: i32| match largest > side {
            true => (i64::from(length) * i64::from(side) / i64::from(largest)).max(1) as i32,
            false => length,
        };
        Self { width: scaled(self.width), height: scaled(self.height), margin: 0 }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [f64; 2] {
        [f64::from(self.width), f64::from(self.height)]
    }

    pub fn pixels(&self) -> u64 {
        self.width as u64 * self.height as u64
    }

    /// Blocks of at most `side` cells along each axis that cover all cells.
    pub fn blocks(&self, side: i32) -> Vec<CellBlock> {
        let starts = |length: i32| (-self.margin..length + self.margin).step_by(side.max(1) as usize);
        let range = |start: i32, length: i32| start..(start + side).min(length + self.margin);
        let block = |top: i32, left: i32| CellBlock {
            columns: range(left, self.width),
            rows: range(top, self.height),
        };
        starts(self.height).flat_map(|top| starts(self.width).map(move |left| block(top, left))).collect()
    }

    /// The sides of which a position lies outside of all cells: left, right, above, below.
    pub fn outside(&self, position: &MappedPosition) -> [bool; 4] {
        let margin = f64::from(self.margin);
        let [width, height] = self.size();
        let MappedPosition { across, down, .. } = *position;
        [across < -margin, across > width + margin, down < -margin, down > height + margin]
    }
}

impl CellBlock {
    /// The corners, in pixels from the left and the top.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        let [left, right] = [self.columns.start, self.columns.end].map(f64::from);
        let [top, bottom] = [self.rows.start, self.rows.end].map(f64::from);
        [[left, top], [right, top], [left, bottom], [right, bottom]]
    }

    /// Its cells, one block each, row by row.
    pub fn cells(&self) -> impl Iterator<Item = Self> {
        let columns = self.columns.clone();
        let row = move |row: i32| {
            columns.clone().map(move |column| Self { columns: column..column + 1, rows: row..row + 1 })
        };
        self.rows.clone().flat_map(row)
    }

    /// The number of cells.
    pub fn len(&self) -> u64 {
        self.columns.len() as u64 * self.rows.len() as u64
    }
}
