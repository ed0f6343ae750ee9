//! What a target error costs beside uniform samples:
//!
//! ```text
//! cargo bench --bench targets -- FILE... [--frame N] [--size WxH] [--noise ERROR] [--seeds N] [--reference SAMPLES]
//! cargo bench --bench targets -- sequences/light-show.ron --frame 10 --noise 0.05
//! ```
//!
//! A frame is traced to the target with many seeds, and in turn with numbers of samples in every pixel, on one thread:
//! powers of two, and one and a half times each. True errors are against two long renders with seeds of their own; see
//! [`ReferencePair`]. It prints:
//!
//! - the median error of the target's pictures, relative to the mean of the frame, and their samples a pixel;
//! - the median of the stated error over the true one, and the shares of the seeds whose true error lies in the stated
//!   interval, and above it;
//! - the CPU time and the rays of the target, as shares of what the uniform samples of the same median error take.
//!   Times and errors of uniform samples are interpolated between their numbers on logarithmic axes,
//!   without numbers whose errors are larger than those of fewer samples;
//! - the error of the worst block of 8 x 8 pixels, as a share of that of uniform samples of the same time;
//! - the share of the squared error that the worst hundredth of the pixels holds, beside that of uniform samples of the
//!   same time.
//!
//! Each value but the shares of the seeds is a median over them. Costs and errors below 1 are less than those of uniform
//! samples.

use kinora::accuracy::image_error::ReferencePair;
use kinora::base::clock::timed;
use kinora::base::color::Rgb;
use kinora::film::Noise;
use kinora::pipeline::schedule::{FilmCollector, FrameLoop};
use kinora::sequence::quality::{Denoise, NoiseTarget, SampleReuse};
use kinora::sequence::{Sequence, load};
use libm::{log2, pow};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::error::Error;
use std::io::{Write as _, stdout};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// The side of a block, in pixels.
const BLOCK: usize = 8;

/// The exponents of the middle one of the numbers of uniform samples, which is a power of two.
const MIDDLES: Range<u32> = 3..13;

/// The numbers of uniform samples.
const COUNTS: usize = 5;

struct Settings {
    files: Vec<String>,
    frame: u32,
    size: Option<(u32, u32)>,
    noise: f64,
    seeds: u32,
    reference: u32,
}

/// A picture of one seed.
#[derive(Clone, Copy)]
struct Picture {
    /// CPU time in seconds.
    time: f64,
    rays: f64,
    /// The root of the mean squared error, relative to the mean of the frame.
    error: f64,
    /// The largest error of a block.
    block: f64,
    /// The share of the squared error in the worst hundredth of the pixels.
    worst: f64,
    samples: f64,
    /// The stated error over the true one, and the ends of its interval; 0 without a target.
    stated: f64,
    low: f64,
    high: f64,
}

/// A frame of a sequence, and what its pictures are compared with.
struct Frame<'a> {
    sequence: &'a Sequence,
    number: u32,
    pool: &'a ThreadPool,
    references: ReferencePair,
    /// The mean of the frame.
    mean: f64,
}

fn main() -> Outcome<()> {
    let settings = settings()?;
    if settings.files.is_empty() {
        // `cargo bench` alone runs every bench; this one needs a sequence.
        return Ok(writeln!(stdout(), "targets: give a sequence, such as sequences/light-show.ron")?);
    }
    writeln!(
        stdout(),
        "{:28} {:>6} {:>8} {:>8}   {:>6} {:>6} {:>6}   {:>6} {:>6} {:>8}   worst hundredth: target, uniform",
        "frame",
        "target",
        "error",
        "samples",
        "stated",
        "inside",
        "above",
        "time",
        "rays",
        "block"
    )?;
    settings.files.iter().try_for_each(|file| compare(file, &settings))
}

fn settings() -> Outcome<Settings> {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let mut settings =
        Settings { files: Vec::new(), frame: 0, size: None, noise: 0.05, seeds: 20, reference: 8192 };
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--frame" => settings.frame = value()?.parse()?,
            "--size" => {
                let size = value()?;
                let (width, height) = size.split_once('x').ok_or("a size is WIDTHxHEIGHT")?;
                settings.size = Some((width.parse()?, height.parse()?));
            }
            "--noise" => settings.noise = value()?.parse()?,
            "--seeds" => settings.seeds = value()?.parse()?,
            "--reference" => settings.reference = value()?.parse()?,
            _ => settings.files.push(argument),
        }
    }
    match settings.seeds {
        0 => Err("at least one seed".into()),
        _ => Ok(settings),
    }
}

/// Prints the line of a file.
fn compare(file: &str, settings: &Settings) -> Outcome<()> {
    let mut sequence = load(Path::new(file)).map_err(|faults| faults.to_string())?;
    sequence.output.size = settings.size.unwrap_or(sequence.output.size);
    (sequence.quality.denoise, sequence.quality.reuse) = (Denoise::Off, SampleReuse::Off);
    let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
    let frame = Frame::new(&sequence, settings, &pool)?;
    let mut targets = vec![frame.target(settings.noise, 1)?];
    let counts = frame.counts_around(&targets[0])?;
    let mut all = vec![Vec::new(); COUNTS];
    for seed in 1..=settings.seeds {
        if seed > 1 {
            targets.push(frame.target(settings.noise, seed)?);
        }
        for (pictures, count) in all.iter_mut().zip(&counts) {
            pictures.push(frame.uniform(*count, seed)?);
        }
    }
    let target = Picture::median(&targets);
    let uniform: Vec<Picture> = all.iter().map(|pictures| Picture::median(pictures)).collect();
    // Nobody would take a number of samples whose error is larger than that of fewer.
    let mut useful: Vec<Picture> = Vec::new();
    for picture in &uniform {
        if useful.last().is_none_or(|last| picture.error < last.error) {
            useful.push(*picture);
        }
    }
    if useful.len() < 2 {
        return Err("more uniform samples have larger errors: take more seeds".into());
    }
    let at_error = |of: fn(&Picture) -> f64| interpolated(&useful, |at| at.error, of, target.error);
    let at_time = |of: fn(&Picture) -> f64| interpolated(&uniform, |at| at.time, of, target.time);
    let name = Path::new(file).file_stem().unwrap_or_default().to_string_lossy();
    writeln!(
        stdout(),
        "{:28} {:>5.1}% {:>7.2}% {:>8.1}   {:>6.2} {:>5.0}% {:>5.0}%   {:>6.2} {:>6.2} {:>8.2}   {:>16.0}% {:>8.0}%",
        format!("{name}, {}", settings.frame),
        100.0 * settings.noise,
        100.0 * target.error,
        target.samples,
        target.stated,
        100.0 * share(&targets, |at| (at.low..=at.high).contains(&at.error)),
        100.0 * share(&targets, |at| at.error > at.high),
        target.time / at_error(|at| at.time),
        target.rays / at_error(|at| at.rays),
        target.block / at_time(|at| at.block),
        100.0 * target.worst,
        100.0 * at_time(|at| at.worst),
    )?;
    Ok(())
}

impl<'a> Frame<'a> {
    fn new(sequence: &'a Sequence, settings: &Settings, pool: &'a ThreadPool) -> Outcome<Self> {
        let long = |seed| traced(sequence, settings.frame, pool, None, settings.reference, seed);
        let references = ReferencePair { a: long(1_000_001)?.radiance, b: long(1_000_002)?.radiance };
        let best = references.best();
        let sum: f64 = best.iter().map(|light| light.as_dvec3().element_sum()).sum();
        let mean = sum / (3 * best.len()) as f64;
        Ok(Self { sequence, number: settings.frame, pool, references, mean })
    }

    fn target(&self, noise: f64, seed: u32) -> Outcome<Picture> {
        let noise = NoiseTarget { error: noise, most: NoiseTarget::MOST };
        self.picture(Some(noise), self.sequence.quality.samples, seed)
    }

    fn uniform(&self, samples: u32, seed: u32) -> Outcome<Picture> {
        self.picture(None, samples, seed)
    }

    fn picture(&self, noise: Option<NoiseTarget>, samples: u32, seed: u32) -> Outcome<Picture> {
        let Trace { radiance, noise, time, rays } =
            traced(self.sequence, self.number, self.pool, noise, samples, seed)?;
        let width = self.sequence.output.size.0 as usize;
        let mut squares = self.references.squared_errors(&radiance);
        let error = (squares.iter().sum::<f64>() / squares.len() as f64).max(0.0).sqrt() / self.mean;
        let block = worst_block(&squares, width).max(0.0).sqrt() / self.mean;
        squares.sort_by(|a, b| b.total_cmp(a));
        let worst = squares[..squares.len().div_ceil(100)].iter().sum::<f64>() / squares.iter().sum::<f64>();
        let Noise { error: stated, low, high, samples, .. } = noise;
        Ok(Picture { time, rays, error, block, worst, samples, stated: stated / error, low, high })
    }

    /// Ascending numbers of samples, around that with the error of a picture. Those between powers of two are traced, not
    /// interpolated, as stratified points are best at powers of two.
    fn counts_around(&self, picture: &Picture) -> Outcome<[u32; COUNTS]> {
        for middle in MIDDLES {
            let count = 1 << middle;
            if self.uniform(count, 1)?.error <= picture.error {
                return Ok([count / 2, count / 4 * 3, count, count / 2 * 3, 2 * count]);
            }
        }
        Err("uniform samples do not reach the target".into())
    }
}

/// A frame, and what it took.
struct Trace {
    radiance: Vec<Rgb>,
    /// With no error if there was no target.
    noise: Noise,
    time: f64,
    rays: f64,
}

/// Traces a frame to a target, or with a number of samples in every pixel.
fn traced(
    sequence: &Sequence,
    frame: u32,
    pool: &ThreadPool,
    noise: Option<NoiseTarget>,
    samples: u32,
    seed: u32,
) -> Outcome<Trace> {
    let mut sequence = sequence.clone();
    let quality = &mut sequence.quality;
    (quality.noise, quality.samples, quality.seed) = (noise, samples, seed);
    let mut frames = FrameLoop::new(&sequence, FilmCollector::default(), Arc::default());
    let (done, took) = timed(|| pool.install(|| frames.frame(frame)));
    done.map_err(|error| format!("{error:?}"))?;
    let rays = frames.stats().counts.rays.total();
    let film = frames.into_sink().and_then(|mut films| films.0.pop()).ok_or("no film")?;
    let noise = film.noise.unwrap_or(Noise { samples: samples.into(), ..Noise::default() });
    let time = took.cpu.unwrap_or(took.wall);
    Ok(Trace { radiance: film.radiance().collect(), noise, time, rays: rays as f64 })
}

/// The largest mean of a block.
fn worst_block(squares: &[f64], width: usize) -> f64 {
    let bands = squares.chunks(BLOCK * width);
    let block = |band: &[f64], left: usize| {
        let rows = band.chunks(width).map(|row| &row[left..width.min(left + BLOCK)]);
        let (sum, count) = rows.flatten().fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
        sum / count
    };
    let all = bands.flat_map(|band| (0..width).step_by(BLOCK).map(move |left| block(band, left)));
    all.fold(0.0, f64::max)
}

impl Picture {
    fn median(pictures: &[Self]) -> Self {
        let of = |value: fn(&Self) -> f64| {
            let mut values: Vec<f64> = pictures.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            let middle = values.len() / 2;
            if values.len().is_multiple_of(2) {
                (values[middle - 1] + values[middle]) / 2.0
            } else {
                values[middle]
            }
        };
        Self {
            time: of(|at| at.time),
            rays: of(|at| at.rays),
            error: of(|at| at.error),
            block: of(|at| at.block),
            worst: of(|at| at.worst),
            samples: of(|at| at.samples),
            stated: of(|at| at.stated),
            low: of(|at| at.low),
            high: of(|at| at.high),
        }
    }
}

/// The share of the pictures for which something holds.
fn share(pictures: &[Picture], holds: fn(&Picture) -> bool) -> f64 {
    pictures.iter().filter(|picture| holds(picture)).count() as f64 / pictures.len() as f64
}

/// The value `y` of uniform samples where `x` is `at`, on logarithmic axes. Beyond the numbers of samples that were
/// traced, the line through the nearest two goes on.
fn interpolated(pictures: &[Picture], x: fn(&Picture) -> f64, y: fn(&Picture) -> f64, at: f64) -> f64 {
    let place = |picture: &Picture| (x(picture) - at).signum();
    let turn = pictures.windows(2).position(|pair| place(&pair[0]) != place(&pair[1]));
    let distance = |picture: &Picture| log2(x(picture) / at).abs();
    let last = pictures.len() - 2;
    let nearest = if distance(&pictures[0]) < distance(&pictures[last + 1]) { 0 } else { last };
    let pair = &pictures[turn.unwrap_or(nearest)..][..2];
    let share = log2(at / x(&pair[0])) / log2(x(&pair[1]) / x(&pair[0]));
    y(&pair[0]) * pow(y(&pair[1]) / y(&pair[0]), share)
}
