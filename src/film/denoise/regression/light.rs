//! The light of the rows of pixels that are summed.

use super::super::columns::{Columns, LANES};
use super::super::planes::{COLUMN, Planes};
use crate::base::lanes::{Level, Real, Row, Single};

/// Two rows of pixels in lanes, all channels of all layers.
pub struct LightRows {
    pub channels: usize,
    pub columns: Columns,
    numbers: Vec<f32>,
}

impl LightRows {
    pub fn new(columns: Columns, channels: usize) -> Self {
        Self { channels, columns, numbers: vec![0.0; 2 * channels * columns.of_row()] }
    }

    /// Takes rows from `y` on. Rows below the picture are black.
    #[inline(always)]
    pub fn take<L: Level>(&mut self, light: &Planes, y: usize) {
        let (columns, channels) = (self.columns, self.channels);
        if y + 1 >= light.height {
            self.numbers.fill(0.0);
        }
        for row in 0..2.min(light.height.saturating_sub(y)) {
            for channel in 0..channels {
                let number = (row * channels + channel, 2 * channels);
                columns.spread::<L>(light.row(channel, y + row), number, &mut self.numbers);
            }
        }
    }

    #[inline(always)]
    pub fn at<F: Real>(&self, row: usize, channel: usize, block: usize, place: usize) -> F {
        let pixel = block * COLUMN + place;
        let at = (pixel * 2 + row) * self.channels + channel;
        F::F32::load(&self.numbers, at * LANES).to_f64()
    }
}
