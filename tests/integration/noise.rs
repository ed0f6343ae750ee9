//! Errors of sampled pictures: how they fall with samples, and whether the stated errors are true.

use crate::command::{folder, kinora};
use crate::support::{sequence, shoot};
use exr::meta::attribute::AttributeValue;
use kinora::accuracy::image_error::ReferencePair;
use kinora::base::cancel::Stop;
use kinora::base::color::Rgb;
use kinora::base::stats::ProgressMeter;
use kinora::film::{AovSet, Film, Noise};
use kinora::pipeline::plan::Plan;
use kinora::pipeline::schedule::{FilmCollector, FrameLoop};
use kinora::sampling::SamplerKind;
use kinora::sequence::Sequence;
use kinora::sequence::quality::{Denoise, NoiseTarget};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

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

pub fn film(sequence: &Sequence, frame: u32, seed: u32) -> Film {
    let mut sequence = sequence.clone();
    sequence.quality.seed = seed;
    shoot(&sequence, [frame]).remove(0).film
}

fn radiance(sequence: &Sequence, frame: u32, seed: u32) -> Vec<Rgb> {
    film(sequence, frame, seed).radiance().collect()
}

/// Two long renders, with seeds that nothing else has.
pub fn references(sequence: &Sequence, frame: u32, samples: u32) -> ReferencePair {
    let mut sequence = sequence.clone();
    (sequence.quality.samples, sequence.quality.noise) = (samples, None);
    sequence.quality.points = SamplerKind::Sobol;
    sequence.quality.denoise = Denoise::Off;
    let [a, b] = [1_000_001, 1_000_002].map(|seed| radiance(&sequence, frame, seed));
    ReferencePair { a, b }
}

/// The exponent with which the error falls as samples are added, by least squares over the logarithms.
fn slope(points: SamplerKind) -> f64 {
    let mut sequence = soft_shadow("samples: 1");
    let references = references(&sequence, 0, 4096);
    sequence.quality.points = points;
    let error = |samples: u32| {
        sequence.quality.samples = samples;
        let square: f64 = (0..16).map(|seed| references.squared_error(&radiance(&sequence, 0, seed))).sum();
        (libm::log2(f64::from(samples)), libm::log2(square / 16.0) / 2.0)
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
    let slope = slope(SamplerKind::Independent);
    assert!((slope + 0.5).abs() < 0.03, "{slope}");
}

#[test]
fn stratified_samples_converge_faster() {
    let slope = slope(SamplerKind::Sobol);
    assert!(slope < -0.6, "{slope}");
}

/// How far a picture really is from the reference, measured as [`Noise`] measures.
pub fn true_error(film: &Film, references: &ReferencePair) -> f64 {
    let radiance: Vec<Rgb> = film.radiance().collect();
    let best = references.best();
    let sum: f64 = best.iter().map(|light| light.as_dvec3().element_sum()).sum();
    references.squared_error(&radiance).max(0.0).sqrt() / (sum / (3 * best.len()) as f64)
}

/// Of many runs of a frame: the share whose true error lies in the reported interval, the share whose true error lies above
/// it, and the mean true error.
pub fn stated(sequence: &Sequence, frame: u32, seeds: Range<u32>, samples: u32) -> (f64, f64, f64) {
    let references = references(sequence, frame, samples);
    let (mut inside, mut above, mut sum) = (0, 0, 0.0);
    let runs = seeds.len() as f64;
    for seed in seeds {
        let film = film(sequence, frame, seed);
        let noise = film.noise.expect("an error was asked for");
        let error = true_error(&film, &references);
        inside += u32::from((noise.low..=noise.high).contains(&error));
        above += u32::from(error > noise.high);
        sum += error;
    }
    let share = |count: u32| f64::from(count) / runs;
    (share(inside), share(above), sum / runs)
}

/// Light that few paths find, and those much of it: what a mirror ball throws from a small lamp onto the floor.
const RARE: &str = r#"(output: (size: (24, 16)), quality: (QUALITY, integrator: Path(), bounces: 4), background: 0.02, ambient: 0,
    camera: (position: (0, 4, 7), target: (0, 0.4, 0)),
    lights: { "lamp": Sphere(center: (-2, 3.5, 2), radius: 0.6, intensity: 30) },
    objects: { "floor": (shape: Plane(), material: Lambertian(color: 0.6)),
        "ball": (shape: Sphere(center: (0, 1, 0)), material: Metal(color: 0.9)),
        "post": (shape: Box(min: (1.4, 0, -1), max: (1.8, 2, -0.6)), material: Lambertian(color: 0.6)) })"#;

/// Hardly any light, behind a screen that leaves most of the picture black.
const DARK: &str = r#"(output: (size: (24, 16)), quality: (QUALITY), background: 0, ambient: 0,
    camera: (position: (0, 4, 7), target: (0, 0.4, 0)),
    lights: { "panel": Rectangle(corner: (-3, 2.2, -2), u: (0.8, 0, 0), v: (0, 0, 0.8), intensity: 0.01) },
    objects: { "floor": (shape: Plane(), material: Lambertian(color: 0.05)),
        "ball": (shape: Sphere(center: (0, 1, 0)), material: Lambertian(color: 0.05)),
        "screen": (shape: Box(min: (-1.5, 0, -9), max: (-1.3, 9, 9)), material: Lambertian(color: 0.05)) })"#;

/// Target errors are met, and stated errors are true: the interval that holds the truth in 95 of 100 frames holds it
/// in 90 to 99, though decisions to stop depend on the same samples. Of 200 frames with a chance of 95 %,
/// fewer than 180 are one case in 300, more than 198 one in 1000.
#[track_caller]
fn assert_stated(sequence: &Sequence, (seeds, reference): (u32, u32)) {
    let target = sequence.quality.noise.expect("a target error").error;
    let (inside, above, mean) = stated(sequence, 0, 0..seeds, reference);
    let what = format!("{target}: {inside} inside, {above} above, {mean} on average");
    assert!((0.9..=0.99).contains(&inside) && above <= 0.1, "{what}");
    assert!(mean <= target, "{what}");
}

fn with_quality(scene: &str, quality: &str) -> Sequence {
    sequence(&scene.replace("QUALITY", quality))
}

#[test]
fn target_errors_are_reached_and_reported() {
    assert_stated(&soft_shadow("noise: 0.1"), (200, 4096));
    assert_stated(&with_quality(RARE, "noise: 0.2"), (200, 4096));
}

#[test]
#[ignore = "not met yet (99.15 %), takes half a minute; cargo test --release --test integration small_target_errors -- --ignored"]
fn small_target_errors_are_reached_and_reported() {
    // So many that the share is known within 1 %.
    assert_stated(&soft_shadow("noise: 0.05"), (2000, 4096));
}

/// Few squares make the estimate, so their variance is uncertain.
#[test]
#[ignore = "takes minutes; cargo test --release --test integration few_lit_pixels -- --ignored"]
fn few_lit_pixels_have_true_errors() {
    assert_stated(&with_quality(DARK, "noise: 0.1"), (2000, 1 << 16));
}

#[test]
#[ignore = "takes half an hour; cargo test --release --test integration shipped_scenes -- --ignored --nocapture"]
fn shipped_scenes_reach_target_errors() {
    // In frame 24 of the room the lens is open; frame 0 has no random samples, and so no error. The last two are limits that
    // docs/accuracy.md names: what is stated for them is often too large. These seeds were not used to choose the method.
    for (file, frame, least) in [
        ("field-orbit", 0, 0.9),
        ("field-dielectric", 0, 0.9),
        ("field-metal", 0, 0.9),
        ("light-show", 10, 0.9),
        ("room-effects", 24, 0.9),
        ("field-lambertian", 0, 0.8),
        ("room-effects", 44, 0.8),
    ] {
        let path = format!("{}/sequences/{file}.ron", env!("CARGO_MANIFEST_DIR"));
        let mut sequence = kinora::sequence::load(std::path::Path::new(&path)).expect("a sequence");
        sequence.output.size = (64, 40);
        for error in [0.1, 0.05] {
            sequence.quality.noise = Some(NoiseTarget { error, most: NoiseTarget::MOST });
            let (inside, above, mean) = stated(&sequence, frame, 5000..5100, 4096);
            eprintln!("{file} {frame} {error}: {inside} inside, {above} above, {mean} on average");
            assert!(
                inside >= least && above <= 0.05 && mean <= error,
                "{file} {frame} {error}: {inside} {above} {mean}"
            );
        }
    }
}

/// Two panels, of which the second is on in frame 0 alone.
fn switched() -> Sequence {
    sequence(
        "(timeline: (frames: 2, keys: Frames), output: (size: (20, 12)), quality: (noise: 0.1), ambient: 0,
        camera: (position: (0, 4, 7), target: (0, 0.4, 0)),
        lights: { \"a\": Rectangle(corner: (-3, 5, -2), u: (2, 0, 0), v: (0, 0, 2), intensity: [(0, 12), (9, 0)]),
            \"b\": Sphere(center: (3, 5, 1), radius: 1, intensity: 9, on: [(0, true), (1, false)]) },
        objects: { \"floor\": (shape: Plane()), \"ball\": (shape: Sphere(center: (0, 1, 0))) })",
    )
}

/// One film serves both frames, and is good enough for each of them. A frame is the same by itself.
#[test]
fn shared_films_reach_the_error_of_all_frames() {
    let sequence = switched();
    let plan = Plan::new(&sequence, &[0, 1], AovSet::default(), u64::MAX);
    assert_eq!((plan.films.len(), plan.reused()), (1, 1));
    let mut frames = FrameLoop::new(&sequence, FilmCollector::default(), Arc::default());
    kinora::pipeline::plan::run(&plan, &mut frames, || true).expect("frames");
    let films = frames.into_sink().expect("the sink").0;
    let noises: Vec<Noise> = films.iter().map(|film| film.noise.expect("an error was asked for")).collect();
    assert!(noises.iter().all(|noise| noise.error <= 0.1), "{noises:?}");
    assert_eq!(noises[0].samples, noises[1].samples);
    assert_ne!(noises[0].error, noises[1].error);
    for (frame, film) in (0..).zip(&films) {
        let alone = shoot(&sequence, [frame]).remove(0).film;
        assert_eq!(
            alone.radiance().collect::<Vec<_>>(),
            film.radiance().collect::<Vec<_>>(),
            "frame {frame}"
        );
        assert_eq!(alone.noise, film.noise, "frame {frame}");
    }
}

/// Another weight in another frame is another film, though this frame shows the same.
#[test]
fn the_error_of_shared_frames_is_part_of_the_identity() {
    let text = |last: f64| {
        format!(
            "(timeline: (frames: 2, keys: Frames), output: (size: (8, 8)), quality: (noise: 0.1), lights: {{
            \"a\": Sphere(center: (3, 5, 1), radius: 1, intensity: [(0, 9), (1, {last})]) }}, objects: {{ \"ball\": (shape: Sphere()) }})"
        )
    };
    let look = |last: f64| kinora::pipeline::plan::evaluate(&sequence(&text(last)), &[0]).frames.remove(0);
    let (one, other) = (look(3.0), look(4.0));
    assert!(one.weights == other.weights && one.film() != other.film() && one.digest() != other.digest());
    assert_eq!(one, look(3.0));
}

#[test]
fn adaptive_frames_do_not_depend_on_threads() {
    let shoot_on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| shoot(&switched(), [0]).remove(0).film)
    };
    assert_eq!(shoot_on(1), shoot_on(3));
    // More blocks than one part of their sums, and incomplete ones at both edges.
    let large = |threads, quality: &str| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let text = format!(
            "(output: (size: (101, 90)), quality: ({quality}), ambient: 0, camera: (position: (0, 2, 6)),
            lights: {{ \"lamp\": Sphere(center: (3, 5, 1), radius: 1, intensity: 9) }},
            objects: {{ \"floor\": (shape: Plane()), \"ball\": (shape: Sphere(center: (0, 1, 0))) }})"
        );
        pool.install(|| shoot(&sequence(&text), [0]).remove(0).film)
    };
    let film = large(1, "noise: 0.02, max_samples: 64");
    assert_eq!(film, large(3, "noise: 0.02, max_samples: 64"));
    assert!(film.noise.is_some_and(|noise| noise.samples > 16.0 && noise.samples < 64.0), "{:?}", film.noise);
    let [least, even] = ["noise: 0.0001, max_samples: 16", "samples: 16"].map(|quality| large(2, quality));
    assert_eq!(least.radiance().collect::<Vec<_>>(), even.radiance().collect::<Vec<_>>());
}

/// Smooth parts take fewer samples than difficult ones, and no pixel takes more than it may.
#[test]
fn samples_go_where_the_error_is() {
    let rays = |quality: &str| {
        let shot = shoot(&soft_shadow(quality), [0]).remove(0);
        (shot.work.camera, shot.film.noise)
    };
    let (camera, noise) = rays("noise: 0.05");
    let noise = noise.expect("an error was asked for");
    assert_eq!(camera as f64, (noise.samples * 384.0).round());
    assert!(noise.samples > 16.0 && noise.samples < 512.0 && noise.capped == 0.0, "{noise:?}");
    let (camera, noise) = rays("noise: 0.0001, max_samples: 48");
    assert_eq!(camera, 48 * 384);
    assert!(noise.is_some_and(|noise: Noise| (noise.capped - 1.0).abs() < 1e-9 && noise.error > 0.0001));
}

/// The moments of a frame are looked at again until all of them together are good.
#[test]
fn motion_blur_reaches_target_errors() {
    let text = |quality: &str| {
        format!(
            "(timeline: (frames: 4, keys: Frames), output: (size: (16, 12)), quality: (shutter_steps: 8, {quality}),
            background: 0.2, camera: (position: (0, 0, 5), shutter: 0.5), objects: {{ \"ball\": (shape: Sphere(),
            material: (emission: 1), translation: [(0, (-1, 0, 0)), (4, (3, 0, 0))]) }})"
        )
    };
    let shoot = |quality: &str| shoot(&sequence(&text(quality)), [1]).remove(0).film;
    let (good, long) = (shoot("noise: 0.05"), shoot("samples: 4096"));
    let (noise, best) = (good.noise.expect("an error was asked for"), long.radiance().collect::<Vec<_>>());
    let error =
        kinora::accuracy::image_error::mean_squared_error(&good.radiance().collect::<Vec<_>>(), &best).sqrt();
    assert!(noise.error < 0.05 && error < 0.03, "{noise:?} {error}");
}

/// A stop in the first round leaves every pixel with a few samples, of which the error is unknown; also between moments.
#[test]
fn stopped_frames_keep_few_samples_and_know_no_error() {
    let moving = "(timeline: (frames: 4, keys: Frames), output: (size: (16, 12)), quality: (shutter_steps: 8, noise: 0.05),
        background: 0.2, camera: (position: (0, 0, 5), shutter: 0.5), objects: { \"ball\": (shape: Sphere(),
        material: (emission: 1), translation: [(0, (-1, 0, 0)), (4, (3, 0, 0))]) })";
    for sequence in [soft_shadow("noise: 0.05"), sequence(moving)] {
        let meter = Arc::new(ProgressMeter::default());
        meter.stop.get_or_init(Stop::default).flag().store(2, Relaxed);
        let mut frames = FrameLoop::new(&sequence, FilmCollector::default(), Arc::clone(&meter));
        frames.frame(0).expect("a frame");
        let rays = frames.stats().counts.rays.camera;
        let film = frames.into_sink().expect("the sink").0.remove(0);
        let noise = film.noise.expect("an error was asked for");
        assert!(
            film.unfinished && (noise.samples - 2.0).abs() < 1e-9 && noise.error.is_infinite(),
            "{noise:?}"
        );
        assert_eq!(rays, u64::from(2 * film.width * film.height));
        assert!(film.radiance().all(|light| light.is_finite()) && film.radiance().any(|light| light.x > 0.0));
    }
}

#[test]
fn deterministic_frames_ignore_target_errors() {
    let text =
        "(output: (size: (8, 8)), quality: Error(0.01), lights: { \"sun\": Point(position: (1, 5, 3)) },
        objects: { \"ball\": (shape: Sphere()) })";
    let shot = shoot(&sequence(text), [0]).remove(0);
    assert_eq!((shot.film.noise, shot.work.camera), (None, 4 * 64));
}

/// The errors of all frames in a summary for programs.
fn summarised(printed: &str) -> &str {
    let start = printed.rfind("\"noise\":").expect("errors");
    let end = printed[start..].find("\"bvh_builds\"").expect("what follows");
    &printed[start..start + end]
}

/// In PNG and EXR files, in the summary, and again where frames are kept.
#[test]
fn frames_record_their_error() {
    let folder = folder();
    let text = "(timeline: (frames: 3, keys: Frames), output: (size: (24, 16)), quality: (noise: 0.1), background: 0.1,
        camera: (position: (0, 4, 7), target: (0, 0.4, 0)),
        lights: { \"panel\": Rectangle(corner: (-3, 5, -2), u: (2, 0, 0), v: (0, 0, 2), intensity: 12) },
        objects: { \"floor\": (shape: Plane()), \"ball\": (shape: Sphere(), translation: [(0, (0, 1, 0)), (2, (0, 1, 1))]) })";
    std::fs::write(folder.path().join("soft.ron"), text).expect("the folder is writable");
    let render = |outputs: &[&str]| {
        kinora(folder.path(), &[&["render", "soft.ron", "--progress", "json"], outputs].concat())
    };
    let both = ["-o", "f_#.png", "-o", "f_#.exr"];
    let printed = render(&both);
    let sequence = kinora::sequence::load(&folder.path().join("soft.ron")).expect("a sequence");
    for frame in 0..3 {
        let noise = shoot(&sequence, [frame]).remove(0).film.noise.expect("an error was asked for");
        let Noise { error, low, high, samples, capped, denoised } = noise;
        assert_eq!(denoised, None);
        let wanted = format!("{error} low={low} high={high} samples={samples} capped={capped}");
        let texts = kinora::encode::frame_texts(&folder.path().join(format!("f_{frame}.png")));
        let found =
            texts.iter().find(|(keyword, _)| keyword == "kinora:error").map(|(_, text)| text.as_str());
        assert_eq!(found, Some(wanted.as_str()));
        let path = folder.path().join(format!("f_{frame}.exr"));
        let layer = exr::prelude::read_first_flat_layer_from_file(path).expect("an EXR file");
        let attributes = layer.layer_data.attributes.other;
        let has_error = attributes.values().any(|value| match value {
            AttributeValue::Text(text) => text.to_string().contains(&format!("kinora:error: {wanted}\n")),
            _ => false,
        });
        assert!(has_error, "{attributes:?}");
        assert!(summarised(&printed).contains(&format!("\"{frame}\":{{\"error\":{error}")), "{printed}");
    }
    let again = render(&both);
    assert!(again.contains("\"kept\":3") && summarised(&again) == summarised(&printed), "{again}");
    render(&["-o", "g_#.png", "-o", "g_#.exr", "--no-metadata"]);
    for name in ["g_0.png", "g_0.exr"] {
        let bytes = std::fs::read(folder.path().join(name)).expect("a frame");
        assert!(!bytes.windows(12).any(|window| window == b"kinora:error"), "{name}");
    }
}

/// With `vary_noise`, every frame has noise of its own: the same for any set of frames, and none is the film of another.
#[test]
fn noise_varies_on_request() {
    let still = |quality: &str| {
        sequence(&format!(
            "(timeline: (frames: 3, keys: Frames), output: (size: (24, 16)), quality: (samples: 2, {quality}),
            camera: (position: (0, 4, 7), target: (0, 0.4, 0)),
            lights: {{ \"panel\": Rectangle(corner: (-4, 5, -2), u: (2, 0, 0), v: (0, 0, 2), intensity: 12) }},
            objects: {{ \"floor\": (shape: Plane()) }})"
        ))
    };
    let varied = still("vary_noise: true");
    let films: Vec<_> = shoot(&varied, 0..3).into_iter().map(|shot| shot.film.data).collect();
    assert!(films[0] != films[1] && films[1] != films[2] && films[0] != films[2]);
    assert_eq!(shoot(&varied, [2])[0].film.data, films[2]);
    let count =
        |sequence: &Sequence| Plan::new(sequence, &[0, 1, 2], AovSet::default(), u64::MAX).films.len();
    assert_eq!([count(&varied), count(&still("seed: 3"))], [3, 1]);
    // Grids have no noise.
    let mut plain = varied.clone();
    plain.lights.clear();
    assert_eq!(count(&plain), 1);
}

/// With `vary_noise`, frames that could share paths, samples of views or films of a cross-fade have the bytes that they
/// have alone, and noise that differs from frame to frame.
#[test]
fn varied_noise_does_not_depend_on_other_frames() {
    let scene = |quality: &str, camera: &str, ball: &str| {
        format!(
            "(timeline: (frames: 4, keys: Frames), output: (size: (24, 16)), quality: (vary_noise: true, {quality}),
            {camera}, lights: {{ \"panel\": Rectangle(corner: (-4, 5, -2), u: (2, 0, 0), v: (0, 0, 2), intensity: 12) }},
            objects: {{ \"floor\": (shape: Plane()), \"ball\": (shape: Sphere(radius: 0.2), translation: {ball}) }})"
        )
    };
    let still = "camera: (position: (0, 4, 7), target: (0, 0.4, 0))";
    let zoom = "camera: (position: (0, 4, 7), target: (0, 0.4, 0), projection: Perspective(fov: [(0, 40), (3, 30)]))";
    let blur = "camera: (position: (0, 4, 7), target: (0, 0.4, 0), shutter: 0.5)";
    let fade = "cameras: { \"a\": (position: (0, 4, 7), target: (0, 0.4, 0)),
        \"b\": (position: (1, 4, 7), target: (0, 0.4, 0)) }, active_camera: [(0, \"a\"), (2, \"b\")], cross_fade: 3";
    let (rests, moves) = ("(2.5, 0.5, 0)", "[(0, (2.5, 0.5, 0)), (3, (3, 0.5, 0))]");
    let folder = folder();
    for (name, text) in [
        ("mover", scene("samples: 4", still, moves)),
        ("blur", scene("samples: 4, shutter_steps: 4", blur, moves)),
        ("zoom", scene("samples: 4, reuse: Zoom", zoom, rests)),
        ("fade", scene("samples: 4", fade, rests)),
        ("noise", scene("noise: 0.2", still, rests)),
        ("denoise", scene("samples: 4, denoise: Auto", still, rests)),
    ] {
        std::fs::write(folder.path().join("a.ron"), text).expect("the folder is writable");
        let bytes = |file: &str| std::fs::read(folder.path().join(name).join(file)).expect("a frame");
        let all = format!("{name}/all_#.png");
        kinora(folder.path(), &["render", "a.ron", "-q", "-o", &all]);
        let one = format!("{name}/one_#.png");
        kinora(folder.path(), &["render", "a.ron", "-q", "-o", &one, "--frames", "2"]);
        assert!(bytes("all_2.png") == bytes("one_2.png"), "{name}");
        let pixels = |frame: u32| {
            let path = folder.path().join(name).join(format!("all_{frame}.png"));
            image::open(path).expect("a picture").to_rgb8().into_raw()
        };
        // Far from what moves.
        let left = |frame: u32| pixels(frame)[24 * 3 * 8..][..24].to_vec();
        assert!(left(1) != left(2) && left(2) != left(3), "{name}");
    }
}

/// What does not change from frame to frame has the same noise, so that it stands still; another seed gives other noise.
#[test]
fn noise_does_not_crawl() {
    let moving = |seed: u32| {
        sequence(&format!(
            "(timeline: (frames: 2, keys: Frames), output: (size: (24, 16)), quality: (samples: 2, seed: {seed}),
            camera: (position: (0, 4, 7), target: (0, 0.4, 0)),
            lights: {{ \"panel\": Rectangle(corner: (-4, 5, -2), u: (2, 0, 0), v: (0, 0, 2), intensity: 12) }},
            objects: {{ \"floor\": (shape: Plane()), \"ball\": (shape: Sphere(radius: 0.5),
                translation: [(0, (2.5, 0.5, 0)), (1, (3, 0.5, 0))]) }})"
        ))
    };
    let left = |film: &Film| -> Vec<Rgb> {
        let pixels = film.radiance().enumerate();
        pixels.filter(|(index, _)| index % 24 < 10).map(|(_, light)| light).collect()
    };
    let shots = shoot(&moving(0), 0..2);
    assert!(left(&shots[0].film) == left(&shots[1].film));
    assert!(shots[0].film.data != shots[1].film.data, "the ball has moved");
    assert!(left(&shots[0].film) != left(&shoot(&moving(1), [0])[0].film), "noise is there");
}
