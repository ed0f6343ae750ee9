//! In which size to measure, so that it takes about as long as it may, and how much memory that takes.

use super::Request;
use crate::accuracy::change::{Change, Effect};
use crate::accuracy::image_error::mean_squared_error;
use crate::accuracy::settings::{Known, Scope, Settings, samples_of};
use crate::accuracy::studio::Studio;
use crate::base::color::Rgb;
use crate::base::math::DVec3;
use crate::pipeline::render::RenderError;
use crate::sampling::hash;
use crate::sequence::Sequence;
use crate::sequence::quality::{Integrator, PathSettings, Quality};
use std::time::Instant;

/// Share of the time that goes into rendering; the rest into comparing.
const SHARE: f64 = 0.85;
/// Trials of a size, at most.
const TRIALS: u32 = 3;
/// Lights, and objects, that are switched off in turn, at most.
const PARTS_QUICK: usize = 6;
const PARTS_USUAL: usize = 16;
/// Share of the time in which they are chosen.
const LOOK_SHARE: f64 = 0.04;
/// Parts in which references are rendered, so that progress can be told.
pub const PARTS: u32 = 16;
/// Pixels of a picture that is measured, at least and at most.
const LEAST: f64 = 48.0 * 27.0;
const MOST: f64 = 480.0 * 300.0;
/// At least where a first answer is wanted soon, of a file that asks for very many samples.
const LEAST_QUICK: f64 = 16.0 * 12.0;

impl Request {
    /// Pixels at least.
    fn least(&self) -> f64 {
        if self.quick { LEAST_QUICK } else { LEAST }
    }
}

/// What is tried, and in which size, so that it takes about as long as it may.
pub fn planned(
    studio: &mut Studio,
    sequence: &Sequence,
    request: &Request,
) -> Result<(Settings, (u32, u32)), RenderError> {
    let (own, full) = (&sequence.quality, sequence.output.size);
    studio.resize(scaled(full, LEAST_QUICK));
    let (known, each) = look(studio, own)?;
    let scope = Scope { quick: request.quick, most: request.most_samples };
    let mut settings = Settings::new(own, known, scope);
    settings.layers(own, &studio.layerings());
    let time = studio.time();
    let refracts = Change::effects(sequence, time).contains(&Change::Without(Effect::Refraction));
    let area = Change::LargerLights.of(sequence, time) != *sequence;
    settings.remedies(own, refracts, area);
    settings.parts(own, parts(studio, sequence, request)?);
    let affordable = SHARE * request.time.as_secs_f64() / each / studio.frames() as f64 / work(&settings);
    let size = request.size.unwrap_or_else(|| scaled(full, affordable.clamp(request.least(), MOST)));
    Ok((settings, size))
}

/// A first look at small pictures: what is known of the sequence, and the seconds that a sample of a pixel takes.
fn look(studio: &Studio, own: &Quality) -> Result<(Known, f64), RenderError> {
    let other = match own.integrator {
        Integrator::Whitted => Integrator::Path(PathSettings::default()),
        Integrator::Path(_) => Integrator::Whitted,
    };
    let random = studio.is_random(own.integrator);
    let pilot = Quality { samples: own.samples.min(16), noise: None, ..*own };
    let first = studio.shoot(&pilot)?;
    let second = studio.shoot(&Quality { seed: hash([own.seed, 0, 4]), ..pilot })?;
    let samples = samples_of(&pilot, random, 0.0);
    // As all threads would, which pictures of so few pixels do not keep busy.
    let each = second.took.on(studio.threads()) / (studio.pixels() * samples);
    let (a, b) = (first.radiance(), second.radiance());
    // Of layers as they are traced: before their weights, as clamps are.
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
            let films = studio.shoot(own)?.films;
            let taken = films.iter().filter_map(|film| film.noise).map(|noise| noise.samples);
            taken.fold(1.0, f64::max)
        }
    };
    // As independent samples would have it: enough to choose a target of about the same error.
    let error = error * (samples / own_samples).sqrt();
    let error = if random && error.is_finite() { error } else { 0.0 };
    let other_random = studio.is_random(other);
    Ok((Known { random, other_random, samples: own_samples, error, bright: f64::from(bright) }, each))
}

/// Effects, lights and objects to switch off: all effects, and of the others those that change the picture most.
fn parts(
    studio: &Studio,
    sequence: &Sequence,
    request: &Request,
) -> Result<Vec<(Change, String)>, RenderError> {
    let (start, time) = (Instant::now(), studio.time());
    let few = Quality { samples: 1, antialias: 1, noise: None, ..sequence.quality };
    let plain = studio.shoot(&few)?.radiance();
    let most = if request.quick { PARTS_QUICK } else { PARTS_USUAL };
    let mut all = Change::effects(sequence, time);
    for changes in [Change::lights(sequence, time), Change::objects(sequence, time)] {
        let mut ranked = Vec::new();
        for change in changes {
            // Where there are very many, those that come last in the file are left out.
            let late = start.elapsed().as_secs_f64() > LOOK_SHARE * request.time.as_secs_f64();
            if late && ranked.len() >= most {
                break;
            }
            let changed = studio.shoot_changed(&few, change)?.radiance();
            ranked.push((mean_squared_error(&plain, &changed), change));
        }
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        all.extend(ranked.into_iter().take(most).map(|(_, change)| change));
    }
    Ok(all.into_iter().map(|change| (change, change.name(sequence))).collect())
}

/// Settles for this size, or for a smaller one if a trial says that the rest would take longer than there is time for: what
/// a sample costs can be far off in pictures of a few pixels, or while something else is at work.
pub fn fit(
    studio: &mut Studio,
    settings: &Settings,
    mut size: (u32, u32),
    request: &Request,
    start: Instant,
) -> Result<(), RenderError> {
    let own = &settings.all[0].quality;
    for _ in 0..TRIALS {
        studio.resize(size);
        let few = Quality { samples: (settings.reference / PARTS / 2).max(1), noise: None, ..*own };
        let trial = if settings.random { few } else { *own };
        let seconds = studio.shoot(&trial)?.took.wall;
        let each = seconds / samples_of(&trial, settings.random, 0.0);
        let whole = each * work(settings);
        let left = SHARE * request.time.saturating_sub(start.elapsed()).as_secs_f64();
        let pixels = f64::from(size.0) * f64::from(size.1);
        let smaller = scaled(size, (pixels * left / whole).clamp(request.least().min(pixels), pixels));
        if smaller == size || request.size.is_some() {
            break;
        }
        size = smaller;
    }
    Ok(())
}

/// Samples in a pixel over all that is rendered.
pub fn work(settings: &Settings) -> f64 {
    let tries: f64 = settings.all.iter().map(|setting| f64::from(setting.runs) * setting.samples).sum();
    tries + 2.0 * f64::from(settings.reference)
}

/// A size of the same shape with no more than so many pixels.
fn scaled((width, height): (u32, u32), pixels: f64) -> (u32, u32) {
    let share = (pixels / (f64::from(width) * f64::from(height))).sqrt().min(1.0);
    let side = |side: u32| ((f64::from(side) * share).round() as u32).max(1);
    (side(width), side(height))
}

/// Bytes that measuring so many settings takes, for pictures of all frames together: films with the sums of the long ones,
/// references with what they display as and what FLIP sees of them, and of every setting the picture and the sum of all
/// its runs.
pub fn memory_for(layers: u64, settings: u64, pixels: u64) -> u64 {
    let (light, sum) = (size_of::<Rgb>() as u64, size_of::<DVec3>() as u64);
    let shown = size_of::<[f32; 3]>() as u64;
    // Two shots and their sums are there at a time, and two halves of each layer of the main reference.
    let films = layers.saturating_mul(2 * light + sum + 2 * light);
    let references = 2 * light + shown + FLIP_BYTES;
    // Sums of even and odd runs, squared errors, and what is displayed, once of all runs.
    let tried = settings.saturating_mul(2 * sum + 12 + 2 * shown);
    pixels.saturating_mul(films.saturating_add(references).saturating_add(tried))
}

/// What FLIP keeps of a pixel: colours and features, with their halves while they are filtered.
const FLIP_BYTES: u64 = 64;
