//! Series of meshes: one file per time.

use crate::command::{contents, kinora, refused};
use crate::support::{put, sequence_in, shoot, shoot_all_in};
use kinora::base::digest::Digest;
use kinora::film::Film;
use kinora::pipeline::plan::evaluate;
use kinora::sequence::{load_text, parse};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A square at a height, of two triangles. Its data `heat` is ten times the height at all vertices.
fn square(height: f64) -> String {
    let mut text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n\
        property double z\nproperty double heat\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
        .to_owned();
    for [x, z] in [[-1, -1], [-1, 1], [1, 1], [1, -1]] {
        text.push_str(&format!("{x} {height} {z} {}\n", 10.0 * height));
    }
    text + "3 0 1 2\n3 0 2 3\n"
}

/// A folder with squares at heights 0, 0.5 and 1.
fn folder() -> TempDir {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    for (number, height) in [0.0, 0.5, 1.0].into_iter().enumerate() {
        put(folder.path(), &format!("s_{number:02}.ply"), &square(height));
    }
    folder
}

/// Six frames of an object with this shape.
fn text(shape: &str) -> String {
    format!(
        "(timeline: (frames: 6, fps: 24, keys: Frames), output: (size: (24, 16)), quality: (antialias: 1),
        camera: (position: (1, 2, 5)), background: 0.2, lights: {{ \"sun\": Point(position: (3, 4, 5)) }},
        objects: {{ \"sheet\": (shape: {shape}) }})"
    )
}

fn series(between: &str) -> String {
    text(&format!("Mesh(series: \"s_##.ply\", at: (first: 0, step: 2), between: {between})"))
}

fn films(folder: &Path, text: &str) -> Vec<Film> {
    shoot_all_in(folder, text).into_iter().map(|shot| shot.film).collect()
}

fn same(a: &Film, b: &Film) -> bool {
    a == b
}

fn keys(folder: &Path, text: &str) -> Vec<Digest> {
    let sequence = sequence_in(folder, text);
    evaluate(&sequence, &[0, 1, 2, 3, 4, 5]).frames.into_iter().map(|frame| frame.image_hash).collect()
}

#[test]
fn each_step_shows_its_file() {
    let folder = folder();
    let held = films(folder.path(), &series("Hold"));
    for (frame, film) in held.iter().enumerate() {
        let file = text(&format!("Mesh(\"s_{:02}.ply\")", (frame / 2).min(2)));
        assert!(same(film, &films(folder.path(), &file)[0]), "frame {frame}");
    }
    assert!(!same(&held[0], &held[2]) && !same(&held[2], &held[4]));
}

#[test]
fn blends_lie_between_their_files() {
    let folder = folder();
    let blended = films(folder.path(), &series("Blend"));
    for (frame, height) in [0.0, 0.25, 0.5, 0.75, 1.0, 1.0].into_iter().enumerate() {
        put(folder.path(), "one.ply", &square(height));
        let one = films(folder.path(), &text("Mesh(\"one.ply\")"));
        assert!(same(&blended[frame], &one[0]), "frame {frame}");
    }
    // Other triangles cannot be blended, so the step before is held.
    let other = square(0.5).replace("3 0 2 3", "3 0 3 2");
    put(folder.path(), "s_01.ply", &other);
    let keys = keys(folder.path(), &series("Blend"));
    assert!(keys[0] == keys[1] && keys[1] != keys[2] && keys[2] == keys[3] && keys[3] != keys[4]);
}

#[test]
fn frames_may_come_in_any_order() {
    let folder = folder();
    for between in ["Hold", "Blend"] {
        let sequence = sequence_in(folder.path(), &series(between));
        let in_order = shoot(&sequence, 0..6);
        for order in [[5, 3, 0, 4, 1, 2], [2, 0, 2, 0, 5, 0]] {
            for (frame, shot) in order.into_iter().zip(shoot(&sequence, order)) {
                assert!(same(&shot.film, &in_order[frame as usize].film), "{between} {frame}");
            }
        }
    }
}

#[test]
fn only_frames_of_a_changed_file_are_others() {
    let folder = folder();
    for (between, changed) in [("Hold", [2, 4]), ("Blend", [1, 4])] {
        let before = keys(folder.path(), &series(between));
        put(folder.path(), "s_01.ply", &square(0.625));
        let after = keys(folder.path(), &series(between));
        for frame in 0..6 {
            assert_eq!(before[frame] != after[frame], (changed[0]..changed[1]).contains(&frame), "{frame}");
        }
        put(folder.path(), "s_01.ply", &square(0.5));
    }
    // The first file has no other part in the frames than its own.
    let shown = text(
        "Mesh(series: \"s_##.ply\", at: (step: 2)), material: Unlit(color: Scalar(of: \"heat\", range: (0, 9)))",
    );
    let before = keys(folder.path(), &shown);
    put(folder.path(), "s_00.ply", &square(0.0).replace(" 0\n", " 1\n"));
    let after = keys(folder.path(), &shown);
    assert_eq!(
        (0..6).map(|frame| before[frame] != after[frame]).collect::<Vec<_>>()[1..4],
        [true, false, false]
    );
}

#[test]
fn runs_continue_where_files_are_the_same() {
    let folder = folder();
    put(folder.path(), "a.ron", &series("Hold"));
    let render =
        |more: &[&str]| kinora(folder.path(), &[&["render", "a.ron", "-o", "out/f_#.png"], more].concat());
    render(&["-t", "1"]);
    let first = contents(&folder.path().join("out"));
    assert_eq!(first.len(), 6);
    put(folder.path(), "s_02.ply", &square(1.25));
    let printed = render(&["-t", "2"]);
    assert!(printed.contains("4 ") && printed.contains("kept"), "{printed}");
    let second = contents(&folder.path().join("out"));
    let same: Vec<bool> = first.iter().zip(&second).map(|(a, b)| a == b).collect();
    assert_eq!(same, [true, true, true, true, false, false]);
    for shard in ["1/2", "2/2"] {
        kinora(folder.path(), &["render", "a.ron", "--shard", shard, "-o", "parts/f_#.png"]);
    }
    assert!(contents(&folder.path().join("parts")) == second);
}

#[test]
fn the_range_of_data_is_that_of_all_files() {
    let folder = folder();
    let scalar = |range: &str| {
        text(&format!(
            "Mesh(series: \"s_##.ply\", at: [0, 1, 5]), material: Unlit(color: Scalar(of: \"heat\"{range}))"
        ))
    };
    let auto = films(folder.path(), &scalar(""));
    let given = films(folder.path(), &scalar(", range: (0, 10)"));
    assert!(auto.iter().zip(&given).all(|(a, b)| same(a, b)));
    assert!(!same(&auto[0], &auto[1]) && same(&auto[1], &auto[4]) && !same(&auto[4], &auto[5]));
    let notes = sequence_in(folder.path(), &scalar("")).notes();
    assert!(notes.iter().any(|note| note.ends_with("the range of `heat` is (0, 10)")), "{notes:?}");
    put(folder.path(), "s_01.ply", &square(0.5).replace("heat", "cold"));
    let faults =
        parse(&folder.path().join("a.ron").to_string_lossy(), &scalar("")).expect_err("a fault").to_string();
    assert!(faults.contains("not all files of the series have the data `heat`"), "{faults}");
    assert!(faults.contains("\"s_01.ply\" has none"), "{faults}");
}

#[test]
fn all_files_move_by_the_centre_of_the_first() {
    let folder = folder();
    let centered = "Mesh(series: \"s_##.ply\", at: (step: 2), center: Base, scale: 2)";
    let films = films(folder.path(), &text(centered));
    for (frame, height) in [(0, 0.0), (2, 1.0), (4, 2.0)] {
        put(folder.path(), "one.ply", &square(height));
        let one = text("Mesh(\"one.ply\"), scale: (2, 1, 2)");
        assert!(same(&films[frame], &self::films(folder.path(), &one)[0]), "frame {frame}");
    }
}

#[test]
fn a_list_of_files_has_times_of_its_own() {
    let folder = folder();
    fs::create_dir(folder.path().join("run")).expect("a disk");
    let step = |time: &str, number: u32| {
        format!("<DataSet timestep=\"{time}\" part=\"0\" file=\"../s_{number:02}.ply\"/>\n")
    };
    let list = |steps: &str| {
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\">\n<Collection>\n{steps}</Collection></VTKFile>"
        );
        put(folder.path(), "run/a.pvd", &text);
    };
    list(&[step("0", 2), step("3", 0), step("4.0", 1)].concat());
    let found = films(folder.path(), &text("Mesh(series: \"run/a.pvd\")"));
    let held = films(folder.path(), &series("Hold"));
    for (frame, other) in [(0, 4), (2, 4), (3, 0), (4, 2), (5, 2)] {
        assert!(same(&found[frame], &held[other]), "frame {frame}");
    }
    list(&[step("0", 2), step("0", 0)].concat());
    let shown = text("Mesh(series: \"run/a.pvd\")");
    put(folder.path(), "a.ron", &shown);
    let printed = refused(folder.path(), &["check", "a.ron"]);
    assert!(
        printed.contains("parts of a mesh are read from .vtk, .vtp, .vtu, .pvtp and .pvtu files"),
        "{printed}"
    );
    assert!(printed.contains("s_02.ply"), "{printed}");
}

/// A legacy VTK file with a square between x and x + 1.
fn tile(x: i32) -> String {
    format!(
        "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n{x} 0 -1 {x} 0 1 {0} 0 1 {0} 0 -1\n\
         POLYGONS 1 5\n4 0 1 2 3\n",
        x + 1
    )
}

/// Parallel programs write a file for each part, and a list of them.
#[test]
fn parts_of_one_time_are_one_mesh() {
    let folder = folder();
    let collection =
        |steps: &str| format!("<VTKFile type=\"Collection\"><Collection>\n{steps}</Collection></VTKFile>");
    let part = |time: u32, file: &str| format!("<DataSet timestep=\"{time}\" file=\"{file}\"/>\n");
    let list = |parts: &[&str]| {
        let pieces: String = parts.iter().map(|part| format!("<Piece Source=\"{part}\"/>\n")).collect();
        format!("<VTKFile type=\"PPolyData\"><PPolyData>\n{pieces}</PPolyData></VTKFile>")
    };
    for x in -1..2 {
        put(folder.path(), &format!("t{x}.vtk"), &tile(x));
    }
    let whole = tile(-1).replace(" 0 0 -1", " 2 0 -1").replace(" 0 0 1", " 2 0 1");
    put(folder.path(), "whole.vtk", &whole);
    put(folder.path(), "all.pvtp", &list(&["t-1.vtk", "t0.vtk", "t1.vtk"]));
    put(
        folder.path(),
        "a.pvd",
        &collection(
            &[part(0, "t-1.vtk"), part(0, "t0.vtk"), part(0, "t1.vtk"), part(3, "all.pvtp")].concat(),
        ),
    );
    let shown = films(folder.path(), &text("Mesh(\"whole.vtk\")"));
    for shape in ["Mesh(\"all.pvtp\")", "Mesh(series: \"a.pvd\")"] {
        let found = films(folder.path(), &text(shape));
        assert!(found.iter().zip(&shown).all(|(a, b)| same(a, b)), "{shape}");
    }
    // Jobs know all parts.
    put(folder.path(), "a.ron", &text("Mesh(series: \"a.pvd\")"));
    let export = || {
        kinora(folder.path(), &["farm", "export", "shell", "a.ron", "-o", "f_#.png"]);
        let job = fs::read_to_string(folder.path().join("a.farm.sh")).expect("a job");
        fs::remove_file(folder.path().join("a.farm.sh")).expect("a disk");
        job
    };
    let before = export();
    put(folder.path(), "t1.vtk", &tile(2));
    assert!(before != export(), "another part is another job");
    // Faults name the part.
    put(folder.path(), "t1.vtk", &tile(1).replace("4 0 1 2 3", "4 0 1 2 9"));
    let printed = refused(folder.path(), &["check", "a.ron"]);
    assert!(printed.contains("\"t1.vtk\", line 8: ") || printed.contains("\"t1.vtk\": "), "{printed}");
    put(folder.path(), "all.pvtp", &list(&["all.pvtp"]));
    put(folder.path(), "a.ron", &text("Mesh(\"all.pvtp\")"));
    let printed = refused(folder.path(), &["check", "a.ron"]);
    assert!(printed.contains("\"all.pvtp\": the parts of a list are .vtk, .vtp or .vtu files"), "{printed}");
}

#[test]
fn damaged_and_missing_files_are_named_before_the_first_frame() {
    let folder = folder();
    put(folder.path(), "a.ron", &series("Hold"));
    kinora(folder.path(), &["check", "a.ron"]);
    put(folder.path(), "s_01.ply", &square(0.5).replace("3 0 2 3", "3 0 2 9"));
    for command in [&["check", "a.ron"][..], &["render", "a.ron", "-o", "f_#.png"]] {
        let printed = refused(folder.path(), command);
        assert!(printed.contains("cannot read the mesh \"s_01.ply\" of the series"), "{printed}");
        assert!(printed.contains("there is no vertex 9"), "{printed}");
    }
    fs::remove_file(folder.path().join("s_01.ply")).expect("a disk");
    let printed = refused(folder.path(), &["check", "a.ron"]);
    assert!(printed.contains("s_01.ply is missing"), "{printed}");
    assert!(!folder.path().join("f_0.png").exists());
}

#[test]
fn files_that_change_meanwhile_are_an_error() {
    let folder = folder();
    let path = folder.path().join("a.ron");
    let root = kinora::base::files::Root::of(folder.path());
    let sequence = load_text(&path, &series("Hold"), root, &Default::default()).expect("a sequence");
    put(folder.path(), "s_02.ply", &square(3.0));
    let mut frames = kinora::pipeline::schedule::FrameLoop::new(
        &sequence,
        kinora::pipeline::schedule::FilmCollector::default(),
        Default::default(),
    );
    frames.frame(2).expect("the second file is the same");
    let error = frames.frame(4).expect_err("the third file is another one");
    let printed = kinora::pipeline::render::RenderError::from(error).to_string();
    assert!(
        printed.starts_with("frame 4: cannot read the mesh ")
            && printed.ends_with("it has changed since it was checked"),
        "{printed}"
    );
}

#[test]
fn jobs_know_every_file() {
    let folder = folder();
    put(folder.path(), "a.ron", &series("Hold"));
    kinora(folder.path(), &["farm", "export", "shell", "a.ron", "-o", "f_#.png"]);
    let job = fs::read_to_string(folder.path().join("a.farm.sh")).expect("a job");
    let words: Vec<&str> = job.split_whitespace().collect();
    let place = words.iter().position(|word| *word == "--expect").expect("a fingerprint");
    let expected = words[place + 1].trim_matches(['\'', '"']);
    let arguments = ["render", "a.ron", "--expect", expected, "--frames", "0", "-o", "f_#.png"];
    kinora(folder.path(), &arguments);
    put(folder.path(), "s_02.ply", &square(1.5));
    let printed = refused(folder.path(), &arguments);
    assert!(printed.contains("s_02.ply has changed since"), "{printed}");
}

#[test]
fn open_shutters_see_several_steps() {
    let folder = folder();
    let blurred = series("Blend").replace("(position: (1, 2, 5))", "(position: (1, 2, 5), shutter: 1)");
    let sharp = films(folder.path(), &series("Blend"));
    let found = films(folder.path(), &blurred);
    assert!(!same(&found[0], &sharp[0]));
    assert!(same(&found[1], &films(folder.path(), &blurred)[1]));
}
