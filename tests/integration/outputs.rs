//! What `kinora` writes besides plain frames: videos, raw streams, filmstrips, posters, and animations of frames that
//! are there; and what is left when it is stopped.

use crate::command::{BALL, contents, folder, kinora, refused, run};
use std::fs;
use std::path::Path;

fn size(folder: &Path, name: &str) -> (u32, u32) {
    image::image_dimensions(folder.join(name)).expect(name)
}

#[test]
fn raw_video_goes_to_the_standard_output_and_words_elsewhere() {
    let folder = folder();
    let output = run(folder.path(), &["render", "ball.ron", "-o", "-", "--frames", "0-3"]);
    let head = b"YUV4MPEG2 W32 H18 F24:1 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n";
    assert!(output.stdout.starts_with(head));
    assert_eq!(output.stdout.len(), head.len() + 4 * (6 + 32 * 18 * 3 / 2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("frames  4"));
    let refused = run(folder.path(), &["render", "ball.ron", "-o", "-", "--progress", "json"]);
    assert_eq!(refused.status.code(), Some(2));
}

/// What netpbm calls a stream: pictures one after the other, each with its header.
#[test]
fn stills_go_to_the_standard_output_one_after_the_other() {
    let folder = folder();
    kinora(folder.path(), &["render", "ball.ron", "-o", "f_#.ppm", "-o", "f_#.png", "--frames", "0-2"]);
    let files = contents(folder.path());
    let all = |extension: &str| [0, 1, 2].map(|k| files[&format!("f_{k}.{extension}")].clone()).concat();
    let stream = |more: &[&str]| {
        let output =
            run(folder.path(), &[&["render", "ball.ron", "-o", "-", "--frames", "0-2"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stderr).contains("frames  3"), "words go elsewhere");
        output.stdout
    };
    assert!(stream(&["--format", "ppm"]) == all("ppm"));
    assert!(stream(&["--format", "png"]) == all("png"));
    // Frames that are kept go there as well.
    assert!(stream(&["--format", "png", "-o", "f_#.png"]) == all("png"));
    assert!(stream(&["--format", "ppm", "-o", "f_#.png"]) == all("ppm"));
    assert!(stream(&["--format", "y4m"]) == stream(&[]));
    let one =
        run(folder.path(), &["render", "ball.ron", "-o", "-", "--format", "png", "--frames", "1", "-q"]);
    assert!(one.stdout == files["f_1.png"] && one.stderr.is_empty());
    let plain = stream(&["--format", "ppm-ascii"]);
    let text = String::from_utf8(plain).expect("letters");
    assert!(text.lines().all(|line| line.len() <= 70), "as netpbm says");
    let mut words = text.split_ascii_whitespace();
    for k in 0..3 {
        let head: Vec<_> = words.by_ref().take(4).collect();
        assert_eq!(head, ["P3", "32", "18", "255"]);
        let samples: Vec<u8> =
            words.by_ref().take(32 * 18 * 3).map(|word| word.parse().expect("a code")).collect();
        let shown = image::open(folder.path().join(format!("f_{k}.png"))).expect("a PNG").into_rgb8();
        assert!(samples == shown.into_raw(), "frame {k}");
    }
    assert_eq!(words.next(), None);
}

#[test]
fn formats_of_the_standard_output_are_listed() {
    let folder = folder();
    let printed = |more: &[&str]| refused(folder.path(), &[&["render", "ball.ron"], more].concat());
    assert!(printed(&["-o", "-", "--format", "gif"]).contains("y4m, ppm, ppm-ascii or png"));
    assert!(printed(&["-o", "a.png", "--format", "ppm"]).contains("write -o - as well"));
    assert!(
        printed(&["-o", "-", "--format", "png", "--progress", "json"])
            .contains("both write to the standard output")
    );
}

#[test]
fn ppm_files_may_be_of_ascii() {
    let folder = folder();
    let text = BALL.replace("size: (32, 18)", "size: (32, 18), ppm: (ascii: true)");
    fs::write(folder.path().join("ascii.ron"), text).expect("writable");
    kinora(folder.path(), &["render", "ascii.ron", "-o", "a.ppm", "-o", "a.png", "--frames", "5"]);
    let files = contents(folder.path());
    assert!(files["a.ppm"].starts_with(b"P3\n"));
    let open = |name: &str| image::open(folder.path().join(name)).expect(name).into_rgb8();
    assert!(open("a.ppm") == open("a.png"));
    let stream = run(folder.path(), &["render", "ascii.ron", "-o", "-", "--format", "ppm", "--frames", "5"]);
    assert!(stream.stdout == files["a.ppm"], "as the sequence says");
}

#[test]
fn clamped_half_floats_are_counted() {
    let folder = folder();
    let text = "(output: (size: (4, 2), exr: (precision: Half)), background: (70000, 1, 65519))";
    fs::write(folder.path().join("bright.ron"), text).expect("writable");
    let printed = kinora(folder.path(), &["render", "bright.ron", "-o", "a.exr"]);
    assert!(printed.contains("8 numbers above 65504"), "{printed}");
    let image =
        exr::prelude::read_first_flat_layer_from_file(folder.path().join("a.exr")).expect("an EXR file");
    for channel in image.layer_data.channel_data.list {
        let expected = if channel.name.to_string() == "G" { 1.0 } else { 65504.0 };
        assert!(channel.sample_data.values_as_f32().all(|value| value == expected), "{}", channel.name);
    }
    let printed = kinora(folder.path(), &["render", "ball.ron", "-o", "b.exr", "--frames", "0"]);
    assert!(!printed.contains("65504"), "{printed}");
}

#[test]
fn every_format_is_written_and_frames_can_be_assembled_again() {
    let folder = folder();
    let all = ["a_##.png", "a.gif", "a.apng", "a.webp", "a.mp4", "a.y4m", "a_##.jpg", "a_##.ppm", "a_##.exr"];
    let mut arguments = vec!["render", "ball.ron"];
    arguments.extend(all.iter().flat_map(|name| ["-o", name]));
    kinora(folder.path(), &arguments);
    let printed =
        kinora(folder.path(), &["assemble", "a_##.png", "-o", "b.gif", "-o", "b.mp4", "-o", "b.webp"]);
    assert!(printed.contains("frames  12 at 24 per second"));
    let bytes = |name: &str| fs::read(folder.path().join(name)).expect(name);
    for format in ["gif", "mp4", "webp"] {
        assert!(bytes(&format!("a.{format}")) == bytes(&format!("b.{format}")), "{format}");
    }
    let refused = run(folder.path(), &["assemble", "c_##.png", "-o", "c.gif"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("there are no frames c_##.png"));
}

/// The only thread of a run traces, and encodes while it waits for the encoder.
#[test]
fn videos_do_not_depend_on_threads() {
    let folder = folder();
    let video = |threads: &str| {
        let name = format!("{threads}.mp4");
        kinora(folder.path(), &["render", "ball.ron", "-r", "400", "-t", threads, "-o", &name]);
        fs::read(folder.path().join(name)).expect("a video")
    };
    let one = video("1");
    assert!(one == video("2") && one == video("3"));
}

#[test]
fn frames_can_be_assembled_as_the_sequence_says() {
    let folder = folder();
    let own = "gif: (loop_count: 1, colors: 16), apng: (loop_count: 1), webp: (loop_count: 1), transparent: true, \
         background_color: \"#f00\"";
    let text = BALL.replace("size: (32, 18)", &format!("size: (32, 18), {own}"));
    fs::write(folder.path().join("ball.ron"), text).expect("writable");
    let formats = ["gif", "apng", "webp", "mp4"];
    let named = |name: &str| formats.map(|format| format!("{name}.{format}"));
    let outputs =
        |names: &[String]| names.iter().flat_map(|name| ["-o".to_owned(), name.clone()]).collect::<Vec<_>>();
    let run = |arguments: &[&str], names: &[String]| {
        let outputs = outputs(names);
        let arguments = arguments.iter().copied().chain(outputs.iter().map(String::as_str));
        kinora(folder.path(), &arguments.collect::<Vec<_>>())
    };
    run(&["render", "ball.ron", "-o", "f_##.png"], &named("a"));
    run(
        &["assemble", "f_##.png", "--loop-count", "1", "--background-color", "#ff0000", "--colors", "16"],
        &named("b"),
    );
    let files = contents(folder.path());
    for format in formats {
        assert!(files[&format!("a.{format}")] == files[&format!("b.{format}")], "{format}");
    }
    run(&["assemble", "f_##.png", "--colors", "16"], &named("c"));
    let files = contents(folder.path());
    assert!(formats.iter().all(|format| files[&format!("a.{format}")] != files[&format!("c.{format}")]));
    for (option, value) in [
        ("--loop-count", "0"),
        ("--loop-count", "65536"),
        ("--background-color", "red"),
        ("--background-color", "#12345"),
    ] {
        let refused =
            crate::command::refused(folder.path(), &["assemble", "f_##.png", "-o", "d.gif", option, value]);
        assert!(refused.contains(option), "{refused}");
    }
}

#[test]
fn layers_of_any_names_have_channels_of_their_own() {
    let folder = folder();
    let light = |(index, name): (usize, &&str)| {
        format!("{name:?}: Point(position: (1, 5, 3), intensity: [(0, 1), ({}, 0)]),", index + 1)
    };
    for names in [&["albedo", "N", "Z", "R"][..], &["x y", "x_y_3", "x.y"]] {
        let lights: String = names.iter().enumerate().map(light).collect();
        let text = BALL.replace("lights: {", &format!("lights: {{ {lights}"));
        let text = text.replace("(32, 18)", "(32, 18), exr: (layers: [Lights, Depth, Normal, Albedo])");
        fs::write(folder.path().join("lit.ron"), text).expect("writable");
        kinora(folder.path(), &["render", "lit.ron", "--frames", "0", "--overwrite", "-o", "f.exr"]);
    }
}

#[test]
fn missing_glyphs_are_reported() {
    let folder = folder();
    let note = "captions are without `漢`, which the font does not have";
    let printed = |arguments: &[&str]| {
        let printed = kinora(folder.path(), arguments);
        assert_eq!(printed.matches(note).count(), 1, "{arguments:?}: {printed}");
    };
    printed(&["render", "ball.ron", "-o", "f_##.png", "--caption", "zoë 漢 {frame}"]);
    printed(&["filmstrip", "ball.ron", "-n", "2", "--caption", "漢"]);
    printed(&["assemble", "f_##.png", "-o", "strip.png", "--caption", "漢"]);
    printed(&["poster", "ball.ron", "--caption", "漢漢"]);
    let text = BALL.replace("size: (32, 18)", "size: (32, 18), caption: \"漢\"");
    fs::write(folder.path().join("ball.ron"), text).expect("writable");
    printed(&["check", "ball.ron"]);
}

#[test]
fn parts_beside_whole_animations_are_noted() {
    let folder = folder();
    fs::write(folder.path().join("part_a.gif"), "a part").expect("writable");
    let render =
        |rest: &[&str]| kinora(folder.path(), &[&["render", "ball.ron", "-o", "a.gif"], rest].concat());
    let printed = render(&[]);
    assert!(printed.contains("note    part_a.gif holds a part of this animation"), "{printed}");
    assert!(folder.path().join("part_a.gif").exists(), "it may be wanted");
    assert!(!render(&["-o", "part_a.gif"]).contains("holds a part"));
}

/// Frames that are made of the film of another have its error.
#[test]
fn errors_name_all_frames() {
    let folder = folder();
    let still =
        BALL.replace("frames: 12", "frames: 3").replace("[(0, (-1, 0, 0)), (12, (1, 0, 0))]", "(0, 0, 0)");
    fs::write(folder.path().join("still.ron"), still).expect("writable");
    let noisy = ["--integrator", "path", "--noise", "0.5", "--progress", "json", "-o", "f_#.png"];
    let printed = kinora(folder.path(), &[&["render", "still.ron"], &noisy[..]].concat());
    let noise = printed.split("\"noise\":{").nth(1).expect("a summary");
    assert!([0, 1, 2].iter().all(|frame| noise.contains(&format!("\"{frame}\":{{\"error\""))), "{printed}");
}

#[test]
fn the_rate_of_finished_frames_is_in_them() {
    let folder = folder();
    kinora(folder.path(), &["render", "ball.ron", "-r", "30000/1001", "-o", "f_##.png"]);
    let printed = kinora(folder.path(), &["assemble", "f_##.png", "-o", "f.gif"]);
    assert!(printed.contains("at 30000/1001 per second"));
    kinora(folder.path(), &["render", "ball.ron", "--no-metadata", "-o", "g_##.png"]);
    let (with, without) =
        (fs::read(folder.path().join("f_00.png")), fs::read(folder.path().join("g_00.png")));
    assert!(with.expect("a file").len() > without.expect("a file").len() + 100);
}

#[test]
fn filmstrips_and_posters() {
    let folder = folder();
    kinora(folder.path(), &["filmstrip", "ball.ron", "-n", "4", "--columns", "2"]);
    let strip = size(folder.path(), "output/ball_filmstrip.png");
    assert!(strip.0 > 64 && strip.1 > 2 * 18 + 20, "{strip:?}");
    kinora(
        folder.path(),
        &["poster", "ball.ron", "--at", "0.25", "--transparent", "-o", "p.png", "-s", "64x36"],
    );
    let poster = image::open(folder.path().join("p.png")).expect("a picture").into_rgba8();
    assert_eq!((poster.dimensions(), poster.get_pixel(0, 0)[3]), ((64, 36), 0));
    for (arguments, message) in [
        (&["filmstrip", "ball.ron", "-o", "s.gif"][..], "write .png, .jpg or .ppm"),
        (&["filmstrip", "ball.ron", "--frames", "0-99"], "--frames: "),
        (&["poster", "ball.ron", "-o", "p.mp4"], "a poster is one picture"),
        (&["poster", "ball.ron", "--frame", "12"], "the last one is 11"),
        (&["render", "ball.ron", "--caption", "{day}"], "there is no `{day}`"),
    ] {
        let refused = run(folder.path(), arguments);
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
        assert!(String::from_utf8_lossy(&refused.stderr).contains(message), "{refused:?}");
    }
}

#[test]
fn invalid_places_are_refused_before_rendering() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("folder.png")).expect("a disk");
    kinora(path, &["render", "ball.ron", "-o", "f_##.png"]);
    let before = contents(path);
    for (arguments, message) in [
        (&["filmstrip", "ball.ron", "-o", "folder.png"][..], "folder.png: it is a folder; name a file in it"),
        (&["filmstrip", "ball.ron", "-o", "ball.ron/s.png"], "ball.ron is a file; name a folder there"),
        (&["render", "ball.ron", "-o", "ball.ron/a.gif"], "ball.ron is a file; name a folder there"),
        (&["assemble", "f_##.png", "-o", "a.gif", "-o", "folder.png"], "folder.png: it is a folder"),
        (&["assemble", "none/f_##.png", "-o", "a.gif"], "none/f_##.png: there is no folder none; name"),
        (&["assemble", "ball.ron/f_##.png", "-o", "a.gif"], "ball.ron is a file; name a folder there"),
        (&["accuracy", "ball.ron", "-o", "ball.ron/new"], "ball.ron is a file; name another folder with -o"),
    ] {
        let printed = refused(path, arguments);
        assert!(printed.contains(message), "{printed}");
    }
    assert!(contents(path) == before, "something was written");
}

/// A run that is stopped leaves whole frames, animations of what there is, and the command to go on.
#[cfg(unix)]
#[test]
fn a_signal_stops_after_the_frame_in_hand() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let folder = folder();
        let long = BALL.replace("frames: 12", "frames: 100000").replace("(32, 18)", "(320, 180)");
        fs::write(folder.path().join("long.ron"), long).expect("writable");
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("kinora"));
        command
            .current_dir(folder.path())
            .args(["render", "long.ron", "-o", "f_#.png", "-o", "a.gif", "-o", "a.apng"]);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the binary runs");
        let start = Instant::now();
        while !folder.path().join("f_2.png").exists() {
            assert!(start.elapsed() < Duration::from_secs(60), "no frame comes");
            std::thread::sleep(Duration::from_millis(5));
        }
        let sent = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
        assert!(sent.expect("a command").success());
        let output = child.wait_with_output().expect("it ends");
        let printed = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{printed}");
        let next = "to continue: kinora render long.ron -o 'f_#.png' -o a.gif -o a.apng";
        assert!(printed.trim_end().ends_with(next), "{printed}");
        let done = printed.split("stopped after ").nth(1).and_then(|rest| rest.split(' ').next());
        let done: u32 = done.and_then(|digits| digits.parse().ok()).expect("a number");
        let mut names: Vec<String> = fs::read_dir(folder.path())
            .expect("a folder")
            .flatten()
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .collect();
        names.retain(|name| !name.starts_with("f_"));
        names.sort();
        assert_eq!(names, ["ball.ron", "long.ron", "part_a.apng", "part_a.gif"]);
        let whole = |frame: u32| image::open(folder.path().join(format!("f_{frame}.png"))).is_ok();
        assert!((0..done).all(whole) && !folder.path().join(format!("f_{done}.png")).exists());
    }
}

#[cfg(unix)]
#[test]
fn names_of_outputs_need_not_be_text() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = folder();
    let (stills, movie) = (OsStr::from_bytes(b"d\xff/f\xfe_##.png"), OsStr::from_bytes(b"d\xff/\xfe.gif"));
    let printed = |words: &[&str], output: &[&OsStr]| {
        let mut command =
            assert_cmd::Command::cargo_bin("kinora").expect("the binary is built with its tests");
        let done =
            command.current_dir(folder.path()).args(words).args(output).output().expect("the binary runs");
        assert!(done.status.success(), "{}", crate::command::stderr(&done));
        String::from_utf8_lossy(&done.stdout).into_owned()
    };
    let option = OsStr::new("-o");
    let first = printed(&["render", "ball.ron"], &[option, stills, option, movie]);
    assert!(first.contains("wrote   d\\xff/f\\xfe_##.png\n        d\\xff/\\xfe.gif\n"), "{first}");
    let names = contents(&folder.path().join(OsStr::from_bytes(b"d\xff")));
    assert_eq!(names.len(), 13);
    assert!(folder.path().join(OsStr::from_bytes(b"d\xff/f\xfe_07.png")).exists());
    assert!(printed(&["render", "ball.ron"], &[option, stills, option, movie]).contains("12 of them kept"));
    printed(&["assemble"], &[stills, option, OsStr::from_bytes(b"\xfe.mp4")]);
    let status = ["farm", "status"].map(OsStr::new);
    let job = [&status[..], &[OsStr::from_bytes(b"d\xff"), OsStr::new("ball.ron"), option, stills]].concat();
    assert!(printed(&[], &job).contains("12 done"));
}

/// Nobody reads the frames: from the beginning, or not to the end.
#[cfg(unix)]
#[test]
fn a_closed_standard_output_is_an_error() {
    use std::process::{Command, Stdio};
    let folder = folder();
    let shell = |line: &str| {
        let mut command = Command::new("sh");
        let binary = assert_cmd::cargo::cargo_bin("kinora");
        command.args(["-c", line, "sh"]).arg(binary).current_dir(folder.path());
        command.output().expect("a shell")
    };
    kinora(folder.path(), &["render", "ball.ron", "-o", "f_##.png"]);
    for words in ["render ball.ron -o - -o new/f_##.png", "assemble f_##.png -o -"] {
        // Who starts a program without a standard output may also open the null device for reading and writing.
        for nowhere in [">&-", "1<> /dev/null"] {
            let done = shell(&format!("exec \"$1\" {words} {nowhere}"));
            let printed = crate::command::stderr(&done);
            assert_eq!(done.status.code(), Some(3), "{printed}");
            for part in ["cannot write to the standard output: it is closed, or", "with `> /dev/null`"] {
                assert!(printed.contains(part), "{printed}");
            }
            assert!(!folder.path().join("new").exists());
        }
        assert!(shell(&format!("exec \"$1\" {} > /dev/null", words.replace("new/", ""))).status.success());
    }
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("kinora"));
    command.current_dir(folder.path()).args(["render", "ball.ron", "-s", "640x360", "-o", "-"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the binary runs");
    drop(child.stdout.take());
    let done = child.wait_with_output().expect("it ends");
    assert_eq!(done.status.code(), Some(3));
    let printed = crate::command::stderr(&done);
    assert!(
        printed.contains("cannot write the standard output: ")
            && printed.contains("the reader of the pipe has ended"),
        "{printed}"
    );
}

#[cfg(unix)]
#[test]
fn a_stopped_quiet_run_prints_nothing() {
    use std::process::{Command, Stdio};
    // From frame 12 on, frames repeat one film.
    for (signal, code, frame) in [("INT", 130, 2), ("TERM", 143, 2), ("INT", 130, 50), ("TERM", 143, 500)] {
        let folder = folder();
        fs::write(folder.path().join("long.ron"), BALL.replace("frames: 12", "frames: 100000"))
            .expect("writable");
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("kinora"));
        command.current_dir(folder.path()).args(["render", "long.ron", "-q", "-o", "f_#.png", "-o", "a.gif"]);
        let mut child =
            command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the binary runs");
        while !folder.path().join(format!("f_{frame}.png")).exists() {
            assert!(child.try_wait().expect("a process").is_none(), "it was too fast");
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        let sent = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
        assert!(sent.expect("a command").success());
        let done = child.wait_with_output().expect("it ends");
        assert_eq!(done.status.code(), Some(code));
        assert!(done.stdout.is_empty() && done.stderr.is_empty(), "{}", crate::command::stderr(&done));
        assert!(folder.path().join("part_a.gif").exists());
        assert!(!folder.path().join("f_99999.png").exists());
    }
}
