//! The command line: help, bad usage, exit codes.

use assert_cmd::Command;
use kinora::base::lanes::LevelName;
use std::path::PathBuf;

/// What a run printed, and its exit code.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

/// Runs `kinora` without a terminal.
fn kinora(arguments: &[&str]) -> Run {
    let mut command = Command::cargo_bin("kinora").expect("the binary is built with its tests");
    let output = command.args(arguments).output().expect("the binary runs");
    let text = |bytes| String::from_utf8(bytes).expect("output is UTF-8");
    Run { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// A bad command must fail with code 2, say all of `hints` on stderr, and nothing on stdout.
fn refused(arguments: &[&str], hints: &[&str]) {
    let run = kinora(arguments);
    assert_eq!(run.code, Some(2), "{arguments:?}: {}", run.stderr);
    assert_eq!(run.stdout, "", "{arguments:?}");
    assert!(run.stderr.starts_with("error: "), "{arguments:?}: {}", run.stderr);
    assert!(!run.stderr.contains('\x1b'), "colours without a terminal: {arguments:?}");
    for hint in hints {
        assert!(run.stderr.contains(hint), "{arguments:?} should say `{hint}`: {}", run.stderr);
    }
}

/// A file name in the tests' own folder for passing files.
fn scratch(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// A level that is misspelt, or that the processor lacks, is refused before anything is done; help is there all the same.
#[test]
fn unknown_simd_levels_are_refused() {
    let with_level = |level: &str, arguments: &[&str]| {
        let mut command = Command::cargo_bin("kinora").expect("the binary is built with its tests");
        command.env("KINORA_SIMD", level).args(arguments).output().expect("the binary runs")
    };
    let check = ["check", "sequences/hello.ron"];
    let valid: Vec<_> = LevelName::ALL.into_iter().filter(|level| level.is_available()).collect();
    let names: Vec<_> = valid.iter().map(|level| level.name()).collect();
    let lacking = LevelName::ALL.into_iter().filter(|level| !level.is_available()).map(LevelName::name);
    for level in ["foo", "AVX2", "portable "].into_iter().chain(lacking) {
        let output = with_level(level, &check);
        assert_eq!(output.status.code(), Some(2), "{level}");
        assert_eq!(output.stdout, b"", "{level}");
        let message = String::from_utf8_lossy(&output.stderr);
        let named = format!("error: environment variable KINORA_SIMD is {level:?}, but ");
        assert!(message.starts_with(&named), "{message}");
        assert!(message.ends_with(&format!("valid here: {}\n", names.join(", "))), "{message}");
        assert!(with_level(level, &["--help"]).status.success(), "{level}");
    }
    for level in names.into_iter().chain([""]) {
        assert!(with_level(level, &check).status.success(), "{level}");
    }
}

#[test]
fn help_shows_the_commands_and_an_example() {
    let run = kinora(&["--help"]);
    assert_eq!(run.code, Some(0));
    assert_eq!(run.stderr, "");
    for part in ["render", "check", "Usage:", "Examples:", "kinora render sequences/hello.ron", "Exit codes:"]
    {
        assert!(run.stdout.contains(part), "`{part}` in {}", run.stdout);
    }
}

#[test]
fn help_of_commands_shows_options_units_and_defaults() {
    let run = kinora(&["render", "--help"]);
    assert_eq!(run.code, Some(0));
    for part in [
        "-o, --output",
        "--frames",
        "-s, --size",
        "-r, --fps",
        "-t, --threads",
        "--bounces",
        "--antialias",
        "--samples",
        "--integrator",
        "--seed",
        "--tonemap",
        "--exposure",
        "--draft",
        "-q, --quiet",
        "--progress",
        "in pixels",
        "per second",
        "[default: ",
        "Examples:",
    ] {
        assert!(run.stdout.contains(part), "`{part}` in {}", run.stdout);
    }
    assert!(kinora(&["check", "--help"]).stdout.contains("kinora check sequences/hello.ron"));
    for command in [
        "render",
        "filmstrip",
        "poster",
        "assemble",
        "check",
        "plan",
        "accuracy",
        "farm export",
        "farm status",
        "expand",
        "explain",
        "fmt",
        "convert",
        "schema",
        "completions",
        "man",
    ] {
        let words: Vec<&str> = command.split(' ').chain(["--help"]).collect();
        let help = kinora(&words).stdout;
        assert!(help.lines().all(|line| line.chars().count() <= 100), "{help}");
    }
}

#[test]
fn the_version_is_printed() {
    let run = kinora(&["--version"]);
    assert_eq!((run.code, run.stdout.trim()), (Some(0), concat!("kinora ", env!("CARGO_PKG_VERSION"))));
}

#[test]
fn no_command_shows_the_help() {
    let run = kinora(&[]);
    assert_eq!(run.code, Some(2));
    assert!(run.stderr.contains("Usage:") && run.stderr.contains("Examples:"), "{}", run.stderr);
}

#[test]
fn unknown_words_are_refused_with_a_guess() {
    refused(&["rendr", "a.ron"], &["'rendr'", "'render'"]);
    refused(&["render", "a.ron", "--frame", "1"], &["'--frame'", "'--frames'"]);
    refused(&["render", "a.ron", "b.ron"], &["'b.ron'"]);
    refused(&["render"], &["<FILE>"]);
    refused(&["check"], &["<FILE>"]);
    refused(&["check", "a.ron", "-o", "a.gif"], &["'-o'"]);
    refused(&["render", "a.ron", "--resume", "--overwrite"], &["'--resume'", "'--overwrite'"]);
    refused(&["render", "a.ron", "--memroy", "2GB"], &["'--memroy'", "--memory is now called --film-cache"]);
}

#[test]
fn shells_get_completions() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let run = kinora(&["completions", shell]);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{shell}");
        assert!(run.stdout.contains("kinora") && run.stdout.contains("time-limit"), "{}", run.stdout);
    }
    refused(&["completions", "bosh"], &["'bosh'", "bash"]);
}

#[test]
fn manual_pages_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let pages = folder.path().join("man/man1");
    let run = kinora(&["man", "-o", pages.to_str().expect("text")]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let count = std::fs::read_dir(&pages).expect("a folder").count();
    assert!(run.stdout.starts_with(&format!("wrote {count} manual pages into ")), "{}", run.stdout);
    let page = std::fs::read_to_string(pages.join("kinora-render.1")).expect("a page");
    assert!(page.contains(".SH EXAMPLES") && page.contains("\\-\\-time\\-limit"), "{page}");
    // A file is where the folder should be.
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("a disk");
    let run = kinora(&["man", "-o", file.to_str().expect("text")]);
    assert_eq!(run.code, Some(3));
    assert!(run.stderr.contains("cannot write manual pages into"), "{}", run.stderr);
}

#[test]
fn fields_are_explained() {
    let run = kinora(&["explain", "output.exposure"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    assert!(run.stdout.starts_with("`exposure` · output\n"), "{}", run.stdout);
    assert!(run.stdout.contains("keys: yes"), "{}", run.stdout);
    refused(&["explain", "exposur"], &["did you mean `exposure`?"]);
    let titles = kinora(&["explain"]).stdout;
    assert!(titles.contains("  timeline\n") && titles.contains("    Tone maps\n"), "{titles}");
}

#[test]
fn the_schema_has_what_the_reference_says() {
    let run = kinora(&["schema"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let schema: serde_json::Value = serde_json::from_str(&run.stdout).expect("JSON");
    let text = |place: &str| schema.pointer(place).and_then(serde_json::Value::as_str).unwrap_or_default();
    assert_eq!(text("/$schema"), "https://json-schema.org/draft/2020-12/schema");
    let frames = text("/$defs/timeline/properties/frames/description");
    assert!(frames.starts_with("number of frames, 1 to 10 000 000. default: 1."), "{frames}");
    let fog = text("/properties/fog/description");
    assert!(fog.starts_with("Fog absorbs light on its way to the eye"), "{fog}");
    assert!(!run.stdout.contains("](#"), "links have no place in an editor");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("kinora.schema.json");
    let written = kinora(&["schema", "-o", path.to_str().expect("text")]);
    assert_eq!(written.code, Some(0), "{}", written.stderr);
    assert_eq!(std::fs::read_to_string(&path).expect("a file"), run.stdout);
}

#[test]
fn files_are_formatted_in_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("text").to_owned();
    let (before, after) =
        ("( timeline:(frames:2) , /* c */\n)", "(\n    timeline: (frames: 2), /* c */\n)\n");
    for (name, text) in [("a.ron", before), ("b.ron", after), ("broken.ron", "(a: [1, 2)")] {
        std::fs::write(path(name), text).expect("a disk");
    }
    let text = |name: &str| std::fs::read_to_string(path(name)).expect("a file");
    // One broken file, and nothing is written.
    let run = kinora(&["fmt", &path("a.ron"), &path("broken.ron")]);
    assert_eq!((run.code, text("a.ron").as_str()), (Some(2), before));
    assert!(run.stderr.contains("broken.ron:1"), "{}", run.stderr);
    let files = [path("a.ron"), path("b.ron")];
    let run = kinora(&["fmt", "--check", &files[0], &files[1]]);
    assert_eq!((run.code, run.stdout.trim_end()), (Some(3), files[0].as_str()));
    assert!(run.stderr.contains("1 file would change"), "{}", run.stderr);
    let run = kinora(&["fmt", &files[0], &files[1]]);
    assert_eq!((run.code, run.stdout.trim_end()), (Some(0), format!("wrote {}", files[0]).as_str()));
    assert_eq!((text("a.ron").as_str(), text("b.ron").as_str()), (after, after));
    assert_eq!(kinora(&["fmt", "--check", &files[0], &files[1]]).code, Some(0));
}

/// All shipped sequences and the parts that they include.
#[test]
fn shipped_files_are_formatted() {
    let folders = ["sequences", "sequences/bench", "sequences/parts"];
    let files = folders.iter().flat_map(|folder| std::fs::read_dir(folder).expect("a folder"));
    let names = files.map(|file| file.expect("a file").path().to_str().expect("text").to_owned());
    let names: Vec<String> = names.filter(|name| name.ends_with(".ron")).collect();
    assert!(names.len() > 40, "{names:?}");
    let words: Vec<&str> = ["fmt", "--check"].into_iter().chain(names.iter().map(String::as_str)).collect();
    let run = kinora(&words);
    assert_eq!((run.code, run.stdout.as_str()), (Some(0), ""), "{}", run.stderr);
}

#[test]
fn options_that_apply_to_nothing_are_refused() {
    for option in ["--json", "--pictures"] {
        refused(&["accuracy", "sequences/hello.ron", option, "out"], &[option, "needs --hard-cases"]);
    }
    for command in [&["assemble", "--help"][..], &["farm", "status", "--help"]] {
        let help = kinora(command).stdout;
        assert!(!help.contains("--film-cache") && !help.contains("--no-reuse"), "{help}");
    }
}

#[test]
fn bad_values_say_what_would_be_right() {
    for (option, values, hint) in [
        ("--size", &["1280", "0x5", "-4x3", "1280x", "axb"][..], "such as 1280x720"),
        ("--fps", &["0", "-24", "24.", "1/0", "inf", "NaN"], "24, 29.97 or 30000/1001"),
        ("--threads", &["0", "-1", "all"], "1 to 1024"),
        ("--bounces", &["-1", "1.5", "x"], "such as 8"),
        ("--antialias", &["0", "-1", "65", "x"], "from 1 (off) to 64"),
        ("--samples", &["0", "-1", "16777217", "x"], "1 to 16777216"),
        ("--seed", &["-1", "4294967296", "x"], "0 to 4294967295"),
        ("--integrator", &["paths", "x"], "whitted or path"),
        ("--progress", &["loud"], "auto, plain, json"),
    ] {
        for value in values {
            refused(&["render", "a.ron", option, value], &[option, value, hint]);
            refused(&["render", option, value, "a.ron"], &[option, value, hint]);
        }
    }
    let assemble = ["assemble", "f_##.png", "-o", "a.gif"];
    for (option, value, hint) in [
        ("--columns", "0", "write 1 to 400"),
        ("--colors", "1", "write 2 to 256"),
        ("--loop-count", "0", "1 to 65535"),
    ] {
        refused(&[&assemble[..], &[option, value]].concat(), &[option, hint]);
    }
    let late = ["poster", "sequences/hello.ron", "--at", "99"];
    refused(&late, &["99 s is after the end: the sequence is 3 s long"]);
}

#[test]
fn bad_frame_sets_say_what_would_be_right() {
    for (set, hint) in [
        ("", "no frames given"),
        ("x", "write for example 7, 0-47, 0..48 or 1-40:2"),
        ("1,,2", "is neither a frame nor a range"),
        ("-5", "frames count from 0"),
        ("-5-3", "frames count from 0"),
        ("9-3", "write 3-9"),
        ("5..5", "its end is exclusive"),
        ("1-9:0", "the smallest step is 1"),
        ("7:2", "a step but no range"),
        ("0-4294967296", "4294967296 is too large"),
    ] {
        refused(&["render", "a.ron", "--frames", set], &["--frames", hint]);
    }
}

#[test]
fn missing_files_and_folders_are_refused() {
    for command in ["render", "check"] {
        refused(&[command, "no/such/file.ron"], &["there is no file no/such/file.ron"]);
        refused(&[command, "src"], &["src is a folder"]);
        refused(&[command, ""], &["<FILE>"]);
    }
}

#[test]
fn a_missing_extension_is_guessed() {
    let file = scratch("present.ron");
    std::fs::write(&file, "()").expect("the folder is writable");
    let bare = file.with_extension("");
    refused(&["check", &bare.to_string_lossy()], &["did you mean", "present.ron?"]);
}

#[test]
fn quiet_runs_print_errors() {
    refused(&["render", "-q", "no/such/file.ron"], &["there is no file"]);
    refused(&["render", "no/such/file.ron", "--progress", "json"], &["there is no file"]);
}

#[test]
fn options_of_other_commands_are_explained() {
    let run = kinora(&["filmstrip", "a.ron", "--time-limit", "5s"]);
    assert_eq!(run.code, Some(2));
    assert!(
        run.stderr.contains(
            "--time-limit is an option of `kinora render`, `kinora poster`, `kinora assemble` and `kinora turntable`"
        ),
        "{}",
        run.stderr
    );
    assert!(!run.stderr.contains("-- --time-limit"), "{}", run.stderr);
    refused(
        &["check", "a.ron", "--seed", "1"],
        &["--seed is an option of `kinora render`, `kinora filmstrip`, `kinora poster`, `kinora assemble`"],
    );
    // No note, because the command has no such option under any name.
    refused(
        &["render", "a.ron", "--plays", "2"],
        &["--plays is now called --loop-count, an option of `kinora assemble`"],
    );
    let help = kinora(&["poster", "--help"]).stdout;
    assert!(!help.contains("GIF"), "{help}");
}

/// The old name of an option works as before, and stderr says what the option is called now.
#[test]
fn renamed_options_still_work_with_a_note() {
    let file = scratch("renamed.ron");
    let text = r#"(timeline: (frames: 2, keys: Frames), output: (size: (8, 6)),
        lights: { "sun": Point(position: (3, 4, 5)) }, objects: { "ball": (shape: Sphere()) })"#;
    std::fs::write(&file, text).expect("the folder is writable");
    let file = file.to_string_lossy();
    let plan = |option: &str| kinora(&["plan", &file, "--no-pilot", "--json", option, "1MB"]);
    let (old, current) = (plan("--memory"), plan("--film-cache"));
    assert_eq!((old.code, &old.stdout), (Some(0), &current.stdout), "{}", old.stderr);
    assert_eq!(old.stderr, "note: --memory is now called --film-cache\n");
    assert_eq!(current.stderr, "");
    // Notes are not errors.
    let quiet = kinora(&["plan", &file, "--no-pilot", "-q", "--memory", "1MB"]);
    assert_eq!((quiet.code, quiet.stderr.as_str()), (Some(0), ""));
    let run = kinora(&["render", &file, "--with-shared", "7", "--shard", "1/2"]);
    assert_eq!(run.code, Some(2));
    assert!(
        run.stderr.starts_with("note: --with-shared is now called --include-shared\nerror: "),
        "{}",
        run.stderr
    );
    assert!(!kinora(&["render", "--help"]).stdout.contains("--memory"));
}

/// A switch is no fade.
#[test]
fn plans_distinguish_switches_from_fades() {
    let file = scratch("switches.ron");
    let text = r#"(timeline: (frames: 6, keys: Frames), output: (size: (16, 12)),
        lights: {
            "a": Point(position: (3, 4, 5), on: [(0, true), (2, false)]),
            "b": Point(position: (3, 4, 5), on: [(0, false), (2, true)]),
            "c": Point(position: (1, 2, 3), intensity: [(3, 1), (5, 0)]),
        },
        objects: { "ball": (shape: Sphere()) })"#;
    std::fs::write(&file, text).expect("the folder is writable");
    let printed = kinora(&["plan", &file.to_string_lossy()]).stdout;
    assert!(printed.contains("2: light \"a\" and light \"b\" toggle (0 films)\n"), "{printed}");
    assert!(printed.contains("4-5: light \"c\" fades (0 films)\n"), "{printed}");
}

#[test]
fn plans_list_spans_effects_layers_rays_and_memory() {
    let file = scratch("plan.ron");
    let text = r#"(timeline: (frames: 8, keys: Frames), output: (size: (16, 12)),
        lights: {
            "key": Point(position: (3, 4, 5), on: [(0, true), (4, false)]),
            "never": Point(position: (1, 2, 3), on: [(0, false), (90, true)]),
        },
        objects: { "floor": (shape: Plane(), material: (mirror: 0.3)), "ball": (shape: Sphere(), translation: [(5, (0, 0, 0)), (7, (1, 0, 0))]) })"#;
    std::fs::write(&file, text).expect("the folder is writable");
    let file = file.to_string_lossy();
    let run = kinora(&["plan", &file]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    for part in [
        "frames  8, 5 reuse another frame's film\n",
        "films   3 films, with up to 2 layers of light\n",
        "a film is the light traced for a frame, in layers; ",
        "spans   0-3: nothing changes (1 film)\n",
        "4: light \"key\" toggles (0 films)\n",
        "5: nothing changes (0 films)\n",
        "6-7: object \"ball\" moves (2 films)\n",
        "key: in 1 film\n",
        "never: dark, not traced\n",
        "shadows: light \"key\" (1 film, ",
        "mirror: objects.\"floor\".material (3 films, ",
        "unused  orthographic, lens, motion blur,",
        "BVH     3 updates\n",
        " times fewer",
        "memory  ",
    ] {
        assert!(run.stdout.contains(part), "`{part}` in {}", run.stdout);
    }
    let both = text.replace("ball\": (shape: Sphere(), ", "ring\": (shape: Sphere(center: (3, 0, 0)), translation: [(5, (0, 0, 0)), (7, (1, 0, 0))]), \"ball\": (shape: Sphere(), ");
    let other = scratch("plans.ron");
    std::fs::write(&other, both).expect("the folder is writable");
    let printed = kinora(&["plan", &other.to_string_lossy()]).stdout;
    assert!(printed.contains("6-7: object \"ring\" and object \"ball\" move (2 films)\n"), "{printed}");
    let lit = text.replace("Point(position: (3, 4, 5),", "Point(position: (3, 4, 5), shadows: false,");
    std::fs::write(&other, lit).expect("the folder is writable");
    let printed = kinora(&["plan", &other.to_string_lossy()]).stdout;
    let unused = printed.lines().find(|line| line.starts_with("unused"));
    assert!(unused.is_some_and(|line| line.contains(", shadows,")), "{printed}");
    let json = kinora(&["plan", &file, "--json", "--frames", "0-5", "--film-cache", "1MB"]);
    assert_eq!(json.code, Some(0));
    let wanted =
        r#"{"event":"plan","frames":6,"reused":5,"spans":[{"first":0,"last":3,"changes":[],"films":1},"#;
    assert!(json.stdout.starts_with(wanted), "{}", json.stdout);
    assert!(json.stdout.contains(r#""budget_bytes":1000000"#), "{}", json.stdout);
    let none = kinora(&["plan", &file, "--json", "--frames", "0-5", "--film-cache", "0"]);
    assert!(none.stdout.contains(r#""budget_bytes":0"#), "{}", none.stdout);
    refused(&["plan", &file, "--film-cache", "much"], &["5MB", "or 0"]);
    refused(&["render", &file, "--film-cache", "5MB", "--no-reuse"], &["cannot be used with"]);
}

/// A plan says how many camera rays a zoom takes, and why frames share none.
#[test]
fn plans_explain_zooms() {
    let file = scratch("zooms.ron");
    let text = |quality: &str, camera: &str| {
        format!(
            r#"(timeline: (frames: 24, keys: Frames), output: (size: (24, 16)), quality: (reuse: Zoom, {quality}),
            camera: (position: (0, 1, 5), target: (0, 0, 0), {camera}), background: 0.5,
            lights: {{ "lamp": Point(position: (3, 6, 4)) }},
            objects: {{ "ball": (shape: Sphere()) }})"#
        )
    };
    let zoom = "path: Zoom(factor: [(0, 1), (23, 4)])";
    for (quality, camera, frames, wanted) in [
        ("antialias: 2", zoom.to_owned(), "0-23", "24 films in 1 group share samples"),
        ("antialias: 2", zoom.to_owned(), "0-23", " times fewer"),
        (
            "antialias: 2",
            zoom.to_owned(),
            "0-1",
            " times as many, because samples of frames that are not rendered",
        ),
        ("antialias: 2", format!("{zoom}, aperture: 0.1"), "0-23", "because the camera has a lens"),
        ("antialias: 2", "path: Orbit(turns: 1)".to_owned(), "0-23", "because no frames next to each other"),
        (
            "antialias: 2, filter: Box(width: 0.5)",
            zoom.to_owned(),
            "0-23",
            "because the filter is narrower than a pixel",
        ),
    ] {
        std::fs::write(&file, text(quality, &camera)).expect("the folder is writable");
        let run = kinora(&["plan", &file.to_string_lossy(), "--frames", frames]);
        assert!(run.stdout.contains(wanted), "{quality} {camera}: {}{}", run.stdout, run.stderr);
    }
}
