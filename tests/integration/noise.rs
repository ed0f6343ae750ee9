//! Errors of sampled pictures: how they fall with samples, and whether what is told of them is true.

use crate::support::{sequence, shoot};
use kinora::color::Rgb;
use kinora::film::{Film, Noise};
use kinora::metrics::References;
use kinora::quality::NoiseTarget;
use kinora::sampling::Points;
use kinora::sequence::Sequence;

/// Soft shadows, and nothing else that is random but the place in a pixel.
fn soft_shadow(quality: &str) -> Sequence {
    sequence(&format!(
        "(output: (size: (24, 16)), quality: ({quality}), background: 0.1, ambient: 0.1,
        camera: (position: (0, 4, 7), target: (0, 0.4, 0)),
        lights: {{ \"panel\": Rectangle(corner: (-3, 5, -2), u: (2, 0, 0), v: (0, 0, 2), intensity: 12) }},
        objects: {{ \"floor\": (shape: Plane()), \"ball\": (shape: Sphere(center: (0, 1, 0))),
            \"post\": (shape: Box(min: (1.4, 0, -1), max: (1.8, 2, -0.6))) }})"
    ))
}

fn film(sequence: &Sequence, seed: u32) -> Film {
    let mut sequence = sequence.clone();
    sequence.quality.seed = seed;
    shoot(&sequence, [0]).remove(0).film
}

fn radiance(sequence: &Sequence, seed: u32) -> Vec<Rgb> {
    film(sequence, seed).radiance().collect()
}

/// Two long renders, with seeds that nothing else has.
fn references(sequence: &Sequence, samples: u32) -> References {
    let mut sequence = sequence.clone();
    (sequence.quality.samples, sequence.quality.noise) = (samples, None);
    sequence.quality.points = Points::Sobol;
    References { a: radiance(&sequence, 1_000_001), b: radiance(&sequence, 1_000_002) }
}

/// The exponent with which the error falls as samples are added, by least squares over the logarithms.
fn slope(points: Points) -> f64 {
    let mut sequence = soft_shadow("samples: 1");
    let references = references(&sequence, 4096);
    sequence.quality.points = points;
    let error = |samples: u32| {
        sequence.quality.samples = samples;
        let square: f64 = (0..16).map(|seed| references.squared_error(&radiance(&sequence, seed))).sum();
        (f64::from(samples).log2(), (square / 16.0).log2() / 2.0)
    };
    let all: Vec<(f64, f64)> = [4, 8, 16, 32, 64].map(error).to_vec();
    let count = all.len() as f64;
    let mean = all.iter().fold((0.0, 0.0), |sum, at| (sum.0 + at.0 / count, sum.1 + at.1 / count));
    let product: f64 = all.iter().map(|at| (at.0 - mean.0) * (at.1 - mean.1)).sum();
    product / all.iter().map(|at| (at.0 - mean.0) * (at.0 - mean.0)).sum::<f64>()
}

/// Four times the samples halve the error of independent ones.
#[test]
fn independent_samples_converge_as_their_square_root() {
    let slope = slope(Points::Independent);
    assert!((slope + 0.5).abs() < 0.03, "{slope}");
}

#[test]
fn stratified_samples_converge_faster() {
    let slope = slope(Points::Sobol);
    assert!(slope < -0.6, "{slope}");
}

/// How far a picture really is from the reference, measured as [`Noise`] measures.
fn true_error(film: &Film, references: &References) -> f64 {
    let radiance: Vec<Rgb> = film.radiance().collect();
    let best = references.best();
    let (width, height) = (film.width as usize, film.height as usize);
    let mean = |pixels: &[usize]| {
        let sum: f64 = pixels.iter().map(|&i| best[i].as_dvec3().element_sum()).sum();
        sum / (3 * pixels.len()) as f64
    };
    let darkest = mean(&(0..best.len()).collect::<Vec<_>>()) / 16.0;
    let mut square = 0.0;
    for (top, left) in
        (0..height).step_by(8).flat_map(|top| (0..width).step_by(8).map(move |left| (top, left)))
    {
        let rows = top..height.min(top + 8);
        let pixels: Vec<usize> =
            rows.flat_map(|y| (left..width.min(left + 8)).map(move |x| y * width + x)).collect();
        let part = References {
            a: pixels.iter().map(|&i| references.a[i]).collect(),
            b: pixels.iter().map(|&i| references.b[i]).collect(),
        };
        let scale = mean(&pixels).max(darkest);
        let error = part.squared_error(&pixels.iter().map(|&i| radiance[i]).collect::<Vec<_>>());
        square += error / (scale * scale) * pixels.len() as f64 / best.len() as f64;
    }
    square.max(0.0).sqrt()
}

fn experiment(sequence: &Sequence, runs: u32, samples: u32) -> (f64, f64, f64, f64) {
    let references = references(sequence, samples);
    let (mut inside, mut above, mut sum, mut told) = (0, 0, 0.0, 0.0);
    for seed in 0..runs {
        let film = film(sequence, seed);
        let noise = film.noise.expect("an error was asked for");
        let error = true_error(&film, &references);
        inside += u32::from((noise.low..=noise.high).contains(&error));
        above += u32::from(error > noise.high);
        sum += error / f64::from(runs);
        told += noise.error / f64::from(runs);
    }
    (f64::from(inside) / f64::from(runs), f64::from(above) / f64::from(runs), sum, told)
}

#[test]
fn zz_experiment() {
    for error in [0.1, 0.05, 0.02] {
        let s = soft_shadow(&format!("noise: {error}"));
        eprintln!("{error} soft {:?}", experiment(&s, 100, 8192));
    }
    for (file, size) in [
        ("sequences/field-orbit.ron", (64, 40)),
        ("sequences/field-dielectric.ron", (64, 40)),
        ("sequences/room-effects.ron", (64, 40)),
    ] {
        let mut s = kinora::sequence::load(std::path::Path::new(file)).expect("x");
        s.output.size = size;
        if file.contains("room") {
            s.quality.integrator = kinora::quality::Integrator::Path(Default::default());
        }
        s.quality.noise = Some(NoiseTarget { error: 0.1, most: 4096 });
        eprintln!("{file} {:?} {:?}", experiment(&s, 30, 4096), film(&s, 0).noise);
    }
}
