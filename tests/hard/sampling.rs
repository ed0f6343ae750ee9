//! Chance and sums. SA-01, SA-02 and SA-06 stand in `src/sampling`, SA-08 in `src/trace/sums.rs`; SA-03 and SA-10 see
//! the whole renderer in `tests/integration`.

use crate::support::{few, shoot_all};
use kinora::appearance::optics::Fuzz;
use kinora::base::math::{DVec2, DVec3};
use kinora::sampling::{PixelSampler, cosine_hemisphere, dimension, disk, uniform_ball, uniform_sphere};
use rayon::prelude::*;

/// 128 of all 2^32 numbers become 1 when they are divided by 2^32 in f32.
fn numbers_are_below_one(draws: u32) {
    (0..1000u32).into_par_iter().for_each(|pixel| {
        let numbers = PixelSampler::new((pixel, 7), 3);
        for sample in 0..draws / 4000 {
            let of = dimension::at_surface(dimension::SCATTER, sample % 3, 0);
            let four = numbers.sample(sample).lanes().numbers::<4>(of);
            assert!(four.iter().all(|u| (0.0..1.0).contains(u)), "{four:?}");
        }
    });
}

#[test]
fn sa_05_numbers_are_below_one() {
    numbers_are_below_one(few(100_000_000) / 4);
}

#[test]
#[ignore = "takes seconds: all draws of SA-05; cargo test --release -- --ignored sa_05"]
fn sa_05_numbers_are_below_one_in_full() {
    numbers_are_below_one(100_000_000);
}

/// Numbers at both ends of what is drawn give unit vectors all the same: nothing is normalised that may vanish.
#[test]
fn sa_05_directions_are_finite_and_of_unit_length() {
    let ends = [0.0, 5e-324, 1e-30, f64::EPSILON, 0.25, 0.5, 0.75, 1.0 - f64::EPSILON, 1.0f64.next_down()];
    let unit = |d: DVec3| d.is_finite() && (d.length() - 1.0).abs() <= 4.0 * f64::EPSILON;
    for (&u, &v) in ends.iter().flat_map(|u| ends.iter().map(move |v| (u, v))) {
        let on_sphere = DVec3::from(uniform_sphere(u, v));
        assert!(unit(on_sphere) && unit(cosine_hemisphere(u, v).into()), "{u} {v}");
        assert!(DVec2::from(disk(u, v)).length() <= 1.0 + f64::EPSILON, "{u} {v}");
        for w in ends {
            let u = [u, v, w];
            assert!(uniform_ball(u).length() <= 1.0 + f64::EPSILON, "{u:?}");
            for mirrored in [DVec3::Z, DVec3::NEG_Z, DVec3::NEG_X, -on_sphere] {
                for fuzz in [1.0, 0.5, 1e-3] {
                    let d = Fuzz(fuzz).sample(mirrored.into(), u).into();
                    assert!(unit(d), "fuzz {fuzz} of {mirrored} by {u:?}: {d}");
                }
            }
        }
    }
}

/// A pixel whose every sample is `emission`, by path tracing.
fn constant_pixel(samples: u32, emission: f32) -> f32 {
    let text = format!(
        "(output: (size: (1, 1)), quality: (integrator: Path, samples: {samples}, bounces: 0), background: {emission:?})"
    );
    shoot_all(&text)[0].pixel(0, 0).x
}

/// A sum in f32 ends at 2^24, and is off by 3.7e-5 after 10^7 samples. There are no more samples in a pixel than 2^24.
#[test]
fn sa_07_constants_keep_their_mean() {
    let samples = few(1 << 22);
    for emission in [0.1, 1.0, 1e-30, 1e30] {
        let found = f64::from(constant_pixel(samples, emission));
        let exact = f64::from(emission);
        assert!((found / exact - 1.0).abs() <= 1e-7, "{samples} times {emission}: {found}");
    }
}

#[test]
#[ignore = "takes half a minute: as many samples as a pixel may have; cargo test --release -- --ignored sa_07"]
fn sa_07_constants_keep_their_mean_in_full() {
    for emission in [0.1, 1.0] {
        let found = f64::from(constant_pixel(1 << 24, emission));
        assert!((found / f64::from(emission) - 1.0).abs() <= 1e-7, "{found}");
    }
}

/// Samples that are spread evenly over 0 to 1, by a gradient from side to side of one pixel.
#[test]
fn sa_07_even_samples_have_their_mean() {
    let text = format!(
        "(output: (size: (1, 1)), quality: (integrator: Path, samples: {}, bounces: 0, filter: Box),
        camera: (position: (0.5, 0, 5), target: (0.5, 0, 0), projection: Orthographic(height: 1)),
        objects: {{ \"wall\": (shape: Plane(normal: (0, 0, 1)),
            material: (ambient: 0, diffuse: 0, emission: 1, emission_color: Gradient(axis: (1, 0, 0), a: 0, b: 1))) }})",
        1 << 16
    );
    let found = f64::from(shoot_all(&text)[0].pixel(0, 0).x);
    // 2^16 stratified points stray from the middles of as many parts by half a part at most.
    assert!((found - 0.5).abs() <= 0.5 / f64::from(1 << 16) + 1e-7, "{found}");
}

/// The slope of log error over log samples, over 16 seeds, and the errors themselves.
fn slope(scene: &str, exact: f64, counts: &[u32]) -> f64 {
    let points: Vec<(f64, f64)> = counts
        .iter()
        .map(|&samples| {
            let squares = (0..16).map(|seed| {
                let text = format!(
                    "(output: (size: (8, 8)), {})",
                    scene.replace("QUALITY", &format!("samples: {samples}, seed: {seed}"))
                );
                let film = &shoot_all(&text)[0].film;
                film.radiance()
                    .map(|pixel| (f64::from(pixel.x) - exact) * (f64::from(pixel.x) - exact))
                    .sum::<f64>()
                    / 64.0
            });
            (libm::log(f64::from(samples)), 0.5 * libm::log(squares.sum::<f64>() / 16.0))
        })
        .collect();
    let n = points.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let (mut xy, mut xx) = (0.0, 0.0);
    for (a, b) in points {
        xy += (a - x) * (b - y);
        xx += (a - x) * (a - x);
    }
    xy / xx
}

/// Every pixel looks at the same point: its neighbours are other seeds.
const SOFT_SHADOW: &str = "quality: (integrator: Path, bounces: 1, QUALITY),
    camera: (position: (3, 1, 0), projection: Orthographic(height: 1e-9)),
    lights: { \"l\": Rectangle(corner: (-1, 1.5, -1), u: (2, 0, 0), v: (0, 0, 2)) },
    objects: { \"floor\": (shape: Plane(), material: Lambertian(color: 0.5)),
        \"half\": (shape: Rectangle(corner: (-9, 0.75, -9), u: (9, 0, 0), v: (0, 0, 18)), material: Lambertian(color: 0)) }";

const FURNACE: &str = "quality: (integrator: Path, bounces: 1000, QUALITY),
    camera: (position: (0.3, 0.1, 0), target: (0, 0, -1)),
    objects: { \"hull\": (shape: Sphere(), material: (diffuse: 0.8, ambient: 0, emission: 0.2, color: 1)) }";

/// Error falls with the root of the samples, and faster where they are stratified.
#[test]
fn sa_09_errors_fall_as_they_should() {
    let counts: &[u32] = if cfg!(debug_assertions) { &[1, 16] } else { &[1, 4, 16, 64, 256] };
    // Of the square one half is hidden, to the other side of the plane through the point.
    let soft = slope(SOFT_SHADOW, 0.5 * 0.178_842_373_315_128, counts);
    assert!(soft <= -0.6, "soft shadow: {soft}");
    let furnace = slope(FURNACE, 1.0, counts);
    assert!(furnace <= -0.47, "furnace: {furnace}");
}
