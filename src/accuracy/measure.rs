//! Renders every setting several times and compares the pictures with two references.

mod benchmark;
mod cost;
mod measured;
mod point;
mod reference;
mod request;
mod results;
mod sizing;
mod temporal;

pub use cost::SequenceCost;
pub use measured::Measured;
pub use point::{Layer, Point};
pub use request::MeasurementRequest;
pub use temporal::TemporalError;

use super::chains::chains;
use super::precision::precision;
use super::renderer::Renderer;
use super::robustness::Robustness;
use super::settings::SettingAxis;
use super::statistics::{ConfidenceInterval, slope};
use crate::pipeline::render::{MemoryUse, RenderError};
use crate::sequence::Sequence;
use crate::sequence::quality::Integrator;
use benchmark::Benchmark;
use sizing::{fit_size, memory_for, plan};
use std::time::Instant;

/// The largest numbers of pixels whose rays are compared with double-double arithmetic.
const QUICK_PIXELS: u32 = 8_000;
const USUAL_PIXELS: u32 = 40_000;

/// Measures the accuracy and the cost of settings. Calls `progress` after each step with the fraction of the work that
/// is done.
pub fn measure(
    sequence: &Sequence,
    request: &MeasurementRequest,
    progress: &mut dyn FnMut(f64),
) -> Result<Measured, RenderError> {
    let start = Instant::now();
    let mut renderer = Renderer::new(sequence, &request.frames, request.threads)?;
    let (settings, size) = plan(&mut renderer, sequence, request)?;
    // Checked before anything is rendered at that size.
    let pixels = u64::from(size.0) * u64::from(size.1) * renderer.frames() as u64;
    MemoryUse::Measurement.check(memory_for(sequence.layers(), settings.all.len() as u64, pixels))?;
    fit_size(&mut renderer, &settings, size, request, start)?;
    let mut benchmark = Benchmark::new(&renderer, settings, &sequence.quality, progress);
    let reference = benchmark.reference()?;
    benchmark.run(&reference, start + request.time)?;
    let layers = benchmark.layers(&reference, sequence)?;
    let temporal = match request.frames.first() {
        Some(&first) => benchmark.temporal(sequence, first, start + request.time)?,
        None => None,
    };
    let Benchmark { mut settings, results, .. } = benchmark;
    let chains = match (settings.random, sequence.quality.integrator) {
        (true, Integrator::Path(_)) => chains(&renderer, sequence, &sequence.quality, results[0].errors()),
        _ => Vec::new(),
    };
    let pixels = if request.quick { QUICK_PIXELS } else { USUAL_PIXELS };
    let size = sequence.output.size;
    let robustness = renderer.scene(|scene| renderer.install(|| Robustness::of(scene, size, pixels)));
    let points: Vec<Point> = results
        .iter()
        .enumerate()
        .map(|(index, tried)| {
            let setting = settings.all[index].clone();
            let baseline = setting.axis.has_baseline().then(|| &results[settings.baseline(index)]);
            tried.point(setting, baseline, &reference, &renderer)
        })
        .collect();
    let points = settings.without_unfinished(points, |point| point.capped);
    Ok(Measured {
        name: sequence.name.clone(),
        frames: request.frames.clone(),
        full_size: sequence.output.size,
        size: renderer.size(),
        threads: renderer.threads(),
        random: settings.random,
        total: SequenceCost::of(sequence, &renderer, &points[0])?,
        slopes: slopes(&points),
        points,
        left_out: settings.left_out,
        reference: settings.reference * if settings.random { 2 } else { 1 },
        reference_error: reference.pair.noise().sqrt(),
        brightness: reference.pair.brightness(),
        wanted: reference.displayed.clone(),
        layers,
        chains,
        temporal,
        robustness,
        precision: precision(),
        took: start.elapsed(),
    })
}

/// The slopes of error over samples. They are fitted separately to each run, because runs are independent.
fn slopes(points: &[Point]) -> Vec<(SettingAxis, ConfidenceInterval)> {
    let of = |axis: SettingAxis| {
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
        (slopes.len() > 1).then(|| (axis, ConfidenceInterval::of(&slopes)))
    };
    [SettingAxis::Samples, SettingAxis::Independent].into_iter().filter_map(of).collect()
}
