//! What both halves and the audits show of the errors of the candidates at each pixel.

use super::super::Film;
use super::audits::AuditRow;
use super::candidates::{CANDIDATES, CandidateRow, LayerCandidates};
use super::planes::Planes;
use crate::base::lanes::{Level, Mask, Row, Select, SimdKernel, Single, dispatch};
use rayon::prelude::*;

/// Planes of a layer: squared errors, summed over the channels, relative to the light of their pixel.
pub struct Measured(Planes);

/// How squared errors are estimated.
#[derive(Clone, Copy)]
pub enum By {
    /// From the halves, for the means of both halves' candidates, if the halves are independent.
    Halves,
    /// From the audits, which suppose nothing.
    Audits,
}

/// The number of estimates for a pixel.
const ESTIMATES: usize = 2 * CANDIDATES;

impl Measured {
    pub const BYTES_PER_PIXEL: u64 = (ESTIMATES * size_of::<f32>()) as u64;

    /// The estimates for a layer. Beside the picture, they are zero.
    pub fn new(candidates: &LayerCandidates, layer: usize, audits: [&Film; 2]) -> Self {
        let mut errors = Planes::unset(candidates.memory(), candidates.size(), ESTIMATES);
        errors.par_lines_mut().enumerate().for_each(|(y, into)| {
            let audits = AuditRow::new(audits, layer, y);
            dispatch(MeasureRow { candidates: candidates.row(y), audits, into });
        });
        Self(errors)
    }

    /// The squared errors of a candidate in a row.
    #[inline(always)]
    pub fn row(&self, by: By, candidate: usize, y: usize) -> &[f32] {
        self.0.row(Self::plane(by, candidate), y)
    }

    /// All planes.
    pub fn planes(&self) -> &Planes {
        &self.0
    }

    /// The plane of the squared errors of a candidate.
    pub const fn plane(by: By, candidate: usize) -> usize {
        by as usize * CANDIDATES + candidate
    }
}

/// Measures the candidates of a row.
///
/// Let a candidate of a half differ from the truth by the bias β and by noise of the variance v, and its samples by
/// noise of the variance s. If the halves are independent, the squares of the differences between a candidate and the
/// samples of the other half are β² + v + s on average, that between the samples 2 s, and that between the candidates 2
/// v. The error of the mean of both is β² + v / 2. But samples of one sequence avoid each other. What that changes is
/// known from the audits, on average over the picture: the product of the differences to both is the squared error,
/// with more noise.
struct MeasureRow<'a> {
    candidates: CandidateRow<'a>,
    audits: AuditRow,
    into: &'a mut [f32],
}

impl SimdKernel for MeasureRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { candidates, audits, into } = self;
        let stride = into.len() / ESTIMATES;
        let [zero, half, quarter] = [0.0, 0.5, 0.25].map(L::F32::splat);
        for x in (0..stride).step_by(L::F32::LANES) {
            let [a, b] = candidates.at::<L::F32>(0, x);
            let audits = audits.at::<L::F32>(x);
            let (samples, unit) = ((a - b).length_squared(), candidates.unit::<L::F32>(x));
            let mut all = [zero; ESTIMATES];
            for candidate in 0..candidates.count() {
                let [first, second] = candidates.at(candidate, x);
                let crossed = (first - b).length_squared() + (second - a).length_squared();
                let error = (crossed - samples) * half - (first - second).length_squared() * quarter;
                all[By::Halves as usize * CANDIDATES + candidate] = unit * error;
                let mean = (first + second) * half;
                let error = (mean - audits[0]).dot(mean - audits[1]);
                all[By::Audits as usize * CANDIDATES + candidate] = unit * error;
            }
            // Light that overflows, and pictures without any.
            let mut is_finite = L::Mask::splat(true);
            for error in all {
                is_finite = is_finite & error.abs().lt(L::F32::splat(f32::INFINITY));
            }
            for (plane, error) in all.into_iter().enumerate() {
                L::F32::select(is_finite, error, zero).store(into, plane * stride + x);
            }
        }
    }
}
