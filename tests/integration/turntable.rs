//! `kinora turntable`, and sequences with tables, as users run them.

use crate::command::{contents, kinora, refused};
use kinora::geometry::mesh::generate;
use kinora::import::{obj, ply};
use std::fs::{self, File};
use std::path::Path;
use tempfile::TempDir;

/// A folder with a part in `parts/`, far from the origin.
fn folder() -> TempDir {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    fs::create_dir(folder.path().join("parts")).expect("the folder is writable");
    let mut part = generate::icosphere(2);
    let far = kinora::base::math::DVec3::new(1e5, 1e5, 0.0);
    part.positions.iter_mut().for_each(|position| *position = *position * 20.0 + far);
    let file = |name: &str| File::create(folder.path().join("parts").join(name)).expect("a file");
    ply::write(file("ball.ply"), &part).expect("a disk");
    obj::write(file("ball.obj"), &part).expect("a disk");
    folder
}

/// The bytes of a frame, without its metadata.
fn picture(folder: &Path, name: &str) -> image::RgbImage {
    image::open(folder.join(name)).expect("a frame").into_rgb8()
}

const SMALL: [&str; 4] = ["-s", "64x48", "--antialias", "1"];

#[test]
fn the_written_sequence_gives_the_same_frames() {
    let folder = folder();
    let at = folder.path();
    let turn = ["turntable", "parts/ball.ply", "--frames", "4", "--write", "turns/t.ron", "-o", "a_#.png"];
    // A folder `assets` makes `turns` the root of the sequence, so that the part is outside of it.
    fs::create_dir_all(at.join("turns/assets")).expect("a disk");
    let printed = kinora(at, &[&turn[..], &SMALL].concat());
    assert!(printed.contains("`kinora render turns/t.ron --allow-outside` renders it again"), "{printed}");
    let text = fs::read_to_string(at.join("turns/t.ron")).expect("a sequence");
    assert!(
        text.contains("\"../parts/ball.ply\"") && text.contains("timeline: (frames: 4, fps: \"20\""),
        "{text}"
    );
    kinora(at, &[&["render", "turns/t.ron", "--allow-outside", "-o", "b_#.png"], &SMALL[..]].concat());
    let files = contents(at);
    for frame in 0..4 {
        assert_eq!(files[&format!("a_{frame}.png")], files[&format!("b_{frame}.png")], "frame {frame}");
    }
    // A ball is in the middle, up to the margins. Its colour is bluer than the ground's.
    let still = picture(at, "a_0.png");
    let is_part = |y: &u32| {
        let [red, _, blue] = still.get_pixel(32, *y).0;
        blue > red.saturating_add(8)
    };
    let column: Vec<u32> = (0..48).filter(is_part).collect();
    // A tenth of 48 pixels is free above it; below, its bluish shadow begins.
    assert!(column.len() > 30 && column.first().is_some_and(|y| (4..=6).contains(y)), "{column:?}");
}

/// The command in the note gives the same frames, whatever options there were.
#[test]
fn the_note_names_the_options_that_the_sequence_does_not_hold() {
    let folder = folder();
    let at = folder.path();
    for (number, options, note) in [
        (0, &["-s", "64x48", "--antialias", "2", "--bounces", "0"][..], "`kinora render t0.ron` renders"),
        (1, &["-s", "64x48", "--exposure", "-1"], "`kinora render t1.ron '--exposure=-1'` renders"),
        (2, &["--antialias", "2", "--draft"], "`kinora render t2.ron '--antialias=2' --draft` renders"),
        (3, &["--draft"], "`kinora render t3.ron --draft` renders"),
    ] {
        let (sequence, frames) = (format!("t{number}.ron"), format!("a{number}.png"));
        let turn = ["turntable", "parts/ball.ply", "--frames", "1", "--write", &sequence, "-o", &frames];
        let printed = kinora(at, &[&turn[..], options].concat());
        assert!(printed.contains(note), "{printed}");
        let command = note.trim_matches('`').split('`').next().unwrap_or_default();
        let given = command.split(' ').skip(1).map(|word| word.trim_matches('\''));
        let words: Vec<&str> = given.chain(["-o", "b.png", "--overwrite"]).collect();
        kinora(at, &words);
        let files = contents(at);
        assert_eq!(files[&frames], files["b.png"], "{options:?}");
    }
}

/// A turn that fails leaves no sequence that would be in the way of the next one.
#[test]
fn the_sequence_is_written_last() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("file"), "").expect("a disk");
    let turn = |output: &'static str| {
        [&["turntable", "parts/ball.ply", "--frames", "1", "--write", "t.ron", "-o", output][..], &SMALL]
            .concat()
    };
    refused(at, &turn("file/a.gif"));
    assert!(!at.join("t.ron").exists());
    kinora(at, &turn("a.gif"));
    let text = fs::read(at.join("t.ron")).expect("a sequence");
    // The same turn again has nothing else to write.
    kinora(at, &turn("a.gif"));
    assert_eq!(fs::read(at.join("t.ron")).expect("a sequence"), text);
    assert!(refused(at, &turn("b.gif")).contains("t.ron exists already"));
}

#[test]
fn the_help_states_its_own_defaults() {
    let printed = kinora(folder().path(), &["turntable", "--help"]);
    for part in ["[default: 640x480]", "[default: 20]", ".vtk", "keeps its number of frames"] {
        assert!(printed.contains(part), "{part}: {printed}");
    }
    assert!(!printed.contains("keeps its duration"), "{printed}");
}

#[test]
fn several_parts_are_one_turn() {
    let folder = folder();
    kinora(
        folder.path(),
        &[&["turntable", "parts/ball.ply", "parts/ball.obj", "--frames", "2", "-o", "a.gif"], &SMALL[..]]
            .concat(),
    );
    assert!(folder.path().join("a.gif").is_file());
    // Without a file, there is a usual one.
    kinora(
        folder.path(),
        &[&["turntable", "parts/ball.obj", "--frames", "2", "--up", "z"], &SMALL[..]].concat(),
    );
    assert!(folder.path().join("output/ball.gif").is_file());
}

/// A glTF file turns in its materials, alone or with meshes, and stands on the ground in the middle.
#[test]
fn gltf_scenes_turn() {
    let folder = folder();
    let at = folder.path();
    // A box that its node lifts, turns and moves far away.
    let boxed = "(objects: { \"b\": (shape: Box(min: (-1, -2, -1), max: (1, 2, 1)), translation: (1e3, 50, -7), \
                 rotation: AxisAngle(axis: (0, 1, 0), angle: 45), material: Lambertian(color: \"#f00\")) })";
    fs::write(at.join("b.ron"), boxed).expect("a disk");
    kinora(at, &["export", "b.ron", "-o", "parts/=b.glb"]);
    let turn = ["turntable", "parts/=b.glb", "--frames", "4", "-o", "a_#.png", "--write", "t.ron"];
    kinora(at, &[&turn[..], &SMALL].concat());
    let is_red = |picture: &image::RgbImage, x: u32, y: u32| {
        let [red, green, _] = picture.get_pixel(x, y).0;
        red > 60 && red / 2 > green
    };
    let still = picture(at, "a_0.png");
    let column: Vec<u32> = (0..48).filter(|y| is_red(&still, 32, *y)).collect();
    // As high as the picture without its margins, and as far to the left as to the right.
    assert!(column.len() > 34 && column.len() <= 40, "{column:?}");
    let row: Vec<u32> = (0..64).filter(|x| is_red(&still, *x, 24)).collect();
    let (left, right) = (row[0], 63 - row[row.len() - 1]);
    assert!(left.abs_diff(right) <= 1, "{row:?}");
    let text = fs::read_to_string(at.join("t.ron")).expect("a sequence");
    assert!(text.contains("Scene(file: \"parts/=b.glb\", animation: Off, lights: false)"), "{text}");
    // With z up, it lies on its side: a quarter of a turn later, it is seen in its length.
    let lying = ["turntable", "parts/=b.glb", "--up", "z", "--frames", "4", "-o", "z_#.png"];
    kinora(at, &[&lying[..], &SMALL].concat());
    let lying = picture(at, "z_1.png");
    let width = (0..64).filter(|x| is_red(&lying, *x, 24)).count();
    assert!(width > row.len() + 4, "{width} and {}", row.len());
    kinora(
        at,
        &[&["turntable", "parts/=b.glb", "parts/ball.ply", "--frames", "2", "-o", "c.gif"], &SMALL[..]]
            .concat(),
    );
    fs::write(at.join("bad.gltf"), "{}").expect("a disk");
    let message = refused(at, &["turntable", "bad.gltf"]);
    assert!(message.contains("cannot read bad.gltf: ") && !message.contains("part.ron"), "{message}");
}

/// The command line may name files anywhere, a sequence only those below the working directory.
#[test]
fn files_may_be_anywhere() {
    let folder = folder();
    let (at, work) = (folder.path(), folder.path().join("parts"));
    let absolute = at.join("a.gif").to_string_lossy().into_owned();
    let turn =
        ["turntable", "ball.ply", "--frames", "2", "--write", "t.ron", "-o", &absolute, "-o", "../b.gif"];
    kinora(&work, &[&turn[..], &SMALL].concat());
    assert!(at.join("a.gif").is_file() && at.join("b.gif").is_file());
    let text = fs::read_to_string(work.join("t.ron")).expect("a sequence");
    assert!(text.contains("files: [\"output/t.gif\"]"), "{text}");
}

#[test]
fn mistakes_are_refused() {
    let folder = folder();
    let at = folder.path();
    fs::write(at.join("bad.obj"), "v 0 0 zero\n").expect("a disk");
    fs::write(at.join("there.ron"), "()").expect("a disk");
    let has = |words: &[&str], part: &str| {
        let message = refused(at, &[&["turntable"], words].concat());
        assert!(message.contains(part), "{message}");
    };
    has(&["none.stl"], "cannot read none.stl: there is no such file");
    has(&["run.pvd"], "`Mesh(series: \"...\")` shows the meshes that a .pvd file lists");
    has(&["part.step"], "cannot read part.step: meshes are read from");
    has(&["bad.obj"], "cannot read bad.obj: line 1: expected three numbers");
    has(&["parts/ball.ply", "--write", "there.ron"], "there.ron exists already");
    has(&["parts/ball.ply", "--write", "no/such/a.ron"], "--write: there is no folder no/such");
    has(&["parts/ball.ply", "--write", "a.txt"], "a sequence is a .ron file");
    has(&["parts/ball.ply", "--frames", "0"], "--frames");
    assert_eq!(fs::read_to_string(at.join("there.ron")).expect("a file"), "()");
    assert!(!at.join("output").exists());
}

/// A changed table changes the frames that are kept, and the fingerprint of jobs.
#[test]
fn tables_are_part_of_what_is_rendered() {
    let folder = folder();
    let at = folder.path();
    let sequence = "(timeline: (frames: 2, fps: 1), output: (size: (16, 12)), \
                    objects: { \"a\": (shape: Sphere(), material: (ambient: 1), poses: \"poses.csv\") })";
    fs::write(at.join("a.ron"), sequence).expect("a disk");
    let table =
        |x: f64| fs::write(at.join("poses.csv"), format!("t,x,y,z\n0,0,0,0\n1,{x},0,0\n")).expect("a disk");
    table(1.0);
    let render = ["render", "a.ron", "-o", "f_#.png"];
    assert!(kinora(at, &render).contains("frames  2"));
    let before = contents(at);
    table(2.0);
    kinora(at, &render);
    let after = contents(at);
    assert_eq!(before["f_0.png"], after["f_0.png"]);
    assert_ne!(before["f_1.png"], after["f_1.png"]);
    kinora(at, &["farm", "export", "shell", "a.ron", "-o", "f_#.png"]);
    table(3.0);
    let message = refused(at, &[&render[..], &["--expect", &expected(at)]].concat());
    assert!(message.contains("poses.csv has changed"), "{message}");
}

/// The fingerprint that a job expects.
fn expected(folder: &Path) -> String {
    let texts = contents(folder).into_values().filter_map(|bytes| String::from_utf8(bytes).ok());
    let all: String = texts.collect();
    let (_, rest) = all.split_once("--expect").expect("a fingerprint");
    let rest = rest.trim_start_matches(['=', ' ', '\'', '"']);
    rest.split([' ', '\'', '"', '\n']).next().unwrap_or_default().to_owned()
}
