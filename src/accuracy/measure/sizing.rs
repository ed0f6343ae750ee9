//! Chooses the size of the pictures so that a measurement takes about the requested time, and predicts its memory.

use super::request::MeasurementRequest;
use super::temporal::temporal_samples;
use crate::accuracy::change::{RemovableEffect, SceneChange};
use crate::accuracy::image_error::mean_squared_error;
use crate::accuracy::renderer::Renderer;
use crate::accuracy::settings::{Experiment, SceneFacts, Scope, samples_of};
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::pipeline::render::RenderError;
use crate::sampling::hash;
use crate::sequence::Sequence;
use crate::sequence::quality::{Integrator, PathSettings, Quality};
use std::time::Instant;

/// Fraction of the time for rendering; comparing takes the rest.
const SHARE: f64 = 0.85;
/// The largest number of trial renders that adjust the size.
const TRIALS: u32 = 3;
/// The largest number of lights, and of objects, that are switched off one at a time.
const MAX_PARTS_QUICK: usize = 6;
const MAX_PARTS: usize = 16;
/// Fraction of the time for ranking these lights and objects.
const RANKING_SHARE: f64 = 0.04;
/// Number of parts in which references are rendered, so that progress can be reported.
pub const REFERENCE_PARTS: u32 = 16;
/// The smallest and the largest number of pixels of a measured picture.
const MIN_PIXELS: f64 = 48.0 * 27.0;
const MAX_PIXELS: f64 = 480.0 * 300.0;
/// The smallest number of pixels with `--quick`, for files with very many samples.
const MIN_PIXELS_QUICK: f64 = 16.0 * 12.0;

impl MeasurementRequest {
    /// The smallest number of pixels for this request.
    fn min_pixels(&self) -> f64 {
        if self.quick { MIN_PIXELS_QUICK } else { MIN_PIXELS }
    }
}

/// The settings to measure, and the size at which measuring them takes about the requested time.
pub fn plan(
    renderer: &mut Renderer,
    sequence: &Sequence,
    request: &MeasurementRequest,
) -> Result<(Experiment, (u32, u32)), RenderError> {
    let (own, full) = (&sequence.quality, sequence.output.size);
    renderer.resize(scaled(full, MIN_PIXELS_QUICK));
    let (facts, each) = pilot(renderer, own)?;
    let scope = Scope { quick: request.quick, most: request.most_samples };
    let mut settings = Experiment::new(own, facts, scope);
    settings.layers(own, &renderer.layerings());
    let time = renderer.time();
    let refracts =
        SceneChange::effects(sequence, time).contains(&SceneChange::Without(RemovableEffect::Refraction));
    let area = SceneChange::LargerLights.of(sequence, time) != *sequence;
    settings.remedies(own, refracts, area);
    settings.parts(own, parts(renderer, sequence, request)?);
    let affordable =
        SHARE * request.time.as_secs_f64() / each / renderer.frames() as f64 / total_samples(&settings);
    let size =
        request.size.unwrap_or_else(|| scaled(full, affordable.clamp(request.min_pixels(), MAX_PIXELS)));
    Ok((settings, size))
}

/// Renders small pictures: returns facts about the sequence, and the seconds per sample of a pixel.
fn pilot(renderer: &Renderer, own: &Quality) -> Result<(SceneFacts, f64), RenderError> {
    let other = match own.integrator {
        Integrator::Whitted => Integrator::Path(PathSettings::default()),
        Integrator::Path(_) => Integrator::Whitted,
    };
    let random = renderer.is_random(own.integrator);
    let few = Quality { samples: own.samples.min(16), noise: None, ..*own };
    let first = renderer.render(&few)?;
    let second = renderer.render(&Quality { seed: hash([own.seed, 0, 4]), ..few })?;
    let samples = samples_of(&few, random, 0.0);
    // The time if all threads were busy; pictures this small do not keep them busy.
    let each = second.took.on_threads(renderer.threads()) / (renderer.pixels() * samples);
    let (a, b) = (first.radiance(), second.radiance());
    // Film layers before their weights, because clamps apply there.
    let traced = first.films.iter().flat_map(|film| film.data.iter());
    let mut values: Vec<f32> = traced.map(|light| light.max_element()).collect();
    values.sort_by(f32::total_cmp);
    let bright = values.get(values.len() * 9 / 10).copied().unwrap_or(1.0);
    let mean =
        a.iter().map(|light| f64::from(light.element_sum()) / 3.0).sum::<f64>() / a.len().max(1) as f64;
    let error = (mean_squared_error(&a, &b) / 2.0).sqrt() / mean;
    let own_samples = match own.noise.filter(|_| random) {
        None => samples_of(own, random, 0.0),
        Some(_) => {
            let films = renderer.render(own)?.films;
            let taken = films.iter().filter_map(|film| film.noise).map(|noise| noise.samples);
            taken.fold(1.0, f64::max)
        }
    };
    // The convergence of independent samples is accurate enough to choose noise targets near this error.
    let error = error * (samples / own_samples).sqrt();
    let error = if random && error.is_finite() { error } else { 0.0 };
    let other_random = renderer.is_random(other);
    Ok((SceneFacts { random, other_random, samples: own_samples, error, bright: f64::from(bright) }, each))
}

/// The parts to switch off: all effects, and the lights and objects that change the picture most.
fn parts(
    renderer: &Renderer,
    sequence: &Sequence,
    request: &MeasurementRequest,
) -> Result<Vec<(SceneChange, String)>, RenderError> {
    let (start, time) = (Instant::now(), renderer.time());
    let few = Quality { samples: 1, antialias: 1, noise: None, ..sequence.quality };
    let plain = renderer.render(&few)?.radiance();
    let most = if request.quick { MAX_PARTS_QUICK } else { MAX_PARTS };
    let mut all = SceneChange::effects(sequence, time);
    for changes in [SceneChange::lights(sequence, time), SceneChange::objects(sequence, time)] {
        let mut ranked = Vec::new();
        for change in changes {
            // If there are very many, the last ones of the file are left out.
            let late = start.elapsed().as_secs_f64() > RANKING_SHARE * request.time.as_secs_f64();
            if late && ranked.len() >= most {
                break;
            }
            let changed = renderer.render_changed(&few, change)?.radiance();
            ranked.push((mean_squared_error(&plain, &changed), change));
        }
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        all.extend(ranked.into_iter().take(most).map(|(_, change)| change));
    }
    Ok(all.into_iter().map(|change| (change, change.name(sequence))).collect())
}

/// Sets the size of the renderer to `size`, or to a smaller one if a trial render predicts that the measurement would
/// take too long. The cost of a sample from pictures of few pixels can be far off, as can a cost measured under other
/// load.
pub fn fit_size(
    renderer: &mut Renderer,
    settings: &Experiment,
    mut size: (u32, u32),
    request: &MeasurementRequest,
    start: Instant,
) -> Result<(), RenderError> {
    let own = &settings.all[0].quality;
    for _ in 0..TRIALS {
        renderer.resize(size);
        let few = Quality { samples: (settings.reference / REFERENCE_PARTS / 2).max(1), noise: None, ..*own };
        let trial = if settings.random { few } else { *own };
        let seconds = renderer.render(&trial)?.took.wall;
        let each = seconds / samples_of(&trial, settings.random, 0.0);
        let whole = each * total_samples(settings);
        let left = SHARE * request.time.saturating_sub(start.elapsed()).as_secs_f64();
        let pixels = f64::from(size.0) * f64::from(size.1);
        let smaller = scaled(size, (pixels * left / whole).clamp(request.min_pixels().min(pixels), pixels));
        if smaller == size || request.size.is_some() {
            break;
        }
        size = smaller;
    }
    Ok(())
}

/// Samples per pixel over all renders of a measurement.
pub fn total_samples(settings: &Experiment) -> f64 {
    let results: f64 = settings.all.iter().map(|setting| f64::from(setting.runs) * setting.samples).sum();
    results + 2.0 * f64::from(settings.reference) + temporal_samples(settings)
}

/// The largest size of the same aspect ratio with at most `pixels` pixels.
fn scaled((width, height): (u32, u32), pixels: f64) -> (u32, u32) {
    let share = (pixels / (f64::from(width) * f64::from(height))).sqrt().min(1.0);
    let side = |side: u32| ((f64::from(side) * share).round() as u32).max(1);
    (side(width), side(height))
}

/// The memory of a measurement in bytes; `pixels` counts those of all frames. It holds films with the sums of the
/// references, the references with their displayed pictures and FLIP's data, and for each setting a picture and the
/// sums of its runs.
pub fn memory_for(layers: u64, settings: u64, pixels: u64) -> u64 {
    let (light, sum) = (size_of::<Rgb>() as u64, size_of::<DVec3>() as u64);
    let shown = size_of::<[f32; 3]>() as u64;
    // Two renderings and their sums at a time, and both references of each film layer.
    let films = layers.saturating_mul(2 * light + sum + 2 * light);
    let references = 2 * light + shown + FLIP_BYTES;
    // Sums of even and odd runs, squared errors, and displayed pictures.
    let tried = settings.saturating_mul(2 * sum + 12 + 2 * shown);
    pixels.saturating_mul(films.saturating_add(references).saturating_add(tried))
}

/// Bytes per pixel that FLIP holds: colours and features, and intermediate results of filters.
const FLIP_BYTES: u64 = 64;
