//! Renders every setting several times, in turn, and compares the pictures with two references.

use super::clock::Took;
use super::layering::Layering;
use super::precision::{Precision, precision};
use super::settings::{Axis, LeftOut, Setting, Settings, samples_of};
use super::statistics::{Estimate, Spread, slope};
use super::studio::{Shot, Studio};
use crate::color::Rgb;
use crate::math::DVec3;
use crate::metrics::{Flip, PIXELS_PER_DEGREE, References, psnr};
use crate::quality::Quality;
use crate::render::{Large, RenderError};
use crate::sampling::hash;
use crate::sequence::Sequence;
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

impl Request {
    /// Pixels at least.
    fn least(&self) -> f64 {
        if self.quick { LEAST_QUICK } else { LEAST }
    }
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

/// Share of the time that goes into rendering; the rest into comparing.
const SHARE: f64 = 0.7;
/// Share of the time for a setting that is sampled until it is good.
const NOISE_SHARE: f64 = 0.1;
/// Trials of a size, at most.
const TRIALS: u32 = 3;
/// Runs of each setting where samples are random.
const RUNS: u32 = 16;
/// Runs where every picture is the same, for the time alone.
const STILL_RUNS: u32 = 5;
/// Runs whose pictures are compared by FLIP, which takes longer than some of them.
const FLIP_RUNS: u32 = 4;
/// Parts in which references are rendered, so that progress can be told.
const PARTS: u32 = 16;
/// Pixels of a picture that is measured, at least and at most.
const LEAST: f64 = 48.0 * 27.0;
const MOST: f64 = 480.0 * 300.0;
/// At least where a first answer is wanted soon, of a file that asks for very many samples.
const LEAST_QUICK: f64 = 16.0 * 12.0;
/// Pixels that a longer ladder of samples is given up for.
const GOOD: f64 = 160.0 * 90.0;

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

/// Bytes that measuring so many settings takes, for pictures of all frames together: films with the sums of the long ones,
/// references with what they display as and what FLIP sees of them, and of every setting the picture and the sum of all
/// its runs.
fn memory_for(layers: u64, settings: u64, pixels: u64) -> u64 {
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

/// What is tried, and in which size, so that it takes about as long as it may.
fn planned(
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
fn fit(
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
fn work(settings: &Settings, own: &Quality) -> f64 {
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

/// References with what comparing needs of them.
struct Reference {
    pair: References,
    displayed: Vec<[f32; 3]>,
    /// One for each frame.
    flips: Vec<Flip>,
    /// Of each layer, if there are several.
    layers: Vec<References>,
}

/// The work in hand.
struct Bench<'a> {
    studio: &'a Studio,
    settings: Settings,
    own: Quality,
    runs: u32,
    tries: Vec<Tried>,
    progress: &'a mut dyn FnMut(f64),
    done: f64,
    whole: f64,
}

/// What came of a setting so far.
#[derive(Default)]
struct Tried {
    took: Vec<Took>,
    rays: u64,
    samples: f64,
    squared: Vec<f64>,
    relative: Vec<f64>,
    psnr: Vec<f64>,
    flip: Vec<f64>,
    sum: Vec<DVec3>,
    picture: Vec<[f32; 3]>,
    exposures: Vec<f32>,
    flips: Vec<f32>,
    /// Share of the pixels that had all the samples that they may.
    capped: f64,
}

impl<'a> Bench<'a> {
    fn new(studio: &'a Studio, settings: Settings, own: &Quality, progress: &'a mut dyn FnMut(f64)) -> Self {
        let tries = settings.all.iter().map(|_| Tried::default()).collect();
        let runs = if settings.random { RUNS } else { STILL_RUNS };
        let whole = work(&settings, own);
        Self { studio, settings, own: *own, runs, tries, progress, done: 0.0, whole }
    }

    fn shoot(&mut self, quality: &Quality) -> Result<Shot, RenderError> {
        self.shoot_in(quality, Layering::Own)
    }

    fn shoot_in(&mut self, quality: &Quality, layering: Layering) -> Result<Shot, RenderError> {
        let shot = self.studio.shoot_in(quality, layering)?;
        self.done += samples_of(quality, self.settings.random);
        (self.progress)((self.done / self.whole).min(1.0));
        Ok(shot)
    }

    /// Those for most axes, and those for bounces.
    fn references(&mut self) -> Result<[Reference; 2], RenderError> {
        let [main, deep] = self.settings.references(&self.own);
        Ok([self.reference(&main, false)?, self.reference(&deep, true)?])
    }

    fn reference(&mut self, quality: &Quality, deep: bool) -> Result<Reference, RenderError> {
        let mut shots = Vec::new();
        for which in 0..2 {
            shots.push(match self.settings.random {
                true => self.long(quality, which)?,
                // Two fine grids whose samples fall on different places.
                false => {
                    let finest = libm::sqrt(f64::from(self.settings.reference)).ceil() as u32 + which;
                    let antialias = if deep { quality.antialias } else { finest };
                    self.shoot(&Quality { antialias, ..*quality })?
                }
            });
        }
        let pair = References { a: shots[0].radiance(), b: shots[1].radiance() };
        let displayed = self.studio.displayed(&shots[0].exposures(), &pair.best());
        let (width, each) = (self.studio.size().0 as usize, displayed.len() / self.studio.frames());
        let flips =
            displayed.chunks(each.max(1)).map(|frame| Flip::new(frame, width, PIXELS_PER_DEGREE)).collect();
        let count = shots[0].films.first().map_or(0, |film| film.weights.len());
        let layers = if count > 1 && !deep { 0..count } else { 0..0 };
        let layers =
            layers.map(|layer| References { a: shots[0].radiance_of(layer), b: shots[1].radiance_of(layer) });
        let layers = layers.collect();
        Ok(Reference { pair, displayed, flips, layers })
    }

    /// Many samples, as the mean of several sets of them.
    fn long(&mut self, quality: &Quality, which: u32) -> Result<Shot, RenderError> {
        let mut sums: Vec<Vec<DVec3>> = Vec::new();
        let mut last = None;
        for part in 0..PARTS {
            let seed = hash([self.own.seed, part, 2 + which]);
            let samples = quality.samples.div_ceil(PARTS);
            let shot = self.shoot(&Quality { samples, seed, ..*quality })?;
            sums.resize(shot.films.len(), Vec::new());
            for (sum, film) in sums.iter_mut().zip(&shot.films) {
                sum.resize(film.data.len(), DVec3::ZERO);
                sum.iter_mut().zip(film.data.iter()).for_each(|(sum, value)| *sum += value.as_dvec3());
            }
            last = Some(shot);
        }
        let mut shot = match last {
            Some(shot) => shot,
            None => self.shoot(quality)?,
        };
        for (film, sum) in shot.films.iter_mut().zip(sums) {
            let mean = |sum: DVec3| (sum / f64::from(PARTS)).as_vec3();
            film.data_mut().iter_mut().zip(sum).for_each(|(value, sum)| *value = mean(sum));
        }
        Ok(shot)
    }

    /// All settings in turn, again and again, so that whatever else the machine does falls on all of them.
    fn run(&mut self, references: &[Reference; 2]) -> Result<(), RenderError> {
        for run in 0..self.runs {
            let seed = hash([self.own.seed, run, 1]);
            for index in 0..self.settings.all.len() {
                let Setting { axis, quality, layering, .. } = self.settings.all[index];
                if self.settings.is_unfinished(index, self.tries[index].capped > 0.0) {
                    continue;
                }
                let shot = self.shoot_in(&Quality { seed, ..quality }, layering)?;
                let reference = &references[usize::from(axis == Axis::Bounces)];
                let random = self.settings.random;
                self.tries[index].add(&shot, &quality, random, reference, self.studio, run);
            }
        }
        Ok(())
    }

    /// What the file's own setting makes of each layer.
    fn layers(
        &mut self,
        references: &[Reference; 2],
        sequence: &Sequence,
    ) -> Result<Vec<Layer>, RenderError> {
        let of = &references[0].layers;
        if of.is_empty() {
            return Ok(Vec::new());
        }
        let shot = self.studio.shoot(&Quality { seed: hash([self.own.seed, 0, 1]), ..self.own })?;
        let whole = references[0].pair.brightness();
        let names = sequence.about().layers;
        let layer = |(index, (pair, name)): (usize, (&References, String))| {
            let brightness = pair.brightness();
            let error = pair.squared_error(&shot.radiance_of(index)).max(0.0).sqrt();
            (brightness > 0.0).then(|| Layer { name, share: brightness / whole, error: error / brightness })
        };
        Ok(of.iter().zip(names).enumerate().filter_map(layer).collect())
    }
}

impl Tried {
    fn add(
        &mut self,
        shot: &Shot,
        quality: &Quality,
        random: bool,
        reference: &Reference,
        studio: &Studio,
        run: u32,
    ) {
        let radiance = shot.radiance();
        self.took.push(shot.took);
        self.rays += shot.rays;
        self.exposures = shot.exposures();
        let taken = shot.films.iter().map(|film| film.noise.map(|noise| noise.samples));
        let taken: f64 = taken.map(|taken| taken.unwrap_or_else(|| samples_of(quality, random))).sum();
        self.samples += taken / studio.frames() as f64;
        self.capped = shot
            .films
            .iter()
            .filter_map(|film| film.noise)
            .map(|noise| noise.capped)
            .fold(self.capped, f64::max);
        self.sum.resize(radiance.len(), DVec3::ZERO);
        self.sum.iter_mut().zip(&radiance).for_each(|(sum, value)| *sum += value.as_dvec3());
        if !random && run > 0 {
            return;
        }
        self.squared.push(reference.pair.squared_error(&radiance));
        self.relative.push(reference.pair.relative_squared_error(&radiance));
        let picture = studio.displayed(&shot.exposures(), &radiance);
        let squares = picture
            .iter()
            .zip(&reference.displayed)
            .flat_map(|(a, b)| (0..3).map(move |i| f64::from(a[i] - b[i]) * f64::from(a[i] - b[i])));
        self.psnr.push(psnr(squares.sum::<f64>() / (3 * picture.len()) as f64));
        if run < FLIP_RUNS {
            let each = (picture.len() / reference.flips.len().max(1)).max(1);
            let frames = picture.chunks(each).zip(&reference.flips);
            let map: Vec<f32> = frames.flat_map(|(frame, flip)| flip.map(frame)).collect();
            self.flip.push(map.iter().map(|&value| f64::from(value)).sum::<f64>() / map.len() as f64);
            if run == 0 {
                (self.picture, self.flips) = (picture, map);
            }
        }
    }

    fn point(self, setting: Setting, references: &[Reference; 2], studio: &Studio) -> Point {
        let (count, frames) = (self.took.len() as f64, studio.frames() as f64);
        let reference = &references[usize::from(setting.axis == Axis::Bounces)];
        let wall: Vec<f64> = self.took.iter().map(|took| took.wall / frames).collect();
        let cpu: Option<Vec<f64>> = self.took.iter().map(|took| Some(took.cpu? / frames)).collect();
        let mean: Vec<Rgb> = self.sum.iter().map(|sum| (*sum / count).as_vec3()).collect();
        let squared = Estimate::of(&self.squared);
        // Of the products of all runs with each other, those with themselves hold their noise.
        let bias = match self.squared.len() as f64 {
            n if n > 1.0 => (n * reference.pair.squared_error(&mean) - squared.mean) / (n - 1.0),
            _ => squared.mean,
        };
        Point {
            wall: Spread::of(&wall),
            cpu: cpu.map(|cpu| Spread::of(&cpu)),
            rays: self.rays as f64 / count / frames,
            samples: self.samples / count,
            squared,
            relative: Estimate::of(&self.relative),
            psnr: Estimate::of(&self.psnr),
            flip: Estimate::of(&self.flip),
            bias,
            picture: self.picture,
            settled: studio.displayed(&self.exposures, &mean),
            runs: self.squared,
            flips: self.flips,
            setting,
        }
    }
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
