//! A frame's bytes depend on the sequence alone: not on threads, SIMD, other frames, or the tree's layout.

use crate::command::contents;
use crate::golden;
use crate::support::{Shot, sequence, shoot, shoot_all};
use assert_cmd::Command;
use kinora::base::lanes::LevelName;
use kinora::base::stats::ProgressMeter;
use kinora::encode::{Existing, Output};
use kinora::film::Film;
use kinora::pipeline::render::{Request, Reuse, render};
use kinora::sequence::{Sequence, load};
use std::collections::BTreeMap;
use std::fs;
use std::num::NonZeroUsize;
use std::sync::Arc;

fn golden_sequences() -> impl Iterator<Item = Sequence> {
    golden::sequences().into_iter().map(|path| load(&path).unwrap_or_else(|error| panic!("{error}")))
}

fn films(shots: Vec<Shot>) -> Vec<Film> {
    shots.into_iter().map(|shot| shot.film).collect()
}

/// All bits of all layers: `==` would take -0 for 0.
fn bits(film: &Film) -> Vec<[u32; 3]> {
    film.data.iter().chain(&film.weights).map(|c| c.to_array().map(f32::to_bits)).collect()
}

#[track_caller]
fn same(a: &[Film], b: &[Film], what: &str) {
    assert_eq!(a.len(), b.len());
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert!(bits(a) == bits(b), "{what}: film {k} differs");
    }
}

#[test]
fn sa_10_films_are_the_same_for_any_number_of_threads_and_any_run() {
    for sequence in golden_sequences() {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            films(pool.install(|| shoot(&sequence, 0..sequence.timeline.frames)))
        };
        let one = on(1);
        for threads in [1, 2, 3, 8] {
            same(&one, &on(threads), &format!("{} on {threads} threads", sequence.name));
        }
    }
}

/// The command writes the same bytes on every SIMD level that the processor has.
#[test]
fn files_are_the_same_on_every_simd_level() {
    for sequence in golden::sequences() {
        let levels = LevelName::ALL.into_iter().filter(|level| level.is_available()).map(LevelName::name);
        let levels: Vec<_> = levels.collect();
        let files = levels.iter().map(|level| {
            let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
            let mut command = Command::cargo_bin("kinora").expect("the binary is built with its tests");
            command.current_dir(folder.path()).env("KINORA_SIMD", level);
            command.arg("render").arg(&sequence).args(["-o", "##.exr", "-o", "##.png"]).assert().success();
            contents(folder.path())
        });
        let files: Vec<_> = files.collect();
        assert!(files[0].len() >= 2, "{sequence:?}");
        for (level, files_of) in levels.iter().zip(&files).skip(1) {
            assert!(files_of == &files[0], "{sequence:?} on {level}");
        }
    }
}

#[test]
fn a_frame_alone_equals_the_frame_of_the_whole_run() {
    for sequence in golden_sequences() {
        let count = sequence.timeline.frames;
        let whole = films(shoot(&sequence, 0..count));
        for frame in 0..count {
            let alone = films(shoot(&sequence, [frame]));
            same(
                &alone,
                &whole[frame as usize..=frame as usize],
                &format!("{} frame {frame}", sequence.name),
            );
        }
        // Backwards, and with a frame twice: what an earlier frame left behind does not show.
        let order: Vec<u32> = (0..count).rev().chain([count / 2, 0, count - 1]).collect();
        let mixed = films(shoot(&sequence, order.iter().copied()));
        let expected: Vec<Film> = order.iter().map(|&frame| whole[frame as usize].clone()).collect();
        same(&mixed, &expected, &format!("{} out of order", sequence.name));
    }
}

/// The bytes of every file that a render of `frames` writes.
fn files(sequence: &Sequence, frames: Vec<u32>, threads: usize) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    let output = |name: &str| Output::parse(folder.path().join(name)).expect("an output");
    let outputs = vec![output("##.png"), output("##.exr"), output("all.gif")];
    let threads = NonZeroUsize::new(threads);
    let request = Request {
        frames,
        outputs,
        confined: false,
        existing: Existing::Replace,
        threads,
        reuse: Reuse::Share,
        time_limit: None,
    };
    render(sequence, &request, &Arc::new(ProgressMeter::default())).unwrap_or_else(|error| panic!("{error}"));
    let entries = fs::read_dir(folder.path()).expect("the folder is readable").flatten();
    let entries = entries.map(|entry| {
        (entry.file_name().to_string_lossy().into_owned(), fs::read(entry.path()).expect("a file"))
    });
    entries.collect()
}

#[test]
fn files_are_the_same_for_any_number_of_threads() {
    for sequence in golden_sequences() {
        let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
        let one = files(&sequence, frames.clone(), 1);
        assert_eq!(one.len(), 2 * frames.len() + 1);
        for threads in [1, 2, 8] {
            assert!(files(&sequence, frames.clone(), threads) == one, "{} on {threads}", sequence.name);
        }
    }
}

#[test]
fn files_of_a_subset_are_those_of_the_whole() {
    for sequence in golden_sequences() {
        let count = sequence.timeline.frames;
        let whole = files(&sequence, (0..count).collect(), 2);
        for subset in [vec![count - 1], (0..count).rev().collect(), (0..count).step_by(2).collect()] {
            let mut some = files(&sequence, subset.clone(), 1);
            some.remove("all.gif");
            assert_eq!(some.len(), 2 * subset.len());
            for (name, bytes) in &some {
                assert!(whole.get(name) == Some(bytes), "{} of {subset:?}: {name}", sequence.name);
            }
        }
    }
}

/// BVH-05: of things at the same place the first in the file is seen, however many other things there are.
#[test]
fn bvh_05_the_first_of_coincident_objects_is_seen() {
    let (red, green) = ("color: (1, 0, 0)", "color: (0, 1, 0)");
    for (shape, place) in [
        ("Sphere()", ""),
        ("Sphere()", "scale: (1, 0.7, 0.5), rotation: AxisAngle(axis: (1, 2, 3), angle: 40)"),
        ("Box(min: (-1, -1, -1), max: (1, 1, 1))", ""),
        ("Box(min: (-1, -1, -1), max: (1, 1, 1))", "rotation: Euler(x: 20, y: 30)"),
        ("Rectangle(corner: (-1, -1, 0), u: (2, 0, 0), v: (0, 2, 0))", ""),
        ("Disk(normal: (0, 1, 1))", ""),
        ("Triangle(a: (-1, -1, 0), b: (1, -1, 0), c: (0, 1, 0))", ""),
    ] {
        // Fillers stand behind the eye; they only change the tree.
        for fillers in [0, 1, 7, 60] {
            let picture = |first: &str, second: &str| {
                let object = |color: &str| {
                    format!(
                        "(shape: {shape}, {place}{} material: ({color}))",
                        if place.is_empty() { "" } else { "," }
                    )
                };
                let mut objects = vec![object(first)];
                objects
                    .extend((0..fillers).map(|k| {
                        format!("(shape: Sphere(center: ({}, {}, 20), radius: 0.3))", k % 8, k / 8)
                    }));
                objects.push(object(second));
                let objects: String =
                    objects.iter().enumerate().map(|(k, o)| format!("\"{k}\": {o},")).collect();
                let text = format!(
                    "(output: (size: (24, 18)), default_material: (ambient: 1), objects: {{ {objects} }})"
                );
                let film = &shoot_all(&text)[0].film;
                film.radiance().fold([0.0, 0.0], |sum, c| [sum[0] + c.x, sum[1] + c.y])
            };
            let [seen, hidden] = picture(red, green);
            assert!(seen > 30.0 && hidden == 0.0, "{shape} {place}, {fillers} fillers: {seen} {hidden}");
            assert_eq!(picture(green, red), [0.0, seen], "{shape} {place}, {fillers} fillers");
        }
    }
}

#[test]
fn bvh_05_a_ball_that_touches_the_floor_is_the_same_in_every_tree() {
    let picture = |fillers: u32| {
        let fillers: String =
            (0..fillers).map(|k| format!("\"{k}\": (shape: Sphere(center: ({k}, 0, 30))),")).collect();
        let text = format!(
            r#"(output: (size: (24, 18)), camera: (position: (0, 0.5, 4), target: (0, 0, 0)),
            objects: {{ "floor": (shape: Plane()), "ball": (shape: Sphere(center: (0, 1, 0))), {fillers} }})"#
        );
        films(shoot_all(&text))
    };
    let alone = picture(0);
    for fillers in [1, 5, 40] {
        same(&picture(fillers), &alone, &format!("{fillers} fillers"));
    }
}

/// GA-01: what has no strength is not there, bit for bit.
#[test]
fn ga_01_zero_strength_equals_absence() {
    let picture = |camera: &str, material: &str, lights: &str, objects: &str| {
        let text = format!(
            r#"(output: (size: (32, 24)), background: (0.1, 0.2, 0.3), timeline: (frames: 2, keys: Frames),
            camera: (position: (0, 2, 5), target: (0, 0.7, 0), {camera}),
            lights: {{ "l": Point(position: (3, 5, 4)), {lights} }}, default_material: (color: "\#c84", {material}),
            objects: {{ "floor": (shape: Plane()), "ball": (shape: Sphere(center: (0, 1, 0))), {objects} }})"#
        )
        .replace("\\#", "#");
        films(shoot(&sequence(&text), [1]))
    };
    let plain = picture("", "", "", "");
    for (camera, material, lights, objects) in [
        ("", "mirror: 0, mirror_color: (1, 0, 0)", "", ""),
        ("", "mirror: 1, mirror_color: 0", "", ""),
        ("", "specular: 0, specular_color: (5, 0, 0), shininess: 0, highlight: BlinnPhong", "", ""),
        ("", "specular: 1, specular_color: 0", "", ""),
        ("", "mirror: [(0, 1), (1, 0)], specular: [(0, 1), (1, 0)]", "", ""),
        ("", "", r#""m": Point(position: (-3, 5, 4), intensity: 0)"#, ""),
        ("", "", r#""m": Point(position: (-3, 5, 4), color: 0)"#, ""),
        ("", "", r#""m": Point(position: (-3, 5, 4), on: false)"#, ""),
        ("", "", "", r#""hidden": (shape: Sphere(center: (0, 1, 0), radius: 2), visible: false)"#),
        ("", "", "", r#""group": (shape: Group)"#),
        (
            "",
            "",
            "",
            r#""flat": (shape: Sphere(center: (0, 1, 0), radius: 2), scale: [(0, 1), (1, 0), (2, 1)])"#,
        ),
        ("aperture: 0, focus: 3", "", "", ""),
        ("shutter: 0", "", "", ""),
        ("", "transparency: 0, transparency_color: (1, 0, 0)", "", ""),
        ("", "transparency: 1, transparency_color: 0", "", ""),
        ("", "refraction: 0, ior: 2, absorption: 3, priority: 5, fresnel: Exact", "", ""),
        ("", "emission: 0, emission_color: (9, 9, 9)", "", ""),
        ("", "fuzz: 0.5", "", ""),
        ("", "mirror: 0, mirror_color: Checker()", "", ""),
        ("roll: 360", "", "", ""),
        ("path: [Zoom(factor: 1), Dolly(forward: 0, right: 0, upward: 0)]", "", "", ""),
    ] {
        same(
            &picture(camera, material, lights, objects),
            &plain,
            &[camera, material, lights, objects].concat(),
        );
    }
    // Roughness of no strength, and fog of none.
    let shiny = |material: &str, fields: &str| {
        films(shoot_all(&format!(
            r#"(output: (size: (16, 12)), background: Gradient(), {fields}
            lights: {{ "l": Point(position: (3, 5, 4)) }}, objects: {{ "b": (shape: Sphere(), material: {material}) }})"#
        )))
    };
    same(&shiny("Metal(fuzz: 0)", ""), &shiny("Metal()", ""), "fuzz");
    let matt = shiny("(specular: 0.5)", "");
    same(&shiny("(specular: 0.5)", "fog: (color: 1, density: 0),"), &matt, "fog");
    let falling = "fog: (color: 1, density: 0, falloff: (height: 2)),";
    same(&shiny("(specular: 0.5)", falling), &matt, "fog with a falloff");
    // Ambient light of no strength against a material that reflects none.
    let dark = |fields: &str| films(shoot_all(&format!(r#"(output: (size: (8, 6)), {fields})"#)));
    same(
        &dark(r#"ambient: 0, objects: { "b": (shape: Sphere()) }"#),
        &dark(r#"objects: { "b": (shape: Sphere(), material: (ambient: 0)) }"#),
        "ambient",
    );
}
