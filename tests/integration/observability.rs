//! `--trace`, `--log` and `--metrics`: what the files say, and that they change nothing else.

use crate::command::{contents, folder, kinora, refused, run, stderr};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

const FILES: [&str; 6] = ["--trace", "run.json", "--log", "run.log", "--metrics", "run.jsonl"];

/// Four frames of a ball. In the last two, only a lamp is dimmed.
const DIMMED: &str = r#"(
    timeline: (frames: 4, fps: 24, keys: Frames),
    output: (size: (48, 32)),
    lights: { "sun": Point(position: (3, 4, 5), intensity: [(0, 1), (1, 1), (3, 0.25)]) },
    objects: {
        "ball": (shape: Sphere(radius: 1)),
        "floor": (shape: Plane(), translation: (0, -1, 0)),
    },
)"#;

fn parsed(path: &Path) -> Value {
    let text = fs::read_to_string(path).expect("a file");
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn lines(path: &Path) -> Vec<Value> {
    let text = fs::read_to_string(path).expect("a file");
    text.lines().map(|line| serde_json::from_str(line).expect("an object")).collect()
}

fn events(path: &Path) -> Vec<Value> {
    parsed(path)["traceEvents"].as_array().expect("a list").clone()
}

/// The frames of the spans of a name.
fn frames(events: &[Value], name: &str) -> BTreeSet<u64> {
    let spans = events.iter().filter(|event| event["ph"] == "X" && event["name"] == name);
    spans.filter_map(|span| span["args"]["frame"].as_u64()).collect()
}

/// Times have three decimals of a microsecond.
fn nanoseconds(value: &Value) -> u64 {
    (value.as_f64().expect("a time") * 1000.0).round() as u64
}

/// Of two spans of a thread, one is in the other, or they are apart.
fn assert_nested(events: &[Value]) {
    let mut threads: BTreeMap<u64, Vec<(u64, u64)>> = BTreeMap::new();
    for span in events.iter().filter(|event| event["ph"] == "X") {
        let (begin, long) = (nanoseconds(&span["ts"]), nanoseconds(&span["dur"]));
        threads.entry(span["tid"].as_u64().expect("a thread")).or_default().push((begin, begin + long));
    }
    for (thread, mut spans) in threads {
        spans.sort_by_key(|&(begin, end)| (begin, std::cmp::Reverse(end)));
        let mut open: Vec<u64> = Vec::new();
        for (begin, end) in spans {
            open.retain(|outer| *outer > begin);
            assert!(open.iter().all(|outer| end <= *outer), "thread {thread}: a span overlaps another");
            open.push(end);
        }
    }
}

#[test]
fn a_trace_has_all_frames_and_its_spans_nest() {
    let folder = folder();
    let plain = ["render", "ball.ron", "-o", "f_##.png", "-o", "a.gif", "-t", "2"];
    kinora(folder.path(), &plain);
    let pictures = contents(folder.path());
    for (name, _) in pictures.iter().filter(|(name, _)| *name != "ball.ron") {
        fs::remove_file(folder.path().join(name)).expect("a file");
    }
    kinora(folder.path(), &[&plain[..], &FILES].concat());
    let found = contents(folder.path());
    assert!(pictures.iter().all(|(name, bytes)| found.get(name) == Some(bytes)), "other bytes");
    assert_eq!(found.len(), pictures.len() + 3);

    let events = events(&folder.path().join("run.json"));
    let all: BTreeSet<u64> = (0..12).collect();
    for name in ["frame", "animate", "submit", "encode"] {
        assert_eq!(frames(&events, name), all, "{name}");
    }
    for name in ["run", "read", "evaluate", "plan", "tile", "store"] {
        assert!(events.iter().any(|event| event["name"] == name), "{name}");
    }
    assert_nested(&events);
    let threads: BTreeSet<&str> = events
        .iter()
        .filter(|event| event["name"] == "thread_name")
        .filter_map(|event| event["args"]["name"].as_str())
        .collect();
    assert!(threads.is_superset(&["main", "encode"].into()), "{threads:?}");
    // So few tiles may all be taken by one thread.
    assert!(threads.iter().any(|name| name.starts_with("render ")), "{threads:?}");
    let log = fs::read_to_string(folder.path().join("run.log")).expect("a file");
    assert!(log.contains("INFO  [encode] encode frame=3 took=") && !log.contains(" tile "), "{log}");
}

/// The first film takes long enough here that the encoder, which starts before it, has to wait for it. Where frames are
/// as quick as those of `ball.ron`, a busy machine may start the encoder's thread after the last of them.
///
/// The same run is long enough for a pilot, unless nobody would read its forecast.
#[test]
fn a_trace_shows_the_pilot_and_that_the_encoder_waited() {
    let folder = folder();
    let slow =
        ["render", "ball.ron", "--frames", "0", "-o", "f_##.png", "-s", "256x144", "--antialias", "32"];
    kinora(folder.path(), &[&slow[..], &["--trace", "run.json"]].concat());
    let found = events(&folder.path().join("run.json"));
    let has = |events: &[Value], name: &str| events.iter().any(|event| event["name"] == name);
    assert!(has(&found, "wait for a film") && has(&found, "pilot"), "{found:?}");
    kinora(folder.path(), &[&slow[..], &["--trace", "quiet.json", "--quiet", "--overwrite"]].concat());
    let quiet = events(&folder.path().join("quiet.json"));
    assert!(has(&quiet, "trace") && !has(&quiet, "pilot"), "{quiet:?}");
}

#[test]
fn metrics_add_up_to_the_summary() {
    let folder = folder();
    fs::write(folder.path().join("dimmed.ron"), DIMMED).expect("a disk");
    for file in ["ball.ron", "dimmed.ron"] {
        let command = ["render", file, "-o", "m_##.png", "--overwrite", "--progress", "json"];
        let printed = kinora(folder.path(), &[&command[..], &["--metrics", "m.jsonl"]].concat());
        let summary: Value = serde_json::from_str(printed.lines().last().expect("a summary")).expect("JSON");
        let lines = lines(&folder.path().join("m.jsonl"));
        assert_eq!(lines.len() as u64, summary["frames"].as_u64().expect("a number"));
        for kind in ["camera", "mirror", "transmitted", "scattered", "shadow", "total"] {
            let sum: u64 = lines.iter().map(|line| line["rays"][kind].as_u64().expect("a number")).sum();
            assert_eq!(Some(sum), summary["rays"][kind].as_u64(), "{file}: {kind}");
        }
        let reused = lines.iter().filter(|line| line["film"] == "reused");
        assert_eq!(Some(reused.clone().count() as u64), summary["reused"].as_u64(), "{file}");
        assert!(reused.clone().all(|line| line["rays"]["total"] == 0), "{file}");
        for line in &lines {
            let path = format!("m_{:02}.png", line["frame"].as_u64().expect("a number"));
            let bytes = fs::metadata(folder.path().join(path)).expect("a file").len();
            assert_eq!(line["bytes"].as_u64(), Some(bytes));
        }
    }
    let again = ["render", "dimmed.ron", "-o", "m_##.png", "--metrics", "m.jsonl"];
    kinora(folder.path(), &again);
    assert!(lines(&folder.path().join("m.jsonl")).iter().all(|line| line["film"] == "kept"));
}

#[test]
fn metrics_name_the_frames_that_were_denoised() {
    let folder = folder();
    let paths = DIMMED.replacen("(48, 32)),", "(48, 32)), quality: (integrator: Path(), samples: 16),", 1);
    fs::write(folder.path().join("paths.ron"), paths).expect("a disk");
    let metrics = |extra: &[&str]| {
        let command = ["render", "paths.ron", "-o", "p_##.png", "--overwrite", "--metrics", "m.jsonl"];
        kinora(folder.path(), &[&command[..], extra].concat());
        lines(&folder.path().join("m.jsonl"))
    };
    assert!(metrics(&[]).iter().all(|line| line["denoised"].is_null() && line["noise"].is_null()));
    let denoised = metrics(&["--denoise=alone"]);
    assert!(denoised.iter().all(|line| line["denoised"].is_boolean() && line["noise"].is_number()));
}

#[test]
fn files_that_clash_are_refused_and_nothing_is_written() {
    let folder = folder();
    let before = contents(folder.path());
    let render = ["render", "ball.ron", "-o", "f_##.png"];
    for (options, parts) in [
        (&["--trace", "ball.ron"][..], ["--trace", "ball.ron"]),
        (&["--log", "./f_03.png"], ["--log", "f_##.png"]),
        (&["--trace", "a.json", "--metrics", "./a.json"], ["--trace", "--metrics"]),
        (&["--metrics", "."], ["--metrics", "folder"]),
    ] {
        let message = refused(folder.path(), &[&render[..], options].concat());
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        assert_eq!(contents(folder.path()), before);
    }
    let done = run(folder.path(), &[&render[..], &["--log", "ball.ron/run.log"]].concat());
    assert_eq!(done.status.code(), Some(3));
    assert!(stderr(&done).contains("--log") && stderr(&done).contains("ball.ron/run.log"));
    assert_eq!(contents(folder.path()), before);
}

/// The files are valid when a signal stops the run, and a trace is even when the system kills it.
#[cfg(target_os = "linux")]
#[test]
fn stopped_runs_leave_valid_files() {
    use std::process::{Command, Stdio};
    use std::time::Duration;
    for signal in ["INT", "KILL"] {
        let folder = folder();
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("kinora"));
        let large = ["render", "ball.ron", "-s", "1280x720", "--antialias", "4", "-o", "f_##.png"];
        command.current_dir(folder.path()).args(large).args(FILES);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the binary runs");
        while !folder.path().join("f_00.png").exists() {
            assert_eq!(child.try_wait().expect("a process"), None, "it has ended");
            std::thread::sleep(Duration::from_millis(5));
        }
        let kill = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
        assert!(kill.expect("a command").success());
        let status = child.wait().expect("it ends");
        let events = events(&folder.path().join("run.json"));
        assert!(!events.is_empty());
        assert_nested(&events);
        if signal == "INT" {
            assert_eq!(status.code(), Some(130));
            assert!(!frames(&events, "encode").is_empty());
            assert!(lines(&folder.path().join("run.jsonl")).len() < 12);
        }
    }
}
