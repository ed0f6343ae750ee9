//! Weighted sums around each pixel, and the errors of the candidates there.

use super::measured::{By, Measured};
use super::planes::{COLUMN, Planes};
use crate::base::lanes::{Level, Row, SimdKernel, dispatch};
use rayon::prelude::*;

/// How far errors of candidates count along an axis, in pixels.
const REACH: usize = 6;

/// What is before a row of sums, and after it, so that lanes find zeros there.
const MARGIN: usize = 8;

/// The weight of pixels at a distance along an axis.
#[inline(always)]
fn weight(distance: usize, reach: usize) -> f32 {
    (reach + 1 - distance) as f32
}

/// The weight of a pixel itself, which sums around it leave out.
fn own_weight(reach: usize) -> f32 {
    weight(0, reach) * weight(0, reach)
}

/// The mean errors of so many candidates around each pixel, without the pixel itself: a plane for each candidate. They may
/// be negative by chance; that of the samples is at least 0.
pub fn surroundings(measured: &Measured, candidates: usize) -> Planes {
    let (width, height) = measured.planes().size();
    let mut means = measured.planes().unset_like(candidates);
    let stride = means.stride;
    let in_rows: Vec<f32> = (0..stride).map(|x| weights(x.min(width - 1), width)).collect();
    means.par_lines_mut().enumerate().for_each(|(y, line)| {
        let in_column = weights(y, height);
        let mut sums = Sums::new(stride);
        for (candidate, into) in line.chunks_exact_mut(stride).enumerate() {
            let plane = Measured::plane(By::Halves, candidate);
            sums.add::<REACH>(measured.planes(), plane, (y, height), into);
            for (sum, in_row) in into.iter_mut().zip(&in_rows) {
                *sum /= in_row * in_column - own_weight(REACH);
            }
            if candidate == 0 {
                into.iter_mut().for_each(|mean| *mean = mean.max(0.0));
            }
        }
    });
    means
}

/// The sum of the weights of the pixels around a place on an axis. Places outside of the picture do not count.
fn weights(center: usize, length: usize) -> f32 {
    let near = center.saturating_sub(REACH)..length.min(center + REACH + 1);
    near.map(|place| weight(place.abs_diff(center), REACH)).sum()
}

/// The sums of numbers around the pixels of a row.
pub struct Sums {
    /// The sums of columns, with margins of zeros.
    columns: Vec<f32>,
}

impl Sums {
    pub fn new(stride: usize) -> Self {
        Self { columns: vec![0.0; stride + 2 * MARGIN] }
    }

    /// Writes the weighted sums of the numbers of a plane around each pixel of row `y` of a picture of that height,
    /// without the pixel itself, up to `REACH` pixels along both axes, at most seven. The planes may have fewer rows
    /// than the picture: each has taken the place of an earlier one.
    pub fn add<const REACH: usize>(
        &mut self,
        planes: &Planes,
        plane: usize,
        (y, height): (usize, usize),
        into: &mut [f32],
    ) {
        let near = y.saturating_sub(REACH)..height.min(y + REACH + 1);
        let (mut rows, mut weights) = ([&[][..]; 2 * MARGIN], [0.0; 2 * MARGIN]);
        let count = near.len();
        for (other, (row, weighted)) in near.zip(rows.iter_mut().zip(&mut weights)) {
            (*row, *weighted) = (planes.row(plane, other % planes.height), weight(other.abs_diff(y), REACH));
        }
        let (rows, weights, own) = (&rows[..count], &weights[..count], planes.row(plane, y % planes.height));
        dispatch(SumAround::<REACH> { rows, weights, own, columns: &mut self.columns, into });
    }
}

struct SumAround<'a, const REACH: usize> {
    /// The rows that count, and their weights.
    rows: &'a [&'a [f32]],
    weights: &'a [f32],
    own: &'a [f32],
    columns: &'a mut [f32],
    into: &'a mut [f32],
}

impl<const REACH: usize> SimdKernel for SumAround<'_, REACH> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { rows, weights, own, columns, into } = self;
        let zero = L::F32::splat(0.0);
        // Rows are padded to whole columns: two times eight pixels.
        for x in (0..into.len()).step_by(COLUMN) {
            let mut sums = [zero; 2];
            for (row, weight) in rows.iter().zip(weights) {
                let (row, weight) = (&row[x..][..COLUMN], L::F32::splat(*weight));
                sums[0] = sums[0] + weight * L::F32::load(row, 0);
                sums[1] = sums[1] + weight * L::F32::load(row, L::F32::LANES);
            }
            let columns = &mut columns[MARGIN + x..][..COLUMN];
            sums[0].store(columns, 0);
            sums[1].store(columns, L::F32::LANES);
        }
        let center = L::F32::splat(weight(0, REACH));
        for x in (0..into.len()).step_by(L::F32::LANES) {
            let columns = &columns[x..][..2 * MARGIN + L::F32::LANES];
            let mut sum = center * L::F32::load(columns, MARGIN);
            for offset in 1..=REACH {
                let both = L::F32::load(columns, MARGIN - offset) + L::F32::load(columns, MARGIN + offset);
                sum = sum + L::F32::splat(weight(offset, REACH)) * both;
            }
            (sum - center * center * L::F32::load(own, x)).store(into, x);
        }
    }
}
