//! Fits light by a linear function of guides, in windows that overlap.
//!
//! The picture is divided into square cells. The four cells around each corner are a window, so neighbouring windows
//! overlap by half. In each window, the light is fitted to the guides by least squares. The fits of the four windows
//! around a pixel are weighted as in bilinear interpolation, so that no edges of windows show.

use super::guides::{COUNT, Guides, POSITION};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Entries of a symmetric matrix over the guides.
const PAIRS: usize = COUNT * (COUNT + 1) / 2;

/// What is added to the variance of a guide in a window, so that guides which hardly vary in it have no influence: a
/// hundredth of the range of an albedo, squared. Positions have cells as their unit.
const RIDGE: f64 = 1e-4;

/// Rows of windows that are fitted one after the other. Two neighbouring batches sum the cells between them twice.
const BATCH: usize = 16;

/// Pictures of light, of the same size as the guides: for each pixel a value per channel and picture.
pub struct Pictures<'a> {
    pub count: usize,
    /// The light of a pixel in a picture.
    pub light: &'a (dyn Fn(usize, usize) -> DVec3 + Sync),
}

/// Sums over the pixels of a cell or a window.
#[derive(Clone)]
struct Moments {
    count: f64,
    guides: [f64; COUNT],
    squares: [f64; PAIRS],
    /// Per picture: the light, and its products with the guides.
    light: Vec<DVec3>,
    products: Vec<[DVec3; COUNT]>,
}

impl Moments {
    fn new(pictures: usize) -> Self {
        Self {
            count: 0.0,
            guides: [0.0; COUNT],
            squares: [0.0; PAIRS],
            light: vec![DVec3::ZERO; pictures],
            products: vec![[DVec3::ZERO; COUNT]; pictures],
        }
    }

    fn add_pixel(&mut self, guides: &[f64; COUNT], light: impl Iterator<Item = DVec3>) {
        self.count += 1.0;
        let mut pair = 0;
        for (row, guide) in guides.iter().enumerate() {
            self.guides[row] += guide;
            for other in &guides[..=row] {
                self.squares[pair] += guide * other;
                pair += 1;
            }
        }
        for ((sum, products), light) in self.light.iter_mut().zip(&mut self.products).zip(light) {
            *sum += light;
            for (product, guide) in products.iter_mut().zip(guides) {
                *product += light * *guide;
            }
        }
    }

    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.guides.iter_mut().zip(other.guides).for_each(|(sum, value)| *sum += value);
        self.squares.iter_mut().zip(other.squares).for_each(|(sum, value)| *sum += value);
        self.light.iter_mut().zip(&other.light).for_each(|(sum, value)| *sum += *value);
        let products = self.products.iter_mut().zip(&other.products);
        products
            .for_each(|(sums, values)| sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += *value));
    }

    /// The least squares fit of every picture: solves the normal equations by Cholesky's decomposition.
    fn fits(&self, cell: f64) -> impl Iterator<Item = Fit> {
        let mean = self.guides.map(|sum| sum / self.count);
        let mut factor = [0.0; PAIRS];
        let mut pair = 0;
        for row in 0..COUNT {
            let ridge = if row < POSITION { RIDGE } else { RIDGE * cell * cell };
            for column in 0..=row {
                let covariance = self.squares[pair] / self.count - mean[row] * mean[column];
                // Rounding may make the variance of a large guide negative.
                factor[pair] = if row == column { covariance.max(0.0) + ridge } else { covariance };
                pair += 1;
            }
        }
        decompose(&mut factor);
        self.light.iter().zip(&self.products).map(move |(light, products)| {
            let light = *light / self.count;
            let mut slopes = [DVec3::ZERO; COUNT];
            for ((slope, product), mean) in slopes.iter_mut().zip(products).zip(mean) {
                *slope = *product / self.count - light * mean;
            }
            solve(&factor, &mut slopes);
            let at_mean: DVec3 = slopes.iter().zip(mean).map(|(slope, mean)| *slope * mean).sum();
            Fit { constant: light - at_mean, slopes }
        })
    }
}

/// The place of an entry of a lower triangular matrix.
const fn entry(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// Cholesky's decomposition in place: a positive definite matrix into L, with L Lᵀ equal to it.
fn decompose(matrix: &mut [f64; PAIRS]) {
    for row in 0..COUNT {
        for column in 0..=row {
            let known: f64 = (0..column).map(|k| matrix[entry(row, k)] * matrix[entry(column, k)]).sum();
            let rest = matrix[entry(row, column)] - known;
            matrix[entry(row, column)] = match row == column {
                // The ridge keeps the diagonal positive but for rounding.
                true => rest.max(f64::EPSILON).sqrt(),
                false => rest / matrix[entry(column, column)],
            };
        }
    }
}

/// Solves L Lᵀ x = b in place.
fn solve(factor: &[f64; PAIRS], b: &mut [DVec3; COUNT]) {
    for row in 0..COUNT {
        let known: DVec3 = (0..row).map(|k| b[k] * factor[entry(row, k)]).sum();
        b[row] = (b[row] - known) / factor[entry(row, row)];
    }
    for row in (0..COUNT).rev() {
        let known: DVec3 = (row + 1..COUNT).map(|k| b[k] * factor[entry(k, row)]).sum();
        b[row] = (b[row] - known) / factor[entry(row, row)];
    }
}

/// A linear function of the guides.
#[derive(Clone, Copy)]
struct Fit {
    constant: DVec3,
    slopes: [DVec3; COUNT],
}

impl Fit {
    /// The mean of two fits. `share` is the weight of the second one.
    fn between(&self, other: &Self, share: f64) -> Self {
        let mut mean = Self { constant: self.constant.lerp(other.constant, share), slopes: self.slopes };
        mean.slopes.iter_mut().zip(&other.slopes).for_each(|(own, other)| *own = own.lerp(*other, share));
        mean
    }

    fn at(&self, guides: &[f64; COUNT]) -> DVec3 {
        self.slopes.iter().zip(guides).fold(self.constant, |sum, (slope, guide)| sum + *slope * *guide)
    }
}

/// Fits all pictures in windows of twice the side of `cell`, in pixels. Returns the fitted light: the pictures of each
/// pixel, row by row.
pub fn fit(guides: &Guides, pictures: &Pictures, cell: usize) -> Vec<glam::Vec3> {
    let rows = guides.height.div_ceil(cell) + 1;
    let batches = (0..rows).into_par_iter().step_by(BATCH);
    let fits: Vec<Fit> = batches
        .flat_map_iter(|first| fit_windows(guides, pictures, cell, first..rows.min(first + BATCH)))
        .collect();
    let in_row = (guides.width.div_ceil(cell) + 1) * pictures.count;
    let mut fitted = vec![glam::Vec3::ZERO; guides.width * guides.height * pictures.count];
    fitted.par_chunks_mut((guides.width * pictures.count).max(1)).enumerate().for_each(|(y, row)| {
        let (above, below) = (y / cell * in_row, (y / cell + 1) * in_row);
        let share = share_of(y, cell);
        let pairs = fits[above..][..in_row].iter().zip(&fits[below..][..in_row]);
        let fits: Vec<Fit> = pairs.map(|(above, below)| above.between(below, share)).collect();
        for (x, out) in row.chunks_exact_mut(pictures.count).enumerate() {
            let guides = guides.at(y * guides.width + x);
            let (left, right) = (x / cell * pictures.count, (x / cell + 1) * pictures.count);
            let share = share_of(x, cell);
            for (picture, out) in out.iter_mut().enumerate() {
                let (left, right) = (fits[left + picture].at(&guides), fits[right + picture].at(&guides));
                *out = left.lerp(right, share).as_vec3();
            }
        }
    });
    fitted
}

/// The weight of the window at the far end of the cell in which a pixel lies.
fn share_of(position: usize, cell: usize) -> f64 {
    ((position % cell) as f64 + 0.5) / cell as f64
}

/// The fits of some rows of windows: window by window, the pictures of each.
fn fit_windows(guides: &Guides, pictures: &Pictures, cell: usize, rows: Range<usize>) -> Vec<Fit> {
    let columns = guides.width.div_ceil(cell) + 1;
    let mut fits = Vec::with_capacity(rows.len() * columns * pictures.count);
    // Cells around the picture are empty.
    let mut above = match rows.start {
        0 => vec![Moments::new(pictures.count); columns + 1],
        first => sum_cells(guides, pictures, cell, first - 1),
    };
    for row in rows {
        let below = sum_cells(guides, pictures, cell, row);
        for column in 0..columns {
            let mut window = above[column].clone();
            [&above[column + 1], &below[column], &below[column + 1]]
                .into_iter()
                .for_each(|cell| window.add(cell));
            fits.extend(window.fits(cell as f64));
        }
        above = below;
    }
    fits
}

/// The sums of a row of cells, with an empty one at both ends.
fn sum_cells(guides: &Guides, pictures: &Pictures, cell: usize, row: usize) -> Vec<Moments> {
    let mut cells = vec![Moments::new(pictures.count); guides.width.div_ceil(cell) + 2];
    for y in row * cell..guides.height.min((row + 1) * cell) {
        for x in 0..guides.width {
            let pixel = y * guides.width + x;
            let light = (0..pictures.count).map(|picture| (pictures.light)(pixel, picture));
            cells[x / cell + 1].add_pixel(&guides.at(pixel), light);
        }
    }
    cells
}
