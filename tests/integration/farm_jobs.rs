//! Exported jobs as parsers read them that have no part in writing them.

use crate::command::kinora;
use crate::farm::{HALF, counted, farm};
use kinora::pipeline::plan::with_shared;
use kinora::sequence::{Sequence, load};
use std::fs;
use toml::{Table, Value};

/// Twelve frames, of which the first half takes many samples and the second one a pixel: two classes of work.
const CLASSES: &str = r#"(
    timeline: (frames: 12, fps: 24, keys: Frames),
    output: (size: (32, 18), files: ["out/half.gif"]),
    quality: (antialias: 1, samples: 64),
    lights: {
        "sun": Point(position: (3, 4, 5)),
        "lamp": Sphere(center: (-3, 4, 5), radius: 1, on: [(0, true), (6, false)]),
    },
    objects: { "ball": (shape: Sphere(radius: 1), translation: [(0, (-1, 0, 0)), (12, (1, 0, 0))]) },
)"#;

/// Letters that mean something to shells, TOML, YAML and templates.
const CAPTION: &str = r#"--caption=- it's "{frame}": # \n {{{name}}}, é"#;

/// A job, and what it is of.
struct Exported {
    text: String,
    sequence: Sequence,
}

/// Jobs of sequences with one class of work and with two, with a GIF and a filmstrip.
fn exported(engine: &str, file: &str) -> Vec<Exported> {
    let export = |text: &str, chunks: &str| {
        let folder = farm();
        fs::write(folder.path().join("half.ron"), text).expect("a disk");
        let flags = ["--filmstrip", "out/a b.png", "--chunks", chunks, "-t", "2", CAPTION];
        kinora(folder.path(), &[&["farm", "export", engine, "half.ron"], &flags[..]].concat());
        Exported {
            text: fs::read_to_string(folder.path().join(file)).expect("a job"),
            sequence: load(&folder.path().join("half.ron")).expect("a sequence"),
        }
    };
    vec![export(HALF, "1"), export(HALF, "4"), export(CLASSES, "4"), export(CLASSES, "100")]
}

/// All frames of a sequence.
fn all() -> Vec<u32> {
    (0..12).collect()
}

/// Every frame is made once, and no film twice.
fn check_frames(sequence: &Sequence, tasks: &[Vec<u32>]) {
    let mut frames = tasks.concat();
    frames.sort_unstable();
    assert_eq!(frames, all(), "{tasks:?}");
    for task in tasks {
        assert_eq!(with_shared(sequence, task, &all()).len(), task.len(), "a film in two tasks: {tasks:?}");
    }
}

/// The word after another.
fn after<'a>(words: &'a [String], word: &str) -> Option<&'a str> {
    let place = words.iter().position(|other| other == word)?;
    words.get(place + 1).map(String::as_str)
}

fn list(of: &Value) -> &[Value] {
    of.as_array().expect("a list")
}

fn text(of: &Value) -> &str {
    of.as_str().expect("text")
}

fn texts(of: &Value) -> Vec<String> {
    list(of).iter().map(|of| text(of).to_owned()).collect()
}

#[test]
fn jobs_for_hyperqueue_are_toml_and_make_every_frame_once() {
    for Exported { text: job, sequence } in exported("hyperqueue", "half.hq.toml") {
        let job: Table = job.parse().unwrap_or_else(|error| panic!("{error}\n{job}"));
        assert_eq!(text(&job["name"]), "half");
        let tasks = list(&job["task"]);
        let ids: Vec<i64> = tasks.iter().filter_map(|task| task["id"].as_integer()).collect();
        assert_eq!(ids, (0..tasks.len() as i64).collect::<Vec<_>>());
        let words = |task: &Value| texts(&task["command"]);
        let (renders, rest): (Vec<&Value>, Vec<&Value>) =
            tasks.iter().partition(|task| words(task)[..2] == ["kinora", "render"]);
        let frames = |task: &&Value| counted(after(&words(task), "--frames").expect("frames"));
        check_frames(&sequence, &renders.iter().map(frames).collect::<Vec<_>>());
        for task in &renders {
            assert!(task.get("deps").is_none() && words(task).iter().any(|word| word == CAPTION), "{task:?}");
        }
        assert_eq!(rest.len(), 2, "a GIF and a filmstrip");
        let before: Vec<Value> = renders.iter().map(|task| task["id"].clone()).collect();
        for task in &rest {
            assert_eq!((&words(task)[..2], list(&task["deps"])), (&assemble()[..], &before[..]));
        }
        assert!(tasks.iter().all(|task| task["request"][0]["resources"]["cpus"].as_integer() == Some(2)));
    }
}

fn assemble() -> [String; 2] {
    ["kinora", "assemble"].map(str::to_owned)
}

/// The default of a parameter of the job.
fn default<'a>(job: &'a Table, name: &str) -> &'a str {
    let mut definitions = list(&job["parameterDefinitions"]).iter();
    let found = definitions.find(|definition| text(&definition["name"]) == name);
    text(&found.unwrap_or_else(|| panic!("{name} is not defined"))["default"])
}

/// What a step runs, with the job's parameters as they are without being said.
fn command(job: &Table, step: &Value) -> Vec<String> {
    let run = &step["script"]["actions"]["onRun"];
    let mut words = texts(&run["args"]);
    for word in &mut words {
        if let Some((before, rest)) = word.clone().split_once("{{Param.") {
            let (name, behind) = rest.split_once("}}").expect("a name");
            *word = format!("{before}{}{behind}", default(job, name));
        }
    }
    words.insert(0, text(&run["command"]).to_owned());
    words
}

#[test]
fn jobs_for_open_job_description_are_yaml_and_make_every_frame_once() {
    let mut most = 0;
    for Exported { text: job, sequence } in exported("openjd", "half.openjd.yaml") {
        let job: Table = serde_saphyr::from_str(&job).unwrap_or_else(|error| panic!("{error}\n{job}"));
        assert_eq!(text(&job["specificationVersion"]), "jobtemplate-2023-09");
        assert_eq!(
            (&texts(&job["extensions"])[..], text(&job["name"])),
            (&["TASK_CHUNKING".to_owned()][..], "half")
        );
        let (renders, rest): (Vec<&Value>, Vec<&Value>) =
            list(&job["steps"]).iter().partition(|step| step.get("parameterSpace").is_some());
        most = most.max(renders.len());
        let mut films = Vec::new();
        for step in &renders {
            let words = command(&job, step);
            assert_eq!(words[..3], ["kinora", "render", "half.ron"]);
            assert!(words.iter().any(|word| word == CAPTION), "{words:?}");
            assert_eq!(after(&words, "--frames"), Some("{{Task.Param.Frame}}"));
            let [frame] = list(&step["parameterSpace"]["taskParameterDefinitions"]) else {
                panic!("{step:?}")
            };
            assert_eq!((text(&frame["name"]), text(&frame["type"])), ("Frame", "CHUNK[INT]"));
            assert!(frame["chunks"]["defaultTaskCount"].as_integer().is_some_and(|count| count > 0));
            // An engine may take any of them together, so each is looked at by itself.
            let among = after(&words, "--include-shared").map(counted).unwrap_or_default();
            let leads = counted(text(&frame["range"]));
            films.extend(leads.iter().map(|&lead| with_shared(&sequence, &[lead], &among)));
            assert!(step.get("dependencies").is_none());
        }
        check_frames(&sequence, &films);
        let names: Vec<&str> = renders.iter().map(|step| text(&step["name"])).collect();
        assert_eq!(rest.len(), 2, "a GIF and a filmstrip");
        for step in &rest {
            assert_eq!(command(&job, step)[..2], assemble());
            let before = list(&step["dependencies"]).iter();
            assert_eq!(before.map(|step| text(&step["dependsOn"])).collect::<Vec<_>>(), names);
        }
        for definition in list(&job["parameterDefinitions"]) {
            let is_path = text(&definition["type"]) == "PATH";
            assert!(!is_path || !text(&definition["default"]).starts_with('/'), "{definition:?}");
        }
    }
    assert_eq!(most, 2, "a step for each class of work");
}
