//! Measures what shared samples of a zoom save: the time and the error of all frames of a sequence, with shared samples
//! and frame by frame, against long references of every eighth frame.
//!
//! ```text
//! cargo run --release --example zoom_error [FILE] [REFERENCE]
//! ```
//!
//! FILE is `sequences/room-zoom.ron` by default, small and traced by paths. REFERENCE is the number of samples of the
//! reference, 16 times those of the file by default. Without random samples it is 8 times finer along each axis.

use kinora::base::color::Rgb;
use kinora::base::stats::ProgressMeter;
use kinora::film::{AovSet, Film};
use kinora::pipeline::plan::{Plan, run};
use kinora::pipeline::schedule::{FilmCollector, FrameLoop};
use kinora::sequence::quality::{Integrator, PathSettings, Quality, SampleReuse};
use kinora::sequence::{Sequence, load};
use std::error::Error;
use std::io::{Write, stdout};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// The frames of the reference: every one of so many.
const STEP: usize = 8;

/// Bytes for films.
const FILMS: u64 = 4 << 30;

struct Run {
    films: Vec<Film>,
    seconds: f64,
    camera_rays: u64,
}

fn rendered(sequence: &Sequence, frames: &[u32], quality: Quality) -> Result<Run, Box<dyn Error>> {
    let sequence = Sequence { quality, ..sequence.clone() };
    let start = Instant::now();
    let plan = Plan::new(&sequence, frames, AovSet::default(), FILMS);
    let meter = Arc::new(ProgressMeter::default());
    let mut all = FrameLoop::new(&sequence, FilmCollector::default(), meter);
    run(&plan, &mut all, || true).map_err(|error| format!("{error:?}"))?;
    let (seconds, camera_rays) = (start.elapsed().as_secs_f64(), all.stats().counts.rays.camera);
    let films = all.into_sink().map_or_else(Vec::new, |films| films.0);
    Ok(Run { films, seconds, camera_rays })
}

/// The mean over frames of the root of the mean squared difference.
fn error(films: &[Film], reference: &[Film]) -> f64 {
    let of_film = |(film, reference): (&Film, &Film)| {
        let square = |(a, b): (Rgb, Rgb)| f64::from((a - b).length_squared()) / 3.0;
        let sum: f64 = film.radiance().zip(reference.radiance()).map(square).sum();
        (sum / (f64::from(film.width) * f64::from(film.height))).sqrt()
    };
    let errors: Vec<f64> = films.iter().step_by(STEP).zip(reference).map(of_film).collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next();
    let reference = arguments.next().map(|text| text.parse::<u32>()).transpose()?;
    let path = file.as_deref().unwrap_or("sequences/room-zoom.ron");
    let mut sequence = load(Path::new(path))?;
    if file.is_none() {
        sequence.quality.integrator = Integrator::Path(PathSettings::default());
        (sequence.quality.bounces, sequence.output.size) = (4, (120, 75));
    }
    let own = Quality { reuse: SampleReuse::Off, ..sequence.quality };
    let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
    let some: Vec<u32> = frames.iter().copied().step_by(STEP).collect();
    let most = reference.unwrap_or(16 * own.samples);
    let grid = own.antialias * 8;
    let long = Quality { samples: most, antialias: grid, seed: own.seed.wrapping_add(1), ..own };
    let truth = rendered(&sequence, &some, long)?.films;
    let mut out = stdout();
    writeln!(out, "{:<32}{:>14}{:>10}{:>11}", "", "camera rays", "seconds", "error")?;
    let mut row = |name: String, quality: Quality| -> Result<(), Box<dyn Error>> {
        let Run { films, seconds, camera_rays } = rendered(&sequence, &frames, quality)?;
        let error = error(&films, &truth);
        Ok(writeln!(out, "{name:<32}{camera_rays:>14}{seconds:>10.2}{error:>11.5}")?)
    };
    row("shared samples".to_owned(), Quality { reuse: SampleReuse::Zoom, ..own })?;
    for (number, part) in [(1, 2), (1, 1), (3, 2), (2, 1)] {
        let samples = (own.samples * number / part).max(1);
        let antialias =
            (f64::from(own.antialias) * (f64::from(number) / f64::from(part)).sqrt()).round() as u32;
        let name = format!("frame by frame, {samples} or {antialias} x {antialias}");
        row(name, Quality { samples, antialias: antialias.max(1), ..own })?;
    }
    Ok(())
}
