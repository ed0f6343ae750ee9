//! The errors of the candidates around each pixel.

use super::candidates::CANDIDATES;
use super::measured::{By, Measured};
use super::planes::Planes;
use crate::base::lanes::{Level, Row, SimdKernel, Single, dispatch};
use rayon::prelude::*;

/// Weights of the errors of pixels at a distance of 0, 1, … along an axis.
const KERNEL: [f32; 7] = [7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0];

/// How far errors count along an axis, in pixels.
const REACH: usize = KERNEL.len() - 1;

/// What is before a row of sums, and after it, so that lanes find zeros there.
const MARGIN: usize = 8;

/// The mean errors of the candidates around each pixel, without the pixel itself, not below 0: a plane for each
/// candidate.
pub fn surroundings(measured: &Measured) -> Planes {
    let (width, height) = measured.size();
    let mut means = Planes::new((width, height), CANDIDATES);
    let stride = means.stride;
    let in_rows: Vec<f32> = (0..stride).map(|x| weights(x.min(width - 1), width)).collect();
    means.par_lines_mut().enumerate().for_each(|(y, line)| {
        let in_column = weights(y, height);
        let mut sums = vec![0.0; stride + 2 * MARGIN];
        for (candidate, into) in line.chunks_exact_mut(stride).enumerate() {
            dispatch(MeanErrors {
                measured,
                candidate,
                y,
                in_rows: &in_rows,
                in_column,
                sums: &mut sums,
                into,
            });
        }
    });
    means
}

/// The sum of the weights of the pixels around a place on an axis. Places outside of the picture do not count.
fn weights(center: usize, length: usize) -> f32 {
    let near = center.saturating_sub(REACH)..length.min(center + REACH + 1);
    near.map(|place| KERNEL[place.abs_diff(center)]).sum()
}

/// The mean errors of a candidate in a row.
struct MeanErrors<'a> {
    measured: &'a Measured,
    candidate: usize,
    y: usize,
    /// The sums of weights along the row.
    in_rows: &'a [f32],
    in_column: f32,
    /// The sums of columns, with margins of zeros.
    sums: &'a mut [f32],
    into: &'a mut [f32],
}

impl SimdKernel for MeanErrors<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { measured, candidate, y, in_rows, in_column, sums, into } = self;
        let (zero, own) = (L::F32::splat(0.0), measured.row(By::Halves, candidate, y));
        let near = y.saturating_sub(REACH)..measured.size().1.min(y + REACH + 1);
        for x in (0..into.len()).step_by(L::F32::LANES) {
            let mut sum = zero;
            for other in near.clone() {
                let errors = measured.row(By::Halves, candidate, other);
                sum = sum + L::F32::splat(KERNEL[other.abs_diff(y)]) * L::F32::load(errors, x);
            }
            sum.store(sums, MARGIN + x);
        }
        let center = L::F32::splat(KERNEL[0] * KERNEL[0]);
        for x in (0..into.len()).step_by(L::F32::LANES) {
            let mut sum = L::F32::splat(KERNEL[0]) * L::F32::load(sums, MARGIN + x);
            for (offset, weight) in KERNEL.into_iter().enumerate().skip(1) {
                let [left, right] = [MARGIN + x - offset, MARGIN + x + offset];
                sum = sum + L::F32::splat(weight) * (L::F32::load(sums, left) + L::F32::load(sums, right));
            }
            let total = L::F32::load(in_rows, x) * L::F32::splat(in_column) - center;
            let mean = (sum - center * L::F32::load(own, x)) / total;
            mean.max(zero).store(into, x);
        }
    }
}
