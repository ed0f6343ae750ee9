//! What the audits show of the candidates over the whole picture.

use super::candidates::{CANDIDATES, CandidateRow, LayerCandidates, difference};
use super::measured::{By, Measured};
use super::planes::Planes;
use crate::base::lanes::{Level, Row, Select, SimdKernel, Single, dispatch};
use rayon::prelude::*;

/// The least error of the samples that counts, as a share of what halves show: estimates may be 0 or negative by chance.
const LEAST: f32 = 1e-3;

/// How many times the squared error of the samples a squared difference may be that is plain noise.
const PLAIN: f32 = 16.0;

/// What the audits show over the whole picture, relative to the error of the samples that halves show.
pub struct Calibration {
    /// What is to be added to the error of each candidate.
    pub more: [f32; CANDIDATES],
    /// The errors of the samples with outliers, and without.
    pub samples: [f32; 2],
}

/// Whether a squared difference to the samples is more than noise, so that there is a detail, which the candidate
/// lacks. `samples` is the squared error of the samples around it.
#[inline(always)]
pub fn is_detail<S: Single>(difference: S, samples: S) -> S::Mask {
    (S::splat(PLAIN) * samples).lt(difference)
}

/// The squared errors of candidates by the audits and by the halves, summed.
type Sums<F> = [[F; CANDIDATES]; 2];

impl Calibration {
    /// What the audits show of a layer. `around` holds the mean errors around each pixel. Outliers do not count.
    pub fn new(candidates: &LayerCandidates, measured: &Measured, around: &Planes) -> Self {
        let sum = |y: usize| dispatch(SumRow { candidates: candidates.row(y), measured, around, y });
        let rows: Vec<Sums<f64>> = (0..around.height).into_par_iter().map(sum).collect();
        let [mut audited, mut errors] = [[0.0; CANDIDATES]; 2];
        for [by_audits, by_halves] in &rows {
            audited.iter_mut().zip(by_audits).for_each(|(sum, error)| *sum += error);
            errors.iter_mut().zip(by_halves).for_each(|(sum, error)| *sum += error);
        }
        let relative = |sum: f64| if errors[0] > 0.0 { (sum / errors[0]) as f32 } else { 0.0 };
        let [with, without, ..] = audited;
        let mut more = [0.0; CANDIDATES];
        for (candidate, more) in more.iter_mut().enumerate() {
            *more = relative(audited[candidate] - errors[candidate]);
        }
        Self { more, samples: [with, without].map(|sum| relative(sum).max(LEAST)) }
    }
}

/// Sums the errors of a row.
struct SumRow<'a> {
    candidates: CandidateRow<'a>,
    measured: &'a Measured,
    around: &'a Planes,
    y: usize,
}

impl SimdKernel for SumRow<'_> {
    type Output = Sums<f64>;

    #[inline(always)]
    fn run<L: Level>(self) -> Sums<f64> {
        let Self { candidates, measured, around, y } = self;
        let (samples, zero) = (around.row(0, y), L::F32::splat(0.0));
        let mut errors = [[&[][..]; CANDIDATES]; 2];
        for (by, errors) in [By::Audits, By::Halves].into_iter().zip(&mut errors) {
            for (candidate, row) in errors.iter_mut().enumerate().take(candidates.count()) {
                *row = measured.row(by, candidate, y);
            }
        }
        let mut sums = [[L::F64::splat(0.0); CANDIDATES]; 2];
        for x in (0..samples.len()).step_by(L::F32::LANES) {
            let [own, dimmed] = [candidates.at(0, x), candidates.at(1, x)];
            let moved = difference(own, dimmed, candidates.unit(x));
            let outlier = is_detail(moved, L::F32::load(samples, x));
            for candidate in 0..candidates.count() {
                for (errors, sums) in errors.iter().zip(&mut sums) {
                    let error = L::F32::load(errors[candidate], x);
                    sums[candidate] = sums[candidate] + L::F32::select(outlier, zero, error).to_f64();
                }
            }
        }
        sums.map(|sums| sums.map(|sum| sum.to_array().iter().sum()))
    }
}
