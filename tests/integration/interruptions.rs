//! Runs that are stopped, killed, or run out of disk at any moment: what there is afterwards is whole, and the next run
//! makes of it what one run would have made.

use crate::command::{BALL, contents, folder, run};
use crate::support::Random;
use assert_cmd::cargo::cargo_bin;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

const OUTPUTS: [&str; 10] =
    ["-o", "f_##.png", "-o", "f_##.exr", "-o", "f_##.jpg", "-o", "a.gif", "-o", "a.apng"];

fn arguments() -> Vec<&'static str> {
    [&["render", "ball.ron", "-s", "96x54"], &OUTPUTS[..]].concat()
}

fn start(folder: &Path) -> Child {
    let mut command = Command::new(cargo_bin("kinora"));
    command.current_dir(folder).args(arguments()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("the binary runs")
}

/// What one run makes, and how long it takes.
fn reference() -> (BTreeMap<String, Vec<u8>>, Duration) {
    let folder = folder();
    let start = Instant::now();
    let done = run(folder.path(), &arguments());
    assert!(done.status.success(), "{done:?}");
    (contents(folder.path()), start.elapsed())
}

/// Every file is one that the whole run makes, to the last byte; or a temporary of a run that was killed, or what a
/// stopped run had of an animation.
fn assert_whole(folder: &Path, whole: &BTreeMap<String, Vec<u8>>, what: &str) {
    for (name, bytes) in contents(folder) {
        let aside = name.starts_with(".kinora-") || name.starts_with("part_a.");
        assert!(
            aside || whole.get(&name) == Some(&bytes),
            "{what}: {name} is partial, or should not be there"
        );
    }
}

/// The last run leaves what one run leaves.
fn assert_resumes(folder: &Path, whole: &BTreeMap<String, Vec<u8>>) {
    let done = run(folder, &arguments());
    assert!(done.status.success(), "{done:?}");
    let mut found = contents(folder);
    found.retain(|name, _| !name.starts_with(".kinora-") && !name.starts_with("part_a."));
    assert!(found == *whole, "{:?}", found.keys());
}

/// Sends signals after random times, over and over in one folder, from which some frames vanish again.
#[cfg(unix)]
fn interrupted(times: usize) {
    let (whole, time) = reference();
    let folder = folder();
    let mut random = Random(8);
    for round in 0..times {
        let mut child = start(folder.path());
        thread::sleep(time.mul_f64(1.1 * random.unit()));
        let signal = ["INT", "TERM", "KILL"][(3.0 * random.unit()) as usize];
        // It may have ended by itself.
        let mut kill = Command::new("kill");
        kill.args([&format!("-{signal}"), &child.id().to_string()]).stderr(Stdio::null());
        kill.status().expect("a command");
        let status = child.wait().expect("it ends");
        let what = format!("round {round}, {signal}, {status}");
        let expected = match signal {
            "INT" => Some(130),
            "TERM" => Some(143),
            _ => None,
        };
        // Before signals are watched, they end the program as ever.
        assert!(status.success() || status.code() == expected || status.code().is_none(), "{what}");
        assert_whole(folder.path(), &whole, &what);
        for frame in 0..12 {
            if random.unit() < 0.4 {
                let kind = ["png", "exr", "jpg"][(3.0 * random.unit()) as usize];
                let _ = fs::remove_file(folder.path().join(format!("f_{frame:02}.{kind}")));
            }
        }
    }
    assert_resumes(folder.path(), &whole);
}

#[cfg(unix)]
#[test]
fn signals_at_random_times_lose_nothing() {
    interrupted(8);
}

#[cfg(unix)]
#[test]
#[ignore = "takes minutes; cargo test --release --test integration signals_at_random -- --ignored"]
fn signals_at_random_times_200_times_lose_nothing() {
    interrupted(200);
}

#[test]
fn two_processes_share_a_folder() {
    let (whole, _) = reference();
    let folder = folder();
    let mut children = [start(folder.path()), start(folder.path())];
    for child in &mut children {
        assert!(child.wait().expect("it ends").success());
    }
    assert_whole(folder.path(), &whole, "after two processes");
    assert_resumes(folder.path(), &whole);
}

/// A file system with room for some frames only; of its own, where users may make one.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_whole_frames() {
    let (whole, _) = reference();
    let folder = folder();
    fs::create_dir_all(folder.path().join("disk")).expect("a disk");
    fs::create_dir_all(folder.path().join("left")).expect("a disk");
    let script = "mount -t tmpfs -o size=\"$1\" none disk || exit 99; cp ball.ron disk; cd disk
        shift; \"$@\" 2>../printed; code=$?; cp -a . ../left; exit $code";
    let mut refused = 0;
    for size in ["24k", "64k", "128k", "300k"] {
        let mut command = Command::new("unshare");
        command.args(["--map-root-user", "--mount", "sh", "-c", script, "sh", size]);
        let done = command.arg(cargo_bin("kinora")).args(arguments()).current_dir(folder.path()).output();
        let Ok(done) = done else { return };
        match done.status.code() {
            Some(0) => continue,
            Some(3) => refused += 1,
            // Here, nobody may have a file system of their own, or mount one.
            Some(1 | 99) => return,
            _ => panic!("{size}: {done:?}"),
        }
        let printed = fs::read_to_string(folder.path().join("printed")).expect("a message");
        assert!(printed.contains("free some space"), "{printed}");
        assert_whole(&folder.path().join("left"), &whole, size);
        assert!(contents(&folder.path().join("left")).keys().all(|name| !name.starts_with('.')), "{size}");
    }
    assert!(refused > 0, "no disk was full");
    assert_resumes(&folder.path().join("left"), &whole);
}

/// Starts a run that would take for ever, of stills and a GIF in the folder `gone`.
#[cfg(unix)]
fn start_long(folder: &Path, frames: u32) -> Child {
    let long = BALL.replace("frames: 12", &format!("frames: {frames}")).replace("(12, (1,", "(9999999, (1,");
    fs::write(folder.join("long.ron"), long).expect("a disk");
    let mut command = Command::new(cargo_bin("kinora"));
    let outputs = ["-o", "gone/f_#.png", "-o", "gone/a.gif"];
    command.current_dir(folder).args(["render", "long.ron"]).args(outputs);
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the binary runs")
}

/// A film that would take for ever ends with the samples that it has, and its frames stand beside their places.
#[cfg(target_os = "linux")]
#[test]
fn a_stopped_film_leaves_part_files() {
    let folder = folder();
    let light = r#""sun": Sphere(center: (3, 4, 5), radius: 1)"#;
    let still = BALL
        .replace(r#""sun": Point(position: (3, 4, 5))"#, light)
        .replace(", translation: [(0, (-1, 0, 0)), (12, (1, 0, 0))]", "");
    fs::write(folder.path().join("ball.ron"), still).expect("a disk");
    let arguments = [
        "render",
        "ball.ron",
        "-s",
        "320x180",
        "--noise",
        "0.0001",
        "--max-samples",
        "16777216",
        "--frames",
        "0-3",
    ];
    let mut command = Command::new(cargo_bin("kinora"));
    command
        .current_dir(folder.path())
        .args(arguments)
        .args(["-o", "f_#.png", "-o", "f_#.exr", "-o", "a.apng"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the binary runs");
    while !crate::command::watches(&child) {
        thread::sleep(Duration::from_millis(2));
    }
    thread::sleep(Duration::from_millis(500));
    assert!(child.try_wait().expect("a process").is_none(), "it has ended");
    let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    let done = child.wait_with_output().expect("it ends");
    let printed = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(130), "{printed}");
    assert!(
        printed.contains("stopped after 0 frames\nwrote   part_f_#.png\nwrote   part_f_#.exr\n"),
        "{printed}"
    );
    let found = contents(folder.path());
    let names: Vec<&str> = found.keys().map(String::as_str).filter(|name| !name.ends_with(".exr")).collect();
    // An animation made of PNGs has whole ones only.
    assert_eq!(
        names,
        ["ball.ron", "part_f_0.png", "part_f_1.png", "part_f_2.png", "part_f_3.png"],
        "{printed}"
    );
    // They are not taken for what they should become.
    let again =
        run(folder.path(), &["render", "ball.ron", "--noise", "0.2", "--frames", "0-3", "-o", "f_#.png"]);
    let summary = String::from_utf8_lossy(&again.stdout);
    assert!(
        !summary.contains("kept") && summary.contains("part_f_#.png holds unfinished frames"),
        "{summary}"
    );
}

#[cfg(unix)]
#[test]
fn a_removed_folder_ends_the_run_with_an_error() {
    let folder = folder();
    let (gone, away) = (folder.path().join("gone"), folder.path().join("away"));
    let mut child = start_long(folder.path(), 100_000);
    while !gone.join("f_3.png").exists() {
        assert!(child.try_wait().expect("a process").is_none(), "it has ended");
        thread::sleep(Duration::from_millis(2));
    }
    // It cannot come again where a file stands. But it may come before the file does.
    fs::create_dir(&away).expect("a disk");
    let mut folders = Vec::new();
    loop {
        folders.push(away.join(folders.len().to_string()));
        fs::rename(&gone, &folders[folders.len() - 1]).expect("a folder");
        if fs::write(&gone, "").is_ok() {
            break;
        }
    }
    let done = child.wait_with_output().expect("it ends");
    let printed = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(3), "{printed}");
    assert!(printed.contains("error: cannot write gone"), "{printed}");
    for folder in folders {
        for name in contents(&folder).into_keys().filter(|name| name.ends_with(".png")) {
            assert!(image::open(folder.join(&name)).is_ok(), "{name} is partial");
        }
    }
}

/// Even those who may write everywhere may not write here.
#[cfg(target_os = "linux")]
#[test]
fn a_read_only_folder_ends_the_run_with_an_error() {
    let folder = folder();
    let done = run(folder.path(), &["render", "ball.ron", "-o", "new/f_##.png", "-o", "/proc/a.gif"]);
    let printed = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{printed}");
    assert!(printed.contains("error: cannot write /proc"), "{printed}");
    assert!(!folder.path().join("new").exists(), "nothing was written, and no folder stays");
}

/// Of a very long sequence, all frames are looked at before the first is traced.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_is_heard_while_frames_are_looked_at() {
    let folder = folder();
    let child = start_long(folder.path(), 3_000_000);
    while !crate::command::watches(&child) {
        thread::sleep(Duration::from_millis(2));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.expect("a command").success());
    let done = child.wait_with_output().expect("it ends");
    let printed = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(130), "{printed}");
    assert!(
        printed.contains("stopped after 0 frames") && printed.contains("to continue: kinora render"),
        "{printed}"
    );
    assert!(!folder.path().join("gone").exists());
}

/// The most memory that a run took, in bytes.
#[cfg(target_os = "linux")]
fn peak_memory(frames: u32) -> u64 {
    let folder = folder();
    let text = BALL.replace("frames: 12", &format!("frames: {frames}")).replace("(12, (1,", "(6, (1,");
    fs::write(folder.path().join("long.ron"), text).expect("a disk");
    let mut command = Command::new(cargo_bin("kinora"));
    let outputs = ["-o", "f_#####.ppm", "-o", "a.gif", "-o", "a.mp4", "-o", "a.webp"];
    command.current_dir(folder.path()).args(["render", "long.ron", "-s", "32x18", "-t", "2"]).args(outputs);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the binary runs");
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().expect("a process").is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kibibytes = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok());
        peak = peak.max(1024 * kibibytes.unwrap_or(0));
        thread::sleep(Duration::from_millis(5));
    }
    assert!(child.wait().expect("it ends").success());
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), frames as usize + 5);
    peak
}

/// What a run of any length may take here: the program, the font, tables, and a few films.
#[cfg(target_os = "linux")]
const MOST_MEMORY: u64 = 64 << 20;

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_frames() {
    let peak = peak_memory(1000);
    assert!((1 << 20..MOST_MEMORY).contains(&peak), "{peak} bytes");
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "takes a minute; cargo test --release --test integration memory_does_not -- --ignored"]
fn memory_does_not_grow_with_10_000_frames() {
    let peak = peak_memory(10_000);
    assert!((1 << 20..MOST_MEMORY).contains(&peak), "{peak} bytes");
}
