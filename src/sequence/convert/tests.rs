use super::*;
use crate::sequence::{Sequence, parse};

fn sequence(name: &str, text: &str) -> Sequence {
    let sequence = parse(name, text).unwrap_or_else(|faults| panic!("{faults}\n{text}"));
    Sequence { warnings: Vec::new(), ..sequence }
}

fn converted_to(name: &str, text: &str) -> String {
    let folder = Path::new(name).parent().expect("a folder");
    converted_text(Path::new(name), text, Root::of(folder)).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Parts of glTF files are only equal to themselves, so their content is compared.
fn is_same(one: &Sequence, other: &Sequence) -> bool {
    one == other || format!("{one:?}") == format!("{other:?}")
}

/// Converts a text of RON to JSON and back. All three load as the same sequence.
fn assert_round_trip(stem: &str, ron: &str) -> String {
    let (ron_name, json_name) = (format!("{stem}.ron"), format!("{stem}.json"));
    let expected = sequence(&ron_name, ron);
    let json = converted_to(&ron_name, ron);
    serde_json::from_str::<serde::de::IgnoredAny>(&json).expect("JSON");
    assert!(is_same(&sequence(&json_name, &json), &expected), "{stem}: another sequence in JSON:\n{json}");
    let again = converted_to(&json_name, &json);
    assert!(is_same(&sequence(&ron_name, &again), &expected), "{stem}: another sequence in RON:\n{again}");
    assert_eq!(converted_to(&ron_name, &again), json, "{stem}");
    json
}

#[test]
fn all_fields_keep_their_content() {
    assert_round_trip("src/sequence/tests/everything", include_str!("../tests/everything.ron"));
    assert_round_trip("src/sequence/tests/larger", include_str!("../tests/larger.ron"));
}

#[test]
fn numbers_keep_their_digits_and_texts_their_characters() {
    let ron = r##"(
        timeline: (duration: 1.000000001, fps: 24, keys: Seconds),
        objects: {
            "é \"1\" \\ \u{1}": (shape: Sphere(radius: +1_000.), translation: [(0.123456789, (.5, -0.0, 1e-7)), (123456789.123456789, (1, 2, 3))]),
            r#"Ball"#: (shape: Sphere(), material: Metal),
        },
    )"##;
    let json = assert_round_trip("a/b", ron);
    for part in ["123456789.123456789", "1000", "0.5", r#""é \"1\" \\ \u0001""#, r#"{"Metal": []}"#] {
        assert!(json.contains(part), "{part}: {json}");
    }
    // Escapes as other programs write them.
    let escaped = json.replace('é', "\\u00e9").replace("Ball", "\\ud83d\\ude00\\/");
    let names: Vec<String> =
        sequence("a/b.json", &escaped).objects.into_iter().map(|object| object.name).collect();
    assert_eq!(names, ["é \"1\" \\ \u{1}", "😀/"]);
}

#[test]
fn a_map_may_have_one_name_that_looks_like_a_word() {
    let json = r#"{"objects": {"Ball": {"shape": "Sphere"}}, "lights": {"Lamp": {"Point": {"position": [0, 1, 2]}}}}"#;
    let ron = converted_to("a/b.json", json);
    let expected =
        r#"(objects: { "Ball": (shape: Sphere) }, lights: { "Lamp": Point(position: (0, 1, 2)) })"#;
    assert_eq!(ron.trim_end(), expected);
}

/// Texts of JSON are never expressions, those of RON that begin with `=` are.
#[test]
fn texts_that_look_like_expressions_stay_texts() {
    let json = r#"{"objects": {"=1+1": {"shape": {"Text": {"text": "=1+1"}}}, "=a \"": {"shape": "Group"},
        "b": {"shape": {"Text": {"text": "=\"q\""}}, "parent": "=a \""},
        "c": {"shape": {"Text": {"text": "\u003d2"}}}}, "output": {"caption": "=3", "files": ["=f.gif"]}}"#;
    let ron = converted_to("a/b.json", json);
    assert!(is_same(&sequence("a/b.ron", &ron), &sequence("a/b.json", json)), "{ron}");
    assert!(ron.contains("r\"=1+1\"") && ron.contains("r\"=f.gif\""), "{ron}");
}

#[test]
fn the_place_of_a_schema_is_ignored() {
    let json = r#"{"$schema": "./kinora.schema.json", "timeline": {"frames": 2}}"#;
    assert!(is_same(&sequence("a/b.json", json), &sequence("a/b.ron", "(timeline: (frames: 2))")));
    assert_eq!(converted_to("a/b.json", json).trim_end(), "(timeline: (frames: 2))");
}

#[test]
fn faults_name_the_place_in_the_file() {
    for (json, parts) in [
        ("{\n  \"objects\": {,}\n}", &["a/b.json:2:15", "JSON"][..]),
        ("{\n  \"quality\": {\n    \"sampels\": 3}}", &["a/b.json:3:6", "did you mean `samples`"]),
        ("{\"output\": {\"size\": [64, \"x\"]}}", &["a/b.json:1:26", "expected a"]),
        ("{\"timeline\": {\"keys\": \"Frame\"}}", &["a/b.json:1:", "did you mean `Frames`"]),
        ("{\"objects\": {\"b\": {\"shape\": {\"Spere\": {}}}}}", &["a/b.json:1:31", "did you mean `Sphere`"]),
        ("{\"let\": {\"a\": 1}}", &["a/b.json:1:2", "`let` needs RON"]),
        ("{\"objects\": {\"b\": {\"template\": \"t\"}}}", &["`template` needs RON"]),
        ("{\"objects\": {\"b\": {\"Repeat\": {\"count\": 2}}}}", &["`Repeat` needs RON"]),
        ("(objects: {})", &["a/b.json:1:1", "JSON"]),
        ("[]", &["a/b.json:1:1", "an object"]),
        ("3", &["a/b.json:1:1", "an object"]),
        ("", &["a/b.json:1:1", "JSON"]),
        ("null", &["a/b.json:1:1"]),
        ("{\"objects\": null}", &["`objects`"]),
        ("{\"$schema\": 1}", &["`$schema`: expected text"]),
        ("{\"output\": {\"$schema\": \"a\"}}", &["the output has no field `$schema`"]),
    ] {
        let message = parse("a/b.json", json).expect_err(json).to_string();
        assert!(parts.iter().all(|part| message.contains(part)), "{parts:?}: {message}");
    }
}
