//! The command in a folder of its own, and what is in the folder afterwards.

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Output;

/// Twelve frames of a ball that moves.
pub const BALL: &str = r#"(
    timeline: (frames: 12, fps: 24, keys: Frames),
    output: (size: (32, 18)),
    background: (0.01, 0.03, 0.05),
    lights: { "sun": Point(position: (3, 4, 5)) },
    objects: { "ball": (shape: Sphere(radius: 1), translation: [(0, (-1, 0, 0)), (12, (1, 0, 0))]) },
)"#;

/// A folder with `ball.ron` in it.
pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("the folder is writable");
    fs::write(folder.path().join("ball.ron"), BALL).expect("the folder is writable");
    folder
}

/// Runs `kinora` in a folder.
pub fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("kinora").expect("the binary is built with its tests");
    command.current_dir(folder).args(arguments).output().expect("the binary runs")
}

/// Runs it to success and returns what it prints.
pub fn kinora(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Runs it to a refusal, and gives its message.
pub fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
    stderr(&output)
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The files of a folder, hidden ones too, with their bytes.
pub fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let plain = entries.filter(|entry| entry.path().is_file());
    plain
        .map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            (name, fs::read(entry.path()).expect("a file"))
        })
        .collect()
}

/// Whether a run watches for signals by now.
#[cfg(target_os = "linux")]
pub fn watches(child: &std::process::Child) -> bool {
    let text = fs::read_to_string(format!("/proc/{}/status", child.id())).expect("a process");
    assert!(!text.contains("State:\tZ"), "it has ended");
    let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:")).expect("a mask");
    // SIGTERM, which is the last of them.
    u64::from_str_radix(caught.trim(), 16).expect("a mask") & 1 << 14 != 0
}
