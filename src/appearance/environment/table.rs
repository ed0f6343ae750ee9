//! Directions drawn at random, more of them from where a sky is bright.

#[cfg(test)]
mod tests;

use super::{Sky, equirect};
use crate::base::color::Rgb;
use crate::base::lanes::{Real, Vec3};
use crate::base::math::{Angle, DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// How likely directions are: constant over each cell of a grid of longitudes and latitudes (Pharr, Jakob,
/// Humphreys, *Physically Based Rendering*, 12.5). It depends on the sky alone, so that neither turning nor
/// fading an environment needs another one.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyTable {
    /// Of the rows from the bottom: the probability of all rows below, then 1.
    rows: Vec<f64>,
    /// Row by row: the probability, within the row, of all cells to the left, then 1.
    columns: Vec<f64>,
    /// Heights between the rows, from -1 to 1.
    heights: Vec<f64>,
    /// Cells in a row.
    width: usize,
}

/// Columns and rows at most.
const FINEST: (u32, u32) = (1024, 512);

/// The share of directions that are drawn evenly: a cell looks dark at the points where the sky was asked, but
/// need not be dark everywhere.
const EVEN: f64 = 0.01;

impl SkyTable {
    /// The table of a sky of images; none for other skies, which are even enough, and for black ones.
    pub fn new(sky: &Sky) -> Option<Self> {
        let (native_width, native_height) = match sky {
            Sky::Constant(_) | Sky::Gradient { .. } => return None,
            Sky::Equirect(image) => (image.width(), image.height()),
            Sky::CubeMap(map) => (4 * map.size(), 2 * map.size()),
        };
        let (width, height) = (native_width.min(FINEST.0), native_height.min(FINEST.1));
        // Every texel of a coarser cell is asked for, and every cell at four points.
        let points = native_width.div_ceil(width).max(native_height.div_ceil(height)).max(2);
        let grid = Grid { width, height, points };
        let cells: Vec<f64> =
            (0..height).into_par_iter().flat_map_iter(|row| grid.brightness(sky, row)).collect();
        Self::of_cells(cells, width as usize)
    }

    /// The table of cells' radiances, row by row from the bottom.
    fn of_cells(mut cells: Vec<f64>, width: usize) -> Option<Self> {
        let height = cells.len() / width;
        let between = |row: usize| Angle(180.0 * (row as f64 / height as f64) - 90.0).cos_sin().y;
        let heights: Vec<f64> = (0..=height).map(between).collect();
        // A row's share of the sphere is that of its height (Archimedes).
        let share = |row: usize| 0.5 * (heights[row + 1] - heights[row]);
        let mean = |row: &[f64]| row.iter().sum::<f64>() / width as f64;
        let whole: f64 = cells.chunks_exact(width).enumerate().map(|(y, row)| share(y) * mean(row)).sum();
        if whole <= 0.0 {
            return None;
        }
        cells.iter_mut().for_each(|cell| *cell = (1.0 - EVEN) * *cell + EVEN * whole);
        let rows = cells.chunks_exact(width).enumerate().map(|(y, row)| share(y) * mean(row));
        let rows = cumulative(rows).collect();
        let columns = cells.chunks_exact(width).flat_map(|row| cumulative(row.iter().copied())).collect();
        Some(Self { rows, columns, heights, width })
    }

    /// Directions in the sky for two numbers in 0..1, and their densities per steradian.
    #[inline(always)]
    pub fn sample<F: Real>(&self, [u, v]: [F; 2]) -> (Vec3<F>, F) {
        let (us, vs) = (u.to_array(), v.to_array());
        let (mut height, mut longitude) = (us, us);
        for lane in 0..F::LANES {
            let place = self.place([us[lane], vs[lane]]);
            (longitude[lane], height[lane]) = (place.x, place.y);
        }
        let (y, one) = (F::from_array(height), F::splat(1.0));
        let level = ((one - y) * (one + y)).max(F::splat(0.0)).sqrt();
        let direction = equirect::around(F::from_array(longitude), y, level);
        // Of the direction as it is rounded: both ways to ask give the same number.
        (direction, self.pdf(direction))
    }

    /// The longitude in 0..=1 and the height of the direction for two numbers in 0..1.
    fn place(&self, [u, v]: [f64; 2]) -> DVec2 {
        let (row, up) = pick(&self.rows, v);
        let (column, right) = pick(self.row(row), u);
        let height = self.heights[row] + up * (self.heights[row + 1] - self.heights[row]);
        DVec2::new((column as f64 + right) / self.width as f64, height)
    }

    /// The densities per steradian of directions, unit vectors in the sky.
    #[inline(always)]
    pub fn pdf<F: Real>(&self, direction: Vec3<F>) -> F {
        let column = equirect::longitude(direction) * F::splat(self.width as f64);
        let (columns, heights) = (column.to_array(), direction.y.to_array());
        let mut pdf = columns;
        for lane in 0..F::LANES {
            pdf[lane] = self.cell_pdf(columns[lane] as usize, heights[lane]);
        }
        F::from_array(pdf)
    }

    /// The density per steradian of a column's cell at a height.
    fn cell_pdf(&self, column: usize, height: f64) -> f64 {
        let row = cell_of(&self.heights, height);
        let columns = self.row(row);
        let column = column.min(self.width - 1);
        let probability = (self.rows[row + 1] - self.rows[row]) * (columns[column + 1] - columns[column]);
        let solid_angle = TAU / self.width as f64 * (self.heights[row + 1] - self.heights[row]);
        probability / solid_angle
    }

    fn row(&self, row: usize) -> &[f64] {
        let start = row * (self.width + 1);
        &self.columns[start..=start + self.width]
    }
}

/// The cells of a table, and at how many points along each axis they ask the sky.
struct Grid {
    width: u32,
    height: u32,
    points: u32,
}

impl Grid {
    /// The mean brightness in each cell of a row.
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

/// How bright a colour looks (Rec. 709).
fn luminance(color: Rgb) -> f64 {
    color.as_dvec3().dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// The sums before each weight, and of all, as shares of the whole. Weights are above 0.
fn cumulative(weights: impl Iterator<Item = f64> + Clone) -> impl Iterator<Item = f64> {
    let whole: f64 = weights.clone().sum();
    let sums = weights.scan(0.0, move |sum, weight| {
        *sum += weight;
        Some((*sum / whole).min(1.0))
    });
    std::iter::once(0.0).chain(sums)
}

/// Which of the intervals between ascending `ends` holds `value`.
fn cell_of(ends: &[f64], value: f64) -> usize {
    ends.partition_point(|end| *end <= value).clamp(1, ends.len() - 1) - 1
}

/// Which interval holds `u`, and how far along it.
fn pick(ends: &[f64], u: f64) -> (usize, f64) {
    let cell = cell_of(ends, u);
    (cell, ((u - ends[cell]) / (ends[cell + 1] - ends[cell])).clamp(0.0, 1.0))
}
