//! Chooses among the candidates for every pixel, by their measured errors around it.

use super::audits::AuditRow;
use super::calibration::{Calibration, is_detail};
use super::candidates::{ALONE, CANDIDATES, CandidateRow, difference};
use super::planes::Planes;
use super::trust::Change;
use crate::base::lanes::{Color, Level, Row, Select, SimdKernel, Single};

/// Mixes the candidates in a row of a layer, weighted by the inverse squares of mean squared errors.
///
/// Errors are means around a pixel, without the pixel itself: its samples are part of its candidates. There are two
/// exceptions. Outliers are lonely, so only the whole picture shows whether samples have a smaller error without them.
/// And details as small as a pixel are known only there: a candidate that differs from both halves, far more than they
/// differ from each other around it, is refused.
///
/// Where neighbours see points through the same pixels, fits to the samples of one picture count as much less as they have
/// fewer samples: the pooled ones are as sharp, and estimates are too coarse to show how much better they are.
///
/// The audits enter by sums over the picture alone, so what is chosen at a pixel hardly depends on their samples there.
pub struct MixRow<'a> {
    pub candidates: CandidateRow<'a>,
    /// The mean errors around each pixel.
    pub around: &'a Planes,
    pub calibration: &'a Calibration,
    pub audits: AuditRow,
    pub y: usize,
    /// The mixed light.
    pub light: [&'a mut [f32]; 3],
    /// What mixing changed.
    pub changes: &'a mut [f32],
}

impl SimdKernel for MixRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(mut self) {
        for x in (0..self.around.stride).step_by(L::F32::LANES) {
            let unit = self.candidates.unit::<L::F32>(x);
            let mut means = [Color::<L::F32>::black(); CANDIDATES];
            let weights = self.weights(x, unit, &mut means);
            let mut mixed = Color::<L::F32>::black();
            for (mean, weight) in means.into_iter().zip(weights).take(self.candidates.count()) {
                mixed = mixed + mean * weight;
            }
            let [samples, ..] = means;
            let infinite = L::F32::splat(f32::INFINITY);
            let is_finite =
                mixed.r.abs().lt(infinite) & mixed.g.abs().lt(infinite) & mixed.b.abs().lt(infinite);
            let mixed = Color::select(is_finite, mixed, samples);
            mixed.store(&mut self.light, x);
            let noise = L::F32::load(self.around.row(0, self.y), x);
            let change = Change::new([samples, mixed], self.audits.at(x), noise, unit);
            change.store(self.changes, x);
        }
    }
}

/// What is added to the errors of all candidates, as a share of that of the samples: so much the estimates around a pixel
/// vary by chance.
const UNCERTAIN: f32 = 0.2;

impl MixRow<'_> {
    /// The weights of the candidates at eight pixels, and the means of both halves. If the samples have no error, they
    /// are the picture. Squares are relative to the light when they are multiplied by `unit`.
    #[inline(always)]
    fn weights<S: Single>(&self, x: usize, unit: S, means: &mut [Color<S>; CANDIDATES]) -> [S; CANDIDATES] {
        let (zero, one) = (S::splat(0.0), S::splat(1.0));
        let samples = S::load(self.around.row(0, self.y), x);
        let least = S::splat(UNCERTAIN * self.calibration.samples[0].min(self.calibration.samples[1]));
        let still = self.candidates.still::<S>(x);
        let own = self.candidates.at::<S>(0, x);
        let mut is_known = zero.lt(samples);
        let (mut weights, mut sum) = ([zero; CANDIDATES], zero);
        for (candidate, weight) in weights.iter_mut().enumerate().take(self.candidates.count()) {
            let error = S::load(self.around.row(candidate, self.y), x);
            is_known = is_known & error.lt(S::splat(f32::INFINITY));
            let relative = match self.calibration.samples.get(candidate) {
                Some(error) => S::splat(*error),
                None => (error / samples + S::splat(self.calibration.more[candidate])).max(zero),
            };
            let both = self.candidates.at::<S>(candidate, x);
            means[candidate] = (both[0] + both[1]) * S::splat(0.5);
            let difference = difference(own, both, unit);
            let refused = S::select(is_detail(difference, samples), difference, zero);
            let error = relative + refused / samples + least;
            // The samples are there twice, mostly alike.
            let share = match candidate {
                0 | 1 => S::splat(0.5),
                2..ALONE => one / (one + still),
                _ => one,
            };
            *weight = share / (error * error);
            sum = sum + *weight;
        }
        for (candidate, weight) in weights.iter_mut().enumerate() {
            let alone = if candidate == 0 { one } else { zero };
            *weight = S::select(is_known, *weight / sum, alone);
        }
        weights
    }
}
