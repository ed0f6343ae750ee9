//! Cross-fades: cuts between cameras that take a time.

use crate::command::{folder, run};
use crate::support::{sequence, shoot_all};
use kinora::base::color::Rgb;
use kinora::film::{AovSet, Film};
use kinora::pipeline::plan::{self, Plan, RayEstimate};
use kinora::pipeline::schedule::{FilmCollector, FrameLoop, Stats};
use std::fs;
use std::sync::Arc;

/// Eight frames, of which frames 3 to 5 show both cameras. `active` and `cameras` may be replaced.
const SCENE: &str = r##"(
    timeline: (frames: 8, fps: 4),
    output: (size: (24, 16), files: ["f_#.png"]),
    quality: (antialias: 2),
    cameras: { "a": (position: (0, 1, 6)), "b": (position: (5, 3, 2), shutter: 0) },
    active_camera: [(0, "a"), (0.5, "b")], cross_fade: 1,
    lights: { "sun": Point(position: (4, 9, 5)), "lamp": Point(position: (-4, 3, 5), intensity: [(0, 0.5), (2, 0.1)]) },
    objects: {
        "floor": (shape: Plane(), material: (color: "#efe6d2")),
        "ball": (shape: Sphere(center: (0, 0.7, 0)), material: (color: "#d8341c", specular: 0.7)),
    },
)"##;

/// The scene through one camera alone.
fn through(text: &str, camera: &str) -> String {
    let text = text.replace("cross_fade: 1,", "");
    text.replace(r#"[(0, "a"), (0.5, "b")]"#, &format!("{camera:?}"))
}

fn radiance(film: &Film) -> Vec<Rgb> {
    film.radiance().collect()
}

/// Renders all frames by a plan, which knows the number of camera rays, unless there is a target error.
fn planned(text: &str, reused: bool) -> (Vec<Film>, Stats) {
    let sequence = sequence(text);
    let mut frames = FrameLoop::new(&sequence, FilmCollector::default(), Arc::default());
    let all: Vec<u32> = (0..sequence.timeline.frames).collect();
    let plan = Plan::new(&sequence, &all, AovSet::default(), if reused { 1 << 30 } else { 0 });
    plan::run(&plan, &mut frames, || true).unwrap_or_else(|fault| panic!("{fault:?}"));
    let stats = frames.stats().clone();
    let known = RayEstimate::of(&sequence, &plan);
    assert_eq!(known.exact, sequence.quality.noise.is_none());
    let traced = stats.counts.rays.camera;
    assert!(if known.exact { known.camera == traced } else { known.camera <= traced }, "{known:?} {traced}");
    (frames.into_sink().expect("the sink").0, stats)
}

/// What the frames show is the mean of both cameras' light, weighted by the time since the cut.
#[track_caller]
fn mixes_evenly(text: &str) {
    let [mixed, a, b] =
        [text.to_owned(), through(text, "a"), through(text, "b")].map(|text| shoot_all(&text));
    for (frame, share) in (0..8).zip([0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0]) {
        let [mixed, a, b] = [&mixed, &a, &b].map(|shots| radiance(&shots[frame].film));
        let largest = a.iter().zip(&b).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max);
        assert!(largest > 0.1, "the cameras show different pictures");
        for ((mixed, a), b) in mixed.iter().zip(a).zip(b) {
            let mean = a * (1.0 - share) + b * share;
            assert!(
                (*mixed - mean).length() <= 1e-6 * (1.0 + mean.length()),
                "frame {frame}: {mixed} {mean}"
            );
        }
    }
}

#[test]
fn light_is_mixed_evenly() {
    mixes_evenly(SCENE);
    // Both cameras go on moving, one of them with an open shutter.
    let moving = SCENE.replace("shutter: 0", "shutter: 0.5, path: [Orbit()]");
    mixes_evenly(&moving.replace("(position: (0, 1, 6))", "(position: (0, 1, 6), path: [Orbit()])"));
    mixes_evenly(&SCENE.replace("antialias: 2", "integrator: Path, samples: 4"));
}

/// Each still camera is traced once for the whole cross-fade, and once for its other frames.
#[test]
fn still_cameras_are_traced_once() {
    let (films, stats) = planned(SCENE, true);
    let picture = 24 * 16 * 4;
    assert_eq!((stats.counts.rays.camera, stats.traced, stats.reused), (4 * picture, 5, 3));
    // Films of other frames do not matter.
    let (alone, _) = planned(SCENE, false);
    for (frame, (film, other)) in films.iter().zip(&alone).enumerate() {
        assert_eq!(radiance(film), radiance(other), "frame {frame}");
    }
    let moving = SCENE.replace("shutter: 0", "path: [Orbit()]");
    let (_, stats) = planned(&moving, true);
    // One film of the first camera before the cut and one in it, and films of the second camera for five frames.
    assert_eq!(stats.counts.rays.camera, 7 * picture);
    // Samples are random through one camera only.
    let lens = SCENE.replace("shutter: 0", "aperture: 0.2, focus: 3").replace("antialias: 2", "samples: 16");
    let (_, stats) = planned(&lens, true);
    assert_eq!(stats.counts.rays.camera, 2 * 24 * 16 * (4 + 16));
}

/// A target error holds for the mixed light as well.
#[test]
fn mixed_films_reach_target_errors() {
    let text = SCENE.replace("antialias: 2", "integrator: Path, noise: 0.05");
    let text = text.replace("Point(position: (4, 9, 5))", "Sphere(center: (4, 9, 5), radius: 2)");
    let (films, _) = planned(&text, true);
    for film in &films {
        let noise = film.noise.expect("an error");
        assert!(noise.error > 0.0 && noise.error <= 0.05 && noise.low <= noise.error, "{noise:?}");
    }
    assert!(films[4].noise.map(|noise| noise.samples) > films[0].noise.map(|noise| noise.samples));
}

/// Frames are the same whoever renders them, are kept, and change with the length of the cross-fade.
#[test]
fn files_know_the_cross_fade() {
    let folder = folder();
    let write = |text: &str| fs::write(folder.path().join("a.ron"), text).expect("a disk");
    let render = |options: &[&str]| {
        let answer = run(folder.path(), &[&["render", "a.ron"], options].concat());
        assert!(answer.status.success(), "{}", crate::command::stderr(&answer));
        String::from_utf8_lossy(&answer.stdout).into_owned()
    };
    let bytes = |frame: u32| fs::read(folder.path().join(format!("f_{frame}.png"))).expect("a frame");
    write(SCENE);
    render(&["--shard", "1/2", "--threads", "1"]);
    render(&["--shard", "2/2"]);
    let all: Vec<Vec<u8>> = (0..8).map(bytes).collect();
    assert!(render(&[]).contains("8 of them kept"));
    render(&["--overwrite", "--frames", "4"]);
    assert_eq!(bytes(4), all[4]);
    write(&SCENE.replace("cross_fade: 1", "cross_fade: 0.75"));
    render(&[]);
    let changed: Vec<u32> = (0..8).filter(|frame| bytes(*frame) != all[*frame as usize]).collect();
    assert_eq!(changed, [3, 4, 5]);
    // The preview mixes as well.
    run(folder.path(), &["preview", "a.ron", "--snapshot", "4", "-o", "s.png"]);
    let picture = |name: &str| image::open(folder.path().join(name)).expect("a picture").to_rgb8();
    assert!(picture("s.png") == picture("f_4.png"));
}
