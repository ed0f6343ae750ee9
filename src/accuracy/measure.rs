//! Renders every setting several times, in turn, and compares the pictures with two references.

mod bench;
mod sizing;
mod tried;

use super::precision::{Precision, precision};
use super::settings::{Axis, LeftOut, Setting};
use super::statistics::{Estimate, Spread, slope};
use super::studio::Studio;
use crate::render::{Large, RenderError};
use crate::sequence::Sequence;
use bench::Bench;
use sizing::{RUNS, fit, memory_for, planned};
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
    /// Longest ladder of samples; what the time allows if absent.
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
    /// What no more samples take away, squared.
    pub bias: f64,
    /// What the picture displays as; the first run.
    pub picture: Vec<[f32; 3]>,
    /// The same of all runs together.
    pub settled: Vec<[f32; 3]>,
    /// Of each run: squared error.
    pub runs: Vec<f64>,
    pub flips: Vec<f32>,
}

impl Point {
    /// Root of the mean squared error of what is displayed, in 0..=1.
    pub fn displayed(&self) -> Estimate {
        self.psnr.map(|decibels| libm::exp10(-decibels / 20.0))
    }

    /// 1 / (squared error x seconds): twice of it is the same picture in half the time.
    pub fn efficiency(&self) -> f64 {
        1.0 / (self.squared.mean * self.wall.median)
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
    pub runs: u32,
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
    /// The same for all sequences.
    pub precision: Vec<Precision>,
    pub took: Duration,
}

/// Share of the time for a setting that is sampled until it is good.
const NOISE_SHARE: f64 = 0.1;

/// Measures. `progress` hears of every step what share of the work is done; it may answer that it is enough.
pub fn measure(
    sequence: &Sequence,
    request: &Request,
    progress: &mut dyn FnMut(f64),
) -> Result<Measured, RenderError> {
    let start = Instant::now();
    let own = sequence.quality;
    let mut studio = Studio::new(sequence, &request.frames, request.threads)?;
    let (mut settings, size) = planned(&mut studio, &own, sequence.output.size, request)?;
    let each = fit(&mut studio, &settings, &own, size, request, start)?;
    settings.hurry((NOISE_SHARE * request.time.as_secs_f64() / each / f64::from(RUNS)) as u32);
    Large::Measurement.check(memory_for(
        sequence.layers(),
        settings.all.len() as u64,
        studio.pixels() as u64,
    ))?;
    let mut bench = Bench::new(&studio, settings, &own, progress);
    let references = bench.references()?;
    bench.run(&references)?;
    let layers = bench.layers(&references, sequence)?;
    let Bench { mut settings, tries, runs, .. } = bench;
    let tries = settings.without_unfinished(tries, |tried| tried.capped > 0.0);
    let main = &references[0];
    let points: Vec<Point> = settings
        .all
        .into_iter()
        .zip(tries)
        .map(|(setting, tried)| tried.point(setting, &references, &studio))
        .collect();
    Ok(Measured {
        name: sequence.name.clone(),
        frames: request.frames.clone(),
        full_size: sequence.output.size,
        size: studio.size(),
        threads: studio.threads(),
        random: settings.random,
        runs,
        slopes: slopes(&points),
        points,
        left_out: settings.left_out,
        reference: settings.reference,
        reference_error: main.pair.noise().sqrt(),
        brightness: main.pair.brightness(),
        wanted: main.displayed.clone(),
        layers,
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
