//! The cells of a picture: its pixels, and those around it that the filter reaches.

use super::view::MappedPosition;
use crate::film::filter::Filter;
use std::ops::Range;

/// The size of pictures, and how far around them samples lie, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raster {
    width: i32,
    height: i32,
    /// Of samples that the filter reaches: those that the pixels of a picture need.
    needed: f64,
    /// Of samples that a view traces.
    traced: f64,
}

/// A rectangle of cells. A cell is the square of a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellBlock {
    pub columns: Range<i32>,
    pub rows: Range<i32>,
}

impl Raster {
    /// `margin` is the distance up to which a view traces more than its pixels need.
    pub fn new((width, height): (u32, u32), filter: Filter, margin: f64) -> Self {
        let needed = ((filter.width - 1.0) / 2.0).max(0.0);
        Self { width: width as i32, height: height as i32, needed, traced: needed + margin }
    }

    /// A raster of at most `side` pixels along each axis, for the same views.
    pub fn reduced(&self, side: i32) -> Self {
        let largest = self.width.max(self.height);
        if largest <= side {
            return *self;
        }
        let scaled = |length: i32| (i64::from(length) * i64::from(side) / i64::from(largest)).max(1) as i32;
        let scale = f64::from(side) / f64::from(largest);
        let [needed, traced] = [self.needed, self.traced].map(|distance| distance * scale);
        Self { width: scaled(self.width), height: scaled(self.height), needed, traced }
    }

    /// How far around a picture the samples lie that its pixels need.
    pub fn needed(&self) -> f64 {
        self.needed
    }

    /// How far around a picture its view traces samples.
    pub fn traced(&self) -> f64 {
        self.traced
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [f64; 2] {
        [f64::from(self.width), f64::from(self.height)]
    }

    pub fn pixels(&self) -> u64 {
        self.width as u64 * self.height as u64
    }

    /// Blocks of at most `side` cells along each axis that cover all cells with traced samples.
    pub fn blocks(&self, side: i32) -> Vec<CellBlock> {
        let margin = self.traced.ceil() as i32;
        let starts = |length: i32| (-margin..length + margin).step_by(side.max(1) as usize);
        let range = |start: i32, length: i32| start..(start + side).min(length + margin);
        let block = |top: i32, left: i32| CellBlock {
            columns: range(left, self.width),
            rows: range(top, self.height),
        };
        starts(self.height).flat_map(|top| starts(self.width).map(move |left| block(top, left))).collect()
    }

    /// The sides of a picture from which a position is farther away than `margin`: left, right, above, below.
    pub fn outside(&self, position: &MappedPosition, margin: f64) -> [bool; 4] {
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
