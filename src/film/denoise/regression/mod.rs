//! Fits light by a linear function of guides, in windows that overlap.
//!
//! The picture is divided into square cells. The four cells around each corner are a window, so neighbouring windows
//! overlap by half. In each window, the light is fitted to the guides by least squares. The fits of the four windows
//! around a pixel are weighted as in bilinear interpolation, so that no edges of windows show.
//!
//! Cells have several sizes. Those of a size are summed from the four of the size below in each, so pixels are summed
//! once. Cells go from size to size as they are complete: of each size, a row of cells and two rows of fits are in
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
use crate::base::lanes::{Level, Real, SimdKernel, dispatch};
use light::LightRows;
use rayon::prelude::*;
use scale::Scale;
use std::mem::swap;
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
        || Workspace::new(light, COUNT),
        |workspace, (batch, fitted)| {
            let rows = batch * of_batch..light.height.min((batch + 1) * of_batch);
            workspace.start();
            dispatch(FitRows { guides, shown, light, rows, workspace, fitted });
        },
    );
    fitted
}

/// What a batch works with. The next one uses it again: new memory takes the system more time than zeros do.
struct Workspace {
    /// The bounds of fits in the last rows, as many as the scales are apart.
    bounds: [Planes; 2],
    light: LightRows,
    scales: Vec<Scale>,
}

impl Workspace {
    fn new(light: &Planes, scales: usize) -> Self {
        let (columns, channels) = (Columns::new(light.width), light.count);
        // Two rows of the largest cells: the first size is at the end of the second one when the last size comes to the
        // first one.
        let rows = 2 << scales;
        Self {
            bounds: [(); 2].map(|()| Planes::unset(light.memory(), (light.width, rows), channels)),
            light: LightRows::new(columns, channels),
            scales: (0..scales).map(|scale| Scale::new(columns, 2 << scale, channels)).collect(),
        }
    }

    /// Prepares a batch.
    fn start(&mut self) {
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
        let Workspace { bounds: range, light: summed, scales } = workspace;
        // The windows of the largest cells reach as far.
        let largest = 1 << scales.len();
        let first = rows.start.saturating_sub(largest) / 2;
        let last = (rows.end.next_multiple_of(largest) + largest) / 2;
        for row in first..last {
            summed.take::<L>(light, 2 * row);
            // Every second row of cells completes one of the next size.
            let complete = scales.len().min(1 + row.trailing_ones() as usize);
            let scales = &mut scales[..complete];
            add_row::<L::F64>(guides, summed, (row, &rows), scales);
            // Of the pixels that the smallest cells come to, just before they do.
            bounds(light, rows.start.max(2 * row.saturating_sub(1))..rows.end.min(2 * row), range);
            for (scale, (own, fitted)) in scales.iter_mut().zip(&mut fitted).enumerate() {
                own.evaluate::<L>(shown, range, (row >> scale, &rows), fitted);
            }
        }
    }
}

/// Adds a row of the smallest cells, and those of the next sizes that are complete with it.
#[inline(always)]
fn add_row<F: Real>(
    guides: &Guides,
    light: &LightRows,
    (row, rows): (usize, &Range<usize>),
    scales: &mut [Scale],
) {
    scales.iter_mut().enumerate().for_each(|(scale, own)| own.start_row(row >> scale, rows));
    for block in 0..light.columns.blocks() {
        for place in 0..scales[0].cells.of_column() {
            add_cell::<F>(guides, light, (row, block, place), scales);
        }
        for own in &mut *scales {
            own.end_block::<F>(block);
        }
    }
    for own in scales {
        own.end_row::<F>();
    }
}

/// Adds the next one of the smallest cells, and those that are complete with it.
#[inline(always)]
fn add_cell<F: Real>(
    guides: &Guides,
    light: &LightRows,
    (row, block, place): (usize, usize, usize),
    scales: &mut [Scale],
) {
    for scale in 0..scales.len() {
        if let [own, larger @ ..] = &mut scales[scale..] {
            let is_complete = match scale {
                0 => own.add_pixels::<F>(guides, light, (row, block, place)),
                _ => own.add::<F>(block, place >> scale),
            };
            // At every second place, a window is a cell of the next size.
            let is_cell = is_complete && (place >> scale) % 2 == 1;
            let Some(next) = larger.first_mut().filter(|_| is_cell) else { return };
            swap(&mut own.cells.window, &mut next.cells.next);
        }
    }
}
