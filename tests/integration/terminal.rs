//! What reaches a terminal: whatever files and names hold, no control or format character does.

use crate::command::{BALL, folder, run};
use kinora::base::escape::must_escape;
use std::fs;
use std::path::Path;

/// Clears the screen in two ways, turns the text around, hides it and ends its line.
const EVIL: &str = "e\u{1b}[2J\u{9b}2J\u{85}\u{202e}\u{200b}\u{7f}\r\u{2028}\u{e0041}v";

/// The same as RON writes it.
const IN_RON: &str = r#"e\u{1b}[2J\u{9b}2J\u{85}\u{202e}\u{200b}\u{7f}\r\n\u{2028}\u{e0041}v"#;

/// Runs `kinora`, and gives all that it prints, in which there is nothing but plain text and line breaks.
fn printed(folder: &Path, arguments: &[&str], code: i32) -> String {
    let done = run(folder, arguments);
    let printed = [done.stdout, done.stderr].map(|bytes| String::from_utf8(bytes).expect("UTF-8")).concat();
    assert_eq!(done.status.code(), Some(code), "{arguments:?}: {printed:?}");
    let found = printed.chars().find(|c| *c != '\n' && must_escape(*c));
    assert!(found.is_none(), "{arguments:?} prints {found:?}: {printed:?}");
    printed
}

#[test]
fn names_of_files_are_shown_escaped() {
    let folder = folder();
    let shown = |printed: &str| assert!(printed.contains(r"e\u{1b}[2J\u{9b}2J"), "{printed}");
    let sequence = format!("{EVIL}.ron");
    shown(&printed(folder.path(), &["check", &sequence], 2));
    fs::write(folder.path().join(&sequence), BALL).expect("a disk");
    shown(&printed(folder.path(), &["check", &sequence], 0));
    let (stills, movie) = (format!("{EVIL}/{EVIL}_##.png"), format!("{EVIL}.gif"));
    shown(&printed(folder.path(), &["render", &sequence, "-o", &stills, "-o", &movie], 0));
    shown(&printed(
        folder.path(),
        &["render", &sequence, "-o", &movie, "--frames", "0", "--progress", "plain"],
        0,
    ));
    shown(&printed(folder.path(), &["render", &sequence, "-o", &movie, "--fail-if-exists"], 2));
    shown(&printed(folder.path(), &["render", &sequence, "-o", EVIL], 2));
    shown(&printed(folder.path(), &["assemble", &stills, "-o", &movie], 0));
    fs::write(folder.path().join(&sequence), "(objects: 3)").expect("a disk");
    shown(&printed(folder.path(), &["check", &sequence], 2));
    fs::write(folder.path().join(&sequence), b"\xff").expect("a disk");
    printed(folder.path(), &["check", &sequence], 2);
}

#[test]
fn programs_read_names_as_they_are() {
    let folder = folder();
    let name = format!("{EVIL}_##.png");
    let printed = printed(folder.path(), &["render", "ball.ron", "-o", &name, "--progress", "json"], 0);
    let summary = printed.lines().last().expect("a summary");
    let file = summary.split("\"files\":[").nth(1).and_then(|rest| rest.split(']').next()).expect("files");
    assert_eq!(file, r#""e\u001b[2J\u009b2J\u0085\u202e\u200b\u007f\r\u2028\udb40\udc41v_##.png""#);
}

#[test]
fn arguments_are_shown_escaped() {
    let folder = folder();
    for arguments in [&[EVIL][..], &["render", "ball.ron", EVIL], &["render", "ball.ron", "--size", EVIL]] {
        let printed = printed(folder.path(), arguments, 2);
        assert!(printed.contains(r"e\u{1b}[2J\u{9b}2J\u{85}"), "{printed}");
    }
}

#[test]
fn text_of_sequences_is_escaped() {
    let folder = folder();
    let check = |text: &str, code: i32| {
        fs::write(folder.path().join("evil.ron"), text).expect("a disk");
        let printed = printed(folder.path(), &["check", "evil.ron"], code);
        assert!(code == 0 || printed.contains(r"\u{9b}2J"), "{printed}");
        printed
    };
    // In the lines that are quoted, before, at and behind the fault, and in words that are taken from them.
    let quoted = check(&format!("(/* {EVIL} */ objects: 3 /* {EVIL} */)"), 2);
    assert!(quoted.contains(r"e\u{1b}[2J") && quoted.contains("found 3"), "{quoted}");
    check(&format!("(objects: {{ \"{EVIL}\": (shape: Sphere(), parent: \"{IN_RON}x\") }})"), 2);
    check(&format!("(objects: {{ \"a\": (shape: Mesh(\"{IN_RON}.ply\")) }})"), 2);
    check(&format!("(background: Equirect(\"{EVIL}.png\"))"), 2);
    check(&format!("(output: (files: [\"{IN_RON}.gif\"]))"), 2);
    check(&format!("(output: (files: [\"{EVIL}.tiff\"]))"), 2);
    check(&format!("(quality: ({EVIL}: 3))"), 2);
    check(&format!("(output: (caption: \"{{{IN_RON}}}\"))"), 2);
    // Columns are those of what is shown.
    let marked = check("(/* \u{9b}2J */ objects: 3)", 2);
    let lines: Vec<&str> = marked.lines().collect();
    let at = lines[3].find('3').expect("the value");
    assert_eq!(lines[4].find('^'), Some(at), "{marked}");
}

#[test]
fn lines_of_windows_files_are_quoted_without_their_ends() {
    let folder = folder();
    fs::write(folder.path().join("crlf.ron"), "(\r\n\tobjects: 3,\r\n)\r\n").expect("a disk");
    let printed = printed(folder.path(), &["check", "crlf.ron"], 2);
    assert!(printed.contains("2 |     objects: 3,\n"), "{printed}");
}

#[test]
fn names_in_plans_and_notes_stay_in_their_lines() {
    // A note shows the beginning of a name.
    let folder = folder();
    let named = BALL
        .replace("\"ball\"", &format!("\"\\n{IN_RON}\""))
        .replace("\"sun\": Point(", &format!("\"\\n{IN_RON}\": Point(intensity: [(0, 1), (9, 2)], "))
        .replace("Sphere(radius: 1)", "Sphere(radius: 1), material: Lambertian(color: 2)")
        .replace("output: (", "quality: (integrator: Path, samples: 1), output: (");
    fs::write(folder.path().join("named.ron"), named).expect("a disk");
    for arguments in [
        &["plan", "named.ron"][..],
        &["plan", "named.ron", "--json"],
        &["check", "named.ron"],
        &["render", "named.ron"],
    ] {
        let printed = printed(folder.path(), arguments, 0);
        let mut lines = printed.lines().filter(|line| line.contains("[2J")).peekable();
        assert!(
            lines.peek().is_some() && lines.all(|line| line.contains("\\u{a}e") || line.contains("\\ne")),
            "{printed}"
        );
    }
}
