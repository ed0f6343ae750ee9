mod validator;

use super::schema;
use crate::base::files::Root;
use crate::sequence::{converted_text, parse};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

static SCHEMA: LazyLock<Value> = LazyLock::new(|| schema(&|_| None));

fn validate(json: &str) -> Result<(), String> {
    let value = serde_json::from_str(json).unwrap_or_else(|error| panic!("{error}: {json}"));
    validator::validate(&SCHEMA, &SCHEMA, &value)
}

/// All names in `properties` of a schema.
fn properties(schema: &Value, names: &mut BTreeSet<String>) {
    match schema {
        Value::Object(words) => {
            names.extend(
                words
                    .get("properties")
                    .and_then(Value::as_object)
                    .into_iter()
                    .flat_map(|fields| fields.keys().cloned()),
            );
            words.values().for_each(|schema| properties(schema, names));
        }
        Value::Array(schemas) => schemas.iter().for_each(|schema| properties(schema, names)),
        _ => {}
    }
}

/// All decoders: the files of the room, but those that expand RON.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let name = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if entry.is_dir() && !["expand", "fmt", "convert", "tests", "schema"].contains(&name.as_str()) {
            sources(&entry, found);
        } else if name.ends_with(".rs") && !name.ends_with("tests.rs") {
            found.push(entry);
        }
    }
}

/// The text of all decoders, and those of the shapes, without comments and tests.
fn decoders() -> Vec<(PathBuf, String)> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    sources(&source.join("sequence"), &mut found);
    sources(&source.join("geometry/shape"), &mut found);
    let text = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("a source");
        let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        let text = lines.collect::<Vec<_>>().join("\n");
        (path, text)
    };
    found.into_iter().map(text).collect()
}

#[test]
fn sequences_that_convert_satisfy_the_schema() {
    for (stem, ron) in [
        ("everything", include_str!("../../tests/everything.ron")),
        ("larger", include_str!("../../tests/larger.ron")),
    ] {
        let path = Path::new("src/sequence/tests").join(stem).with_extension("ron");
        let json = converted_text(&path, ron, Root::of(Path::new("src/sequence/tests")));
        let json = json.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(validate(&json), Ok(()), "{stem}");
    }
}

/// Sequences that the reader accepts.
const ACCEPTED: &[&str] = &[
    "{}",
    r#"{"$schema": "./kinora.schema.json", "timeline": {"frames": 4}}"#,
    r#"{"objects": {"Ball": {"shape": "Sphere"}}, "lights": {"Lamp": {"Point": {"position": [0, 1, 2]}}}}"#,
    r#"{"objects": {"b": {"shape": {"Sphere": []}, "material": {"Metal": []}}}}"#,
    r#"{"objects": {"b": {"shape": {"Sphere": {}}, "material": {"color": {"VertexColor": []}}}}}"#,
    r##"{"objects": {"b": {"shape": "Sphere", "material": {"color": "VertexColor", "mirror_color": "#fff"}}}}"##,
    r#"{"objects": {"b": {"shape": "Sphere", "rotation": {"Quaternion": [[0, 0, 0, 1]]}}}}"#,
    r#"{"objects": {"b": {"shape": "Sphere", "rotation": {"Quaternion": [[[0, [0, 0, 0, 1]], [1, [0, 0, 1, 0]]]]}}}}"#,
    r#"{"objects": {"b": {"shape": "Sphere", "translation": [[0, [1, 2, 3]], [1, [0, 0, 0], "Smooth"]]}}}"#,
    r#"{"objects": {"b": {"shape": "Sphere", "translation": [{"t": 0, "v": [1, 2, 3], "ease": {"Bezier": [0, 0, 1, 1]}}]}}}"#,
    r#"{"objects": {"b": {"shape": "Sphere", "scale": {"Track": {"keys": [[0, 1], [1, [1, 2, 3]]], "repeat": "Loop"}}}}}"#,
    r#"{"quality": {"Error": 0.01}}"#,
    r#"{"quality": {"Error": [0.01]}}"#,
    r#"{"quality": {"noise": 0.01, "most_samples": 100, "integrator": {"Path": {"roulette": "Off"}}, "filter": "Gaussian"}}"#,
    r#"{"background": {"Srgb": [1, 2, 3]}, "ambient": 0.5, "fog": {"density": [[0, 1], [1, 2]]}}"#,
    r#"{"camera": {"projection": "Orthographic", "path": ["Orbit", {"Zoom": {"factor": 2}}]}}"#,
    r#"{"camera": {"path": {"Orbit": {"turns": 2}}}, "timeline": {"fps": "30000/1001", "duration": 1}}"#,
    r#"{"output": {"files": "a_####.png", "caption": "{frame}", "png": {"bits": 16}, "gif": {"plays": 2}}}"#,
    r#"{"annotations": {"a": {"Label": {"text": "x", "at": [0, 0, 0], "backdrop": "None", "offset": {"Pixels": [1, 2]}}}}}"#,
    r#"{"annotations": {"a": {"Caption": {"text": "x", "backdrop": "Halo"}}}}"#,
    r##"{"annotations": {"a": {"Caption": {"text": "x", "backdrop": {"Halo": "#fff"}}}}}"##,
    r#"{"annotations": {"a": {"Caption": {"text": "x", "backdrop": {"Box": {"opacity": 0.5}}}}}}"#,
    r#"{"annotations": {"a": {"Caption": "x"}, "b": {"Clock": []}, "c": "Clock", "d": {"Caption": ["x"]}}}"#,
    r#"{"annotations": {"a": {"Line": {"from": {"Screen": [0, 1]}, "to": {"Screen": [[[0, [0, 1]], [1, [1, 1]]]]}}}}}"#,
    r##"{"objects": {"m": {"shape": {"Mesh": {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]],
        "normals": [[0, 0, 1], [0, 0, 1], [0, 0, 1]], "uvs": [[0, 0], [1, 0], [0, 1]], "colors": ["#fff", 0.5, [1, 1, 1]]}}}}}"##,
    r#"{"objects": {"m": {"shape": {"Mesh": {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]],
        "normals": {"Crease": {"angle": 30}}}}}}}"#,
];

#[test]
fn what_the_reader_accepts_satisfies_the_schema() {
    for json in ACCEPTED {
        assert!(parse("a/b.json", json).map_err(|faults| println!("{faults}")).is_ok(), "{json}");
        assert_eq!(validate(json), Ok(()), "{json}");
    }
}

#[test]
fn mistakes_do_not_satisfy_the_schema() {
    for json in [
        "[]",
        r#"{"sceen": 1}"#,
        r#"{"$schema": 1}"#,
        r#"{"let": {"a": 1}}"#,
        r#"{"quality": {"sampels": 3}}"#,
        r#"{"quality": {"samples": 2.5}}"#,
        r#"{"quality": {"samples": 0}}"#,
        r#"{"quality": {"integrator": {"Path": {"rulette": 1}}}}"#,
        r#"{"quality": {"integrator": "Pathh"}}"#,
        r#"{"timeline": {"frames": "3"}}"#,
        r#"{"timeline": {"keys": "Frame"}}"#,
        r#"{"timeline": {"fps": -24}}"#,
        r#"{"timeline": {"duration": 0, "fps": 24}}"#,
        r#"{"output": {"size": [64]}}"#,
        r#"{"output": {"size": [64, "x"]}}"#,
        r#"{"output": {"png": {"bits": 12}}}"#,
        r#"{"fog": {}}"#,
        r#"{"fog": {"density": -1}}"#,
        r#"{"objects": []}"#,
        r#"{"objects": null}"#,
        r#"{"objects": {"b": {}}}"#,
        r#"{"objects": {"b": {"template": "t"}}}"#,
        r#"{"objects": {"b": {"shape": "Spere"}}}"#,
        r#"{"objects": {"b": {"shape": {"Sphere": {"radios": 1}}}}}"#,
        r#"{"objects": {"b": {"shape": {"Sphere": {"radius": true}}}}}"#,
        r#"{"objects": {"b": {"shape": "Scene"}}}"#,
        r#"{"objects": {"b": {"shape": "Sphere", "material": {"colour": 1}}}}"#,
        r#"{"objects": {"b": {"shape": "Sphere", "material": {"color": {"Checker": {"a": {"Dots": {"c": 1}}}}}}}}"#,
        r#"{"objects": {"b": {"shape": "Sphere", "translation": [[0, [1, 2]]]}}}"#,
        r#"{"objects": {"b": {"shape": "Sphere", "translation": [[0, [1, 2, 3], "Smoth"]]}}}"#,
        r#"{"lights": {"l": {"Point": {}}}}"#,
        r#"{"lights": {"l": "Point"}}"#,
        r#"{"lights": {"l": {"Repeat": {"count": 2}}}}"#,
        r#"{"annotations": {"a": {"Label": {"text": "x"}}}}"#,
        r#"{"annotations": {"a": {"Label": {"text": "x", "at": [0, 0, 0], "place": "Top"}}}}"#,
    ] {
        assert!(parse("a/b.json", json).is_err(), "the reader accepts {json}");
        assert!(validate(json).is_err(), "the schema accepts {json}");
    }
}

#[test]
fn the_schema_has_every_field_that_decoders_name() {
    let mut known = BTreeSet::new();
    properties(&SCHEMA, &mut known);
    let mut count = 0;
    for (path, text) in decoders() {
        let ways = ["fields.or(", "fields.optional(", "fields.required(", "fields.renamed("];
        for name in ways.iter().flat_map(|way| text.split(way).skip(1)) {
            let Some(name) = name.trim_start().strip_prefix('"').and_then(|name| name.split('"').next())
            else {
                continue;
            };
            assert!(known.contains(name), "{}: {name}", path.to_string_lossy());
            count += 1;
        }
    }
    assert!(count > 250, "found only {count} fields");
}

/// A decoder that compares words itself hides them from the schema.
#[test]
fn decoders_say_which_words_they_look_for() {
    for (path, text) in decoders() {
        let squeezed: String = text.split_whitespace().collect::<Vec<_>>().join(" ");
        for hidden in [
            ".word() == \"",
            ".word() != \"",
            "bare_word() == Some(\"",
            "bare_word() != Some(\"",
            "matches!(node.word(),",
        ] {
            for place in squeezed.match_indices(hidden).map(|(at, _)| &squeezed[at..]) {
                let end = place.char_indices().nth(60).map_or(place.len(), |(at, _)| at);
                let is_announced = text.contains(".ask_words(") || text.contains(".begins_with(");
                assert!(is_announced, "{}: {}", path.to_string_lossy(), &place[..end]);
            }
        }
    }
}

#[test]
fn descriptions_have_the_names_of_owners() {
    let schema = schema(&|path| Some(path.join(".")));
    let description = |place: &str| schema.pointer(place).and_then(Value::as_str).map(str::to_owned);
    assert_eq!(description("/properties/timeline/description"), Some("timeline".to_owned()));
    let texts = schema.to_string();
    for path in ["lights.Point.position", "objects.shape.Sphere.radius", "output.png.bits"] {
        assert!(texts.contains(&format!("\"description\":\"{path}\"")), "{path}");
    }
}
