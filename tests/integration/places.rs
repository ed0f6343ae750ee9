//! Where outputs go: through links to folders, in the place of links, and into pipes and devices.
#![cfg(target_os = "linux")]

use crate::command::{BALL, contents, folder, kinora, refused, run, stderr, watches};
use assert_cmd::cargo::cargo_bin;
use std::fs;
use std::io::Read;
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// A sequence that names its own files.
fn naming(folder: &Path, files: &str) {
    let text = BALL.replace("size: (32, 18)", &format!("size: (32, 18), files: [{files}]"));
    fs::write(folder.join("named.ron"), text).expect("a disk");
}

/// A folder in which runs work, and one outside of it.
fn inside_and_outside() -> (tempfile::TempDir, tempfile::TempDir) {
    let (inside, outside) = (folder(), folder());
    fs::remove_file(outside.path().join("ball.ron")).expect("a file");
    symlink(outside.path(), inside.path().join("lnk")).expect("a disk");
    symlink(outside.path().join("nothing"), inside.path().join("nowhere")).expect("a disk");
    fs::create_dir(inside.path().join("real")).expect("a disk");
    symlink("real", inside.path().join("near")).expect("a disk");
    (inside, outside)
}

#[test]
fn sequences_do_not_write_out_of_the_working_directory() {
    let (inside, outside) = inside_and_outside();
    let path = inside.path();
    for files in [
        "\"lnk/x_##.png\"",
        "\"lnk/new/x_##.png\"",
        "\"a.gif\", \"lnk/x.gif\"",
        "\"near/../lnk/x.gif\"",
        "\"nowhere/x.gif\"",
    ] {
        naming(path, files);
        for arguments in
            [&["check", "named.ron"][..], &["render", "named.ron"], &["render", "named.ron", "--draft"]]
        {
            let printed = refused(path, arguments);
            let dots = files.contains("..");
            assert!(
                dots || printed.contains("out of the working directory; only what -o names"),
                "{printed}"
            );
        }
        refused(path, &["render", "named.ron", "--frames", "3"]);
        refused(path, &["farm", "export", "shell", "named.ron"]);
    }
    assert!(contents(outside.path()).is_empty() && !outside.path().join("new").exists());
    assert!(!path.join("a.gif").exists() && contents(&path.join("real")).is_empty());
    // Links that stay inside are no way out, and whoever types -o may go anywhere.
    naming(path, "\"near/x_##.png\"");
    kinora(path, &["render", "named.ron"]);
    assert_eq!(contents(&path.join("real")).len(), 12);
    kinora(path, &["render", "named.ron", "-o", "lnk/new/x.gif"]);
    assert!(outside.path().join("new/x.gif").exists());
}

#[test]
fn default_outputs_stay_inside_the_folder() {
    let (inside, outside) = inside_and_outside();
    let path = inside.path();
    symlink(outside.path(), path.join("output")).expect("a disk");
    for command in ["render", "poster", "filmstrip"] {
        let printed = refused(path, &[command, "ball.ron"]);
        assert!(printed.contains("out of the working directory"), "{printed}");
    }
    assert!(contents(outside.path()).is_empty());
    kinora(path, &["poster", "ball.ron", "-o", "output/a.png"]);
    kinora(path, &["filmstrip", "ball.ron", "-o", "output/b.png"]);
    assert_eq!(contents(outside.path()).len(), 2);
}

#[test]
fn a_link_in_the_place_of_a_file_is_replaced() {
    let (inside, outside) = inside_and_outside();
    let path = inside.path();
    fs::write(outside.path().join("precious"), "mine").expect("a disk");
    naming(path, "\"a_##.png\", \"a.gif\"");
    for (name, to) in [("a_03.png", "precious"), ("a.gif", "precious"), ("a_04.png", "none")] {
        symlink(outside.path().join(to), path.join(name)).expect("a disk");
    }
    kinora(path, &["render", "named.ron"]);
    for name in ["a_03.png", "a_04.png", "a.gif"] {
        assert!(path.join(name).symlink_metadata().expect(name).is_file(), "{name} is still a link");
    }
    assert_eq!(
        contents(outside.path()).into_iter().collect::<Vec<_>>(),
        [("precious".into(), b"mine".into())]
    );
}

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().expect("a command").success());
}

/// What comes out of a pipe while `kinora` writes into it.
fn through(folder: &Path, name: &str, arguments: &[&str]) -> Vec<u8> {
    let pipe = folder.join(name);
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read(pipe).expect("a pipe")
    });
    kinora(folder, arguments);
    assert!(pipe.symlink_metadata().expect(name).file_type().is_fifo(), "{name} was replaced");
    reader.join().expect("it ends")
}

#[test]
fn pipes_are_written_into() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("p")).expect("a disk");
    for (name, rest) in [
        ("a.y4m", &[][..]),
        ("a.png", &["--frames", "3"]),
        ("a.jpg", &["--frames", "3"]),
        ("a.ppm", &["--frames", "3"]),
    ] {
        let to = format!("p/{name}");
        kinora(path, &[&["render", "ball.ron", "-o", name], rest].concat());
        pipe(&path.join(&to));
        // A second run writes into it again, whatever may not be replaced.
        for more in [&[][..], &["--fail-if-exists"], &["--overwrite"]] {
            let arguments = [&["render", "ball.ron", "-o", &to], rest, more].concat();
            assert!(
                through(path, &to, &arguments) == fs::read(path.join(name)).expect(name),
                "{name} {more:?}"
            );
        }
    }
    // One frame among others, and a picture of many.
    pipe(&path.join("p/f_03.png"));
    kinora(path, &["render", "ball.ron", "-o", "f_##.png"]);
    let frame = through(path, "p/f_03.png", &["render", "ball.ron", "-o", "p/f_##.png"]);
    assert!(frame == fs::read(path.join("f_03.png")).expect("a frame"));
    pipe(&path.join("p/strip.png"));
    kinora(path, &["filmstrip", "ball.ron", "-o", "strip.png"]);
    let strip = through(path, "p/strip.png", &["filmstrip", "ball.ron", "-o", "p/strip.png"]);
    assert!(strip == fs::read(path.join("strip.png")).expect("a strip"));
}

#[test]
fn seeking_formats_are_not_written_into_pipes() {
    let folder = folder();
    let path = folder.path();
    for name in ["a.gif", "a.apng", "a.webp", "a.mp4", "a.exr"] {
        pipe(&path.join(name));
        let printed = refused(path, &["render", "ball.ron", "--frames", "3", "-o", name, "-o", "new/f.png"]);
        assert!(printed.contains(&format!("cannot write {name}: it is a pipe, which takes only formats that are written sequentially: .png")), "{printed}");
        assert!(path.join(name).symlink_metadata().expect(name).file_type().is_fifo(), "{name} was replaced");
    }
    kinora(path, &["render", "ball.ron", "-o", "f_##.png"]);
    let printed = refused(path, &["assemble", "f_##.png", "-o", "a.gif"]);
    assert!(printed.contains("a.gif: it is a pipe"), "{printed}");
    let _bound = std::os::unix::net::UnixListener::bind(path.join("s.png")).expect("a disk");
    let printed = refused(path, &["render", "ball.ron", "--frames", "3", "-o", "s.png"]);
    assert!(printed.contains("cannot write s.png: it is a socket; name a file"), "{printed}");
    assert!(!path.join("new").exists());
}

#[test]
fn devices_are_written_into_but_not_by_sequences() {
    let folder = folder();
    let path = folder.path();
    symlink("/dev/null", path.join("null.y4m")).expect("a disk");
    kinora(path, &["render", "ball.ron", "-o", "null.y4m"]);
    assert!(path.join("null.y4m").symlink_metadata().expect("a link").is_symlink());
    naming(path, "\"null.y4m\"");
    let printed = refused(path, &["render", "named.ron"]);
    assert!(printed.contains("it leads to /dev/null, out of the working directory"), "{printed}");
    // What a sequence names inside may be a pipe.
    pipe(&path.join("own.y4m"));
    naming(path, "\"own.y4m\"");
    assert_eq!(through(path, "own.y4m", &["render", "named.ron"]).len(), 61 + 12 * (6 + 32 * 18 * 3 / 2));
}

#[test]
fn a_closed_pipe_ends_the_run() {
    let folder = folder();
    let path = folder.path();
    pipe(&path.join("a.y4m"));
    let mut command = Command::new(cargo_bin("kinora"));
    command.current_dir(path).args(["render", "ball.ron", "-s", "640x360", "-o", "a.y4m"]);
    let mut child = command.stderr(Stdio::piped()).spawn().expect("the binary runs");
    // It does not wait for who writes.
    let mut reader = fs::OpenOptions::new();
    let mut reader = reader.read(true).custom_flags(0o4000).open(path.join("a.y4m")).expect("a pipe");
    let mut byte = [0];
    while !reader.read(&mut byte).is_ok_and(|read| read > 0) && child.try_wait().expect("a process").is_none()
    {
        std::thread::sleep(Duration::from_millis(1));
    }
    drop(reader);
    let done = child.wait_with_output().expect("it ends");
    assert_eq!(done.status.code(), Some(3));
    assert!(stderr(&done).contains("cannot write a.y4m: "), "{}", stderr(&done));
    assert!(run(path, &["check", "ball.ron"]).status.success());
}

/// While nobody reads a pipe, a run can be stopped: before its first frame, and when a frame's file is the pipe.
#[test]
fn a_run_that_waits_for_a_reader_can_be_stopped() {
    for (name, output, done) in [("in.y4m", "in.y4m", 0), ("f_02.ppm", "f_##.ppm", 2)] {
        for (signal, code) in [("TERM", 143), ("INT", 130)] {
            let folder = folder();
            let path = folder.path();
            pipe(&path.join(name));
            let mut command = Command::new(cargo_bin("kinora"));
            command.current_dir(path).args(["render", "ball.ron", "-o", output]);
            let mut child = command.stderr(Stdio::piped()).spawn().expect("the binary runs");
            while !watches(&child) || done > 0 && !path.join("f_01.ppm").exists() {
                assert!(child.try_wait().expect("a process").is_none(), "it has ended");
                std::thread::sleep(Duration::from_millis(2));
            }
            // It begins to wait.
            std::thread::sleep(Duration::from_millis(300));
            let sent = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
            assert!(sent.expect("a command").success());
            let ended = child.wait_with_output().expect("it ends");
            let printed = stderr(&ended);
            assert_eq!(ended.status.code(), Some(code), "{printed}");
            assert!(printed.contains(&format!("stopped after {done} frames")), "{printed}");
            assert_eq!(contents(path).len(), 1 + done, "{name}");
        }
    }
}

#[test]
fn a_pipe_is_not_an_existing_frame() {
    let folder = folder();
    let path = folder.path();
    pipe(&path.join("f.jpg"));
    let reader = std::thread::spawn({
        let pipe = path.join("f.jpg");
        move || fs::read(pipe).expect("a pipe")
    });
    let printed = kinora(path, &["render", "ball.ron", "--frames", "3", "-o", "f.jpg"]);
    assert!(!printed.contains("could be kept"), "{printed}");
    reader.join().expect("it ends");
    kinora(path, &["render", "ball.ron", "--frames", "3", "-o", "g.jpg"]);
    let printed = kinora(path, &["render", "ball.ron", "--frames", "3", "-o", "g.jpg"]);
    assert!(printed.contains("could be kept: g.jpg cannot hold metadata"), "{printed}");
}

#[test]
fn plan_and_render_refuse_the_same_outputs() {
    let (inside, outside) = inside_and_outside();
    let path = inside.path();
    symlink(outside.path(), path.join("out")).expect("a disk");
    naming(path, "\"out/a_##.png\"");
    for command in ["plan", "check", "render"] {
        let printed = refused(path, &[command, "named.ron"]);
        assert!(printed.contains("out of the working directory"), "{command}: {printed}");
    }
}
