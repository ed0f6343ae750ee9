//! Jobs for engines, and processes that share the frames of one.

use crate::command::{BALL, contents, folder, kinora, refused, run, stderr};
use assert_cmd::cargo::cargo_bin;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

/// Twelve frames, of which the second half is a light that fades over what the sixth shows.
pub const HALF: &str = r#"(
    timeline: (frames: 12, fps: 24, keys: Frames),
    output: (size: (32, 18), files: ["out/half.gif"]),
    lights: { "sun": Point(position: (3, 4, 5), intensity: [(0, 1), (6, 1), (12, 0)]) },
    objects: { "ball": (shape: Sphere(radius: 1), translation: [(0, (-1, 0, 0)), (6, (1, 0, 0))]) },
)"#;

const ENGINES: [(&str, &str); 4] = [
    ("openjd", "half.openjd.yaml"),
    ("slurm", "half.slurm.sh"),
    ("hyperqueue", "half.hq.toml"),
    ("shell", "half.farm.sh"),
];

/// A folder with `half.ron` in it, and other sequences.
pub fn farm() -> tempfile::TempDir {
    let folder = folder();
    fs::write(folder.path().join("half.ron"), HALF).expect("a disk");
    folder
}

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = Command::new(cargo_bin("kinora"));
    command.current_dir(folder).args(arguments).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("the binary runs")
}

/// The jobs as they are expected, `tests/golden/farm`. `KINORA_BLESS=1` writes them as they are now.
#[test]
fn jobs_are_as_expected() {
    let folder = farm();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("sub")).expect("a disk");
    fs::rename(at("half.ron"), at("sub/half.ron")).expect("a disk");
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/farm");
    let bless = std::env::var_os("KINORA_BLESS").is_some();
    for (engine, _) in ENGINES {
        let flags =
            ["-o", "out/f_##.png", "-o", "out/a b.gif", "--filmstrip", "out/strip.png", "--chunks", "3"];
        let more = ["-t", "2", "--throttle", "5", "--caption", "it's {{{frame}}}", "--exposure", "-1", "-q"];
        let printed =
            kinora(folder.path(), &[&["farm", "export", engine, "sub/half.ron"], &flags[..], &more].concat());
        assert!(printed.is_empty(), "{printed}");
    }
    let mut found = contents(&at("sub"));
    found.remove("half.ron");
    if bless {
        fs::create_dir_all(&golden).expect("a disk");
        found.iter().for_each(|(name, bytes)| fs::write(golden.join(name), bytes).expect("a disk"));
    }
    let expected = contents(&golden);
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (name, bytes) in found {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        assert_eq!(text, String::from_utf8_lossy(&expected[&name]), "{name}");
    }
}

#[test]
fn only_jobs_are_replaced() {
    let folder = farm();
    for (engine, name) in ENGINES {
        let export = ["farm", "export", engine, "half.ron"];
        fs::write(folder.path().join(name), "mine").expect("a disk");
        let before = contents(folder.path());
        let printed = refused(folder.path(), &export);
        assert!(
            printed.contains(&format!("{name} is there already")) && printed.contains("move it away"),
            "{printed}"
        );
        assert!(contents(folder.path()) == before, "{engine}: something was written");
        fs::remove_file(folder.path().join(name)).expect("it was there");
        let printed = kinora(folder.path(), &export);
        assert!(
            printed.contains(&format!("wrote   {name}\n")) && printed.contains("\nsubmit  "),
            "{printed}"
        );
        kinora(folder.path(), &export);
    }
}

#[test]
fn impossible_jobs_are_refused() {
    let folder = farm();
    for name in ["folder.gif", "folder.png"] {
        fs::create_dir(folder.path().join(name)).expect("a disk");
    }
    for (rest, part) in [
        (&["-o", "-"][..], "no standard output to stream to"),
        (&["--filmstrip", "a.gif"], "a filmstrip is one picture"),
        (&["-o", "a.gif", "--bits", "16"], "assembled of PNGs of 8 bits"),
        (&["--chunks", "0"], "--chunks"),
        (&["--frames", "12"], "there is no frame 12"),
        (&["--shard", "1/2"], "--shard"),
        (&["-o", "f.png"], "write \"f_####.png\""),
        (&["-o", "half.ron/f_##.png"], "half.ron is a file; name a folder there"),
        (&["-o", "folder.gif"], "cannot write folder.gif: it is a folder"),
        (&["--filmstrip", "folder.png"], "cannot write folder.png: it is a folder"),
    ] {
        let printed = refused(folder.path(), &[&["farm", "export", "shell", "half.ron"], rest].concat());
        assert!(printed.contains(part), "{printed}");
    }
    let printed = refused(folder.path(), &["farm", "export", "cron", "half.ron"]);
    assert!(printed.contains("openjd") && printed.contains("hyperqueue"), "{printed}");
    assert_eq!(contents(folder.path()).len(), 2);
}

/// The frames of a set, counted out.
pub fn counted(set: &str) -> Vec<u32> {
    let set: kinora::base::frame_set::FrameSet = set.parse().expect("a set");
    set.frames(12).expect("frames")
}

#[test]
fn a_film_is_in_one_task() {
    let folder = farm();
    kinora(folder.path(), &["farm", "export", "shell", "half.ron", "--chunks", "4"]);
    let text = fs::read_to_string(folder.path().join("half.farm.sh")).expect("a job");
    let chunks =
        text.split("<<'FRAMES'\n").nth(1).and_then(|rest| rest.split("FRAMES\n").next()).expect("chunks");
    let chunks: Vec<Vec<u32>> = chunks.lines().map(counted).collect();
    let mut all = chunks.concat();
    all.sort_unstable();
    assert_eq!(all, (0..12).collect::<Vec<_>>());
    let with_six = chunks.iter().find(|chunk| chunk.contains(&6)).expect("a chunk");
    assert!((6..12).all(|frame| with_six.contains(&frame)), "{chunks:?}");
    assert!(chunks.len() >= 3, "{chunks:?}");
}

#[test]
fn plans_for_workers_are_marked_as_estimates() {
    let folder = farm();
    let printed = kinora(folder.path(), &["plan", "half.ron", "--workers", "1,2"]);
    let farm = printed.split("\nfarm    ").nth(1).expect("a group for the farm");
    let lines: Vec<&str> = farm.lines().map(str::trim).collect();
    assert_eq!(
        lines[1].split_whitespace().collect::<Vec<_>>(),
        ["workers", "makespan", "speed-up", "efficiency"]
    );
    assert!(lines[2].starts_with("1 ") && lines[3].starts_with("2 "), "{printed}");
    assert!(lines[4].starts_with("an estimate from "), "{printed}");
}

/// A name for the binary that scripts find.
#[cfg(unix)]
fn path_with_kinora(folder: &Path) -> std::ffi::OsString {
    let programs = folder.join("bin");
    fs::create_dir_all(&programs).expect("a disk");
    let _ = std::os::unix::fs::symlink(cargo_bin("kinora"), programs.join("kinora"));
    let rest = std::env::var_os("PATH").unwrap_or_default();
    let all = std::iter::once(programs).chain(std::env::split_paths(&rest));
    std::env::join_paths(all).expect("a path")
}

#[cfg(unix)]
#[test]
fn shell_jobs_write_the_files_of_one_run() {
    let folder = farm();
    let path = path_with_kinora(folder.path());
    let settings = ["-s", "48x27", "--caption", "it's {frame}", "--exposure", "-1"];
    let one = ["render", "half.ron", "-o", "one/half/frame_####.png", "-o", "one/half.gif"];
    kinora(folder.path(), &[&one[..], &settings].concat());
    kinora(
        folder.path(),
        &[&["farm", "export", "shell", "half.ron", "--chunks", "5"], &settings[..]].concat(),
    );
    let submitted = || {
        let mut command = Command::new("sh");
        command
            .args(["half.farm.sh", "3"])
            .current_dir(folder.path())
            .env("PATH", &path)
            .output()
            .expect("a shell")
    };
    let done = submitted();
    assert!(done.status.success(), "{}", stderr(&done));
    let at = |name: &str| contents(&folder.path().join(name));
    assert!(at("one/half") == at("out/half"), "{:?}", at("out/half").keys());
    assert!(at("one")["half.gif"] == at("out")["half.gif"], "the GIF differs");
    // Run again, it finds all done; and after a change it refuses.
    assert!(submitted().status.success());
    // Exit codes are those of tasks, not those of `xargs`.
    fs::remove_file(folder.path().join("out/half/frame_0003.png")).expect("a frame");
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -f 0; exec sh half.farm.sh 3"]).current_dir(folder.path()).env("PATH", &path);
    let done = command.output().expect("a shell");
    assert_eq!(done.status.code(), Some(3), "{}", stderr(&done));
    assert!(submitted().status.success());
    fs::write(folder.path().join("half.ron"), HALF.replace("radius: 1", "radius: 2")).expect("a disk");
    let done = submitted();
    assert_eq!(done.status.code(), Some(2), "{}", stderr(&done));
    assert!(stderr(&done).contains("half.ron has changed"), "{}", stderr(&done));
    assert!(at("one/half") == at("out/half"), "a refused task wrote something");
}

#[test]
fn tasks_refuse_changed_files() {
    let folder = farm();
    let textured = BALL.replace("radius: 1)", "radius: 1), material: (color: Image(file: \"a.png\"))");
    fs::write(folder.path().join("image.ron"), textured).expect("a disk");
    kinora(folder.path(), &["poster", "ball.ron", "-o", "a.png", "-s", "8x8"]);
    kinora(folder.path(), &["farm", "export", "shell", "image.ron"]);
    let job = fs::read_to_string(folder.path().join("image.farm.sh")).expect("a job");
    let words: Vec<&str> = job.split_whitespace().collect();
    let place = words.iter().position(|word| *word == "--expect").expect("a fingerprint");
    let expected = words[place + 1];
    let render = |expected: &str, progress: &str| {
        let rest = ["--expect", expected, "--frames", "3", "-o", "f_##.png", "--progress", progress];
        run(folder.path(), &[&["render", "image.ron"], &rest[..]].concat())
    };
    assert!(render(expected, "plain").status.success());
    fs::remove_file(folder.path().join("f_03.png")).expect("it was there");
    let another = format!("9{expected}");
    for (expected, part) in [(another.as_str(), "exported by Kinora 9"), ("abc", "is not a fingerprint")] {
        let done = render(expected, "plain");
        assert_eq!(done.status.code(), Some(2));
        assert!(stderr(&done).contains(part), "{}", stderr(&done));
    }
    kinora(folder.path(), &["poster", "ball.ron", "-o", "a.png", "-s", "8x9"]);
    let done = render(expected, "openjd");
    let printed = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(printed.starts_with("openjd_fail: ") && printed.contains("a.png has changed since"), "{printed}");
    assert_eq!(done.status.code(), Some(2));
    assert!(!folder.path().join("f_03.png").exists());
}

#[test]
fn films_come_along() {
    let folder = farm();
    let made = |frames: &str, among: &str| {
        let out = format!("{frames}/f_##.png");
        let rest = ["--frames", frames, "--include-shared", among, "-o", &out];
        kinora(folder.path(), &[&["render", "half.ron"], &rest[..]].concat());
        contents(&folder.path().join(frames))
            .into_keys()
            .collect::<Vec<_>>()
            .join(" ")
            .replace("f_", "")
            .replace(".png", "")
    };
    assert_eq!(made("4,6", "0-11"), "04 06 07 08 09 10 11");
    assert_eq!(made("7", "0-9:3"), "06 07 09");
    assert_eq!(made("2", "0-11"), "02");
}

#[test]
fn progress_is_reported_to_runners() {
    let folder = farm();
    let printed = kinora(folder.path(), &["render", "half.ron", "-o", "f_##.png", "--progress", "openjd"]);
    assert!(printed.contains("openjd_progress: 100.0\nopenjd_status: frame 12/12"), "{printed}");
    let printed = refused(folder.path(), &["render", "half.ron", "-o", "-", "--progress", "openjd"]);
    assert!(printed.contains("both write to the standard output"), "{printed}");
}

const SHARED: [&str; 8] = ["render", "half.ron", "--claim", "-s", "200x120", "--threads", "1", "-o"];

/// What one run makes.
fn whole(folder: &Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    kinora(folder, &["render", "half.ron", "-s", "200x120", "-o", "one/f_##.png"]);
    contents(&folder.join("one"))
}

#[test]
fn processes_share_the_frames() {
    let folder = farm();
    let whole = whole(folder.path());
    let arguments = [&SHARED[..], &["all/f_##.png", "--progress", "json"]].concat();
    let outputs = std::thread::scope(|scope| {
        let workers = [0, 1, 2].map(|_| scope.spawn(|| run(folder.path(), &arguments)));
        workers.map(|worker| worker.join().expect("it ends"))
    });
    let mut made = 0;
    let mut films = 0;
    for done in outputs {
        assert!(done.status.success(), "{}", stderr(&done));
        let printed = String::from_utf8_lossy(&done.stdout).into_owned();
        let number = |key: &str| {
            let rest =
                printed.lines().last().and_then(|line| line.split(&format!("\"{key}\":")).nth(1)).expect(key);
            rest.split([',', '}']).next().and_then(|digits| digits.parse::<u32>().ok()).expect(key)
        };
        made += number("frames") - number("kept");
        films += number("frames") - number("kept") - number("reused");
    }
    // Every frame was made once, and every film traced once.
    assert_eq!((made, films), (12, 7));
    assert!(contents(&folder.path().join("all")) == whole, "or a claim is left");
}

/// A claim that is held in a folder, if there is one.
fn only_claim(folder: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(folder).ok()?.flatten();
    entries.map(|entry| entry.path()).find(|path| path.to_string_lossy().contains(".kinora-claim-"))
}

#[cfg(target_os = "linux")]
#[test]
fn frames_of_killed_processes_are_taken_over() {
    let folder = farm();
    let whole = whole(folder.path());
    let all = folder.path().join("all");
    let arguments = [&SHARED[..], &["all/f_##.png"]].concat();
    let mut kills = 0;
    for _ in 0..20 {
        let mut child = start(folder.path(), &arguments);
        let begun = Instant::now();
        // As soon as it has something in hand.
        let claim = loop {
            match only_claim(&all) {
                None if child.try_wait().expect("a process").is_none()
                    && begun.elapsed() < Duration::from_secs(60) =>
                {
                    sleep(Duration::from_millis(1));
                }
                claim => break claim,
            }
        };
        if claim.is_none() {
            break;
        }
        child.kill().expect("a process");
        child.wait().expect("it ends");
        kills += u32::from(only_claim(&all).is_some());
    }
    assert!(kills > 0, "no process was killed with a claim");
    let begun = Instant::now();
    kinora(folder.path(), &arguments);
    assert!(begun.elapsed() < Duration::from_secs(60), "it waited for dead processes");
    let mut found = contents(&all);
    found.retain(|name, _| !name.ends_with(".part"));
    assert!(found == whole, "{:?}", found.keys());
}

/// A process elsewhere holds a claim as long as it is heard of.
#[test]
fn claims_from_elsewhere_are_respected() {
    let folder = farm();
    let whole = whole(folder.path());
    let all = folder.path().join("all");
    let arguments = [&SHARED[..], &["all/f_##.png"]].concat();
    // Whatever the claims are called, one that is seen is made another's.
    let mut child = start(folder.path(), &arguments);
    let name = loop {
        if let Some(claim) = only_claim(&all) {
            break claim;
        }
        assert!(child.try_wait().expect("a process").is_none(), "it was too fast");
    };
    child.kill().expect("a process");
    child.wait().expect("it ends");
    fs::remove_dir_all(&all).expect("a folder");
    fs::create_dir(&all).expect("a disk");
    fs::write(&name, "elsewhere boot 7 7\n0\n").expect("a disk");
    let status =
        || kinora(folder.path(), &["farm", "status", "all", "half.ron", "-s", "200x120", "-o", "f_##.png"]);
    let mut child = start(folder.path(), &arguments);
    // The others are made, and it waits.
    let begun = Instant::now();
    loop {
        let printed = status();
        assert!(begun.elapsed() < Duration::from_secs(60), "{printed}");
        if printed.contains(" 0 stale, 0 missing") {
            assert!(printed.contains("by process 7 on elsewhere, last sign of life "), "{printed}");
            break;
        }
    }
    assert!(child.try_wait().expect("a process").is_none(), "it did not wait");
    assert!(name.exists());
    let file = fs::File::options().write(true).open(&name).expect("a claim");
    file.set_modified(SystemTime::now() - Duration::from_secs(600)).expect("a claim");
    assert!(child.wait().expect("it ends").success());
    assert!(contents(&all) == whole, "or a claim is left");
}

#[test]
fn only_identifiable_outputs_are_shared() {
    let folder = farm();
    for (rest, part) in [
        (&["-o", "f_##.jpg"][..], "f_##.jpg cannot hold metadata that identifies its frames"),
        (&["-o", "f_##.png", "--no-metadata"], "f_##.png cannot hold metadata that identifies its frames"),
        (&["-o", "a.gif"], "every process would write all of a.gif"),
        (&["-o", "f_##.png", "--overwrite"], "--overwrite"),
        (&["-o", "f_##.png", "--time-limit", "9s"], "--time-limit picks the samples"),
    ] {
        let printed = refused(folder.path(), &[&["render", "half.ron", "--claim"], rest].concat());
        assert!(printed.contains(part), "{printed}");
    }
    assert_eq!(contents(folder.path()).len(), 2);
}

#[test]
fn status_lists_frames_by_state() {
    let folder = farm();
    let path = folder.path();
    let status = |rest: &[&str]| kinora(path, &[&["farm", "status", "out/half", "half.ron"], rest].concat());
    let printed = refused(path, &["farm", "status", "half", "half.ron"]);
    assert!(
        printed.contains("there is no folder half; the frames of half.ron are in out/half, unless"),
        "{printed}"
    );
    let printed = refused(path, &["farm", "status", "out/half", "half.ron"]);
    assert!(printed.contains("there is no folder out/half yet; it appears with the first task"), "{printed}");
    let printed = refused(path, &["farm", "status", "half.ron", "out/half"]);
    assert!(printed.contains("half.ron is a file; the frames' folder comes first"), "{printed}");
    fs::create_dir_all(path.join("out/half")).expect("a disk");
    assert_eq!(
        status(&[]),
        "frames  12: 0 done, 0 in work, 0 stale, 12 missing\nmissing 0-11\n\
         note    there is no file out/half/frame_####.png; if the job was exported with -o, pass the job's -o\n"
    );
    let frames = |set: &str, rest: &[&str]| {
        let arguments =
            ["render", "half.ron", "--frames", set, "-o", "out/half/frame_####.png", "--overwrite"];
        kinora(path, &[&arguments[..], rest].concat());
    };
    frames("0-7", &[]);
    frames("3,5", &["--exposure", "1"]);
    fs::write(path.join("out/half/frame_0011.png"), "").expect("a disk");
    let printed = status(&[]);
    assert!(
        printed
            .starts_with("frames  12: 6 done, 0 in work, 3 stale, 3 missing\nstale   3,5,11\nmissing 8-10\n"),
        "{printed}"
    );
    let printed = status(&["--json"]);
    let counts = r#"{"event":"status","done":{"count":6,"frames":"0-2,4,6-7"},"in_work":[],"stale":{"count":3,"frames":"3,5,11"},"missing":{"count":3,"frames":"8-10"},"left_s":"#;
    assert!(printed.starts_with(counts), "{printed}");
    // Settings count, and so does the set.
    let printed = status(&["--frames", "2-3", "--exposure", "1"]);
    assert!(
        printed.starts_with("frames  2: 1 done, 0 in work, 1 stale, 0 missing\nstale   2\n"),
        "{printed}"
    );
    let printed = refused(path, &["farm", "status", "out", "half.ron", "-o", "f_##.jpg"]);
    assert!(printed.contains("cannot hold metadata that identifies its frames"), "{printed}");
}
