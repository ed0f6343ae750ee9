//! Frames whose camera stays in its place share samples if it zooms and turns.

use crate::support::sequence;
use kinora::base::cancel::Stop;
use kinora::base::color::Rgb;
use kinora::base::stats::ProgressMeter;
use kinora::encode::{EncodeError, Existing, Output};
use kinora::film::{AovSet, Film};
use kinora::pipeline::plan::{self, Plan, RayEstimate};
use kinora::pipeline::render::{Request, Reuse, render};
use kinora::pipeline::schedule::{FilmSink, FrameLoop, Stats};
use kinora::sequence::Sequence;
use kinora::sequence::quality::{NoiseTarget, SampleReuse};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Films with the numbers of their frames.
#[derive(Default)]
struct Films(Vec<(u32, Film)>);

impl FilmSink for Films {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        self.0.push((frame, film));
        Ok(())
    }
}

/// A scene with many edges: steps, a mirror, and shadows. It has no patterns, which are filtered for the view that traces
/// them.
fn scene(quality: &str, camera: &str, frames: u32) -> Sequence {
    let step = |k: i32| {
        let (x, z) = (f64::from(k % 6) - 2.7, f64::from(k / 6) * 1.3 - 4.0);
        let (right, near, top) = (x + 0.4, z + 0.5, 0.1 + 0.1 * f64::from(k % 5));
        format!(
            "\"{k}\": (shape: Box(min: ({x}, 0, {z}), max: ({right}, {top}, {near})), material: (color: 0.2)),"
        )
    };
    let steps: String = (0..24).map(step).collect();
    sequence(&format!(
        r##"(timeline: (frames: {frames}, keys: Frames), output: (size: (48, 30)), quality: ({quality}),
        background: Gradient(bottom: "#406080", top: "#c0d0e0"),
        camera: (position: (0, 2.4, 6), target: (0.2, 0.7, 0), {camera}),
        lights: {{
            "sun": Point(position: (6, 9, 5)),
            "lamp": Sphere(center: (-3, 4, 2), radius: 0.5, intensity: [(0, 1), (5, 0.2), (47, 1)]),
        }},
        objects: {{
            "floor": (shape: Rectangle(corner: (-9, 0, 9), u: (18, 0, 0), v: (0, 0, -18)),
                      material: (color: "#efe6d2", mirror: 0.1)),
            {steps}
            "ball": (shape: Sphere(center: (-0.5, 1, -0.2)), material: (color: "#d8341c", specular: 0.7, mirror: 0.3)),
            "box": (shape: Box(min: (0.8, 0, 0.2), max: (1.8, 1, 1.2)), material: (color: "#2e74c0")),
        }})"##
    ))
}

const ZOOM: &str = "path: Zoom(factor: [(0, 1), (47, 4)])";
const PATHS: &str = "integrator: Path, bounces: 2, samples: 16";

/// Without the lamp, nothing is random.
fn grid_scene(quality: &str, camera: &str, frames: u32) -> Sequence {
    let mut sequence = scene(quality, camera, frames);
    sequence.lights.truncate(1);
    sequence
}

fn with_reuse(sequence: &Sequence, reuse: SampleReuse) -> Sequence {
    let mut sequence = sequence.clone();
    sequence.quality.reuse = reuse;
    sequence
}

fn frame_loop(sequence: &Sequence, aovs: AovSet) -> FrameLoop<Films> {
    FrameLoop::with_aovs(sequence, aovs, Films::default(), Arc::new(ProgressMeter::default()))
}

/// Frames by a plan with room for so many bytes of films.
fn planned(sequence: &Sequence, frames: &[u32], budget: u64) -> (Vec<(u32, Film)>, Stats, Plan) {
    let plan = Plan::new(sequence, frames, AovSet::default(), budget);
    let mut all = frame_loop(sequence, AovSet::default());
    plan::run(&plan, &mut all, || true).unwrap_or_else(|fault| panic!("{fault:?}"));
    let stats = all.stats().clone();
    (all.into_sink().expect("the sink").0, stats, plan)
}

fn all_frames(sequence: &Sequence) -> Vec<u32> {
    (0..sequence.timeline.frames).collect()
}

fn radiance(films: &[(u32, Film)]) -> Vec<Vec<Rgb>> {
    films.iter().map(|(_, film)| film.radiance().collect()).collect()
}

/// The root of the mean squared difference of each frame.
fn errors(films: &[Vec<Rgb>], reference: &[Vec<Rgb>]) -> Vec<f64> {
    let error = |(film, reference): (&Vec<Rgb>, &Vec<Rgb>)| {
        let square = |(a, b): (&Rgb, &Rgb)| f64::from((*a - *b).length_squared()) / 3.0;
        let sum: f64 = film.iter().zip(reference).map(square).sum();
        (sum / film.len() as f64).sqrt()
    };
    films.iter().zip(reference).map(error).collect()
}

fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len() as f64
}

/// A long reference, frame by frame.
fn reference(sequence: &Sequence, frames: &[u32]) -> Vec<Vec<Rgb>> {
    let mut long = with_reuse(sequence, SampleReuse::Off);
    (long.quality.samples, long.quality.antialias, long.quality.seed) = (1024, 16, 77);
    radiance(&planned(&long, frames, u64::MAX).0)
}

#[test]
fn a_zoom_takes_an_eighth_of_the_rays_and_the_plan_knows() {
    for sequence in [scene(PATHS, ZOOM, 48), grid_scene("antialias: 2", ZOOM, 48)] {
        let own = with_reuse(&sequence, SampleReuse::Zoom);
        let (films, stats, plan) = planned(&own, &all_frames(&own), u64::MAX);
        let expected = RayEstimate::of(&own, &plan);
        assert_eq!((films.len(), stats.counts.samples.films), (48, 48));
        assert!(expected.shares_views && !expected.exact && !expected.shares_paths);
        assert_eq!(stats.counts.rays.camera, expected.camera + stats.counts.samples.own);
        assert!(8 * stats.counts.rays.camera <= expected.camera_alone, "{:?}", stats.counts);
        assert!(stats.counts.samples.own * 1000 <= expected.camera, "{:?}", stats.counts.samples);
    }
}

#[test]
fn frames_have_the_same_bytes_however_they_are_rendered() {
    let turned = "path: [Orbit(turns: 0), Zoom(factor: [(0, 1), (9, 2)])], roll: [(0, 0), (9, 20)]";
    let wide = format!("{PATHS}, filter: Gaussian");
    for (quality, camera) in [(PATHS, ZOOM), (&wide, turned), ("antialias: 2, samples: 5", ZOOM)] {
        let sequence = with_reuse(&scene(quality, camera, 10), SampleReuse::Zoom);
        let (films, stats, _) = planned(&sequence, &all_frames(&sequence), u64::MAX);
        assert_eq!(stats.counts.samples.films, 10);
        let whole = radiance(&films);
        // Room for some films at once, for one, in another order, and one after the other.
        let picture = 48 * 30 * 200;
        for (frames, budget) in [(vec![0, 1, 2, 3, 4, 5, 6, 7, 8, 9], 4 * picture), (vec![7, 2, 9], 0)] {
            let some = radiance(&planned(&sequence, &frames, budget).0);
            for (frame, film) in frames.iter().zip(some) {
                assert!(film == whole[*frame as usize], "{quality}: frame {frame} of {frames:?}");
            }
        }
        let mut alone = frame_loop(&sequence, AovSet::default());
        alone.frame(4).unwrap_or_else(|fault| panic!("{fault:?}"));
        let alone = alone.into_sink().expect("the sink").0;
        assert!(radiance(&alone)[0] == whole[4], "{quality}");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        let single = pool.install(|| planned(&sequence, &all_frames(&sequence), u64::MAX).0);
        assert!(radiance(&single) == whole, "{quality}: threads");
    }
}

/// The mean errors of frames alone and of frames that share samples, against a long reference.
fn mean_errors(sequence: &Sequence) -> [f64; 2] {
    let frames: Vec<u32> = (0..sequence.timeline.frames).step_by(8).collect();
    let truth = reference(sequence, &frames);
    [SampleReuse::Off, SampleReuse::Zoom].map(|reuse| {
        let films = planned(&with_reuse(sequence, reuse), &frames, u64::MAX).0;
        mean(&errors(&radiance(&films), &truth))
    })
}

/// On average over a zoom or a turn, frames that share samples are no worse than those with samples of their own.
#[test]
fn errors_are_no_larger_than_frame_by_frame() {
    let pan = "path: Keys(target: [(0, (-1.5, 0.7, 0)), (47, (1.5, 0.9, 0))])";
    let roll = "path: Zoom(factor: [(0, 1), (47, 1.2)]), roll: [(0, 0), (47, 40)]";
    for (quality, camera) in [("antialias: 2", ZOOM), ("antialias: 2", pan), ("antialias: 3", roll)] {
        let [alone, shared] = mean_errors(&grid_scene(quality, camera, 48));
        assert!(shared <= alone, "{quality} {camera}: {shared} {alone}");
    }
    for camera in [ZOOM, pan] {
        let [alone, shared] = mean_errors(&scene(PATHS, camera, 48));
        assert!(shared <= alone, "{camera}: {shared} {alone}");
    }
}

/// Slow zooms of small pictures, in which most pixels are at an edge, and slow turns.
#[test]
fn edges_of_slow_motions_are_shared_and_hardly_worse_than_frame_by_frame() {
    let zoom = "path: Zoom(factor: [(0, 1), (23, 4)])";
    let slow = "path: Zoom(factor: [(0, 1), (23, 1.1)])";
    let pan = "path: Keys(target: [(0, (0.2, 0.7, 0)), (23, (0.5, 0.7, 0))])";
    for (size, quality, camera) in [
        ((1, 1), "antialias: 8", zoom),
        ((40, 2), "antialias: 4", zoom),
        ((1, 30), "antialias: 4", slow),
        ((48, 27), "antialias: 4", slow),
        ((48, 27), "antialias: 2", pan),
    ] {
        let mut sequence = grid_scene(quality, camera, 24);
        sequence.output.size = size;
        let [alone, shared] = mean_errors(&sequence);
        let own = with_reuse(&sequence, SampleReuse::Zoom);
        let counts = planned(&own, &all_frames(&own), u64::MAX).1.counts;
        // A single pixel may be right by chance. Without samples at its edges, it is wrong by 0.03.
        let chance = if size == (1, 1) { 0.01 } else { 0.0 };
        assert!(shared <= 1.5 * alone + chance, "{size:?} {camera}: {shared} {alone}");
        assert_eq!(counts.samples.films, 24, "{size:?} {camera}");
        // Samples for one film only are few beside those that the films would take alone.
        assert!(counts.samples.own * 10 <= counts.samples.alone, "{size:?} {camera}: {counts:?}");
    }
}

/// The mean over many seeds is that of a long reference: the ratio of sums is hardly biased.
#[test]
fn the_mean_over_seeds_is_the_truth() {
    let sequence = scene("integrator: Path, bounces: 1, samples: 2", ZOOM, 48);
    let frames = [0, 20, 44];
    let truth = reference(&sequence, &frames);
    const SEEDS: u32 = 32;
    let mut sums = vec![vec![Rgb::ZERO; 48 * 30]; frames.len()];
    let mut single = Vec::new();
    for seed in 0..SEEDS {
        let mut sequence = with_reuse(&sequence, SampleReuse::Zoom);
        sequence.quality.seed = seed;
        let films = radiance(&planned(&sequence, &frames, u64::MAX).0);
        single.push(mean(&errors(&films, &truth)));
        for (sum, film) in sums.iter_mut().zip(films) {
            sum.iter_mut().zip(film).for_each(|(sum, light)| *sum += light / SEEDS as f32);
        }
    }
    let (bias, single) = (mean(&errors(&sums, &truth)), mean(&single));
    // Independent errors fall by the root of the number of seeds.
    assert!(bias < 1.25 * single / f64::from(SEEDS).sqrt(), "{bias} of {single}");
}

/// A run that is stopped after films were traced together keeps them, and does not go on to the frames that repeat the
/// last one. A run that is stopped while they are traced has none.
#[test]
fn stopped_runs_keep_the_films_that_are_there() {
    let held = "path: Zoom(factor: [(0, 1, Step), (4, 1.3, Step), (8, 1.6, Step)])";
    for (camera, done) in [(ZOOM, 12), (held, 9)] {
        let sequence = with_reuse(&grid_scene("antialias: 2", camera, 12), SampleReuse::Zoom);
        let plan = Plan::new(&sequence, &all_frames(&sequence), AovSet::default(), u64::MAX);
        let mut frames = frame_loop(&sequence, AovSet::default());
        // The run asks once before it traces.
        let asked = AtomicUsize::new(0);
        let on = || asked.fetch_add(1, Relaxed) == 0;
        assert_eq!(plan::run(&plan, &mut frames, on).unwrap_or_else(|fault| panic!("{fault:?}")), done);
        assert_eq!(frames.into_sink().expect("the sink").0.len(), done);
    }
    let sequence = with_reuse(&grid_scene("antialias: 2", ZOOM, 12), SampleReuse::Zoom);
    for budget in [0, u64::MAX] {
        let plan = Plan::new(&sequence, &all_frames(&sequence), AovSet::default(), budget);
        let meter = Arc::new(ProgressMeter::default());
        let stop = Stop::default();
        stop.flag().store(2, Relaxed);
        meter.stop.set(stop).expect("no stop yet");
        let mut frames = FrameLoop::with_aovs(&sequence, AovSet::default(), Films::default(), meter);
        assert_eq!(plan::run(&plan, &mut frames, || true).unwrap_or_else(|fault| panic!("{fault:?}")), 0);
        assert_eq!(frames.stats().counts.rays.camera, 0);
    }
}

#[test]
fn what_cannot_share_samples_is_as_without() {
    let orbit = "path: Orbit(turns: 1)";
    let whip = "path: Orbit(turns: 0)";
    let lens = "path: Zoom(factor: [(0, 1), (3, 2)]), aperture: 0.1";
    for (quality, camera) in [("antialias: 2", orbit), ("antialias: 2", whip), (PATHS, lens)] {
        let sequence = scene(quality, camera, 4);
        let of = |reuse| planned(&with_reuse(&sequence, reuse), &[0, 1, 2, 3], u64::MAX);
        let ((alone, ..), (shared, stats, _)) = (of(SampleReuse::Off), of(SampleReuse::Zoom));
        assert!(radiance(&alone) == radiance(&shared), "{camera}");
        assert_eq!(stats.counts.samples.films, 0);
    }
    // Patterns fade by the size of pixels.
    let patterned = sequence(
        "(timeline: (frames: 4, keys: Frames), output: (size: (12, 8)), quality: (reuse: Zoom),
        camera: (position: (0, 2, 6), target: (0, 0, 0), path: Zoom(factor: [(0, 1), (3, 1.3)])),
        objects: {\"floor\": (shape: Plane(), material: (color: Checker(a: 0, b: 1)))})",
    );
    assert_eq!(planned(&patterned, &[0, 1, 2, 3], u64::MAX).1.counts.samples.films, 0);
    let mut sequence = with_reuse(&scene(PATHS, ZOOM, 2), SampleReuse::Zoom);
    sequence.quality.noise = Some(NoiseTarget { error: 0.5, most: 16 });
    assert_eq!(planned(&sequence, &[0, 1], u64::MAX).1.counts.samples.films, 0);
}

/// Depths, normals, albedo and coverage are those of the frame, whichever view traced them.
#[test]
fn aovs_belong_to_the_frame() {
    let mut sequence =
        grid_scene("antialias: 8", "path: Keys(target: [(0, (-2, 0.7, 0)), (3, (1, 0.9, 0))])", 4);
    sequence.output.transparent = true;
    let aovs = AovSet { coverage: true, features: true, guides: false, samples: false };
    let of = |reuse| {
        let mut frames = frame_loop(&with_reuse(&sequence, reuse), aovs);
        (0..4).try_for_each(|frame| frames.frame(frame)).unwrap_or_else(|fault| panic!("{fault:?}"));
        frames.into_sink().expect("the sink").0
    };
    for ((_, alone), (_, shared)) in of(SampleReuse::Off).iter().zip(&of(SampleReuse::Zoom)) {
        let (mut worst, mut pixels) = (0.0_f32, 0);
        for pixel in 0..48 * 30 {
            let features = [alone, shared].map(|film| film.features_at(pixel).expect("features"));
            let alphas = [alone, shared].map(|film| film.alpha_at(pixel));
            assert!((alphas[0] - alphas[1]).abs() < 0.2, "{alphas:?}");
            // Inside of surfaces, where depth varies little.
            if let [Some(a), Some(b)] = features.map(|features| features.depth)
                && alphas == [1.0, 1.0]
                && features[0].normal.dot(features[1].normal) > 0.9999
            {
                (worst, pixels) = (worst.max((a / b - 1.0).abs()), pixels + 1);
            }
        }
        assert!(pixels > 300 && worst < 0.05, "{pixels} {worst}");
    }
}

/// Processes that share frames claim all views of a zoom together: each view's samples are traced once.
#[test]
fn claimed_frames_share_samples() {
    let sequence = with_reuse(&grid_scene("antialias: 2", ZOOM, 12), SampleReuse::Zoom);
    let rays = |existing: Existing, reuse: Reuse| {
        let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
        let request = Request {
            frames: all_frames(&sequence),
            outputs: vec![Output::parse(folder.path().join("##.png")).expect("an output")],
            confined: false,
            existing,
            threads: None,
            reuse,
            time_limit: None,
        };
        let summary = render(&sequence, &request, &Arc::default()).unwrap_or_else(|error| panic!("{error}"));
        summary.counts.rays.camera
    };
    let together = rays(Existing::Replace, Reuse::Share);
    assert_eq!(rays(Existing::Share, Reuse::Share), together);
    assert!(rays(Existing::Replace, Reuse::Off) > 2 * together);
}
