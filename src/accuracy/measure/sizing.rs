//! In which size to measure, so that it takes about as long as it may, and how much memory that takes.

use super::Request;
use crate::accuracy::settings::{Settings, samples_of};
use crate::accuracy::studio::Studio;
use crate::color::Rgb;
use crate::math::DVec3;
use crate::quality::Quality;
use crate::render::RenderError;
use std::time::Instant;

/// Share of the time that goes into rendering; the rest into comparing.
const SHARE: f64 = 0.7;
/// Trials of a size, at most.
const TRIALS: u32 = 3;
/// Runs of each setting where samples are random.
pub const RUNS: u32 = 16;
/// Runs where every picture is the same, for the time alone.
pub const STILL_RUNS: u32 = 5;
/// Parts in which references are rendered, so that progress can be told.
pub const PARTS: u32 = 16;
/// Pixels of a picture that is measured, at least and at most.
const LEAST: f64 = 48.0 * 27.0;
const MOST: f64 = 480.0 * 300.0;
/// At least where a first answer is wanted soon, of a file that asks for very many samples.
const LEAST_QUICK: f64 = 16.0 * 12.0;
/// Pixels that a longer ladder of samples is given up for.
const GOOD: f64 = 160.0 * 90.0;

impl Request {
    /// Pixels at least.
    fn least(&self) -> f64 {
        if self.quick { LEAST_QUICK } else { LEAST }
    }
}

/// What is tried, and in which size, so that it takes about as long as it may.
pub fn planned(
    studio: &mut Studio,
    own: &Quality,
    full: (u32, u32),
    request: &Request,
) -> Result<(Settings, (u32, u32)), RenderError> {
    studio.resize(scaled(full, LEAST));
    let random = studio.is_random()?;
    let pilot = Quality { samples: own.samples.min(16), noise: None, ..*own };
    studio.shoot(&pilot)?;
    let seconds = studio.shoot(&pilot)?.took.wall;
    let each = seconds / (studio.pixels() * samples_of(&pilot, random));
    let layerings = studio.layerings();
    let settings = |most| {
        let mut settings = Settings::new(own, random, most);
        settings.layers(own, &layerings);
        settings
    };
    let affordable = |settings: &Settings| {
        // Some of the time goes into comparing.
        let samples = SHARE * request.time.as_secs_f64() / each / studio.frames() as f64;
        samples / work(settings, own)
    };
    let ladders: &[u32] = if request.quick { &[16] } else { &[1024, 256, 64] };
    let chosen = request.most_samples.map(settings).or_else(|| {
        let good =
            |settings: &Settings| affordable(settings) >= GOOD.min(f64::from(full.0) * f64::from(full.1));
        ladders.iter().map(|&most| settings(most)).find(good)
    });
    let chosen = chosen.unwrap_or_else(|| settings(ladders[ladders.len() - 1]));
    let size = request.size.unwrap_or_else(|| scaled(full, affordable(&chosen).clamp(request.least(), MOST)));
    Ok((chosen, size))
}

/// Settles for this size, or for a smaller one if a trial says that the rest would take longer than there is time for: what
/// a sample costs can be far off in pictures of a few pixels, or while something else is at work. Gives the seconds that a
/// sample of every pixel takes.
pub fn fit(
    studio: &mut Studio,
    settings: &Settings,
    own: &Quality,
    mut size: (u32, u32),
    request: &Request,
    start: Instant,
) -> Result<f64, RenderError> {
    let mut each = f64::INFINITY;
    for _ in 0..TRIALS {
        studio.resize(size);
        let few = Quality { samples: settings.reference / PARTS / 2, noise: None, ..*own };
        let trial = if settings.random { few } else { *own };
        let seconds = studio.shoot(&trial)?.took.wall;
        each = seconds / samples_of(&trial, settings.random);
        let whole = each * work(settings, own);
        let left = SHARE * request.time.saturating_sub(start.elapsed()).as_secs_f64();
        let pixels = f64::from(size.0) * f64::from(size.1);
        let smaller = scaled(size, (pixels * left / whole).clamp(request.least().min(pixels), pixels));
        if smaller == size || request.size.is_some() {
            break;
        }
        size = smaller;
    }
    Ok(each)
}

/// Samples in a pixel over all that is rendered.
pub fn work(settings: &Settings, own: &Quality) -> f64 {
    let runs = f64::from(if settings.random { RUNS } else { STILL_RUNS });
    let tries: f64 =
        settings.all.iter().map(|setting| runs * samples_of(&setting.quality, settings.random)).sum();
    let references = settings.references(own).map(|quality| match settings.random {
        true => 2.0 * f64::from(quality.samples),
        false => 2.0 * f64::from(settings.reference),
    });
    tries + references.iter().sum::<f64>()
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
    let references = 2 * (2 * light + shown + FLIP_BYTES);
    // What all runs add up to is displayed, too.
    let tried = settings.saturating_mul(sum + 2 * shown);
    pixels.saturating_mul(films.saturating_add(references).saturating_add(tried))
}

/// What FLIP keeps of a pixel: colours and features, with their halves while they are filtered.
const FLIP_BYTES: u64 = 64;
