//! Nothing is traced twice, and no picture shows it: a frame made of the film of another frame has the bytes that it has
//! by itself.

use crate::support::{Random, sequence, shoot};
use kinora::base::clock::TimeSource;
use kinora::base::digest::Digest;
use kinora::base::stats::ProgressMeter;
use kinora::encode::{EncodeError, Existing, Output};
use kinora::film::{AovSet, Film};
use kinora::pipeline::plan::{self, PilotBudget, PilotTime, Plan, evaluate, run_pilot};
use kinora::pipeline::render::{Request, Reuse, Summary, render};
use kinora::pipeline::schedule::{FilmSink, FrameLoop, Stats};
use kinora::sequence::Sequence;
use kinora::sequence::quality::NoiseTarget;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// What frames show, to the bit.
#[derive(Default)]
struct Shown(Vec<(u32, Vec<[u32; 3]>, u32)>);

impl FilmSink for Shown {
    fn push(&mut self, frame: u32, film: Film) -> Result<(), EncodeError> {
        let pixels = film.radiance().map(|radiance| radiance.to_array().map(f32::to_bits)).collect();
        self.0.push((frame, pixels, film.exposure.to_bits()));
        Ok(())
    }
}

fn frame_loop(sequence: &Sequence) -> FrameLoop<Shown> {
    FrameLoop::new(sequence, Shown::default(), Arc::new(ProgressMeter::default()))
}

/// Frames by a plan with room for so many bytes of films.
fn planned(sequence: &Sequence, frames: &[u32], budget: u64) -> (Shown, Stats, Plan) {
    let plan = Plan::new(sequence, frames, AovSet::default(), budget);
    let (shown, tally) = run(sequence, &plan);
    (shown, tally, plan)
}

/// Runs a plan.
fn run(sequence: &Sequence, plan: &Plan) -> (Shown, Stats) {
    let mut frames = frame_loop(sequence);
    plan::run(plan, &mut frames, || true).unwrap_or_else(|fault| panic!("{fault:?}"));
    let tally = frames.stats().clone();
    (frames.into_sink().expect("the sink"), tally)
}

/// Frames one by one.
fn alone(sequence: &Sequence, frames: &[u32]) -> (Shown, Stats) {
    let mut all = frame_loop(sequence);
    frames.iter().for_each(|&frame| all.frame(frame).unwrap_or_else(|fault| panic!("{fault:?}")));
    let tally = all.stats().clone();
    (all.into_sink().expect("the sink"), tally)
}

#[track_caller]
fn same(one: &Shown, other: &Shown, what: &str) {
    assert_eq!(one.0.len(), other.0.len());
    for (a, b) in one.0.iter().zip(&other.0) {
        assert!(a == b, "{what}: frame {} differs", a.0);
    }
}

/// Keys at random frames; values are those of `value`.
fn keys(random: &mut Random, frames: u32, mut value: impl FnMut(&mut Random) -> String) -> String {
    let mut keys = String::new();
    let mut frame = 0;
    while frame < frames {
        let ease = ["", ", Step", ", Smooth"][(3.0 * random.unit()) as usize];
        _ = write!(keys, "({frame}, {}{ease}), ", value(random));
        frame += 1 + (4.0 * random.unit()) as u32;
    }
    format!("[{keys}]")
}

fn number(random: &mut Random) -> String {
    let value = (2.0 * random.unit() - 0.6).max(0.0);
    format!("{value:.3}")
}

fn color(random: &mut Random) -> String {
    let mut part = || (1.3 * random.unit() - 0.3).max(0.0);
    format!("({:.3}, {:.3}, {:.3})", part(), part(), part())
}

const FRAMES: u32 = 10;

/// A sequence of a few things and lights, of which lights are keyed at random, and other things now and then.
fn random_sequence(seed: u64) -> Sequence {
    let mut random = Random(seed);
    let mut chance = |share: f64| random.unit() < share;
    let (paths, moves, orbits, blurs) = (chance(0.5), chance(0.25), chance(0.15), chance(0.2));
    let (fog, glass, clamp, lens) = (chance(0.3), chance(0.4), chance(0.2), chance(0.2));
    let mut lights = String::new();
    for index in 0..2 + (4.0 * random.unit()) as usize {
        let at = random.point(3.0);
        let place = format!("({:.2}, {:.2}, {:.2})", at.x, 3.5 + at.y.abs(), at.z);
        let kind = match (5.0 * random.unit()) as u32 {
            0 => format!("Spot(position: {place}, angle: 80"),
            1 => format!("Directional(direction: (-{:.2}, -3, 1)", random.unit()),
            2 => format!("Sphere(center: {place}, radius: 0.4"),
            3 => format!("Rectangle(corner: {place}, u: (1, 0, 0), v: (0, 0, 1)"),
            _ => format!("Point(position: {place}"),
        };
        let mut tracks = String::new();
        if random.unit() < 0.6 {
            _ = write!(tracks, ", intensity: {}", keys(&mut random, FRAMES, number));
        }
        if random.unit() < 0.4 {
            let switch = |random: &mut Random| (random.unit() < 0.5).to_string();
            _ = write!(tracks, ", on: {}", keys(&mut random, FRAMES, switch).replace(", Smooth", ""));
        }
        if random.unit() < 0.3 {
            _ = write!(tracks, ", color: {}", keys(&mut random, FRAMES, color));
        }
        _ = writeln!(lights, "\"{index}\": {kind}{tracks}),");
    }
    let mut when = |on: bool, text: &str| {
        if on { text.replace("KEYS", &keys(&mut random, FRAMES, number)) } else { String::new() }
    };
    let background = when(seed.is_multiple_of(3), "background: KEYS,");
    let ambient = when(seed % 4 == 1, "ambient: KEYS,");
    let fog = when(fog, "fog: (density: 0.05, color: KEYS),");
    let emission = when(seed.is_multiple_of(2), "emission: KEYS,");
    let exposure = when(seed.is_multiple_of(5), "exposure: KEYS,");
    let moves = when(moves, "translation: [(3, (0, 0, 0)), (6, (0.5, 0, 0))],");
    let glass = when(
        glass,
        "\"glass\": (shape: Sphere(center: (1.2, 0.6, 1), radius: 0.6), material: Dielectric()),",
    );
    let integrator = if paths {
        "integrator: Path, bounces: 3, samples: 3,"
    } else {
        "bounces: 3, antialias: 1, samples: 3,"
    };
    let clamp = if clamp { "clamp: 2," } else { "" };
    let camera = [
        if orbits { "path: Orbit(azimuth: [(0, 0), (2, 20), (8, 20), (9, 0)])," } else { "" },
        if blurs { "shutter: [(0, 0.5, Step), (5, 0)]," } else { "" },
        if lens { "aperture: [(0, 0, Step), (5, 0.1)]," } else { "" },
    ]
    .concat();
    sequence(&format!(
        r#"(timeline: (frames: {FRAMES}, keys: Frames), output: (size: (14, 10), {exposure}),
        quality: ({integrator} {clamp} shutter_steps: 4), {background} {ambient} {fog}
        camera: (position: (0, 2, 8), target: (0, 0.8, 0), {camera}),
        lights: {{ {lights} }},
        objects: {{
            "floor": (shape: Plane(), material: (color: 0.6, mirror: 0.2)),
            "ball": (shape: Sphere(center: (-1, 0.8, 0), radius: 0.8), material: (color: 0.5, specular: 0.4), {moves}),
            "bulb": (shape: Sphere(center: (0.2, 0.3, 1.5), radius: 0.3), material: ({emission} color: 0.3)),
            {glass}
        }})"#
    ))
}

/// Lights keyed at random: each frame made of whatever film is the frame by itself, with much room, with little, with
/// none, backwards and of some frames alone.
#[test]
fn reuse_never_shows() {
    let (mut reused, mut rays, mut rays_alone) = (0, 0, 0);
    for seed in 0..48 {
        let sequence = random_sequence(seed);
        let frames: Vec<u32> = (0..FRAMES).collect();
        let (wanted, tally_alone) = alone(&sequence, &frames);
        let film = 14 * 10 * 12;
        for budget in [u64::MAX, 3 * film, film, 0] {
            let (shown, tally, plan) = planned(&sequence, &frames, budget);
            same(&shown, &wanted, &format!("seed {seed} with {budget} bytes"));
            assert_eq!(tally.reused as usize, plan.reused(), "seed {seed}");
            assert!(plan.kept_bytes() <= budget, "seed {seed}: {} of {budget}", plan.kept_bytes());
            assert!(tally.counts.rays.total() <= tally_alone.counts.rays.total() || budget < u64::MAX);
            if budget == u64::MAX {
                reused += tally.reused;
                rays += tally.counts.rays.total();
                rays_alone += tally_alone.counts.rays.total();
            }
        }
        let some: Vec<u32> =
            frames.iter().rev().copied().filter(|frame| frame % 3 != 1).chain([4, 4]).collect();
        let (shown, _, _) = planned(&sequence, &some, u64::MAX);
        same(&shown, &alone(&sequence, &some).0, &format!("seed {seed} backwards"));
        for frame in &shown.0 {
            assert!(wanted.0.contains(frame), "seed {seed}: frame {} backwards", frame.0);
        }
    }
    assert!(reused > 150 && 2 * rays < rays_alone, "{reused} frames reused, {rays} rays of {rays_alone}");
}

/// Every file of a render: stills, 16 bits and linear, and animations.
fn files(sequence: &Sequence, frames: &[u32], reuse: Reuse) -> (BTreeMap<String, Vec<u8>>, Summary) {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let output = |name: &str| Output::parse(folder.path().join(name)).expect("an output");
    let outputs = ["##.png", "##.exr", "all.gif", "all.apng"].map(output).to_vec();
    let request = Request {
        frames: frames.to_vec(),
        outputs,
        confined: false,
        existing: Existing::Replace,
        threads: None,
        reuse,
        time_limit: None,
    };
    let summary = render(sequence, &request, &Arc::default()).unwrap_or_else(|error| panic!("{error}"));
    let entries = fs::read_dir(folder.path()).expect("the folder is readable").flatten();
    let read = |entry: fs::DirEntry| {
        (entry.file_name().to_string_lossy().into_owned(), fs::read(entry.path()).expect("a file"))
    };
    (entries.map(read).collect(), summary)
}

#[test]
fn files_are_the_same_to_the_byte() {
    for seed in [2, 5, 8] {
        let mut sequence = random_sequence(seed);
        sequence.output.formats.exr.layers.lights = true;
        sequence.output.formats.exr.layers.depth = true;
        sequence.output.transparent = seed == 5;
        let frames: Vec<u32> = (0..FRAMES).collect();
        let (wanted, without) = files(&sequence, &frames, Reuse::Off);
        let (found, with) = files(&sequence, &frames, Reuse::Share);
        assert!(found == wanted, "seed {seed}");
        assert_eq!((wanted.len(), without.reused), (2 * FRAMES as usize + 2, 0));
        assert_eq!(with.expected.map(|expected| expected.reused), Some(with.reused));
        // Two shards.
        let (even, odd): (Vec<u32>, Vec<u32>) = frames.iter().partition(|frame| *frame % 2 == 0);
        for part in [even, odd] {
            for (name, bytes) in files(&sequence, &part, Reuse::Within(1 << 20)).0 {
                assert!(name.starts_with("all") || wanted[&name] == bytes, "seed {seed}: {name}");
            }
        }
    }
}

fn shipped(name: &str) -> Sequence {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("sequences").join(name);
    let mut sequence = kinora::sequence::load(&path).unwrap_or_else(|error| panic!("{error}"));
    sequence.output.size = (24, 18);
    sequence.quality.samples = 4;
    sequence
}

/// 48 frames with three keyed lights, by both integrators.
#[test]
fn light_choreography_takes_a_25th_of_the_rays() {
    for integrator in ["Whitted", "Path"] {
        let sequence = sequence(&format!(
            r#"(timeline: (frames: 48, keys: Frames), output: (size: (32, 24)), quality: (integrator: {integrator}, samples: 4),
            lights: {{
                "a": Point(position: (3, 5, 4), on: [(0, true), (16, false), (30, true)]),
                "b": Point(position: (-4, 3, 4), intensity: [(0, 0.1), (24, 1), (47, 0.3)]),
                "c": Point(position: (0, 6, 1), color: [(0, (1, 0, 0)), (47, (0, 0.5, 1))]),
            }},
            objects: {{ "floor": (shape: Plane(), material: (mirror: 0.2)), "ball": (shape: Sphere(center: (0, 1, 0))) }})"#
        ));
        let frames: Vec<u32> = (0..48).collect();
        let (wanted, tally_alone) = alone(&sequence, &frames);
        let (shown, tally, plan) = planned(&sequence, &frames, u64::MAX);
        same(&shown, &wanted, integrator);
        assert_eq!((plan.films.len(), tally.traced, tally.reused), (1, 1, 47));
        let ratio = tally_alone.counts.rays.total() as f64 / tally.counts.rays.total() as f64;
        assert!(ratio >= 25.0, "{integrator}: {ratio} times fewer rays");
    }
}

/// A room with a mirror, glass and a matt floor, in which a small ball moves, a lamp fades, and a plate changes its
/// colour.
fn moving(quality: &str, camera: &str) -> Sequence {
    sequence(&format!(
        r#"(timeline: (frames: 12, keys: Frames), output: (size: (48, 36)), quality: ({quality} shutter_steps: 4),
        background: 0.3,
        camera: (position: (0, 2, 8), target: (0, 0.8, 0), {camera}),
        lights: {{ "lamp": Point(position: (3, 6, 4), intensity: [(0, 1), (11, 0.2)]),
            "other": Point(position: (-4, 5, 3), on: [(0, true), (5, false)]) }},
        objects: {{
            "floor": (shape: Plane(), material: (color: 0.6)),
            "mirror": (shape: Rectangle(corner: (-3, 0, -2), u: (2, 0, 0), v: (0, 2, 0)), material: (mirror: 0.8)),
            "glass": (shape: Sphere(center: (1.5, 0.6, 1), radius: 0.6), material: Dielectric()),
            "ball": (shape: Sphere(radius: 0.2), translation: [(0, (-2, 0.2, 0)), (9, (2, 0.4, -1))],
                visible: [(0, true), (4, false), (5, true)], material: (specular: 0.5)),
            "plate": (shape: Disk(center: (2, 0.01, 2), radius: 0.4), material: (color: [(0, 0.1, Step), (6, 0.9)])),
        }})"#
    ))
}

/// Frames in which little moves share most of their paths, and have the bytes that they have alone.
#[test]
fn moving_objects_share_paths() {
    let frames: Vec<u32> = (0..12).collect();
    for quality in [
        "bounces: 3, antialias: 2,",
        "integrator: Path, bounces: 3, samples: 4,",
        "integrator: Path, bounces: 2, samples: 5, clamp: 1,",
    ] {
        let sequence = moving(quality, "");
        let (wanted, without) = alone(&sequence, &frames);
        let (shown, with, plan) = planned(&sequence, &frames, u64::MAX);
        same(&shown, &wanted, quality);
        let paths = with.counts.paths;
        assert_eq!((with.traced, without.traced), (plan.films.len() as u32, 12), "{quality}");
        assert_eq!(without.counts.paths.all, 0);
        assert!(paths.reused() > 3 * paths.retraced && paths.retraced > 0, "{quality}: {paths:?}");
        // Nearly every path is traced once for all frames, and again for some.
        let frames_of = u64::from(with.traced);
        assert_eq!(paths.once * frames_of + paths.whole, paths.all, "{quality}");
        assert!(10 * paths.whole < paths.all, "{quality}: {paths:?}");
        assert_eq!(with.counts.rays.camera, paths.once + paths.retraced + paths.whole, "{quality}");
        assert_eq!(with.bvh_builds + with.bvh_refits, plan.bvh_updates());
        assert!(3 * with.counts.rays.total() < without.counts.rays.total(), "{quality}");
        let some = [9, 2, 3, 11];
        same(&planned(&sequence, &some, u64::MAX).0, &alone(&sequence, &some).0, "some frames");
        // Without room for several films, each is traced alone.
        let (shown, with, _) = planned(&sequence, &frames, 0);
        same(&shown, &wanted, quality);
        assert_eq!(with.counts.rays, without.counts.rays);
        let pool =
            |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let [(one, a), (three, b)] = [1, 3].map(|threads| {
            let (shown, stats, _) = pool(threads).install(|| planned(&sequence, &frames, u64::MAX));
            (shown, stats.counts)
        });
        same(&one, &three, "threads");
        assert_eq!(a, b, "threads");
    }
}

/// The still half of a picture is traced once for all frames, although the other half moves in each of them.
#[test]
fn the_still_half_of_a_picture_is_shared() {
    let sequence = sequence(
        r#"(timeline: (frames: 12, keys: Frames), output: (size: (128, 64)), quality: (bounces: 2, antialias: 1),
        camera: (position: (0, 0, 8), target: (0, 0, 0), projection: Orthographic(height: 2)),
        lights: { "lamp": Point(position: (0, 0, 9)) }, background: 0.2,
        objects: {
            "still": (shape: Box(min: (-2, -1, -1), max: (0, 1, 0)), material: (specular: 0.3)),
            "moving": (shape: Box(min: (0.2, -1, -1), max: (2, 1, 0)), translation: [(0, (0, 0, 0)), (11, (0, 0, 0.3))]),
        })"#,
    );
    let frames: Vec<u32> = (0..12).collect();
    let (wanted, without) = alone(&sequence, &frames);
    let (shown, with, _) = planned(&sequence, &frames, u64::MAX);
    same(&shown, &wanted, "half of the picture");
    let paths = with.counts.paths;
    // Tiles of the other half are tried by 16 of their 256 pixels.
    assert!(10 * paths.whole > 4 * paths.all && 10 * paths.whole < 5 * paths.all, "{paths:?}");
    assert!(10 * with.counts.rays.total() < 6 * without.counts.rays.total(), "{:?}", with.counts);
}

/// A run that is stopped pushes films that were traced together, but not the frames that repeat the last of them.
#[test]
fn a_stop_leaves_out_frames_that_repeat_a_film() {
    let sequence = sequence(
        r#"(timeline: (frames: 40, keys: Frames), output: (size: (48, 36)), quality: (antialias: 2),
        objects: { "ball": (shape: Sphere(radius: 0.3), translation: [(0, (-1, 0, 0)), (4, (1, 0, 0))]),
            "wall": (shape: Box(min: (-3, -3, -3), max: (3, 3, -2))) })"#,
    );
    let plan = Plan::new(&sequence, &(0..40).collect::<Vec<_>>(), AovSet::default(), u64::MAX);
    assert_eq!(plan.films.len(), 5);
    let (mut frames, asked) = (frame_loop(&sequence), std::cell::Cell::new(0));
    let on = || asked.replace(asked.get() + 1) == 0;
    let done = plan::run(&plan, &mut frames, on).unwrap_or_else(|fault| panic!("{fault:?}"));
    assert_eq!(done, 5);
    let pushed = frames.into_sink().expect("the sink").0;
    assert_eq!(pushed.iter().map(|(frame, ..)| *frame).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
}

/// Every moment of an open shutter is a pose of its own.
#[test]
fn blurred_objects_share_paths() {
    let sequence = moving("integrator: Path, bounces: 2, samples: 8,", "shutter: 0.5,");
    let frames: Vec<u32> = (0..12).collect();
    let (shown, with, _) = planned(&sequence, &frames, u64::MAX);
    let (wanted, without) = alone(&sequence, &frames);
    same(&shown, &wanted, "open shutter");
    assert!(3 * with.counts.rays.total() < without.counts.rays.total());
    let whole =
        moving("bounces: 2, antialias: 2, samples: 6,", "shutter: [(0, 0.5, Step), (4, 0), (8, 0.7)],");
    same(&planned(&whole, &frames, u64::MAX).0, &alone(&whole, &frames).0, "some shutters");
}

/// Scenes of many objects and few samples are not copied: that would take longer than tracing them.
#[test]
fn scenes_with_few_samples_are_not_copied() {
    let scene = |side: u32| {
        let still: String = (0..500)
            .map(|k| format!(r#""{k}": (shape: Sphere(center: ({k}, 9, -9), radius: 0.1)), "#))
            .collect();
        sequence(&format!(
            r#"(timeline: (frames: 4, keys: Frames), output: (size: ({side}, {side})), quality: (antialias: 1),
            objects: {{ {still} "m": (shape: Sphere(radius: 0.2), translation: [(0, (0, 0, 0)), (3, (1, 0, 0))]) }})"#
        ))
    };
    // 501 objects, of which each needs four samples.
    for (side, shared) in [(44, false), (45, true)] {
        let (sequence, frames) = (scene(side), [0, 1, 2, 3]);
        let (shown, with, _) = planned(&sequence, &frames, u64::MAX);
        same(&shown, &alone(&sequence, &frames).0, "many objects");
        assert_eq!(with.counts.paths.all > 0, shared, "{side}");
    }
}

/// A film that cannot share paths with the next one keeps no others from sharing theirs.
#[test]
fn films_behind_one_that_differs_share_paths() {
    let scene = |objects: &str| {
        sequence(&format!(
            r#"(timeline: (frames: 14, keys: Frames), output: (size: (48, 36)),
            quality: (integrator: Path, bounces: 2, samples: 4), background: 0.3,
            objects: {{ "floor": (shape: Rectangle(corner: (-5, -1, -5), u: (10, 0, 0), v: (0, 0, 10))), {objects} }})"#
        ))
    };
    let small = |keys: &str| {
        let object = format!(r#""ball": (shape: Sphere(radius: 0.2), translation: [{keys}])"#);
        scene(&object)
    };
    let glow = r#""glow": (shape: Sphere(center: (1, 1, 0), radius: 0.2), material: (emission: 3), visible: KEYS),
        "ball": (shape: Sphere(radius: 0.2), translation: [(0, (-2, 0, 0)), (13, (2, 0, 0))])"#;
    let glowing = |keys: &str| scene(&glow.replace("KEYS", keys));
    let far = "(4000, 0, 0)";
    for (sequence, sharing, what) in [
        (small(&format!("(0, {far}, Step), (1, (0, 0, 0)), (13, (1, 0, 0))")), 13, "far away at first"),
        (
            small(&format!(
                "(0, (0, 0, 0)), (6, (1, 0, 0), Step), (7, {far}, Step), (8, (1, 0, 0)), (13, (0, 0, 0))"
            )),
            13,
            "far away in the middle",
        ),
        (glowing("[(0, true), (1, false)]"), 13, "glowing at first"),
        (glowing("[(0, true), (1, false), (2, true), (3, false)]"), 11, "blinking"),
    ] {
        let frames: Vec<u32> = (0..14).collect();
        let (shown, with, plan) = planned(&sequence, &frames, u64::MAX);
        same(&shown, &alone(&sequence, &frames).0, what);
        let expected = sharing.min(plan.films.len() as u64 - 1);
        assert!(with.counts.paths.all >= expected * 48 * 36 * 4, "{what}: {:?}", with.counts.paths);
        let estimate = plan::cost_estimate(&sequence, &plan, PilotBudget::PLAN).expected;
        assert!(2 * estimate.camera < estimate.camera_alone, "{what}: {estimate:?}");
        assert!(estimate.path_obstacle.is_some(), "{what}: {estimate:?}");
    }
}

/// Whether it pays to copy scenes is decided film by film: one film of many moments is traced alone.
#[test]
fn a_film_of_many_moments_is_no_obstacle() {
    let still: String =
        (0..100).map(|k| format!(r#""{k}": (shape: Sphere(center: ({k}, 9, -9), radius: 0.1)), "#)).collect();
    let sequence = sequence(&format!(
        r#"(timeline: (frames: 6, keys: Frames), output: (size: (32, 32)),
        quality: (integrator: Path, bounces: 1, samples: 4, shutter_steps: 64), background: 0.3,
        camera: (position: (0, 0, 5), shutter: [(0, 0, Step), (5, 1)]),
        objects: {{ {still} "m": (shape: Sphere(radius: 0.2), translation: [(0, (0, 0, 0)), (6, (1, 0, 0))]) }})"#
    ));
    let frames: Vec<u32> = (0..6).collect();
    let (shown, with, _) = planned(&sequence, &frames, u64::MAX);
    same(&shown, &alone(&sequence, &frames).0, "many moments");
    assert_eq!(with.counts.paths.all, 5 * 32 * 32 * 4);
}

/// If all paths meet something that moves, or light depends on it, frames are traced alone.
#[test]
fn frames_with_much_motion_are_traced_alone() {
    let scene = |objects: &str| {
        sequence(&format!(
            r#"(timeline: (frames: 6, keys: Frames), output: (size: (160, 120)),
            quality: (integrator: Path, bounces: 2, samples: 1), background: 0.3,
            lights: {{ "lamp": Point(position: (3, 6, 4)) }}, objects: {{ {objects} }})"#
        ))
    };
    let moves = "translation: [(0, (0, 0, 0)), (5, (0, -0.5, 0))]";
    for (objects, shared) in [
        (format!(r#""floor": (shape: Plane(point: (0, -1, 0)), {moves}), "ball": (shape: Sphere())"#), true),
        (
            format!(
                r#""floor": (shape: Plane()), "bulb": (shape: Sphere(), material: (emission: 1), {moves})"#
            ),
            false,
        ),
    ] {
        let (sequence, frames) = (scene(&objects), [0, 1, 2, 3, 4, 5]);
        let (shown, with, _) = planned(&sequence, &frames, u64::MAX);
        let (wanted, without) = alone(&sequence, &frames);
        same(&shown, &wanted, &objects);
        assert_eq!(with.counts.paths.all > 0, shared, "{objects}");
        let ratio = with.counts.rays.total() as f64 / without.counts.rays.total() as f64;
        assert!(ratio < 1.05, "{objects}: {ratio} times as many rays");
    }
}

/// A plan expects about as many rays as are traced. Which paths are traced again is an estimate from small pictures.
#[test]
fn plans_expect_shared_paths() {
    let mut sequence = moving("bounces: 3, antialias: 2,", "");
    sequence.output.size = (200, 150);
    // Its films are traced in groups of two to 22, or alone, as the extents of its scene change.
    let mut pendulum = shipped("annotated-pendulum.ron");
    pendulum.output.size = (200, 125);
    let frames: Vec<u32> = (0..12).collect();
    for (sequence, frames) in [
        (&sequence, frames.clone()),
        (&shipped("loop.ron"), (0..48).collect()),
        (&pendulum, (0..100).collect()),
    ] {
        let (_, found, plan) = planned(sequence, &frames, u64::MAX);
        let expected = plan::estimate_rays(sequence, &plan, PilotBudget::PLAN);
        assert!(expected.shares_paths, "{}", sequence.name);
        let rays = expected.rays.expect("a trial") as f64 / found.counts.rays.total() as f64;
        assert!((0.75..1.33).contains(&rays), "{}: {rays}", sequence.name);
        let clock = TimeSource::Rays(1e-6);
        let outlook = run_pilot(sequence, &plan, AovSet::default(), PilotTime::PLAN, clock);
        let seconds = outlook.forecast(&sequence.quality).wall.mid;
        let ratio = seconds / (1e-6 * found.counts.rays.total() as f64);
        assert!((0.75..1.33).contains(&ratio), "{}: {ratio} of the time", sequence.name);
    }
    let (_, found, plan) = planned(&sequence, &frames, u64::MAX);
    let expected = plan::estimate_rays(&sequence, &plan, PilotBudget::PLAN);
    let known = plan::RayEstimate::of(&sequence, &plan);
    assert_eq!(known.camera, 200 * 150 * 4 * plan.films.len() as u64);
    assert!(expected.camera < known.camera && known.camera <= expected.camera_alone);
    let outlook = run_pilot(&sequence, &plan, AovSet::default(), PilotTime::PLAN, TimeSource::Rays(1e-6));
    let ratio = outlook.forecast(&sequence.quality).camera / found.counts.rays.camera as f64;
    assert!((0.75..1.33).contains(&ratio), "{ratio}");
}

/// What plans say of the shipped sequences is what happens: films, trees and rays of the camera exactly, all rays nearly.
#[test]
fn plans_come_true() {
    for (name, films) in [("light-show.ron", 1), ("loop.ron", 24), ("hold.ron", 30)] {
        let sequence = shipped(name);
        let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
        let plan = Plan::new(&sequence, &frames, AovSet::default(), u64::MAX).without_shared_paths();
        let (shown, tally) = run(&sequence, &plan);
        assert_eq!((plan.films.len(), tally.traced), (films, films as u32), "{name}");
        assert_eq!(tally.bvh_builds + tally.bvh_refits, plan.bvh_updates(), "{name}");
        let expected = plan::estimate_rays(&sequence, &plan, PilotBudget::PLAN);
        let found = tally.counts.rays;
        assert_eq!(expected.camera, found.camera, "{name}");
        let rays = expected.rays.expect("a trial") as f64 / found.total() as f64;
        assert!((rays - 1.0).abs() < 0.05, "{name}: {rays}");
        let work = plan::cost_estimate(&sequence, &plan, PilotBudget::PLAN);
        assert_eq!((work.expected.camera, work.expected.rays), (expected.camera, expected.rays), "{name}");
        let share = work.films.iter().sum::<f64>() / found.total() as f64;
        assert!(work.films.len() == films && (share - 1.0).abs() < 0.05, "{name}: {share}");
        // Without a trial, films are weighed by the rays of the camera.
        let untried = plan::cost_estimate(&sequence, &plan, PilotBudget::NONE);
        assert_eq!(
            (untried.expected.rays, untried.films.iter().sum()),
            (None, found.camera as f64),
            "{name}"
        );
        same(&planned(&sequence, &frames, u64::MAX).0, &shown, name);
        // Some frames by themselves.
        let some: Vec<u32> = frames.iter().copied().step_by(frames.len() / 7).collect();
        for frame in alone(&sequence, &some).0.0 {
            assert!(shown.0.contains(&frame), "{name}: frame {}", frame.0);
        }
    }
}

/// A ball that turns in itself turns its textures, but not the primitives: neither plan nor run updates the BVH.
#[test]
fn a_ball_that_turns_in_itself_needs_no_update() {
    let sequence = sequence(
        r#"(timeline: (frames: 5, keys: Frames), output: (size: (16, 12)), quality: (antialias: 1),
        objects: { "ball": (shape: Sphere(), material: (color: Checker(a: 0.1, b: 0.9)),
            rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), (4, 360)])) })"#,
    );
    let frames: Vec<u32> = (0..5).collect();
    let (shown, tally, plan) = planned(&sequence, &frames, u64::MAX);
    assert_eq!((plan.films.len(), tally.traced), (4, 4), "the last frame is as the first");
    assert_eq!((tally.bvh_builds, tally.bvh_refits, plan.bvh_updates()), (1, 0, 1));
    assert_eq!(tally.primitives_packed, 4);
    same(&shown, &alone(&sequence, &frames).0, "turning");
}

/// A program may move objects. Plans, films that several frames share, frames in any order and the recognition of
/// existing frames work as with keys, because they compare what is seen.
#[test]
fn programs_move_objects() {
    let text = |keys: &str| {
        sequence(&format!(
            r#"(timeline: (frames: 8, fps: 4), output: (size: (16, 12)), quality: (antialias: 1),
            camera: (position: (0, 0, 5), shutter: [(0, 0, Step), (1, 1)]),
            objects: {{ "arm": (shape: Group, {keys}), "ball": (shape: Sphere(), parent: "arm"),
                "floor": (shape: Box(min: (-1, -3, -1), max: (1, -2, 1))) }})"#
        ))
    };
    // To and fro along x, by halves and quarters: exact in both.
    let keyed = text("translation: [(0, (0, 1, 0)), (1, (1, 1, 0)), (2, (0, 1, 0))]");
    let mut driven = text("translation: (0, 1, 0)");
    let sway = |from: f64| {
        move |time: f64| translated([if time < 1.0 { time } else { 2.0 - time } + from, 0.0, 0.0])
    };
    driven.drive("arm", sway(0.0)).expect("the arm");
    let frames: Vec<u32> = (0..8).collect();
    let (shown, tally, plan) = planned(&driven, &frames, u64::MAX);
    same(&shown, &alone(&driven, &frames).0, "driven");
    same(&shown, &alone(&keyed, &frames).0, "keyed");
    assert_eq!(tally.bvh_builds + tally.bvh_refits, plan.bvh_updates());
    assert_eq!(evaluate(&driven, &frames), evaluate(&keyed, &frames));

    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let run = |sequence: &Sequence| {
        let outputs = vec![Output::parse(folder.path().join("##.png")).expect("an output")];
        render(sequence, &Request::new(sequence, outputs), &Arc::default()).expect("a run").kept
    };
    assert_eq!((run(&driven), run(&driven), run(&keyed)), (0, 8, 8));
    driven.drive("arm", sway(0.5)).expect("the arm");
    assert_eq!(run(&driven), 0, "another motion");
    driven
        .drive("arm", |time| translated([if time < 1.0 { 0.0 } else { f64::NAN }, 0.0, 0.0]))
        .expect("the arm");
    let gone = alone(&driven, &[7]).0;
    let without = alone(&text("visible: false"), &[7]).0;
    same(&gone, &without, "what is not finite is hidden");
    let unknown = driven.drive("arn", sway(0.0)).expect_err("no such object");
    assert_eq!(unknown.to_string(), "the sequence has no object `arn`; did you mean `arm`?");
}

/// The map that adds a vector.
fn translated(by: [f64; 3]) -> [[f64; 3]; 4] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], by]
}

/// If an error is to be reached, a pilot finds how many samples that takes.
#[test]
fn plans_forecast_the_samples_of_an_error() {
    for (name, error) in [("field-orbit.ron", 0.05), ("field-moves.ron", 0.1)] {
        let mut sequence = shipped(name);
        sequence.quality.noise = Some(NoiseTarget { error, most: 1024 });
        sequence.output.size = (160, 120);
        let (_, tally, plan) = planned(&sequence, &[0, 3], u64::MAX);
        assert!(!plan::RayEstimate::of(&sequence, &plan).exact);
        let outlook = run_pilot(&sequence, &plan, AovSet::default(), PilotTime::PLAN, TimeSource::Rays(1e-6));
        let expected = outlook.forecast(&sequence.quality);
        let (camera, all) = (tally.counts.rays.camera, tally.counts.rays.total());
        for (what, forecast, found) in [("camera", expected.camera, camera), ("all", expected.rays, all)] {
            let ratio = forecast / found as f64;
            assert!((0.75..1.33).contains(&ratio), "{name}, {what}: {forecast} for {found}");
        }
    }
    let mut sequence = shipped("glazed-orbit.ron");
    sequence.quality.noise = Some(NoiseTarget { error: 0.05, most: 1024 });
    let plan = planned(&sequence, &[0], u64::MAX).2;
    assert!(plan::RayEstimate::of(&sequence, &plan).exact, "nothing is random");
}

/// Lights that are off in every frame that shares a film are not traced; trees and packing are as for one frame.
#[test]
fn dark_lights_are_not_traced() {
    let lamp = |name: &str, on: &str| format!("\"{name}\": Point(position: (3, 4, 5), on: {on}),");
    let text = |lights: &str| {
        sequence(&format!(
            r#"(timeline: (frames: 12, keys: Frames), output: (size: (16, 12)), quality: (antialias: 1),
            lights: {{ {lights} }}, objects: {{ "floor": (shape: Plane()), "ball": (shape: Sphere()) }})"#
        ))
    };
    let lit = lamp("lit", "[(0, true), (6, false)]");
    let shadow = |lights: &str, frames: &[u32]| planned(&text(lights), frames, u64::MAX).1.counts.rays.shadow;
    let all: Vec<u32> = (0..12).collect();
    let one = shadow(&lit, &[0]);
    assert!(one > 50);
    assert_eq!(shadow(&lit, &all), one);
    assert_eq!(shadow(&lit, &all[6..]), 0);
    let late = lamp("late", "[(0, false), (9, true)]");
    assert_eq!(shadow(&(lit.clone() + &late), &all[..9]), one, "it comes on later, in no frame of these");
    assert_eq!(shadow(&(lit.clone() + &late), &all), 2 * one);
    let (_, tally, _) = planned(&text(&lit), &all, u64::MAX);
    assert_eq!((tally.bvh_builds, tally.geometry_packs, tally.shading_packs, tally.traced), (1, 1, 1, 1));
}

/// A curve that comes back to its first key has two frames there, of one film.
#[test]
fn the_ends_of_a_closed_curve_share_a_film() {
    let mut random = Random(5);
    for closed in [true, false] {
        for _ in 0..40 {
            let mut point = || (0..3).map(|_| number(&mut random)).collect::<Vec<_>>().join(", ");
            let (a, b, c) = (point(), point(), point());
            let sequence = sequence(&format!(
                r#"(timeline: (frames: 10, keys: Frames), output: (size: (4, 4)), objects: {{ "ball": (shape: Sphere(),
                translation: Track(keys: [(0, ({a}), CatmullRom), (3, ({b}), CatmullRom), (5, ({c}), CatmullRom), (9, ({a}))],
                              closed: {closed})) }})"#
            ));
            let plan = Plan::new(&sequence, &[0, 9], AovSet::default(), u64::MAX);
            assert_eq!(plan.film_of[0], plan.film_of[1], "({a}), ({b}), ({c}), closed: {closed}");
        }
    }
}

/// A shutter that is open while a lamp fades sees nothing move.
#[test]
fn only_moving_scenes_have_several_moments() {
    let text = |object: &str| {
        sequence(&format!(
            r#"(timeline: (frames: 6, keys: Frames), output: (size: (16, 12)), quality: (antialias: 2, samples: 9),
            camera: (shutter: 1), lights: {{ "lamp": Point(position: (3, 4, 5), intensity: [(0, 0.1), (5, 1)]) }},
            objects: {{ "floor": (shape: Plane()), "ball": (shape: Sphere(), {object}) }})"#
        ))
    };
    let frames = [0, 1, 2, 3, 4, 5];
    let films = planned(&text(""), &frames, u64::MAX).1;
    assert_eq!(films.counts.rays.camera, 16 * 12 * 4, "one film, without random samples");
    // The ball moves in two frames, and those before it, after it and with it are different films.
    let moving = text("translation: [(2, (0, 0, 0)), (4, (1, 0, 0))]");
    assert_eq!(planned(&moving, &frames, u64::MAX).1.traced, 4);
    assert_eq!(alone(&moving, &frames).1.counts.rays.camera, 16 * 12 * (4 * 4 + 2 * 9));
}

/// Twelve frames of a ball that moves over a floor.
const SCENE: &str = r#"(
    timeline: (frames: 12, fps: 24, keys: Frames), output: (size: (16, 9)), quality: (samples: 2), background: 0.03,
    materials: {},
    lights: { "sun": Point(position: (3, 4, 5)), },
    objects: { "floor": (shape: Plane(point: (0, -1, 0)), material: (color: 0.7)),
               "ball": (shape: Sphere(radius: 1), translation: [(0, (-1, 0, 0)), (12, (1, 0, 0))]), },
)"#;

/// What is added, into which section.
const ADDED: [(&str, &str); 11] = [
    ("objects", r#""b": (shape: Sphere(center: (2, 0, 0), radius: 0.5), visible: [(0, false), (8, true)])"#),
    (
        "objects",
        r#""b": (shape: Sphere(center: (2, 0, 0)), material: (emission: [(0, 0), (12, 1)]), visible: [(0, false), (8, true)])"#,
    ),
    (
        "objects",
        r#""b": (shape: Sphere(center: (2, 0, 0)), material: Metal(color: 0.5, fuzz: 0.3), visible: [(0, false), (8, true)])"#,
    ),
    ("objects", r#""b": (shape: Sphere(center: (2, 0, 0)), material: (color: Checker()), visible: false)"#),
    (
        "objects",
        r#""g": (shape: Group, visible: [(0, false), (8, true)]), "b": (shape: Sphere(center: (2, 0, 0)), parent: "g")"#,
    ),
    ("materials", r#""unused": (color: 0.1, emission: [(0, 0), (12, 1)])"#),
    ("lights", r#""x": Point(position: (1, 2, 3), on: [(0, false), (8, true)])"#),
    ("lights", r#""x": Point(position: [(0, (1, 2, 3)), (12, (3, 2, 1))], intensity: [(8, 0), (12, 1)])"#),
    ("lights", r#""x": Point(position: (1, 2, 3), intensity: 0)"#),
    ("lights", r#""x": Directional(direction: (0, -1, 0), color: (0, 0, 0))"#),
    (
        "lights",
        r#""x": Point(position: (1, 2, 3), on: [(0, false), (8, true)]), "y": Point(position: (3, 2, 1), on: [(0, false), (8, true)])"#,
    ),
];

/// The digests of all frames, by which they are known again, and their pixels.
fn known(text: &str) -> Vec<(Digest, Vec<[u32; 3]>)> {
    let sequence = sequence(text);
    let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
    let looks = evaluate(&sequence, &frames).frames;
    let films = shoot(&sequence, frames).into_iter().map(|shot| shot.film);
    let pixels = |film: Film| film.radiance().map(|color| color.to_array().map(f32::to_bits)).collect();
    looks.into_iter().map(|look| look.image_hash).zip(films.map(pixels)).collect()
}

/// What is hidden, dark or unused has no part in what a frame is known by: two frames are called alike if their pixels are.
#[test]
fn frames_are_identified_by_their_content() {
    let with = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    };
    let keyed = with(SCENE, "Point(", "Point(intensity: [(0, 1), (12, 2)], ");
    let soft = with(&keyed, "lights: {", "lights: { \"soft\": Sphere(center: (0, 6, 0), radius: 1),");
    let glowing =
        with(&keyed, "radius: 1)", "radius: 1), material: (emission: [(0, 1), (12, 2)], color: 0.5)");
    let path = |text: &str| with(text, "quality: (", "quality: (integrator: Path, ");
    let noise = with(&path(&keyed), "samples: 2", "noise: 0.3, max_samples: 16");
    let turning = with(
        SCENE,
        "translation",
        "rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), (12, 90)]), translation",
    );
    let unlit = with(SCENE, "radius: 1)", "radius: 1), material: (color: 0, ambient: 1)");
    let unlit = with(&unlit, "color: 0.7", "color: 0, ambient: 1");
    let bases = [
        path(&keyed),
        path(&soft),
        path(&glowing),
        noise,
        glowing,
        soft,
        keyed,
        turning,
        unlit,
        SCENE.to_owned(),
    ];
    for (number, base) in bases.iter().enumerate() {
        let before = known(base);
        for (section, added) in ADDED {
            let start = format!("{section}: {{");
            let first = with(base, &start, &format!("{start} {added},"));
            let at = base.find(&start).expect("a section");
            let end = at + base[at..].find("},\n").expect("its end");
            let last = format!("{}{added},{}", &base[..end], &base[end..]);
            for text in [first, last] {
                let after = known(&text);
                for (frame, (before, after)) in before.iter().zip(&after).enumerate() {
                    let (called, are) = (before.0 == after.0, before.1 == after.1);
                    assert_eq!(called, are, "base {number}, frame {frame}, with {added}:\n{text}");
                }
            }
        }
    }
}

/// Where a shape was before it was turned is asked by its paint alone.
#[test]
fn rotations_without_texture_share_films() {
    let films = |ball: &str| {
        let text = SCENE
            .replace("translation: [(0, (-1, 0, 0)), (12, (1, 0, 0))]", ball)
            .replace("color: 0.7", "color: Checker()");
        let looks = evaluate(&sequence(&text), &(0..12).collect::<Vec<u32>>()).frames;
        looks.into_iter().map(|look| look.scene_hash).collect::<BTreeSet<_>>().len()
    };
    let turning = "rotation: AxisAngle(axis: (0, 1, 0), angle: [(0, 0), (12, 90)])";
    assert_eq!(films(turning), 1);
    assert_eq!(films(&format!("material: (color: Checker()), {turning}")), 12);
}
