//! Frames that are denoised with the samples of the frames around them.

use crate::command::{contents, folder, kinora};
use crate::noise::{film, references, stated, true_error};
use crate::support::sequence;
use kinora::film::Film;
use kinora::pipeline::plan::{evaluate, with_shared, work_groups};
use kinora::sequence::Sequence;
use kinora::sequence::quality::Denoise;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A room in which a ball moves, with lamps of two layers, seen by a camera with these fields.
fn room(camera: &str, quality: &str) -> String {
    format!(
        r##"(output: (size: (64, 48)), quality: (integrator: Path(), bounces: 3, {quality}), background: 0.05,
        timeline: (frames: 6, keys: Frames), camera: (target: (0, 1, 0), {camera}),
        lights: {{ "panel": Rectangle(corner: (-1, 6, -1), u: (2, 0, 0), v: (0, 0, 2), intensity: 12),
            "side": Sphere(center: (6, 5, 4), radius: 0.5, intensity: [(0, 5), (5, 20)], color: (1, 0.8, 0.5)) }},
        objects: {{
            "floor": (shape: Plane(), material: Lambertian(color: Checker(a: "#777", b: "#ccc"))),
            "wall": (shape: Box(min: (-4, 0, -3), max: (4, 5, -2.8)), material: Lambertian(color: (0.7, 0.5, 0.4))),
            "egg": (shape: Sphere(center: (-1.3, 1, 0)), material: Lambertian(color: 0.8)),
            "ball": (shape: Sphere(center: (0, 0.5, 2), radius: 0.5), translation: [(0, (0, 0, 0)), (5, (1, 0, 0))],
                material: Lambertian(color: (0.2, 0.6, 0.8))) }})"##
    )
}

const STILL: &str = "position: (0, 3, 8)";
const MOVING: &str = "position: [(0, (0, 3, 8)), (5, (0.5, 3, 8))]";

/// The sequence with neighbours, and without.
fn both(camera: &str, quality: &str) -> [Sequence; 2] {
    let with = sequence(&room(camera, &format!("{quality}, denoise: Auto")));
    let mut alone = with.clone();
    alone.quality.denoise = Denoise::Alone;
    [with, alone]
}

fn square(sequence: &Sequence, frame: u32) -> f64 {
    let references = references(sequence, frame, 1024);
    (0..4).map(|seed| true_error(&film(sequence, frame, seed), &references)).map(|error| error * error).sum()
}

/// The same error takes less than half of the samples where the camera stands, and fewer where it moves.
#[test]
fn neighbors_lower_the_error() {
    for (camera, at_most) in [(STILL, 0.5), (MOVING, 0.8)] {
        let [with, alone] =
            both(camera, "samples: 16, vary_noise: true").map(|sequence| square(&sequence, 3));
        assert!(with < at_most * alone, "{camera}: {with} {alone}");
    }
}

/// Of 40 frames with a chance of 95 %, fewer than 34 are one case in 300.
#[test]
fn stated_errors_with_neighbors_are_true() {
    let [with, _] = both(MOVING, "samples: 16, vary_noise: true");
    let (inside, above, mean) = stated(&with, 3, 0..40, 1024);
    assert!(inside >= 0.85, "{inside}, {above} above, {mean}");
}

#[test]
#[ignore = "takes minutes; cargo test --release --test integration neighbors_over_200_seeds -- --ignored"]
fn stated_errors_with_neighbors_over_200_seeds() {
    for (camera, quality, frame) in [
        (STILL, "samples: 16, vary_noise: true", 2),
        (MOVING, "samples: 16, vary_noise: true", 3),
        (MOVING, "samples: 16", 3),
        (MOVING, "samples: 64", 0),
    ] {
        let [with, _] = both(camera, quality);
        let (inside, above, mean) = stated(&with, frame, 0..200, 4096);
        assert!((0.9..=0.99).contains(&inside), "{camera} {quality}: {inside}, {above} above, {mean}");
    }
}

/// The mean change of the light from frame to frame, as a share of the light, where only noise changes it: the ball and
/// what it shades are in the lower half.
fn flicker(sequence: &Sequence) -> f64 {
    let films: Vec<Film> = (1..5).map(|frame| film(sequence, frame, 0)).collect();
    let light = |film: &Film, pixel: usize| f64::from(film.radiance_of(pixel, 0).element_sum());
    let upper = 0..64 * 20;
    let changes = films
        .array_windows()
        .flat_map(|[a, b]| upper.clone().map(move |pixel| (light(a, pixel), light(b, pixel))));
    let (mut sum, mut count) = (0.0, 0);
    for (a, b) in changes.filter(|(a, b)| a + b > 0.0) {
        sum += (a - b).abs() / (a + b);
        count += 1;
    }
    sum / f64::from(count)
}

#[test]
fn noise_that_varies_flickers_less() {
    let [with, alone] = both(STILL, "samples: 16, vary_noise: true").map(|sequence| flicker(&sequence));
    assert!(with < 0.6 * alone, "{with} {alone}");
}

/// A frame has the same bytes alone, in shards, in runs with and without reuse, with any threads, and if a part of the run
/// is kept.
#[test]
fn bytes_do_not_depend_on_which_frames_are_rendered() {
    let folder = folder();
    let at = folder.path();
    // A plain ball that turns has other own spaces under the same light, and a lamp that is out has a layer all the same.
    let spun = room(STILL, "samples: 8, denoise: Auto")
        .replace(
            "(-1.3, 1, 0))",
            "(0, 0, 0)), translation: (-1.3, 1, 0), rotation: Euler(y: [(0, 0), (5, 140)])",
        )
        .replace(
            "[(0, (0, 0, 0)), (5, (1, 0, 0))]",
            "[(0, (0, 0, 0), Step), (2, (1, 0, 0), Step), (4, (1.3, 0, 0))]",
        )
        .replace("[(0, 5), (5, 20)]", "[(0, 5, Step), (2, 0, Step), (4, 9)]");
    let plain = |camera: &str| room(camera, "samples: 8, denoise: Auto, shutter_steps: 4");
    let open = plain("position: (0, 3, 8), shutter: 0.5");
    for (name, text) in [("still", plain(STILL)), ("moving", plain(MOVING)), ("open", open), ("spun", spun)] {
        fs::write(at.join(format!("{name}.ron")), text).expect("the folder is writable");
        let render = |prefix: &str, more: &[&str]| {
            let (file, output) = (format!("{name}.ron"), format!("{name}{prefix}#.png"));
            kinora(at, &[&["render", &file, "-o", &output], more].concat())
        };
        render("_all_", &["--threads", "2"]);
        render("_one_", &["--frames", "3", "--threads", "1"]);
        render("_each_", &["--no-reuse"]);
        render("_shard_", &["--shard", "2/2"]);
        render("_share_", &["--claim"]);
        render("_rest_", &["--frames", "0,4"]);
        let rest = render("_rest_", &[]);
        assert!(rest.contains("2 of them kept"), "{rest}");
        let files = contents(at);
        let of_run =
            |file: &&String| file.starts_with(name) && !file.contains("_all_") && file.ends_with(".png");
        let names: Vec<&String> = files.keys().filter(of_run).collect();
        assert!(names.len() >= 6 * 3 + 4, "{names:?}");
        for file in names {
            let (_, frame) = file.rsplit_once('_').expect("a number");
            assert_eq!(files[file], files[&format!("{name}_all_{frame}")], "{file}");
        }
    }
}

/// The camera rays of a run, as they were planned and as they were traced.
fn camera_rays(at: &Path, more: &[&str]) -> [u64; 2] {
    let summary = kinora(at, &[&["render", "a.ron", "-o", "a_##.png", "--overwrite"], more].concat());
    let number = |text: &str| text.replace(',', "").trim().parse().expect("a number");
    let line = |begins: &str| summary.lines().find_map(|line| line.trim().strip_prefix(begins));
    let planned = line("planned ").and_then(|text| text.split(" rays").next()).expect("a plan");
    [number(planned), number(line("camera ").expect("camera rays"))]
}

/// The plan knows the samples that other frames need, and the summary says that they were traced.
#[test]
fn samples_of_other_frames_are_planned() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("a.ron"), room(MOVING, "samples: 8, denoise: Auto")).expect("the folder is writable");
    let camera = |more: &[&str]| camera_rays(at, more);
    let pixels = 64 * 48;
    // Eight samples of each frame, and two audits of two samples.
    assert_eq!(camera(&[]), [pixels * 6 * 12; 2]);
    assert_eq!(camera(&["--frames", "3"]), [pixels * (5 * 8 + 4); 2]);
    assert_eq!(camera(&["--frames", "0"]), [pixels * (3 * 8 + 4); 2]);
    assert_eq!(camera(&["--frames", "0,1"]), [pixels * (4 * 8 + 2 * 4); 2]);
    assert_eq!(camera(&["--frames", "3", "--denoise=alone"]), [pixels * 12; 2]);
    let summary = kinora(at, &["render", "a.ron", "-o", "b_#.png", "--frames", "3"]);
    assert!(summary.contains("the samples of 4 frames were traced besides, to denoise 1"), "{summary}");
    let plan = kinora(at, &["plan", "a.ron", "--frames", "3"]);
    assert!(plan.contains("samples of 4 frames beside these, for the denoiser"), "{plan}");
    let poster = kinora(at, &["poster", "a.ron", "--frame", "3", "-o", "p.png"]);
    assert!(!poster.contains("besides"), "{poster}");
}

/// Twelve frames of four scenes that repeat.
fn repeating() -> String {
    let keys: Vec<String> =
        (0..12).map(|frame| format!("({frame}, ({}, 0, 0), Step)", f64::from(frame % 4) * 0.3)).collect();
    room(STILL, "samples: 8, denoise: Auto")
        .replace("frames: 6", "frames: 12")
        .replace("[(0, (0, 0, 0)), (5, (1, 0, 0))]", &format!("[{}]", keys.join(", ")))
}

/// No samples are traced twice: those of frames with and without neighbours, and of frames between fades.
#[test]
fn samples_are_traced_once() {
    let folder = folder();
    let at = folder.path();
    let held = room(STILL, "samples: 8, denoise: Auto").replace(
        "[(0, (0, 0, 0)), (5, (1, 0, 0))]",
        "[(0, (0, 0, 0), Step), (3, (1, 0, 0), Step), (4, (1.3, 0, 0))]",
    );
    fs::write(at.join("a.ron"), held).expect("the folder is writable");
    let [planned, traced] = camera_rays(at, &[]);
    let pixels = 64 * 48;
    // Three scenes, in at most six films with audits of their own.
    assert!(planned == traced && (pixels * 3 * 12..=pixels * (3 * 8 + 6 * 4)).contains(&traced), "{traced}");
    let cameras = "cameras: { \"a\": (target: (0, 1, 0), position: (0, 3, 8)),
            \"b\": (target: (0, 1, 0), position: (8, 2, 0)) },
        active_camera: [(0, \"a\"), (1, \"b\"), (7, \"a\")], cross_fade: 2,";
    let fading = repeating().replace("camera: (target: (0, 1, 0), position: (0, 3, 8)),", cameras);
    assert!(fading.contains("cross_fade"));
    fs::write(at.join("a.ron"), fading).expect("the folder is writable");
    let [planned, traced] = camera_rays(at, &[]);
    assert_eq!(planned, traced);
}

/// Whatever frames a process is given, together the groups are all frames, each of them once.
#[test]
fn groups_of_processes_are_all_frames() {
    for text in [repeating(), room(MOVING, "samples: 8, denoise: Auto").replace("frames: 6", "frames: 30")] {
        let sequence = sequence(&text);
        let all: Vec<u32> = (0..sequence.timeline.frames).collect();
        let groups = work_groups(&evaluate(&sequence, &all).frames);
        let mut found = BTreeSet::new();
        for group in &groups {
            let frames = with_shared(&sequence, &[group.frames[0] as u32], &all);
            assert!(frames.iter().all(|frame| found.insert(*frame)), "{frames:?}");
        }
        assert_eq!(found.into_iter().collect::<Vec<u32>>(), all);
    }
}
