//! Runs beside and after each other in one folder.

use crate::command::{BALL, contents, folder, kinora, refused};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

#[test]
fn shards_write_the_frames_of_one_run() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    kinora(
        folder.path(),
        &["render", "ball.ron", "-o", "one/f_##.png", "-o", "one/f_##.exr", "-o", "one/a.gif"],
    );
    std::thread::scope(|scope| {
        for shard in ["1/5", "2/5", "3/5", "4/5", "5/5"] {
            let outputs = ["-o", "all/f_##.png", "-o", "all/f_##.exr"];
            let arguments = [&["render", "ball.ron", "--shard", shard], &outputs[..]].concat();
            let path = folder.path();
            scope.spawn(move || kinora(path, &arguments));
        }
    });
    kinora(folder.path(), &["assemble", "all/f_##.png", "-o", "all/a.gif"]);
    assert!(contents(&at("one")) == contents(&at("all")));
    assert_eq!(contents(&at("one")).len(), 25);
}

#[test]
fn shards_write_stills() {
    let folder = folder();
    let printed = kinora(folder.path(), &["render", "ball.ron", "--shard", "1/1"]);
    assert!(printed.contains("output/ball.gif holds all frames and is left as it is"), "{printed}");
    assert!(!folder.path().join("output/ball.gif").exists());
    let printed = refused(folder.path(), &["render", "ball.ron", "--shard", "1/2", "-o", "a.gif"]);
    assert!(
        printed.contains("every process would write all of a.gif") && printed.contains("kinora assemble"),
        "{printed}"
    );
    let printed = refused(folder.path(), &["render", "ball.ron", "--shard", "3/2", "-o", "f_##.png"]);
    assert!(printed.contains("such as 2/4"), "{printed}");
    let printed = kinora(folder.path(), &["render", "ball.ron", "--shard", "1/20", "-o", "few/f_##.png"]);
    assert_eq!(printed, "shard 1/20 has no frames: there are 12 frames\n");
    assert!(!folder.path().join("few").exists());
}

#[test]
fn nothing_is_replaced_where_nothing_may_be() {
    let folder = folder();
    let refusing = |outputs: &[&str]| {
        refused(folder.path(), &[&["render", "ball.ron", "--fail-if-exists"], outputs].concat())
    };
    for name in ["f_11.png", "a.gif"] {
        fs::write(folder.path().join(name), "mine").expect("a disk");
    }
    let before = contents(folder.path());
    for outputs in [&["-o", "f_##.png"][..], &["-o", "new/f_##.png", "-o", "a.gif"]] {
        let printed = refusing(outputs);
        assert!(printed.contains(" exists already") && printed.contains("--fail-if-exists"), "{printed}");
    }
    assert!(contents(folder.path()) == before && !folder.path().join("new").exists());
    // Frames of other numbers are none of those that would be written.
    let rest = ["render", "ball.ron", "--fail-if-exists", "--frames", "0-10", "-o", "f_##.png"];
    kinora(folder.path(), &rest);
    refused(folder.path(), &rest);
    refused(folder.path(), &["render", "ball.ron", "--fail-if-exists", "--overwrite"]);
    fs::create_dir(folder.path().join("g_03.png")).expect("a disk");
    let printed = refused(folder.path(), &["render", "ball.ron", "-o", "g_##.png"]);
    assert!(printed.contains("g_03.png: it is a folder"), "{printed}");
}

/// The frames of a run: all of them, and those that were kept.
fn told_kept(printed: &str) -> (u32, u32) {
    let line = printed.lines().find(|line| line.starts_with("frames ")).expect("a summary");
    let mut numbers = line.split(|c: char| !c.is_ascii_digit()).filter_map(|digits| digits.parse().ok());
    (numbers.next().expect("a number"), numbers.next().unwrap_or(0))
}

/// Renders into stills of all kinds and animations; gives how many frames were kept and what there is then.
fn rendered(folder: &Path, rest: &[&str]) -> (u32, BTreeMap<String, Vec<u8>>) {
    let outputs = ["-o", "f_##.png", "-o", "f_##.exr", "-o", "f_##.jpg", "-o", "a.gif", "-o", "a.mp4"];
    let printed = kinora(folder, &[&["render", "ball.ron"], &outputs[..], rest].concat());
    (told_kept(&printed).1, contents(folder))
}

#[test]
fn a_second_run_keeps_correct_frames() {
    let folder = folder();
    let path = folder.path();
    let (kept, whole) = rendered(path, &[]);
    assert_eq!((kept, whole.len()), (0, 39));
    let modified = |name: &str| fs::metadata(path.join(name)).and_then(|file| file.modified()).expect(name);
    let before = ["f_00.png", "f_00.exr"].map(modified);
    let (kept, again) = rendered(path, &[]);
    assert_eq!(kept, 12);
    assert!(again == whole, "a second run changes bytes");
    assert_eq!(before, ["f_00.png", "f_00.exr"].map(modified), "kept files are not touched");

    // Each in another way: missing, cut, empty, one bit changed, another frame's, foreign, longer.
    let damage = |name: &str, with: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = whole[name].clone();
        with(&mut bytes);
        fs::write(path.join(name), bytes).expect("a disk");
    };
    fs::remove_file(path.join("f_00.png")).expect("it was there");
    damage("f_01.png", &|bytes| bytes.truncate(bytes.len() - 5));
    damage("f_02.png", &Vec::clear);
    damage("f_03.png", &|bytes| *bytes = whole["f_04.png"].clone());
    damage("f_05.png", &|bytes| *bytes = whole["f_05.jpg"].clone());
    damage("f_06.png", &|bytes| bytes.push(0));
    let middle = whole["f_07.png"].len() / 2;
    damage("f_07.png", &|bytes| bytes[middle] ^= 1);
    let end = whole["f_08.exr"].len() - 40;
    damage("f_08.exr", &|bytes| bytes[end] ^= 1);
    damage("f_09.exr", &|bytes| bytes.truncate(end));
    fs::remove_file(path.join("f_10.jpg")).expect("it was there");
    fs::remove_file(path.join("a.gif")).expect("it was there");
    let (kept, mended) = rendered(path, &[]);
    assert_eq!(kept, 3, "frames 4, 10 and 11");
    assert!(mended == whole, "what is mended differs");

    let (kept, anew) = rendered(path, &["--overwrite"]);
    assert_eq!(kept, 0);
    assert!(anew == whole);
}

/// Every bit of a small frame counts.
#[test]
fn no_damaged_frame_is_kept() {
    let folder = folder();
    let path = folder.path();
    for name in ["f_##.png", "f_##.exr"] {
        let arguments = ["render", "ball.ron", "--frames", "3", "-s", "8x6", "-o", name];
        kinora(path, &arguments);
        let file = path.join(name.replace("##", "03"));
        let whole = fs::read(&file).expect("a frame");
        for part in 0..40 {
            let mut bytes = whole.clone();
            let at = part * (whole.len() - 1) / 39;
            bytes[at] ^= 1 << (part % 8);
            fs::write(&file, &bytes).expect("a disk");
            kinora(path, &arguments);
            assert!(fs::read(&file).expect("a frame") == whole, "{name}: byte {at} is not mended");
        }
    }
}

#[test]
fn only_changed_frames_are_rendered_again() {
    let base = BALL.to_owned();
    let run = |first: &str, second: &str, rest: &[&str]| {
        let folder = folder();
        let render = |text: &str| {
            fs::write(folder.path().join("ball.ron"), text).expect("a disk");
            let printed = kinora(folder.path(), &[&["render", "ball.ron", "-o", "f_##.png"], rest].concat());
            (told_kept(&printed).1, contents(folder.path()))
        };
        render(first);
        let (kept, found) = render(second);
        fs::remove_dir_all(folder.path()).expect("a folder");
        fs::create_dir(folder.path()).expect("a folder");
        assert!(render(second).1 == found, "a run that goes on differs from one that does not");
        kept
    };
    let with = |from: &str, to: &str| {
        assert!(base.contains(from));
        base.replace(from, to)
    };
    // The ball stands still from frame 6 on in both, and goes another way before.
    let moves = |x: f64| with("[(0, (-1, 0, 0)), (12,", &format!("[(0, ({x}, 0, 0)), (6, (1, 0, 0)), (12,"));
    assert_eq!(run(&moves(-1.0), &moves(-2.0), &[]), 6);
    // A light goes out earlier: frames before and after see the same.
    let out = |frame: u32| with("(3, 4, 5)", &format!("(3, 4, 5), on: [(0, true), ({frame}, false)]"));
    assert_eq!(run(&out(9), &out(7), &[]), 10);
    // What does not show, and what changes no pixel.
    let off = "(3, 4, 5)), \"off\": Point(position: (1, 2, 3), intensity: 0)";
    assert_eq!(run(&base, &with("(3, 4, 5))", off), &[]), 12);
    assert_eq!(run(&base, &with("objects: {", "// A comment.\n objects: {"), &["-t", "3"]), 12);
    let until_9 = "objects: { \"late\": (shape: Sphere(center: (2, 0, 0)), material: (emission: [(0, 0), (12, 1)]), \
                   visible: [(0, false), (9, true)]),";
    assert_eq!(run(&base, &with("objects: {", until_9), &[]), 9);
    let lamp = "lights: { \"late\": Point(position: (1, 2, 3), on: [(0, false), (9, true)]),";
    assert_eq!(run(&base, &with("lights: {", lamp), &[]), 9);
    // A caption is drawn over the frames that are there.
    assert_eq!(run(&base, &with("size: (32, 18)", "size: (32, 18), caption: \"{frame}\""), &[]), 12);
    // What changes all.
    assert_eq!(run(&base, &with("size: (32, 18)", "size: (32, 18), tonemap: Filmic"), &[]), 0);
    assert_eq!(run(&base, &with("size: (32, 18)", "size: (32, 17)"), &[]), 0);
    assert_eq!(run(&base, &with("size: (32, 18)", "size: (32, 18), transparent: true"), &[]), 0);
    assert_eq!(run(&base, &with("(0.01, 0.03, 0.05)", "(0.01, 0.03, 0.06)"), &[]), 0);
}

#[test]
fn unused_settings_change_no_frames() {
    let folder = folder();
    let path = folder.path();
    let kept = |file: &str, rest: &[&str]| {
        told_kept(&kinora(path, &[&["render", file, "-o", "f_##.png"], rest].concat())).1
    };
    assert_eq!(kept("ball.ron", &[]), 0);
    // Nothing is random.
    assert_eq!(kept("ball.ron", &["--samples", "9"]), 12);
    assert_eq!(kept("ball.ron", &["--seed", "3"]), 12);
    let before = contents(path);
    fs::rename(path.join("ball.ron"), path.join("other.ron")).expect("a disk");
    assert_eq!(kept("other.ron", &[]), 12);
    assert!(before.iter().all(|(name, bytes)| name == "ball.ron" || contents(path).get(name) == Some(bytes)));
    assert_eq!(kept("other.ron", &["--antialias", "3"]), 0);
    // Everything is.
    let random = ["--integrator", "path", "--samples", "2"];
    assert_eq!(kept("other.ron", &random), 0);
    assert_eq!(kept("other.ron", &[&random[..], &["--antialias", "4"]].concat()), 12);
    assert_eq!(kept("other.ron", &[&random[..], &["--seed", "3"]].concat()), 0);
    // A caption shows the name. It is drawn over the frames that are there.
    let named = ["--caption", "{name}"];
    let plain = fs::read(path.join("f_03.png")).expect("a frame");
    assert_eq!(kept("other.ron", &[&random[..], &["--seed", "3"], &named].concat()), 12);
    let other = fs::read(path.join("f_03.png")).expect("a frame");
    fs::rename(path.join("other.ron"), path.join("ball.ron")).expect("a disk");
    assert_eq!(kept("ball.ron", &[&random[..], &["--seed", "3"], &named].concat()), 12);
    let ball = fs::read(path.join("f_03.png")).expect("a frame");
    assert!(plain != other && other != ball, "the name is shown");
    assert_eq!(kept("ball.ron", &named), 0);
}

#[test]
fn frames_without_metadata_are_rendered_again_with_a_note() {
    let folder = folder();
    for (outputs, reason) in [
        (&["-o", "j_##.jpg"][..], "j_##.jpg cannot hold metadata that identifies its frame"),
        (&["-o", "p_##.ppm"], "p_##.ppm cannot hold metadata"),
        (&["-o", "n_##.png", "--no-metadata"], "PNGs without metadata do not identify their frames"),
        (&["-o", "d_##.png", "--bits", "16", "-o", "d.gif"], "other outputs are made from PNGs of 8 bits"),
    ] {
        let render = || kinora(folder.path(), &[&["render", "ball.ron"], outputs].concat());
        assert!(!render().contains("could be kept"), "{outputs:?}");
        let printed = render();
        assert!(printed.contains(&format!("note    no existing frame could be kept: {reason}")), "{printed}");
        assert_eq!(told_kept(&printed), (12, 0));
    }
    // Deep frames alone are kept, and so are transparent ones that a video is made of.
    for outputs in
        [&["-o", "e_##.png", "--bits", "16"][..], &["-o", "t_##.png", "-o", "t.webp", "--transparent"]]
    {
        let render = || told_kept(&kinora(folder.path(), &[&["render", "ball.ron"], outputs].concat())).1;
        let found = (render(), contents(folder.path()), render());
        assert_eq!((found.0, found.2), (0, 12));
        assert!(found.1 == contents(folder.path()));
    }
}
