//! The error of the change from one frame to the next, which is seen as flicker.

use super::benchmark::Benchmark;
use super::results::differences;
use crate::accuracy::image_error::mean_squared_error;
use crate::accuracy::renderer::Renderer;
use crate::accuracy::settings::Experiment;
use crate::accuracy::statistics::ConfidenceInterval;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::pipeline::render::RenderError;
use crate::sampling::hash;
use crate::sequence::Sequence;
use crate::sequence::quality::Quality;
use std::time::Instant;

/// Independent pairs of runs, and the fewest if the time is over.
const PAIRS: u32 = 4;
const MIN_PAIRS: u32 = 2;

/// How wrong the change from a frame to the next is. Errors are squared: means over pixels and channels.
#[derive(Clone, Debug, PartialEq)]
pub struct TemporalError {
    /// The numbers of both frames.
    pub frames: [u32; 2],
    /// Of the change, if both frames have the same random numbers, so that noise stays in its place where nothing changes.
    pub same: ConfidenceInterval,
    /// Of the change, if each frame has its own (`vary_noise`). None if nothing is random.
    pub varied: Option<ConfidenceInterval>,
    /// Of one picture: the mean of both.
    pub picture: ConfidenceInterval,
    /// The squared change itself.
    pub change: f64,
    /// The mean of both pictures over pixels and channels, above 0.
    pub brightness: f64,
}

impl TemporalError {
    /// The error of the change with the settings of the sequence.
    pub fn own(&self, quality: &Quality) -> ConfidenceInterval {
        self.varied.filter(|_| quality.vary_noise).unwrap_or(self.same)
    }

    /// A squared error as a share of the mean brightness.
    pub fn share(&self, squared: ConfidenceInterval) -> ConfidenceInterval {
        squared.root().map(|error| error / self.brightness)
    }
}

/// Samples per pixel that the measurement takes.
pub fn temporal_samples(settings: &Experiment) -> f64 {
    let own = settings.all[0].samples;
    match settings.random {
        true => f64::from(4 * PAIRS) * own,
        false => 2.0 * (own + f64::from(settings.reference)),
    }
}

/// Two pictures, one after the other.
type Pair = [Vec<Rgb>; 2];

impl Benchmark<'_> {
    /// The error of the change from the first measured frame to the next or, if it is the last one, from the frame before;
    /// after `end`, from fewer runs. None if the sequence has one frame only, if only one of the two is random, or if both
    /// are black.
    pub fn temporal(
        &mut self,
        sequence: &Sequence,
        first: u32,
        end: Instant,
    ) -> Result<Option<TemporalError>, RenderError> {
        let last = sequence.timeline.frames.saturating_sub(1);
        if last == 0 {
            return Ok(None);
        }
        let frames = if first < last { [first, first + 1] } else { [last - 1, last] };
        let renderer = self.renderer.with_frames(&frames)?;
        let own = Quality { vary_noise: false, ..self.own };
        let found = match renderer.are_random(own.integrator)[..] {
            [true, true] => Some(of_random(&renderer, &own, frames, end)?),
            [false, false] => Some(of_grid(&renderer, &own, frames, self.finest_grid())?),
            _ => None,
        };
        self.advance(temporal_samples(&self.settings));
        Ok(found.filter(|found| found.brightness > 0.0))
    }
}

/// The pictures of two frames.
fn pair(renderer: &Renderer, quality: &Quality) -> Result<Pair, RenderError> {
    let films = renderer.render(quality)?.films;
    Ok([0, 1].map(|frame| films.get(frame).map_or_else(Vec::new, |film| film.radiance().collect())))
}

/// The noise of random samples: half the mean squared difference of independent runs.
fn of_random(
    renderer: &Renderer,
    own: &Quality,
    frames: [u32; 2],
    end: Instant,
) -> Result<TemporalError, RenderError> {
    let (mut same, mut varied, mut change, mut brightness) = (Vec::new(), Vec::new(), 0.0, 0.0);
    for number in 0..PAIRS {
        if number >= MIN_PAIRS && Instant::now() > end {
            break;
        }
        let run =
            |half: u32| pair(renderer, &Quality { seed: hash([own.seed, 2 * number + half, 5]), ..*own });
        let (a, b) = (run(0)?, run(1)?);
        let (changes, others) = (change_of(&a), change_of(&b));
        same.push(mean_squared_difference(&changes, &others) / 2.0);
        // Frames with numbers of their own have independent errors, whose squares add up.
        varied.push((mean_squared_error(&a[0], &b[0]) + mean_squared_error(&a[1], &b[1])) / 2.0);
        change += mean_product(&changes, &others);
        brightness += (mean(&a) + mean(&b)) / 2.0;
    }
    let pairs = same.len().max(1) as f64;
    let both = ConfidenceInterval::of(&varied);
    Ok(TemporalError {
        frames,
        same: ConfidenceInterval::of(&same),
        varied: Some(both),
        picture: both.map(|squared| squared / 2.0),
        change: (change / pairs).max(0.0),
        brightness: brightness / pairs,
    })
}

/// Regular grids are compared with the finest one.
fn of_grid(
    renderer: &Renderer,
    own: &Quality,
    frames: [u32; 2],
    finest: u32,
) -> Result<TemporalError, RenderError> {
    let shown = pair(renderer, own)?;
    let wanted = pair(renderer, &Quality { antialias: finest, ..*own })?;
    let picture = [0, 1].map(|frame| mean_squared_error(&shown[frame], &wanted[frame]));
    let (changes, truth) = (change_of(&shown), change_of(&wanted));
    Ok(TemporalError {
        frames,
        same: ConfidenceInterval::of(&[mean_squared_difference(&changes, &truth)]),
        varied: None,
        picture: ConfidenceInterval::of(&[(picture[0] + picture[1]) / 2.0]),
        change: mean_product(&truth, &truth),
        brightness: mean(&wanted),
    })
}

/// The change of each pixel.
fn change_of([before, after]: &Pair) -> Vec<DVec3> {
    differences(after, before)
}

/// Mean over pixels and channels of the product.
fn mean_product(a: &[DVec3], b: &[DVec3]) -> f64 {
    let products: f64 = a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum();
    products / (3 * a.len()).max(1) as f64
}

/// Mean over pixels and channels of the squared difference.
fn mean_squared_difference(a: &[DVec3], b: &[DVec3]) -> f64 {
    let wrong: Vec<DVec3> = a.iter().zip(b).map(|(a, b)| *a - *b).collect();
    mean_product(&wrong, &wrong)
}

/// The mean over both pictures, their pixels and channels.
fn mean(pair: &Pair) -> f64 {
    let all = || pair.iter().flatten();
    let sum: f64 = all().map(|light| light.as_dvec3().element_sum()).sum();
    sum / (3 * all().count()).max(1) as f64
}
