//! Fits light by a linear function of guides, in windows that overlap.
//!
//! The picture is divided into square cells. The four cells around each corner are a window, so neighbouring windows
//! overlap by half. In each window, the light is fitted to the guides by least squares. The fits of the four windows
//! around a pixel are weighted as in bilinear interpolation, so that no edges of windows show.
//!
//! Cells have several sizes. Those of a size are summed from the four of the size below in each, so pixels are summed
//! once. Rows of cells go from size to size as they are complete: of each size, two rows of cells and of fits are in
//! memory.

mod evaluate;
mod least_squares;
mod light;
mod moments;
mod scale;
mod strip;
#[cfg(test)]
mod tests;

use super::columns::Columns;
use super::guides::Guides;
use super::outliers::bounds;
use super::planes::{COLUMN, Planes};
use crate::base::lanes::{Level, SimdKernel, dispatch};
use light::LightRows;
use moments::{sum_cells, sum_pixels};
use rayon::prelude::*;
use scale::Scale;
use std::ops::Range;

/// The number of sizes of cells. Each has twice the side of the one before: 2, 4, 8 and 16 pixels.
pub const SCALES: usize = 4;

/// Rows of pixels that are fitted one after the other: a multiple of the largest cell. The cells above and below are
/// summed twice.
const BATCH: usize = 4 * COLUMN;

/// Fits all layers of light to guides at the first scales. The fits are evaluated at the guides `shown`. A fit stays
/// between the least and the greatest light around its pixel.
pub fn fit<const COUNT: usize>(guides: &Guides, shown: &Guides, light: &Planes) -> [Planes; COUNT] {
    let mut fitted = [(); COUNT].map(|()| light.unset_like(light.count));
    let mut batches: Vec<Vec<&mut [f32]>> =
        (0..light.height.div_ceil(BATCH)).map(|_| Vec::with_capacity(COUNT)).collect();
    for planes in &mut fitted {
        batches.iter_mut().zip(planes.bands_mut(BATCH)).for_each(|(batch, band)| batch.push(band));
    }
    batches.into_par_iter().enumerate().for_each_init(
        || Workspace::new(light, COUNT),
        |workspace, (batch, fitted)| {
            let rows = batch * BATCH..light.height.min((batch + 1) * BATCH);
            workspace.start(light, rows.clone());
            dispatch(FitRows { guides, shown, light, rows, workspace, fitted });
        },
    );
    fitted
}

/// What a batch works with. The next one uses it again: new memory takes the system more time than zeros do.
struct Workspace {
    /// The bounds of fits in the rows of the batch.
    bounds: [Planes; 2],
    light: LightRows,
    scales: Vec<Scale>,
}

impl Workspace {
    fn new(light: &Planes, scales: usize) -> Self {
        let (columns, channels) = (Columns::new(light.width), light.count);
        let rows = light.height.min(BATCH);
        Self {
            bounds: [(); 2].map(|()| Planes::unset(light.memory(), (light.width, rows), channels)),
            light: LightRows::new(columns, channels),
            scales: (0..scales).map(|scale| Scale::new(columns, 2 << scale, channels)).collect(),
        }
    }

    /// Prepares a batch.
    fn start(&mut self, light: &Planes, rows: Range<usize>) {
        bounds(light, rows, &mut self.bounds);
        self.scales.iter_mut().for_each(Scale::clear);
    }
}

/// Fits the light of a batch of rows.
struct FitRows<'a> {
    guides: &'a Guides,
    shown: &'a Guides,
    light: &'a Planes,
    rows: Range<usize>,
    workspace: &'a mut Workspace,
    /// Per scale: all planes of the rows.
    fitted: Vec<&'a mut [f32]>,
}

impl SimdKernel for FitRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { guides, shown, light, rows, workspace, mut fitted } = self;
        let Workspace { bounds, light: summed, scales } = workspace;
        // The windows of the largest cells reach as far.
        let first = rows.start.saturating_sub(COLUMN) / 2;
        let last = (rows.end.next_multiple_of(COLUMN) + COLUMN) / 2;
        for row in first..last {
            summed.take(light, 2 * row);
            sum_pixels::<L::F64>(guides, summed, row, scales[0].next_row());
            // Every second row of cells completes one of the next size.
            let complete = 1 + (row + 1).trailing_zeros() as usize;
            for (scale, fitted) in fitted.iter_mut().enumerate().take(complete) {
                if let [.., smaller, own] = &mut scales[..=scale] {
                    sum_cells::<L::F64>([&smaller.above, &smaller.below], own.next_row());
                }
                scales[scale].fit::<L::F64>(shown, bounds, row >> scale, &rows, fitted);
            }
        }
    }
}
