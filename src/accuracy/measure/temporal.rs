//! The error of the change from one frame to the next, which is seen as flicker.

use super::benchmark::Benchmark;
use super::reference::Reference;
use crate::accuracy::renderer::Renderer;
use crate::accuracy::settings::Experiment;
use crate::accuracy::statistics::ConfidenceInterval;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::pipeline::render::RenderError;
use crate::sampling::hash;
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;

/// Independent pairs of runs.
const PAIRS: u32 = 4;

/// How wrong the change from a frame to the next is. Errors are squared: means over pixels and channels.
#[derive(Clone, Debug, PartialEq)]
pub struct TemporalError {
    /// The numbers of both frames.
    pub frames: [u32; 2],
    /// If both frames have the same random numbers, so that noise stays in its place where nothing changes.
    pub same: ConfidenceInterval,
    /// If each frame has its own (`vary_noise`). None if nothing is random.
    pub varied: Option<ConfidenceInterval>,
    /// The squared change itself.
    pub change: f64,
}

impl TemporalError {
    /// The error with the settings of the sequence.
    pub fn own(&self, quality: &Quality) -> ConfidenceInterval {
        self.varied.filter(|_| quality.vary_noise).unwrap_or(self.same)
    }
}

/// Samples per pixel that the measurement takes.
pub fn temporal_samples(settings: &Experiment) -> f64 {
    let own = settings.all[0].samples;
    match settings.random {
        true => f64::from(4 * PAIRS) * own,
        false => 2.0 * own + f64::from(settings.reference),
    }
}

impl Benchmark<'_> {
    /// The error of the change from the first measured frame to the next or, if it is the last one, from the frame
    /// before. None if the sequence has one frame only.
    pub fn temporal(
        &mut self,
        reference: &Reference,
        sequence: &Sequence,
        first: u32,
    ) -> Result<Option<TemporalError>, RenderError> {
        let last = sequence.timeline.frames.saturating_sub(1);
        let frames = if first < last { [first, first + 1] } else { [last.saturating_sub(1), last] };
        if last == 0 {
            return Ok(None);
        }
        let own = Quality { vary_noise: false, ..self.own };
        let (same, varied, change) = match self.settings.random {
            true => self.of_random(sequence, &own, frames)?,
            false => self.of_grid(reference, sequence, &own, (first, frames))?,
        };
        self.advance(temporal_samples(&self.settings));
        Ok(Some(TemporalError { frames, same, varied, change }))
    }

    /// The pictures of frames.
    fn pictures(
        &self,
        sequence: &Sequence,
        quality: &Quality,
        frames: &[u32],
    ) -> Result<Vec<Vec<Rgb>>, RenderError> {
        let renderer = Renderer::of_frames(self.renderer, sequence, frames)?;
        Ok(renderer.render(quality)?.films.iter().map(|film| film.radiance().collect()).collect())
    }

    /// Random samples have no bias, so the squared error is half the mean squared difference of independent runs.
    fn of_random(
        &self,
        sequence: &Sequence,
        own: &Quality,
        frames: [u32; 2],
    ) -> Result<(ConfidenceInterval, Option<ConfidenceInterval>, f64), RenderError> {
        let (mut same, mut varied, mut change) = (Vec::new(), Vec::new(), 0.0);
        for pair in 0..PAIRS {
            let run = |half: u32| {
                let seed = hash([own.seed, 2 * pair + half, 5]);
                self.pictures(sequence, &Quality { seed, ..*own }, &frames)
            };
            let (a, b) = (run(0)?, run(1)?);
            let (changes, others) = (differences(&a[1], &a[0]), differences(&b[1], &b[0]));
            same.push(mean_square(changes.iter().zip(&others).map(|(a, b)| *a - *b)) / 2.0);
            // Frames with numbers of their own have independent errors, whose squares add up.
            let of_frame = |frame: usize| mean_square(differences(&a[frame], &b[frame]).into_iter()) / 2.0;
            varied.push(of_frame(0) + of_frame(1));
            let products: f64 = changes.iter().zip(&others).map(|(a, b)| a.dot(*b)).sum();
            change += products / (3 * changes.len().max(1)) as f64 / f64::from(PAIRS);
        }
        let varied = Some(ConfidenceInterval::of(&varied));
        Ok((ConfidenceInterval::of(&same), varied, change.max(0.0)))
    }

    /// Regular grids are compared with the finest one.
    fn of_grid(
        &self,
        reference: &Reference,
        sequence: &Sequence,
        own: &Quality,
        (first, frames): (u32, [u32; 2]),
    ) -> Result<(ConfidenceInterval, Option<ConfidenceInterval>, f64), RenderError> {
        let shown = self.pictures(sequence, own, &frames)?;
        let other = frames.into_iter().filter(|frame| *frame != first).collect::<Vec<_>>();
        let finest = Quality { antialias: self.finest_grid(), ..*own };
        let other = self.pictures(sequence, &finest, &other)?;
        // The first of the measured frames.
        let known = &reference.pair.a[..shown[0].len()];
        let (before, after) =
            if frames[0] == first { (known, &other[0][..]) } else { (&other[0][..], known) };
        let wanted = differences(after, before);
        let changes = differences(&shown[1], &shown[0]);
        let wrong = mean_square(changes.iter().zip(&wanted).map(|(a, b)| *a - *b));
        Ok((ConfidenceInterval::of(&[wrong]), None, mean_square(wanted.into_iter())))
    }
}

fn differences(a: &[Rgb], b: &[Rgb]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(a, b)| a.as_dvec3() - b.as_dvec3()).collect()
}

/// The mean over pixels and channels.
fn mean_square(values: impl ExactSizeIterator<Item = DVec3>) -> f64 {
    let count = (3 * values.len()).max(1) as f64;
    values.map(|value| value.length_squared()).sum::<f64>() / count
}
