//! What `kinora` writes besides plain frames: videos, raw streams, filmstrips, posters, and animations of frames that
//! are there; and what is left when it is stopped.

use crate::command::{BALL, folder, kinora, run};
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

#[test]
fn every_format_is_written_and_frames_can_be_assembled_again() {
    let folder = folder();
    let all = ["a_##.png", "a.gif", "a.apng", "a.webp", "a.mp4", "a.y4m", "a_##.jpg", "a_##.ppm", "a_##.exr"];
    let mut arguments = vec!["render", "ball.ron"];
    arguments.extend(all.iter().flat_map(|name| ["-o", name]));
    kinora(folder.path(), &arguments);
    let told = kinora(folder.path(), &["assemble", "a_##.png", "-o", "b.gif", "-o", "b.mp4", "-o", "b.webp"]);
    assert!(told.contains("frames  12 at 24 per second"));
    let bytes = |name: &str| fs::read(folder.path().join(name)).expect(name);
    for format in ["gif", "mp4", "webp"] {
        assert!(bytes(&format!("a.{format}")) == bytes(&format!("b.{format}")), "{format}");
    }
    let refused = run(folder.path(), &["assemble", "c_##.png", "-o", "c.gif"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("there are no frames c_##.png"));
}

#[test]
fn the_rate_of_finished_frames_is_in_them() {
    let folder = folder();
    kinora(folder.path(), &["render", "ball.ron", "-r", "30000/1001", "-o", "f_##.png"]);
    let told = kinora(folder.path(), &["assemble", "f_##.png", "-o", "f.gif"]);
    assert!(told.contains("at 30000/1001 per second"));
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
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{told}");
        let next = "to go on: kinora render long.ron -o 'f_#.png' -o a.gif -o a.apng";
        assert!(told.trim_end().ends_with(next), "{told}");
        let done = told.split("stopped after ").nth(1).and_then(|rest| rest.split(' ').next());
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
