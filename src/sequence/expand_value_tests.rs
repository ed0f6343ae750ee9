//! Named values in all places of an expanded sequence, and faults that are reported once.

use super::expand_tests::{faults, folder, names, plain, read, translations};
use super::*;
use crate::geometry::shape::Mesh;
use std::sync::Arc;

fn parents(sequence: &Sequence) -> Vec<Option<&str>> {
    let name = |index: usize| sequence.objects[index].name.as_str();
    sequence.objects.iter().map(|object| object.value.parent.map(name)).collect()
}

#[test]
fn empty_repetitions_may_stand_anywhere_in_a_template() {
    let (none, one) = ("Repeat(count: \"=n\", object: (shape: Sphere()))", "(shape: Sphere())");
    for (entries, expected) in [
        (format!("\"a\": {none}, \"b\": {one}"), &["x", "x/b"][..]),
        (format!("\"b\": {one}, \"a\": {none}, \"c\": {one}"), &["x", "x/b", "x/c"]),
        (format!("\"b\": {one}, \"a\": {none}"), &["x", "x/b"]),
        (format!("\"a\": {none}, \"b\": {none}"), &["x"]),
        (format!("\"a\": {none}"), &["x"]),
    ] {
        let text = format!(
            "(templates: {{ \"t\": (parameters: {{ \"n\": 0 }}, objects: {{ {entries} }}) }}, \
            objects: {{ \"x\": (template: \"t\") }})"
        );
        assert_eq!(names(&read(&text)), expected, "{text}");
    }
}

#[test]
fn objects_that_are_values_are_moved_from_copy_to_copy() {
    for (value, expected) in [
        ("(shape: Sphere())", [[0.0; 3], [1.0, 0.0, 0.0]]),
        (
            "(shape: Sphere(radius: \"=r\"), translation: (\"=r\", 0.25, -3))",
            [[0.5, 0.25, -3.0], [1.5, 0.25, -3.0]],
        ),
    ] {
        let text = format!(
            "(let: {{ \"r\": 0.5, \"o\": {value} }}, \
            objects: {{ \"c\": Repeat(count: 2, step: (1, 0, 0), object: \"=o\") }})"
        );
        let (_, sequence) = plain(&folder(&[]), &text);
        assert_eq!((names(&sequence), translations(&sequence)), (vec!["c[0]", "c[1]"], expected.to_vec()));
    }
    let message = faults(
        "(let: { \"o\": (shape: Sphere(), translation: true) }, objects: { \"c\": Repeat(count: 2, step: (1, 0, 0), object: \"=o\") })",
    );
    assert!(message.contains("expected numbers (x, y, z)") && message.contains("test.ron:1:45"), "{message}");
    assert!(message.contains("the value is used here"), "{message}");
}

#[test]
fn objects_that_are_values_belong_to_their_template() {
    let text =
        "(let: { \"o\": (shape: Sphere(), material: \"m\"), \"below\": (shape: Sphere(), parent: \"s\") },
        materials: { \"m\": () },
        templates: { \"t\": (parameters: { \"q\": \"=o\" }, objects: {
            \"s\": \"=o\", \"p\": \"=q\", \"b\": \"=below\",
            \"r\": Repeat(count: 2, step: (0, 1, 0), object: \"=q\"),
        }) },
        objects: { \"a\": (template: \"t\", translation: (5, 0, 0)),
            \"b\": (template: \"t\", with: { \"q\": (shape: Sphere(), translation: (1, \"=1+1\", 3)) }) })";
    let (_, sequence) = plain(&folder(&[]), text);
    let expected = [
        ("a", None, [5.0, 0.0, 0.0]),
        ("a/s", Some("a"), [0.0; 3]),
        ("a/p", Some("a"), [0.0; 3]),
        ("a/b", Some("a/s"), [0.0; 3]),
        ("a/r[0]", Some("a"), [0.0; 3]),
        ("a/r[1]", Some("a"), [0.0, 1.0, 0.0]),
        ("b", None, [0.0; 3]),
        ("b/s", Some("b"), [0.0; 3]),
        ("b/p", Some("b"), [1.0, 2.0, 3.0]),
        ("b/b", Some("b/s"), [0.0; 3]),
        ("b/r[0]", Some("b"), [1.0, 2.0, 3.0]),
        ("b/r[1]", Some("b"), [1.0, 3.0, 3.0]),
    ];
    assert_eq!(names(&sequence), expected.map(|(name, ..)| name));
    assert_eq!(parents(&sequence), expected.map(|(_, parent, _)| parent));
    assert_eq!(translations(&sequence), expected.map(|(.., at)| at));
}

#[test]
fn parents_in_templates_are_found_first_in_the_template() {
    let template = "templates: { \"t\": (parameters: { \"p\": Required }, objects: { \"s\": (shape: Sphere()), \"k\": (shape: Sphere(), parent: \"=p\") }) }";
    let text = format!(
        "({template}, objects: {{ \"outer\": (shape: Sphere()), \"s\": (shape: Sphere()), \
        \"x\": (template: \"t\", with: {{ \"p\": \"s\" }}), \"y\": (template: \"t\", with: {{ \"p\": \"outer\" }}) }})"
    );
    let (_, sequence) = plain(&folder(&[]), &text);
    assert_eq!(
        parents(&sequence),
        [None, None, None, Some("x"), Some("x/s"), None, Some("y"), Some("outer")]
    );
    let message = faults(
        "(templates: { \"t\": (objects: { \"s\": (shape: Sphere(), parent: \"outer\") }) },
        objects: { \"outer\": (shape: Sphere()), \"x\": (template: \"t\") })",
    );
    assert!(
        message.contains("there is no object `x/outer`") && !message.contains("did you mean"),
        "{message}"
    );
    assert!(
        message.contains("the parents of a template's objects are in the template, here `x/s`"),
        "{message}"
    );
}

#[test]
fn names_of_values_stand_in_fields_of_copies_and_templates() {
    let text = "(let: { \"t\": \"ball\", \"n\": 2, \"grid\": (1, 2), \"s\": (1, 0, 0), \"at\": (0, 5, \"=n\"), \"moves\": [(0, \"=at\"), (1, (1, 1, 1))] },
        templates: { \"ball\": (objects: { \"b\": (shape: Sphere()) }) },
        objects: {
            \"a\": (template: \"=t\"),
            \"b\": Repeat(count: \"=n\", step: \"=s\", object: (shape: Sphere(), translation: \"=at\")),
            \"c\": Repeat(count: \"=grid\", object: (shape: Sphere(), translation: (\"=j\", 0, 0))),
            \"d\": Repeat(count: 2, step: \"=s\", object: (shape: Sphere(), translation: \"=moves\")),
        })";
    let (_, sequence) = plain(&folder(&[]), text);
    assert_eq!(names(&sequence), ["a", "a/b", "b[0]", "b[1]", "c[0,0]", "c[0,1]", "d[0]", "d[1]"]);
    let at = translations(&sequence);
    assert_eq!(at[2..6], [[0.0, 5.0, 2.0], [1.0, 5.0, 2.0], [0.0; 3], [1.0, 0.0, 0.0]]);
    assert_eq!(at[6..], [[0.0, 5.0, 2.0], [1.0, 5.0, 2.0]]);
    let message =
        faults("(let: { \"n\": 2.5 }, objects: { \"b\": Repeat(count: \"=n\", object: (shape: Sphere())) })");
    assert!(
        message.contains("`count`: expected a whole number") && message.contains("found 2.5"),
        "{message}"
    );
    let message = faults(
        "(let: { \"w\": {} }, templates: { \"t\": (objects: {}) }, objects: { \"b\": (template: \"t\", with: \"=w\") })",
    );
    assert!(message.contains("no expression can stand here"), "{message}");
}

#[test]
fn sections_that_are_values_join_those_of_included_files() {
    let files = folder(&[("m.ron", "(materials: { \"a\": () }, objects: { \"o\": (shape: Sphere()) })")]);
    let text = "(include: [\"m.ron\"], let: { \"m\": { \"b\": (color: \"#ff0000\"), }, \"o\": { \"p\": (shape: Sphere()) } },
        materials: \"=m\", objects: \"=o\")";
    let (_, sequence) = plain(&files, text);
    assert_eq!(names(&sequence), ["o", "p"]);
    let materials: Vec<_> = sequence.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(materials[..2], ["a", "b"]);
    for text in ["include: \"=x\"", "include: [\"=x\"]"] {
        let message = faults(&format!("({text})"));
        assert!(message.contains("no expression can stand here"), "{text}\n{message}");
    }
}

#[test]
fn values_do_not_stand_for_several_objects() {
    for (value, objects) in [
        ("Repeat(count: 2, object: (shape: Sphere()))", "{ \"o\": \"=v\" }"),
        ("(template: \"t\")", "{ \"o\": \"=v\" }"),
        ("(template: \"t\")", "{ \"o\": Repeat(count: 2, step: (1, 0, 0), object: \"=v\") }"),
        ("{ \"a\": (template: \"t\") }", "\"=v\""),
        ("{ \"a\": Repeat(count: 2, object: (shape: Sphere())) }", "\"=v\""),
    ] {
        let message = faults(&format!(
            "(let: {{ \"v\": {value} }}, templates: {{ \"t\": (objects: {{ \"b\": (shape: Sphere()) }}) }}, objects: {objects})"
        ));
        assert!(message.contains("cannot be in a value"), "{value} {objects}\n{message}");
    }
}

#[test]
fn faulty_values_and_templates_have_one_message() {
    for (text, count) in [
        (
            "let: { \"a\": \"=1/0\", \"b\": \"=a+1\", \"c\": \"=b\" }, ambient: \"=c\", timeline: (frames: \"=a\")",
            1,
        ),
        ("let: { \"a\": (1, \"=(\") , \"b\": \"=2*a\" }, ambient: \"=a\"", 1),
        ("let: 5, ambient: \"=c\"", 1),
        ("let: { \"a\": Repeat(count: \"=i\") }, objects: { \"o\": \"=a\" }", 1),
        (
            "templates: { \"t\": (object: {}) }, objects: { \"o\": (template: \"t\"), \"p\": (template: \"t\") }",
            2,
        ),
        ("templates: [], objects: { \"o\": (template: \"t\") }", 1),
        (
            "templates: { \"t\": (parameters: { \"r\": \"=1/0\" }, objects: { \"b\": (shape: Sphere(radius: \"=r\")) }) }, objects: { \"o\": (template: \"t\"), \"p\": (template: \"t\") }",
            1,
        ),
        // Templates that nothing uses are parsed, too.
        ("templates: { \"t\": (objects: { \"b\": (shape: Sphere(radius: \"=2 *\")) }) }", 1),
    ] {
        let message = faults(&format!("({text})"));
        assert_eq!(message.matches("error:").count(), count, "{text}\n{message}");
    }
}

#[test]
fn a_fault_of_many_copies_is_found_soon() {
    // More names than can be compared for each of a million copies.
    let lets: String = (0..3000).map(|n| format!("\"name{n}\": {n}, ")).collect();
    for object in ["(shape: Sphere(radius: \"=nmae1\"))", "(template: \"nmae\")", "(template: \"t\")"] {
        let message = faults(&format!(
            "(let: {{ {lets} }}, templates: {{ \"t\": (objects: {{ \"b\": Repeat(count: 1000, object: (template: \"nmae\")) }}) }},
            objects: {{ \"o\": Repeat(count: 1000000, object: {object}) }})"
        ));
        assert!(message.contains("nmae"), "{message}");
        assert_eq!(message.matches("error:").count(), 1, "{message}");
    }
}

#[test]
fn names_of_included_files_are_kept_once() {
    let lets: String = (0..20_000).map(|n| format!("\"name{n}\": {n}, ")).collect();
    let base = format!("(let: {{ {lets} }})");
    let users: Vec<_> = (0..300)
        .map(|n| {
            (format!("u{n}.ron"), format!("(include: [\"base.ron\"], let: {{ \"u{n}\": \"=name{n}+1\" }})"))
        })
        .collect();
    let mut files = vec![("base.ron", base.as_str())];
    files.extend(users.iter().map(|(name, text)| (name.as_str(), text.as_str())));
    let includes: String = users.iter().map(|(name, _)| format!("\"{name}\", ")).collect();
    let text = format!("(include: [{includes}], timeline: (frames: \"=u0 + u299 + name3\"))");
    let (_, sequence) = plain(&folder(&files), &text);
    assert_eq!(sequence.timeline.frames, 1 + 300 + 3);
}

#[test]
fn files_see_only_what_they_include() {
    let files = folder(&[
        ("a.ron", "(let: { \"x\": 1 })"),
        ("b.ron", "(let: { \"y\": \"=x\" })"),
        ("word.ron", "Library(let: { \"z\": 1 })"),
    ]);
    let path = files.path().join("test.ron");
    let message = |text: &str| {
        std::fs::write(&path, text).expect("a disk");
        load(&path).expect_err(text).to_string()
    };
    assert!(message("(include: [\"a.ron\", \"b.ron\"])").contains("there is no value `x`"));
    let word = message("(include: [\"word.ron\"])");
    assert!(word.contains("around the whole file, without `Library` in front"), "{word}");
}

#[test]
fn uses_are_listed_from_the_inside_out() {
    let message = faults(
        "(
    let: { \"a\": -1,
        \"b\": \"=a\" },
    templates: { \"t\": (objects: {
        \"s\": (shape: Sphere(radius: \"=b\")) }) },
    objects: { \"o\": Repeat(count: 2, object:
        (template: \"t\")) },
)",
    );
    let lines: Vec<_> = message.lines().filter_map(|line| line.split("test.ron:").nth(1)).collect();
    let lines: Vec<_> = lines.iter().filter_map(|line| line.split(':').next()).collect();
    assert_eq!(lines, ["2", "3", "5", "7", "6"], "{message}");
}

#[test]
fn places_in_long_lines_have_columns() {
    let message = faults(&format!(
        "(let: {{ \"a\": -1 }}, {}objects: {{ \"o\": (shape: Sphere(radius: \"=a\")) }})",
        " ".repeat(10_000)
    ));
    assert!(message.contains("test.ron:1:14") && message.contains("test.ron:1:10059"), "{message}");
}

#[test]
fn plain_files_keep_texts_that_begin_with_an_equals_sign() {
    let text = "(templates: { \"t\": (objects: { \"b\": (shape: Sphere()) }) }, objects: { \"=x\": (template: \"t\") })";
    let (plain_text, sequence) = plain(&folder(&[]), text);
    assert_eq!(names(&sequence), ["=x", "=x/b"]);
    assert!(plain_text.contains("parent: r\"=x\""), "{plain_text}");
    let files = folder(&[
        ("=d/m.ron", "(objects: { \"m\": (shape: Mesh(\"m.obj\")) })"),
        ("=d/m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ]);
    for include in ["\"=d/m.ron\"", "r\"=d/m.ron\""] {
        let (plain_text, _) = plain(&files, &format!("(include: [{include}])"));
        assert!(plain_text.contains("Mesh(r\"=d/m.obj\")"), "{plain_text}");
    }
}

#[test]
fn plain_files_keep_comments_around_the_sequence() {
    let text = "// Begins here.\n(timeline: (frames: \"=1+1\"))\n// Ends here.\n";
    let (plain_text, _) = plain(&folder(&[]), text);
    assert_eq!(plain_text, "// Begins here.\n(timeline: (frames: 2),)\n// Ends here.\n");
}

#[test]
fn computed_durations_and_rates_are_rounded() {
    let (plain_text, sequence) = plain(
        &folder(&[]),
        "(let: { \"third\": \"=1/3\" }, timeline: (fps: \"=80/3\", duration: \"=third\"))",
    );
    assert!(plain_text.contains("fps: 26.666667") && plain_text.contains("0.333333333"), "{plain_text}");
    assert_eq!(sequence.timeline.frames, 9);
    let message = faults("(timeline: (duration: 0.3333333333))");
    assert!(message.contains("at most 9 decimal places"), "{message}");
}

#[test]
fn counts_are_exact_for_common_angles() {
    assert_eq!(
        read("(objects: { \"o\": Repeat(count: \"=12*sin(30)\", object: (shape: Sphere())) })").objects.len(),
        6
    );
}

#[test]
fn equal_texts_share_their_mesh() {
    let sequence = read(
        "(objects: { \"t\": Repeat(count: 3, object: (shape: Text(\"M8\"))), \"u\": (shape: Text(text: \"M8\", size: 2)) })",
    );
    let meshes: Vec<_> = sequence
        .objects
        .iter()
        .map(|object| match &object.value.shape {
            Shape::Mesh(Mesh { mesh, .. }) => mesh,
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(Arc::ptr_eq(meshes[0], meshes[2]) && !Arc::ptr_eq(meshes[0], meshes[3]));
}

#[test]
fn annotations_keep_to_their_documentation() {
    for (annotation, part) in [
        (
            "Label(text: \"a\", at: Object(name: \"o\", side: (3, 0, 0)))",
            "`side`: expected a place in the box",
        ),
        ("Caption(text: \"{time}\", values: { \"time\": 42 })", "`{time}` already has a meaning"),
    ] {
        let message = faults(&format!(
            "(objects: {{ \"o\": (shape: Sphere()) }}, annotations: {{ \"a\": {annotation} }})"
        ));
        assert!(message.contains(part), "{message}");
    }
}
