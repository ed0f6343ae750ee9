//! Renders every setting several times, in turn, and compares the pictures with two references.

mod bench;
mod sizing;
mod tried;
mod whole;

pub use whole::Whole;

use super::chains::{Chain, chains};
use super::precision::{Precision, precision};
use super::robustness::Robustness;
use super::settings::{Axis, LeftOut, Setting};
use super::statistics::{Bias, Concentration, Estimate, Spread, slope};
use super::studio::Studio;
use crate::pipeline::render::{Large, RenderError};
use crate::sequence::Sequence;
use crate::sequence::quality::Integrator;
use bench::Bench;
use sizing::{fit, memory_for, planned};
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

/// What to measure, and how long that may take.
#[derive(Clone, Debug)]
pub struct Request {
    pub frames: Vec<u32>,
    /// How long all of it should take, about. Pictures are made smaller to keep it.
    pub time: Duration,
    /// A first answer: fewer settings.
    pub quick: bool,
    /// Of the pictures; what the time allows if absent.
    pub size: Option<(u32, u32)>,
    /// The most samples that are tried, unless the file's own setting takes more.
    pub most_samples: Option<u32>,
    pub threads: Option<NonZeroUsize>,
}

/// What a setting costs, and what it gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    pub setting: Setting,
    /// Seconds for a frame.
    pub wall: Spread,
    /// Of all processors together.
    pub cpu: Option<Spread>,
    /// For a frame.
    pub rays: f64,
    /// In a pixel, on average.
    pub samples: f64,
    /// Mean squared error of radiance; the references' noise does not count.
    pub squared: Estimate,
    /// relMSE.
    pub relative: Estimate,
    /// In decibels, of the displayed picture.
    pub psnr: Estimate,
    /// Mean FLIP of the displayed picture.
    pub flip: Estimate,
    /// What no more samples take away: against the reference or, along axes that are short, against the file's own setting
    /// with as many samples of the same random numbers.
    pub bias: Bias,
    /// Along such axes, the largest change of a displayed value, in 0..=1.
    pub largest_change: f64,
    /// Of a pixel between runs, summed over its channels: the mean over pixels.
    pub variance: f64,
    /// How few pixels hold the squared error of a run.
    pub concentration: Concentration,
    /// Squared errors of pixels, the mean of all runs.
    pub errors: Vec<f32>,
    /// Share of the pixels that hit the limit of samples.
    pub capped: f64,
    /// What the picture displays as; the first run.
    pub picture: Vec<[f32; 3]>,
    /// Of each run: squared error.
    pub runs: Vec<f64>,
    pub flips: Vec<f32>,
}

impl Point {
    /// Root of the mean squared error of what is displayed, in 0..=1.
    pub fn displayed(&self) -> Estimate {
        self.psnr.map(|decibels| libm::exp10(-decibels / 20.0))
    }

    /// Seconds of all processors for a frame or, where the system does not tell, on the wall.
    pub fn time(&self) -> f64 {
        self.cpu.map_or(self.wall.median, |cpu| cpu.median)
    }

    /// 1 / (squared error x seconds): twice of it is the same picture in half the time.
    pub fn efficiency(&self) -> f64 {
        1.0 / (self.squared.mean * self.time())
    }

    /// Root of the mean squared error.
    pub fn error(&self) -> f64 {
        self.squared.mean.max(0.0).sqrt()
    }
}

/// A layer of light, at the file's own setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    pub name: String,
    /// Share of the picture's brightness.
    pub share: f64,
    /// Its error as a share of its own brightness.
    pub error: f64,
    /// Its share of the squared error in the worst hundredth of the pixels.
    pub of_worst: f64,
}

/// All that was measured.
#[derive(Clone, Debug)]
pub struct Measured {
    pub name: String,
    pub frames: Vec<u32>,
    /// Of the file, and of the pictures that were measured.
    pub full_size: (u32, u32),
    pub size: (u32, u32),
    pub threads: usize,
    pub random: bool,
    /// What the whole film costs by the file's own setting.
    pub whole: Whole,
    /// The first is the file's own.
    pub points: Vec<Point>,
    pub left_out: Vec<LeftOut>,
    /// Samples in a pixel of both references together.
    pub reference: u32,
    /// Root of the references' own mean squared error.
    pub reference_error: f64,
    /// Mean of the reference over pixels and channels.
    pub brightness: f64,
    /// What the picture should display as.
    pub wanted: Vec<[f32; 3]>,
    /// With how which power of the samples the error changes, by axis.
    pub slopes: Vec<(Axis, Estimate)>,
    pub layers: Vec<Layer>,
    /// Which paths make the noise of the worst pixels.
    pub chains: Vec<Chain>,
    /// What robustness costs on the scene's own rays; none of a frame without a camera.
    pub robustness: Option<Robustness>,
    /// The same for all sequences.
    pub precision: Vec<Precision>,
    pub took: Duration,
}

/// Pixels whose rays are held against arithmetic of twice the precision, at most.
const QUICK_PIXELS: u32 = 8_000;
const USUAL_PIXELS: u32 = 40_000;

/// Measures. `progress` hears of every step what share of the work is done; it may answer that it is enough.
pub fn measure(
    sequence: &Sequence,
    request: &Request,
    progress: &mut dyn FnMut(f64),
) -> Result<Measured, RenderError> {
    let start = Instant::now();
    let mut studio = Studio::new(sequence, &request.frames, request.threads)?;
    let (settings, size) = planned(&mut studio, sequence, request)?;
    // Before anything is rendered in that size.
    let pixels = u64::from(size.0) * u64::from(size.1) * studio.frames() as u64;
    Large::Measurement.check(memory_for(sequence.layers(), settings.all.len() as u64, pixels))?;
    fit(&mut studio, &settings, size, request, start)?;
    let mut bench = Bench::new(&studio, settings, &sequence.quality, progress);
    let reference = bench.reference()?;
    bench.run(&reference, start + request.time)?;
    let layers = bench.layers(&reference, sequence)?;
    let Bench { mut settings, tries, .. } = bench;
    let chains = match (settings.random, sequence.quality.integrator) {
        (true, Integrator::Path(_)) => chains(&studio, sequence, &sequence.quality, tries[0].errors()),
        _ => Vec::new(),
    };
    let pixels = if request.quick { QUICK_PIXELS } else { USUAL_PIXELS };
    let size = sequence.output.size;
    let robustness = studio.scene(|scene| studio.install(|| Robustness::of(scene, size, pixels)));
    let points: Vec<Point> = tries
        .iter()
        .enumerate()
        .map(|(index, tried)| {
            let setting = settings.all[index].clone();
            let twin = setting.axis.is_short().then(|| &tries[settings.twin(index)]);
            tried.point(setting, twin, &reference, &studio)
        })
        .collect();
    let points = settings.without_unfinished(points, |point| point.capped);
    Ok(Measured {
        name: sequence.name.clone(),
        frames: request.frames.clone(),
        full_size: sequence.output.size,
        size: studio.size(),
        threads: studio.threads(),
        random: settings.random,
        whole: Whole::of(sequence, &studio, &points[0])?,
        slopes: slopes(&points),
        points,
        left_out: settings.left_out,
        reference: settings.reference * if settings.random { 2 } else { 1 },
        reference_error: reference.pair.noise().sqrt(),
        brightness: reference.pair.brightness(),
        wanted: reference.displayed.clone(),
        layers,
        chains,
        robustness,
        precision: precision(),
        took: start.elapsed(),
    })
}

/// Along axes of samples, by run and then over all runs, which are independent.
fn slopes(points: &[Point]) -> Vec<(Axis, Estimate)> {
    let of = |axis: Axis| {
        let on: Vec<&Point> =
            points.iter().filter(|point| point.setting.axis == axis && point.samples > 1.0).collect();
        let runs = on.first()?.runs.len();
        let line = |run: usize| {
            let logarithms = on.iter().filter(|point| point.runs[run] > 0.0);
            let logarithms =
                logarithms.map(|point| (libm::log(point.samples), libm::log(point.runs[run]) / 2.0));
            slope(&logarithms.collect::<Vec<_>>())
        };
        let slopes: Vec<f64> = (0..runs).filter_map(line).collect();
        (slopes.len() > 1).then(|| (axis, Estimate::of(&slopes)))
    };
    [Axis::Samples, Axis::Independent].into_iter().filter_map(of).collect()
}
