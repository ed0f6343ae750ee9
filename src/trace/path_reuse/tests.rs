//! Frames that share paths have the bytes of frames that are traced alone.

use super::*;
use crate::base::math::{DAffine3, DVec3};
use crate::film::filter::FilterSampler;
use crate::scene::{Geometry, Primitive, Shading, Weights};
use crate::sequence::quality::Quality;
use crate::testing::Random;
use crate::trace::random_scene::RandomScene;
use crate::trace::{trace, trace_moment};

/// The scene of a frame at a moment.
struct Posed {
    frame: usize,
    moment: Moment,
    geometry: Geometry,
    shading: Shading,
    bvh: Bvh,
}

/// The poses of some frames of a random scene: objects move, vanish, and take other materials.
fn poses(scene: &RandomScene, random: &mut Random, frames: usize, moments: u32) -> Vec<Posed> {
    let (still, shading) = scene.content();
    let slots: Vec<usize> = (0..still.primitives.len()).collect();
    let movable = |slot: &usize| {
        let primitive = &still.primitives[*slot];
        primitive.transform.is_none() && !primitive.is_light()
    };
    let movable: Vec<usize> = slots.into_iter().filter(movable).collect();
    let share = [0.05, 0.1, 0.2, 1.0][(random.unit() * 4.0) as usize];
    let mut moves: Vec<usize> = movable.iter().copied().filter(|_| random.unit() < share).collect();
    moves.extend(movable.last().filter(|_| share < 1.0));
    let mut all = Vec::new();
    for frame in 0..frames {
        let of = if frame % 3 == 2 { 1 } else { moments };
        let hidden: Vec<bool> = moves.iter().map(|_| random.unit() < 0.15).collect();
        let mut shading = shading.clone();
        if random.unit() < 0.3 {
            shading.materials.reverse();
        }
        for index in 0..of {
            let mut geometry = still.clone();
            for (slot, hidden) in moves.iter().zip(&hidden) {
                let primitive = still.primitives[*slot].clone();
                let moved = motion(&primitive, random, if share < 1.0 { 0.25 } else { 1.0 });
                let content = (&primitive.shape, moved, primitive.finish);
                geometry.set(*slot, (!hidden).then_some(content));
            }
            let bvh = Bvh::build(&geometry);
            all.push(Posed { frame, moment: Moment { index, of }, geometry, shading: shading.clone(), bvh });
        }
    }
    all
}

/// A motion that scales a primitive about its centre.
fn motion(primitive: &Primitive, random: &mut Random, scale: f64) -> DAffine3 {
    let center = primitive.bounds().map_or(DVec3::ZERO, |bounds| bounds.center());
    let by = random.point(0.4) * DVec3::new(1.0, 1.0, 0.5);
    DAffine3::from_translation(center + by)
        * DAffine3::from_scale(DVec3::splat(scale))
        * DAffine3::from_translation(-center)
}

/// Traces a frame alone.
fn alone(poses: &[FramePose], settings: &TraceSettings) -> (Film, Counts) {
    let meter = ProgressMeter::default();
    let [first, ..] = poses else { panic!("a frame without moments") };
    if first.moment == Moment::ONLY {
        return trace(&first.scene, first.bvh, settings, &meter);
    }
    let (width, height) = settings.size;
    let mut film = Film::with_aovs(width, height, first.scene.weights.0.clone(), settings.aovs);
    let mut sums = vec![DVec3::ZERO; film.data.len()];
    let mut counts = Counts::default();
    for pose in poses {
        counts += trace_moment(&pose.scene, pose.bvh, settings, pose.moment, &mut sums, &meter);
    }
    film.data_mut().iter_mut().zip(&sums).for_each(|(layer, sum)| *layer = sum.as_vec3());
    (film, counts)
}

/// What became of a random scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// Frames cannot share paths.
    Alone,
    /// Share of paths that were traced again, in percent, where all had to be shared.
    Shared(u64),
    /// Share of paths that were traced frame by frame, in percent, where that was less work.
    Judged(u64),
}

fn compare(seed: u64, scene: &RandomScene, moments: u32) -> Outcome {
    let random = &mut Random(seed + 5000);
    let posed = poses(scene, random, 7, moments);
    let (camera, quality, aovs, layers) = scene.settings();
    let filter = FilterSampler::new(quality.filter);
    let quality = Quality { samples: quality.samples.max(2), ..quality };
    let settings = TraceSettings { size: (61, 37), quality, filter, aovs, first_sample: 0 };
    let weights = Weights(vec![Rgb::ONE; layers]);
    let all: Vec<FramePose> = posed
        .iter()
        .map(|posed| FramePose {
            frame: posed.frame,
            moment: posed.moment,
            scene: Scene {
                geometry: &posed.geometry,
                shading: &posed.shading,
                weights: &weights,
                camera: &camera,
            },
            bvh: &posed.bvh,
        })
        .collect();
    if !all.iter().all(|pose| pose.obstacle(&all[0], &settings).is_none()) {
        return Outcome::Alone;
    }
    let mut shared = SharedFrames::new(&all, &settings);
    // Every third scene in small parts of samples and pixels.
    if seed.is_multiple_of(3) {
        shared.limits = Limits { values: 48, sums: 100, ..shared.limits };
    }
    // Every second one shares all paths, whether that gains or not: most random scenes move everywhere.
    let is_forced = seed.is_multiple_of(2);
    if is_forced {
        shared.limits.gain = 0.0;
    }
    let (mut films, mut sum) = (Vec::new(), Counts::default());
    let traced = shared.trace(&ProgressMeter::default(), &mut |film, counts| {
        films.push(film);
        sum += counts;
        Ok::<(), ()>(())
    });
    let counts = traced.expect("no error").expect("no stop");
    assert_eq!(sum, counts);
    for (frame, film) in films.iter().enumerate() {
        let own: Vec<FramePose> = all.iter().filter(|pose| pose.frame == frame).copied().collect();
        let (expected, _) = alone(&own, &settings);
        let differing = film
            .data
            .iter()
            .zip(expected.data.iter())
            .filter(|(a, b)| a.to_array().map(f32::to_bits) != b.to_array().map(f32::to_bits));
        let differing = differing.count();
        assert!(
            differing == 0,
            "seed {seed}, frame {frame}: {differing} of {} values differ",
            film.data.len()
        );
    }
    assert_eq!(counts.paths.all % (7 * 61 * 37), 0);
    let percent = |paths: u64| 100 * paths / counts.paths.all;
    match is_forced {
        true => Outcome::Shared(percent(counts.paths.retraced)),
        false => Outcome::Judged(percent(counts.paths.whole)),
    }
}

/// Compares random scenes, and tests that paths were shared in enough of them.
fn compare_all(seeds: std::ops::Range<u64>, moments: u32, scene: impl Fn(u64) -> RandomScene) {
    let outcomes: Vec<Outcome> = seeds.map(|seed| compare(seed, &scene(seed), moments)).collect();
    // Half of the scenes have to share paths. Of these, one in twelve has few enough paths that are traced again.
    let useful = |outcome: &&Outcome| matches!(outcome, Outcome::Shared(0..=80));
    let useful = outcomes.iter().filter(useful).count();
    assert!(useful * 12 >= outcomes.len() / 2, "{outcomes:?}");
    let partly = |outcome: &Outcome| matches!(outcome, Outcome::Judged(1..=99));
    assert!(outcomes.iter().any(partly), "{outcomes:?}");
}

/// However many poses there are, a thread has one scratch buffer for all of them.
#[test]
fn poses_take_turns_with_a_scratch_buffer() {
    let scene = RandomScene::new(2);
    let posed = poses(&scene, &mut Random(5002), 7, 3);
    let (camera, quality, aovs, layers) = scene.settings();
    let filter = FilterSampler::new(quality.filter);
    let settings = TraceSettings { size: (61, 37), quality, filter, aovs, first_sample: 0 };
    let weights = Weights(vec![Rgb::ONE; layers]);
    let pool = Arc::new(ScratchPool::default());
    let scenes: Vec<Scene> = posed
        .iter()
        .map(|posed| Scene {
            geometry: &posed.geometry,
            shading: &posed.shading,
            weights: &weights,
            camera: &camera,
        })
        .collect();
    for (number, (posed, scene)) in (0..).zip(posed.iter().zip(&scenes)) {
        let own = PixelTracer::new(scene, &posed.bvh, &settings, posed.moment);
        let pooled = PixelTracer::new(scene, &posed.bvh, &settings, posed.moment).with_pool(&pool, number);
        let pixels: Vec<(u32, u32)> = (0..61).map(|x| (x, 20)).collect();
        let traced = [own, pooled].map(|tracer| {
            let mut sums = vec![DVec3::ZERO; pixels.len() * tracer.layers()];
            let counts = tracer.trace(&pixels, &mut sums);
            (sums.iter().map(|sum| sum.to_array().map(f64::to_bits)).collect::<Vec<_>>(), counts)
        });
        assert!(traced[0] == traced[1], "{number}");
        assert_eq!(pool.len(), 1);
    }
}

#[test]
fn whitted_frames_are_the_same() {
    compare_all(0..60, 1, RandomScene::new);
}

#[test]
fn path_traced_frames_are_the_same() {
    compare_all(0..60, 1, RandomScene::of_paths);
}

#[test]
fn frames_of_everything_are_the_same() {
    compare_all(0..80, 1, RandomScene::of_everything);
}

#[test]
fn frames_with_open_shutters_are_the_same() {
    compare_all(0..40, 3, RandomScene::of_everything);
}
