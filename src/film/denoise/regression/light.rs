//! The light of the rows of pixels that are summed.

use super::super::columns::Columns;
use super::super::planes::{COLUMN, Planes};
use crate::base::lanes::{Real, Row, Single};

/// Two rows of pixels in lanes, all channels of all layers.
pub struct LightRows {
    pub channels: usize,
    columns: Columns,
    numbers: Vec<f32>,
}

impl LightRows {
    pub fn new(columns: Columns, channels: usize) -> Self {
        Self { channels, columns, numbers: vec![0.0; 2 * channels * columns.of_row()] }
    }

    /// Takes rows from `y` on. Rows below the picture are black.
    pub fn take(&mut self, light: &Planes, y: usize) {
        let (columns, channels) = (self.columns, self.channels);
        for (at, into) in self.numbers.chunks_exact_mut(columns.of_row()).enumerate() {
            let y = y + at / channels;
            match y < light.height {
                true => columns.spread(light.row(at % channels, y), into),
                false => into.fill(0.0),
            }
        }
    }

    #[inline(always)]
    pub fn at<F: Real>(&self, row: usize, channel: usize, place: usize, column: usize) -> F {
        let at = ((row * self.channels + channel) * COLUMN + place) * self.columns.padded + column;
        F::F32::load(&self.numbers, at).to_f64()
    }
}
