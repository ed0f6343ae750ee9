//! `kinora render` and `kinora check` on sequences that are right.

use assert_cmd::Command;
use std::fs;
use std::path::Path;
use std::process::Output;

/// Three frames of a ball, at 24 frames per second.
const BALL: &str = r#"(
    timeline: (frames: 3, fps: 24),
    output: (size: (16, 9)),
    lights: { "sun": Point(position: (3, 4, 5)) },
    objects: { "ball": (shape: Sphere(radius: 1)) },
)"#;

/// Runs `kinora` in a folder, without a terminal.
fn kinora(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("kinora").expect("the binary is built with its tests");
    command.current_dir(folder).args(arguments).output().expect("the binary runs")
}

/// A folder of its own with `ball.ron` in it.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    fs::write(folder.path().join("ball.ron"), BALL).expect("the folder is writable");
    folder
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).expect("output is UTF-8")
}

fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).expect("output is UTF-8")
}

/// All files in a folder, in order of their names.
fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is readable");
    let mut names: Vec<_> =
        entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn check_prints_an_overview_and_writes_nothing() {
    let folder = folder();
    let run = kinora(folder.path(), &["check", "ball.ron"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let line = stdout(&run);
    assert!(line.starts_with("ball: 3 frames · 0.125 s at 24 fps · 16x9 · 1 object · 1 light · "), "{line}");
    assert_eq!(line.lines().count(), 1);
    assert_eq!(files(folder.path()), ["ball.ron"]);
}

#[test]
fn faults_give_code_2() {
    let folder = folder();
    fs::write(folder.path().join("bad.ron"), BALL.replace("radius: 1", "radius: -1")).expect("writable");
    for command in ["check", "render"] {
        let run = kinora(folder.path(), &[command, "bad.ron"]);
        assert_eq!(run.status.code(), Some(2), "{command}");
        assert_eq!(stdout(&run), "", "{command}");
        assert!(stderr(&run).starts_with("error"), "{}", stderr(&run));
        assert!(stderr(&run).contains("bad.ron:5:"), "{}", stderr(&run));
    }
    assert_eq!(files(folder.path()), ["bad.ron", "ball.ron"]);
}

#[test]
fn render_writes_the_chosen_files_and_sums_up() {
    let folder = folder();
    let run = kinora(folder.path(), &["render", "-o", "out/f_##.png", "ball.ron", "-o", "out/ball.gif"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert_eq!(files(&folder.path().join("out")), ["ball.gif", "f_00.png", "f_01.png", "f_02.png"]);
    let summary = stdout(&run);
    for part in ["wrote   out", "frames  3", "time ", "rays ", "camera", "shadow", "BVH ", "stages "] {
        assert!(summary.contains(part), "`{part}` in {summary}");
    }
}

#[test]
fn a_subset_keeps_its_numbers_and_its_bytes() {
    let folder = folder();
    assert!(kinora(folder.path(), &["render", "ball.ron", "-o", "all/##.png"]).status.success());
    let run = kinora(folder.path(), &["render", "ball.ron", "-o", "some/##.png", "--frames", "0-2:2"]);
    assert!(run.status.success(), "{}", stderr(&run));
    assert_eq!(files(&folder.path().join("some")), ["00.png", "02.png"]);
    for name in ["00.png", "02.png"] {
        let read = |from: &str| fs::read(folder.path().join(from).join(name)).expect("it was written");
        assert!(read("all") == read("some"), "{name} differs");
    }
}

#[test]
fn frames_beyond_the_end_are_refused() {
    let folder = folder();
    let run = kinora(folder.path(), &["render", "ball.ron", "--frames", "1-3", "-o", "##.png"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(stderr(&run).contains("there is no frame 3; the sequence has 3 frames, 0-2"), "{}", stderr(&run));
    assert_eq!(files(folder.path()), ["ball.ron"]);
    // The rate of the command line counts: the same eighth of a second holds six frames at 48.
    let run = kinora(folder.path(), &["render", "ball.ron", "-r", "48", "--frames", "5", "-o", "##.png"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert_eq!(files(folder.path()), ["05.png", "ball.ron"]);
}

#[test]
fn quiet_runs_print_nothing() {
    let folder = folder();
    for extra in [&["-q"][..], &["-q", "--progress", "json"], &["--progress", "plain", "--quiet"]] {
        let run = kinora(folder.path(), &[&["render", "ball.ron", "-o", "b.gif"], extra].concat());
        assert_eq!((run.status.code(), stdout(&run), stderr(&run)), (Some(0), "", ""), "{extra:?}");
    }
}

#[test]
fn json_progress_ends_with_a_summary() {
    let folder = folder();
    let run = kinora(folder.path(), &["render", "ball.ron", "-o", "b.gif", "--progress", "json"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let lines: Vec<_> = stdout(&run).lines().collect();
    let (last, progress) = lines.split_last().expect("at least the summary");
    assert!(last.starts_with(r#"{"event":"summary","files":["b.gif"],"frames":3,"#), "{last}");
    assert!(progress.iter().all(|line| line.starts_with(r#"{"event":"progress","frame":"#)), "{lines:?}");
    assert!(progress.last().is_some_and(|line| line.contains(r#""frame":3,"frames":3,"#)), "{lines:?}");
    assert!(lines.iter().all(|line| line.ends_with('}')));
}

#[test]
fn a_draft_is_half_as_wide_and_says_so() {
    let folder = folder();
    let run = kinora(folder.path(), &["render", "ball.ron", "-o", "b_#.png", "--draft"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert!(stdout(&run).contains("a draft: 8x5, antialias 1, samples 16, bounces 1"), "{}", stdout(&run));
    let png = fs::read(folder.path().join("b_0.png")).expect("it was written");
    // Width and height of a PNG are the first fields of its first chunk.
    assert_eq!(png[16..24], [0, 0, 0, 8, 0, 0, 0, 5]);
}

#[test]
fn unwritable_outputs_give_code_3() {
    let folder = folder();
    // No file system has names as long.
    let output = format!("{}/b.gif", "x".repeat(300));
    let run = kinora(folder.path(), &["render", "ball.ron", "-o", &output]);
    assert_eq!(run.status.code(), Some(3), "{}", stderr(&run));
    assert!(stderr(&run).starts_with("error: "), "{}", stderr(&run));
}

#[test]
fn outputs_of_unknown_formats_are_refused() {
    let folder = folder();
    for output in ["b.mp3", "b", ""] {
        let run = kinora(folder.path(), &["render", "ball.ron", "-o", output]);
        assert_eq!(run.status.code(), Some(2), "`{output}`: {}", stderr(&run));
    }
    let run = kinora(folder.path(), &["render", "ball.ron", "-o", "b.png"]);
    assert_eq!(run.status.code(), Some(2), "three frames and one name: {}", stderr(&run));
    let run = kinora(folder.path(), &["render", "ball.ron", "-o", "b.gif", "-o", "b.gif"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(stderr(&run).contains("two outputs would write b.gif"), "{}", stderr(&run));
}

#[test]
fn exposure_and_tone_map_change_pictures_but_no_radiance() {
    let folder = folder();
    let bytes = |options: &[&str]| {
        let outputs = ["-o", "f_#.png", "-o", "f_#.exr", "--frames", "0"];
        let run = kinora(folder.path(), &[&["render", "ball.ron"], &outputs[..], options].concat());
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        ["f_0.png", "f_0.exr"].map(|name| fs::read(folder.path().join(name)).expect(name))
    };
    let [picture, radiance] = bytes(&[]);
    for options in [["--exposure", "-1"], ["--tonemap", "filmic"], ["--tonemap", "None"]] {
        let [other, same] = bytes(&options);
        assert!(other != picture && same == radiance, "{options:?}");
    }
    for options in [["--exposure", "41"], ["--tonemap", "aces"]] {
        let run = kinora(folder.path(), &[&["render", "ball.ron"], &options[..]].concat());
        assert_eq!(run.status.code(), Some(2), "{options:?}: {}", stderr(&run));
    }
}
