//! Fits light by a linear function of guides, in windows that overlap.
//!
//! The picture is divided into square cells. The four cells around each corner are a window, so neighbouring windows
//! overlap by half. In each window, the light is fitted to the guides by least squares. The fits of the four windows
//! around a pixel are weighted as in bilinear interpolation, so that no edges of windows show.
//!
//! Cells have several sizes. Those of a size are summed from the four of the size below in each, so pixels are summed
//! once. Rows of cells go from size to size as they are complete: of each size, two rows of cells and of fits are in
//! memory.

mod cells;
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
use moments::sum_pixels;
use rayon::prelude::*;
use scale::Scale;
use std::ops::Range;

/// The number of sizes of cells. Each has twice the side of the one before: 2, 4, 8 and 16 pixels.
pub const SCALES: usize = 4;

/// The fewest and the most rows of pixels that are fitted one after the other: multiples of the largest cell. The cells
/// above and below are summed twice, so there are no more batches than threads, unless they would need much memory.
const BATCH: [usize; 2] = [4 * COLUMN, 12 * COLUMN];

/// Fits all layers of light to guides at the first scales. The fits are evaluated at the guides `shown`. A fit stays
/// between the least and the greatest light around its pixel.
pub fn fit<const COUNT: usize>(guides: &Guides, shown: &Guides, light: &Planes) -> [Planes; COUNT] {
    let mut fitted = [(); COUNT].map(|()| light.unset_like(light.count));
    let [least, most] = BATCH;
    let share = light.height.div_ceil(rayon::current_num_threads()).next_multiple_of(COLUMN);
    let of_batch = share.clamp(least, most);
    let mut batches: Vec<Vec<&mut [f32]>> =
        (0..light.height.div_ceil(of_batch)).map(|_| Vec::with_capacity(COUNT)).collect();
    for planes in &mut fitted {
        batches.iter_mut().zip(planes.bands_mut(of_batch)).for_each(|(batch, band)| batch.push(band));
    }
    batches.into_par_iter().enumerate().for_each_init(
        || Workspace::new(light, of_batch, COUNT),
        |workspace, (batch, fitted)| {
            let rows = batch * of_batch..light.height.min((batch + 1) * of_batch);
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
    fn new(light: &Planes, rows: usize, scales: usize) -> Self {
        let (columns, channels) = (Columns::new(light.width), light.count);
        let rows = light.height.min(rows);
        Self {
            bounds: [(); 2].map(|()| Planes::unset(light.memory(), (light.width, rows), channels)),
            light: LightRows::new(columns, channels),
            scales: (0..scales).map(|scale| Scale::new(columns, 2 << scale, channels)).collect(),
        }
    }

    /// Prepares a batch.
    fn start(&mut self, light: &Planes, rows: Range<usize>) {
        bounds(light, rows, &mut self.bounds);
        self.scales.iter_mut().for_each(|scale| scale.cells.clear());
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
        let largest = 1 << scales.len();
        let first = rows.start.saturating_sub(largest) / 2;
        let last = (rows.end.next_multiple_of(largest) + largest) / 2;
        for row in first..last {
            summed.take(light, 2 * row);
            sum_pixels::<L::F64>(guides, summed, row, &mut scales[0].cells);
            for (scale, fitted) in fitted.iter_mut().enumerate() {
                let row = row >> scale;
                // Every second row of cells completes one of the next size.
                let is_complete = row % 2 == 1;
                if let [own, larger @ ..] = &mut scales[scale..] {
                    let next = larger.first_mut().filter(|_| is_complete);
                    own.fit::<L::F64>(shown, bounds, (row, &rows), fitted, next);
                }
                if !is_complete {
                    break;
                }
            }
        }
    }
}
