//! Sequences of several files: their plain file, what notices a changed file, and their messages.

use crate::command::{contents, folder, kinora, refused, run, stderr};
use std::fs;
use std::path::Path;

const SCENE: &str = r#"(
    include: ["parts/balls.ron"],
    timeline: (frames: 2),
    output: (size: (32, 18), files: ["out/scene_####.png"]),
    lights: { "sun": Point(position: (3, 4, 5)) },
    // Three balls.
    objects: { "ball": Repeat(count: 3, step: ("=2*r", 0, 0), object: (template: "ball", with: { "paint": "red" })) },
)"#;

const BALLS: &str = r##"(
    let: { "r": 0.6 },
    materials: { "red": (color: "#c02010") },
    templates: { "ball": (parameters: { "paint": Required }, objects: {
        "b": (shape: Sphere(radius: "=r"), material: "=paint"),
    }) },
)"##;

fn scene(folder: &Path) {
    fs::create_dir_all(folder.join("parts")).expect("a disk");
    fs::write(folder.join("scene.ron"), SCENE).expect("a disk");
    fs::write(folder.join("parts/balls.ron"), BALLS).expect("a disk");
}

#[test]
fn the_plain_file_renders_the_same_bytes() {
    let folder = folder();
    scene(folder.path());
    kinora(folder.path(), &["render", "scene.ron"]);
    let frames = contents(&folder.path().join("out"));
    assert_eq!(frames.len(), 2);
    let plain = kinora(folder.path(), &["expand", "scene.ron"]);
    assert!(
        plain.contains("\"ball[2]/b\": (parent: \"ball[2]\"") && plain.contains("// Three balls."),
        "{plain}"
    );
    assert!(!["include", "template", "Repeat", "\"="].iter().any(|word| plain.contains(word)), "{plain}");
    fs::write(folder.path().join("scene.ron"), &plain).expect("a disk");
    assert_eq!(kinora(folder.path(), &["expand", "scene.ron"]), plain);
    fs::remove_dir_all(folder.path().join("out")).expect("a disk");
    kinora(folder.path(), &["render", "scene.ron"]);
    assert!(frames == contents(&folder.path().join("out")), "the bytes differ");
}

#[test]
fn a_changed_include_is_noticed() {
    let folder = folder();
    scene(folder.path());
    kinora(folder.path(), &["render", "scene.ron"]);
    let before = contents(&folder.path().join("out"));
    kinora(folder.path(), &["render", "scene.ron"]);
    assert!(before == contents(&folder.path().join("out")), "frames are kept");
    let changed = BALLS.replace("#c02010", "#1020c0");
    fs::write(folder.path().join("parts/balls.ron"), changed).expect("a disk");
    kinora(folder.path(), &["render", "scene.ron"]);
    let after = contents(&folder.path().join("out"));
    assert!(before.iter().all(|(name, bytes)| after.get(name) != Some(bytes)), "frames are rendered again");
}

#[test]
fn tasks_of_jobs_notice_a_changed_include() {
    let folder = folder();
    scene(folder.path());
    let job = kinora(folder.path(), &["farm", "export", "shell", "scene.ron"]);
    let files = contents(folder.path());
    let expected = files.values().find_map(|bytes| {
        let text = String::from_utf8_lossy(bytes).into_owned();
        let rest = text.split_once("--expect ")?.1.to_owned();
        rest.split_whitespace().next().map(|word| word.trim_matches(['\'', '"']).to_owned())
    });
    let expected = expected.unwrap_or_else(|| panic!("no fingerprint in {:?}\n{job}", files.keys()));
    let task = ["render", "scene.ron", "--frames", "0", "--expect", &expected];
    kinora(folder.path(), &task);
    fs::write(folder.path().join("parts/balls.ron"), BALLS.replace("0.6", "0.7")).expect("a disk");
    let message = refused(folder.path(), &task);
    assert!(message.contains("balls.ron has changed since the job was exported"), "{message}");
}

#[test]
fn mistakes_of_included_files_name_them() {
    let folder = folder();
    scene(folder.path());
    fs::write(folder.path().join("parts/balls.ron"), BALLS.replace("0.6", "-0.6")).expect("a disk");
    for command in ["check", "expand", "plan"] {
        let output = run(folder.path(), &[command, "scene.ron"]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for part in
            ["expected a number above 0", "parts/balls.ron:2:17", "the value is used here", "scene.ron:7:"]
        {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
    fs::write(folder.path().join("parts/balls.ron"), "(").expect("a disk");
    assert!(refused(folder.path(), &["check", "scene.ron"]).contains("parts/balls.ron:1:1"));
}
