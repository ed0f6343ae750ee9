//! Importance sampling of skies: bright parts are sampled more often.

#[cfg(test)]
mod tests;

use super::borders::Borders;
use super::{Sky, equirect};
use crate::base::color::Rgb;
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{Angle, DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A piecewise constant distribution of directions over a grid of longitudes and heights (Pharr, Jakob, Humphreys,
/// *Physically Based Rendering*, 12.5). It depends on the sky alone, so turning or fading an environment keeps it.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentDistribution {
    /// For each row from the bottom, the probability of all rows below it; then 1.
    rows: Borders,
    /// Row by row: for each cell, the probability within the row of all cells to its left; then 1.
    columns: Borders,
    /// Heights of the borders between rows, from -1 to 1.
    heights: Borders,
    /// The mean luminance of all directions.
    mean: f64,
}

/// Maximum columns and rows.
const MAX_SIZE: (u32, u32) = (1024, 512);

/// The fraction of directions that are sampled uniformly. A cell that is dark at its sample points may be bright
/// elsewhere.
const UNIFORM_SHARE: f64 = 0.01;

impl EnvironmentDistribution {
    /// The distribution of a sky of images. It is `None` for black skies, and for constant skies and gradients, which
    /// vary too little.
    pub fn new(sky: &Sky) -> Option<Self> {
        let (native_width, native_height) = match sky {
            Sky::Constant(_) | Sky::Gradient { .. } => return None,
            Sky::Equirect(image) => (image.width(), image.height()),
            Sky::CubeMap(map) => (4 * map.size(), 2 * map.size()),
        };
        let (width, height) = (native_width.min(MAX_SIZE.0), native_height.min(MAX_SIZE.1));
        // Coarser cells look up every texel that they cover, and every cell looks up at least four points.
        let points = native_width.div_ceil(width).max(native_height.div_ceil(height)).max(2);
        let grid = Grid { width, height, points };
        let cells: Vec<f64> =
            (0..height).into_par_iter().flat_map_iter(|row| grid.brightness(sky, row)).collect();
        Self::from_cells(cells, width as usize)
    }

    /// The distribution from the radiances of cells, row by row from the bottom.
    fn from_cells(mut cells: Vec<f64>, width: usize) -> Option<Self> {
        let height = cells.len() / width;
        let between = |row: usize| Angle(180.0 * (row as f64 / height as f64) - 90.0).cos_sin().y;
        let heights: Vec<f64> = (0..=height).map(between).collect();
        // A row's fraction of the sphere is its fraction of the height (Archimedes).
        let share = |row: usize| 0.5 * (heights[row + 1] - heights[row]);
        let mean = |row: &[f64]| row.iter().sum::<f64>() / width as f64;
        let whole: f64 = cells.chunks_exact(width).enumerate().map(|(y, row)| share(y) * mean(row)).sum();
        if whole <= 0.0 {
            return None;
        }
        cells.iter_mut().for_each(|cell| *cell = (1.0 - UNIFORM_SHARE) * *cell + UNIFORM_SHARE * whole);
        let rows = cells.chunks_exact(width).enumerate().map(|(y, row)| share(y) * mean(row));
        Some(Self {
            rows: Borders::new([cumulative(rows).collect()]),
            columns: Borders::new(
                cells.chunks_exact(width).map(|row| cumulative(row.iter().copied()).collect()),
            ),
            heights: Borders::new([heights]),
            mean: whole,
        })
    }

    /// The mean luminance of the sky.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Samples directions in the sky from two numbers in 0..1. Also gives their densities per steradian.
    #[inline(always)]
    pub fn sample<F: Real>(&self, [u, v]: [F; 2]) -> (Vec3<F>, F) {
        let (us, vs) = (u.to_array(), v.to_array());
        let (mut heights, mut longitudes, mut pdf) = (us, us, us);
        let mut rows = [0; 8];
        for lane in 0..F::LANES {
            rows[lane] = self.rows.find(0, vs[lane]);
        }
        let columns = self.columns.find_each(&rows, u);
        for lane in 0..F::LANES {
            let (row, column) = (rows[lane], columns[lane]);
            let up = part(self.rows.around(0, row), vs[lane]);
            let right = part(self.columns.around(row, column), us[lane]);
            let [low, high] = self.heights.around(0, row);
            heights[lane] = low + up * (high - low);
            longitudes[lane] = (column as f64 + right) / self.columns.count() as f64;
            pdf[lane] = self.cell_pdf(column, row);
        }
        let (y, one) = (F::from_array(heights), F::splat(1.0));
        let level = ((one - y) * (one + y)).max(F::splat(0.0)).sqrt();
        // Next to the border of a cell, rounding may move the direction to the neighbour, whose density `pdf` gives.
        (equirect::around(F::from_array(longitudes), y, level), F::from_array(pdf))
    }

    /// The densities per steradian of directions, which are unit vectors in the sky.
    #[inline(always)]
    pub fn pdf<F: Real>(&self, direction: Vec3<F>) -> F {
        let width = self.columns.count();
        let column = equirect::longitude(direction) * F::splat(width as f64);
        let (columns, heights) = (column.to_array(), direction.y.to_array());
        let (mut pdf, mut cells) = (columns, [(0, 0); 8]);
        for lane in 0..F::LANES {
            let column = (columns[lane] as usize).min(width - 1);
            let row = self.heights.find(0, heights[lane]);
            self.columns.prefetch::<F::Level>(row, column);
            cells[lane] = (column, row);
        }
        for lane in 0..F::LANES {
            let (column, row) = cells[lane];
            pdf[lane] = self.cell_pdf(column, row);
        }
        F::from_array(pdf)
    }

    /// The density per steradian in a cell.
    #[inline(always)]
    fn cell_pdf(&self, column: usize, row: usize) -> f64 {
        let probability = self.rows.width(0, row) * self.columns.width(row, column);
        let solid_angle = TAU / self.columns.count() as f64 * self.heights.width(0, row);
        probability / solid_angle
    }
}

/// The grid of cells, and the number of sample points along each axis of a cell.
struct Grid {
    width: u32,
    height: u32,
    points: u32,
}

impl Grid {
    /// The mean luminance of each cell of a row.
    fn brightness(&self, sky: &Sky, row: u32) -> impl Iterator<Item = f64> {
        let points = f64::from(self.points);
        let inside = move |cell: u32, point: u32| f64::from(cell) + (f64::from(point) + 0.5) / points;
        (0..self.width).map(move |column| {
            let places = (0..self.points * self.points).map(|i| {
                let (x, y) = (inside(column, i % self.points), inside(row, i / self.points));
                DVec2::new(x / f64::from(self.width), y / f64::from(self.height))
            });
            places.map(|uv| luminance(sky.radiance_at(uv))).sum::<f64>() / (points * points)
        })
    }
}

/// Luminance (Rec. 709).
fn luminance(color: Rgb) -> f64 {
    color.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// Cumulative sums as fractions of the whole: the sum before each weight, then 1. Weights are above 0.
fn cumulative(weights: impl Iterator<Item = f64> + Clone) -> impl Iterator<Item = f64> {
    let whole: f64 = weights.clone().sum();
    let sums = weights.scan(0.0, move |sum, weight| {
        *sum += weight;
        Some((*sum / whole).min(1.0))
    });
    std::iter::once(0.0).chain(sums)
}

/// The fraction of the way from one border to the next at which a number lies.
#[inline(always)]
fn part([low, high]: [f64; 2], number: f64) -> f64 {
    ((number - low) / (high - low)).clamp(0.0, 1.0)
}
