//! Sequences with values, expressions, repetitions, templates and included files.

use super::*;
use crate::base::files::Root;
use crate::base::math::DVec3;
use crate::base::time::Time;
use crate::geometry::transform::Rotation;
use std::fs;
use std::sync::Arc;
use tempfile::TempDir;

pub(super) fn read(text: &str) -> Sequence {
    parse("dir/test.ron", text).unwrap_or_else(|faults| panic!("{text}\n{faults}"))
}

pub(super) fn faults(text: &str) -> String {
    parse("test.ron", text).err().unwrap_or_else(|| panic!("{text} is accepted")).to_string()
}

/// The file as one plain text, and its sequence. The plain text must be the same sequence.
pub(super) fn plain(folder: &TempDir, text: &str) -> (String, Sequence) {
    let path = folder.path().join("test.ron");
    fs::write(&path, text).expect("a disk");
    let plain =
        expanded(&path, Root::of(folder.path()), &Arc::default()).unwrap_or_else(|error| panic!("{error}"));
    let sequence = load(&path).unwrap_or_else(|error| panic!("{error}"));
    fs::write(&path, &plain).expect("a disk");
    let again = load(&path).unwrap_or_else(|error| panic!("{plain}\n{error}"));
    // Meshes hold NaN, which does not equal itself.
    assert_eq!(format!("{sequence:?}"), format!("{again:?}"), "{plain}");
    (plain, sequence)
}

pub(super) fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a parent")).expect("a disk");
        fs::write(path, text).expect("a disk");
    }
    folder
}

pub(super) fn names(sequence: &Sequence) -> Vec<&str> {
    sequence.objects.iter().map(|object| object.name.as_str()).collect()
}

pub(super) fn translations(sequence: &Sequence) -> Vec<[f64; 3]> {
    let at = |object: &Named<Object>| object.value.transform.at(Time::from_integer(0)).translation;
    sequence.objects.iter().map(|object| at(object).to_array()).collect()
}

#[test]
fn values_stand_for_numbers_and_everything_else() {
    let text = "(
        let: { \"r\": 2.5, \"d\": \"=2*r\", \"at\": (\"=d\", 0.1, -3), \"red\": \"#ff0000\", \"moves\": [(0, 0), (1, \"=r\")] },
        timeline: (frames: \"=4 * 3\"),
        camera: (position: \"=at\"),
        objects: { \"ball\": (shape: Sphere(radius: \"= d / 10\"), material: (color: \"=red\")) },
        lights: { \"sun\": Directional(direction: (0, 1, 0), intensity: \"=moves\") },
    )";
    let plain_text = "(
        timeline: (frames: 12),
        camera: (position: (5, 0.1, -3)),
        objects: { \"ball\": (shape: Sphere(radius: 0.5), material: (color: \"#ff0000\")) },
        lights: { \"sun\": Directional(direction: (0, 1, 0), intensity: [(0, 0), (1, 2.5)]) },
    )";
    assert_eq!(read(text), read(plain_text));
}

#[test]
fn exact_numbers_stay_exact() {
    let keys = |time: &str| {
        let text = format!(
            "(let: {{ \"third\": \"=1/3\" }}, objects: {{ \"o\": (shape: Sphere(), visible: [(0, true), ({time}, false)]) }})"
        );
        read(&text).objects.remove(0).value.visible
    };
    assert_eq!(keys("\"=0.1+0.2\""), keys("0.3"));
    assert_eq!(keys("\"=3*third\""), keys("1"));
    // Rounded to 9 decimal places, as the times of tables.
    assert_eq!(keys("\"=third\""), keys("0.333333333"));
    let rounded = folder(&[]);
    let text = "(objects: { \"o\": (shape: Sphere(), visible: [(0, true), (\"=2/3\", false)]) })";
    assert!(plain(&rounded, text).0.contains("(0.666666667, false)"));
}

#[test]
fn texts_and_names_that_begin_with_an_equals_sign_can_be_written() {
    let text = "(materials: { \"=m\": (color: \"#f00\") }, objects: { \"a\": (shape: Sphere(), material: r\"=m\") })";
    assert_eq!(
        read(text).objects[0].value.made_of,
        read("(materials: { \"m\": () }, objects: { \"a\": (shape: Sphere(), material: \"m\") })").objects[0]
            .value
            .made_of
    );
}

#[test]
fn repeated_objects_have_names_and_places_of_their_own() {
    let row = read(
        "(objects: { \"b\": Repeat(count: 3, object: (shape: Sphere(), translation: (\"=i/2\", 0, 0))) })",
    );
    assert_eq!(names(&row), ["b[0]", "b[1]", "b[2]"]);
    assert_eq!(translations(&row), [[0.0; 3], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    let grid = read(
        "(objects: { \"t\": Repeat(count: (2, 1, 2), step: (10, 0, 3), object: (shape: Sphere(), translation: (1, 2, 3))) })",
    );
    assert_eq!(names(&grid), ["t[0,0,0]", "t[0,0,1]", "t[1,0,0]", "t[1,0,1]"]);
    assert_eq!(translations(&grid), [[1.0, 2.0, 3.0], [1.0, 2.0, 6.0], [11.0, 2.0, 3.0], [11.0, 2.0, 6.0]]);
    let slanted = read(
        "(objects: { \"t\": Repeat(count: (2, 2), step: ((1, 0, 0), (0, 0.1, 1)), object: (shape: Sphere())) })",
    );
    assert_eq!(translations(&slanted), [[0.0; 3], [0.0, 0.1, 1.0], [1.0, 0.0, 0.0], [1.0, 0.1, 1.0]]);
    let keyed = |repeat: &str| read(&format!("(objects: {{ {repeat} }})")).objects;
    for keys in [
        "[(0, (0, 0, 0)), (1, (X, 2, 0), Smooth)]",
        "Track(keys: [(t: 0, v: (0, 0, 0)), (t: 1, v: (X, 2, 0))], repeat: Loop)",
    ] {
        let (first, second) =
            (keys.replace('X', "5"), keys.replace("(0, 0, 0)", "(1, 0, 0)").replace('X', "6"));
        let copies = format!(
            "\"b\": Repeat(count: 2, step: (1, 0, 0), object: (shape: Sphere(), translation: {first}))"
        );
        let written = format!(
            "\"b[0]\": (shape: Sphere(), translation: {first}), \"b[1]\": (shape: Sphere(), translation: {second})"
        );
        assert_eq!(keyed(&copies), keyed(&written));
    }
    assert!(names(&read("(objects: { \"b\": Repeat(count: 0, object: (shape: Sphere())) })")).is_empty());
}

#[test]
fn lights_are_repeated() {
    let sequence = read(
        "(lights: { \"l\": Repeat(count: 2, light: Point(position: (\"=3*i\", 1, 0))), \"m\": Point(position: (0, 0, 0)) })",
    );
    let names: Vec<_> = sequence.lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!(names, ["l[0]", "l[1]", "m"]);
    let crate::appearance::light::LightKind::Point { position, .. } = &sequence.lights[1].value.kind else {
        panic!("a point")
    };
    assert_eq!(*position, DVec3::new(3.0, 1.0, 0.0).into());
}

const CHAIR: &str = "templates: {
    \"chair\": (
        parameters: { \"h\": 0.5, \"wood\": Required, \"leg\": \"=h/2\" },
        objects: {
            \"seat\": (shape: Sphere(radius: \"=h\"), material: \"=wood\"),
            \"leg\": Repeat(count: 2, step: (1, 0, 0), object: (shape: Sphere(radius: \"=leg\"), parent: \"seat\")),
        },
    ),
}, materials: { \"oak\": (), \"pine\": () }";

#[test]
fn templates_make_groups_of_objects() {
    let text = format!(
        "({CHAIR}, objects: {{ \"a\": (template: \"chair\", with: {{ \"wood\": \"pine\" }}, translation: (0, 0, 4)), \
        \"b\": Repeat(count: 2, step: (2, 0, 0), object: (template: \"chair\", with: {{ \"wood\": \"oak\", \"h\": \"=1+i\" }})) }})"
    );
    let folder = folder(&[]);
    let (_, sequence) = plain(&folder, &text);
    assert_eq!(
        names(&sequence),
        [
            "a",
            "a/seat",
            "a/leg[0]",
            "a/leg[1]",
            "b[0]",
            "b[0]/seat",
            "b[0]/leg[0]",
            "b[0]/leg[1]",
            "b[1]",
            "b[1]/seat",
            "b[1]/leg[0]",
            "b[1]/leg[1]"
        ]
    );
    let parents: Vec<_> = sequence.objects.iter().map(|object| object.value.parent).collect();
    assert_eq!(parents[..4], [None, Some(0), Some(1), Some(1)]);
    assert_eq!(parents[9..], [Some(8), Some(9), Some(9)]);
    let radius = |index: usize| match &sequence.objects[index].value.shape {
        Shape::Sphere(sphere) => sphere.radius,
        other => panic!("{other:?}"),
    };
    assert_eq!([radius(1), radius(2), radius(5), radius(9), radius(10)], [0.5, 0.25, 1.0, 2.0, 1.0]);
    assert_eq!(translations(&sequence)[8], [2.0, 0.0, 0.0]);
}

#[test]
fn templates_use_templates() {
    let text = "(templates: {
        \"leaf\": (parameters: { \"x\": 1 }, objects: { \"l\": (shape: Sphere(), translation: (\"=x\", 0, 0)) }),
        \"twig\": (objects: { \"leaf\": Repeat(count: 2, object: (template: \"leaf\", with: { \"x\": \"=i\" })) }),
    }, objects: { \"t\": (template: \"twig\", rotation: Euler(y: 90)) })";
    let sequence = read(text);
    assert_eq!(names(&sequence), ["t", "t/leaf[0]", "t/leaf[0]/l", "t/leaf[1]", "t/leaf[1]/l"]);
    assert_eq!(translations(&sequence)[4], [1.0, 0.0, 0.0]);
    assert!(matches!(sequence.objects[0].value.transform.rotation, Rotation::Euler { .. }));
}

#[test]
fn circles_of_templates_are_refused() {
    let text = "(templates: {
        \"a\": (objects: { \"x\": (template: \"b\") }),
        \"b\": (objects: { \"x\": (template: \"a\") }),
    }, objects: { \"t\": (template: \"a\") })";
    let message = faults(text);
    assert!(message.contains("templates use each other in a circle"), "{message}");
    assert!(message.contains("`a` uses `b` uses `a`"), "{message}");
    // Each one uses the next one twice.
    let many = (0..40).map(|n| {
        format!("\"t{n}\": (objects: {{ \"a\": (template: \"t{0}\"), \"b\": (template: \"t{0}\") }}),", n + 1)
    });
    let many = many.collect::<String>();
    let message = faults(&format!("(templates: {{ {many} }}, objects: {{ \"t\": (template: \"t0\") }})"));
    assert!(message.contains("more than 16 deep"), "{message}");
}

#[test]
fn sizes_are_bounded() {
    let doubled = (1..60).map(|n| format!("\"v{n}\": (\"=v{0}\", \"=v{0}\"),", n - 1)).collect::<String>();
    let text = "text".repeat(250);
    let message = faults(&format!("(let: {{ \"v0\": \"{text}\", {doubled} }})"));
    assert!(message.contains("expands to more than 64 MiB"), "{message}");
    let message = faults("(objects: { \"b\": Repeat(count: (1000, 1001), object: (shape: Sphere())) })");
    assert!(message.contains("more than 1000000 copies"), "{message}");
}

#[test]
fn included_files_bring_everything_but_the_frame() {
    let files = folder(&[
        ("lib/materials.ron", "(include: [\"colors.ron\"], let: { \"gloss\": 0.5 }, materials: { // made of steel\n \"steel\": (color: \"=gray\", specular: \"=gloss\") })"),
        ("lib/colors.ron", "(let: { \"gray\": (0.5, 0.5, 0.5) })"),
        ("lib/parts/bolt.ron", "(include: [\"../colors.ron\", \"../materials.ron\"], templates: { \"bolt\": (objects: { \"b\": (shape: Mesh(\"bolt.obj\"), material: \"steel\") }) },
            lights: { \"lamp\": Point(position: (0, 5, 0)) })"),
        ("lib/parts/bolt.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ]);
    let text = "(
    include: [\"lib/parts/bolt.ron\"],
    // The camera.
    camera: (position: (0, 0, \"=10*gloss\")),
    objects: { \"one\": (template: \"bolt\") },
)";
    let (plain, sequence) = plain(&files, text);
    assert_eq!(names(&sequence), ["one", "one/b"]);
    assert_eq!(sequence.materials[0].name, "steel");
    assert_eq!(sequence.lights[0].name, "lamp");
    assert!(plain.contains("Mesh(\"lib/parts/bolt.obj\")"), "{plain}");
    assert!(plain.contains("// The camera.") && plain.contains("made of steel"), "{plain}");
    // Farm jobs compare all files that were read.
    let root = Root::of(files.path());
    fs::write(files.path().join("test.ron"), text).expect("a disk");
    load_watched(&files.path().join("test.ron"), root.clone(), &Arc::default()).expect("a sequence");
    let read: Vec<_> = root
        .admitted()
        .iter()
        .map(|path| path.file_name().map(|name| name.to_string_lossy().into_owned()))
        .collect();
    for name in ["bolt.obj", "bolt.ron", "colors.ron", "materials.ron"] {
        assert!(read.contains(&Some(name.to_owned())), "{read:?}");
    }
}

#[test]
fn faults_name_the_file_in_which_they_are() {
    let files = folder(&[
        (
            "lib.ron",
            "(\n    templates: {\n        \"ball\": (parameters: { \"r\": 1 }, objects: { \"b\": (shape: Sphere(radius: \"=r-5\", color: 1)) }),\n    },\n    materials: { \"m\": (colr: 1) },\n)",
        ),
        (
            "main.ron",
            "(\n    include: [\"lib.ron\"],\n    objects: { \"x\": Repeat(count: 3, object: (template: \"ball\", with: { \"r\": 2 })) },\n)",
        ),
    ]);
    let message = load(&files.path().join("main.ron")).expect_err("faults").to_string();
    let message = message.replace(&format!("{}/", files.path().to_string_lossy()), "");
    for part in [
        "`radius`: expected a number above 0\n --> lib.ron:3:",
        "found -3",
        "the template is used here",
        "main.ron:3:",
        "in the copy [0] of this",
        "2 more copies have the same mistake",
        "a material has no field `colr`\n --> lib.ron:5:",
        "included here",
        "main.ron:2:",
    ] {
        assert!(message.contains(part), "{part}\n{message}");
    }
    assert_eq!(message.matches("`Sphere` has no field `color`").count(), 1, "{message}");
}

#[test]
fn wrong_includes_are_refused() {
    let files = folder(&[
        ("a.ron", "(include: [\"b.ron\"])"),
        ("b.ron", "(include: [\"a.ron\"], let: { \"x\": 1 })"),
        ("twice.ron", "(let: { \"x\": 2 }, objects: { \"o\": (shape: Sphere()) })"),
        ("broken.ron", "(\n  let: { \"y\" 1 },\n)"),
        ("frame.ron", "(timeline: (frames: 2))"),
        ("x.ron", "(let: { \"x\": 1 })"),
    ]);
    let message = |text: &str| {
        let path = files.path().join("test.ron");
        fs::write(&path, text).expect("a disk");
        load(&path).err().unwrap_or_else(|| panic!("{text} is accepted")).to_string()
    };
    for (text, parts) in [
        (
            "(include: [\"a.ron\"])",
            &["files include each other", "\"a.ron\" includes \"b.ron\" includes \"a.ron\"", "b.ron:1:"][..],
        ),
        ("(include: [\"test.ron\"])", &["\"test.ron\" includes itself"]),
        ("(include: [\"none.ron\"])", &["cannot include \"none.ron\"", "there is no such file"]),
        ("(include: [\"broken.ron\"])", &["broken.ron:2:14", "expected `:`"]),
        ("(include: [\"frame.ron\"])", &["an included file has no field `timeline`"]),
        ("(include: [\"x.ron\", \"twice.ron\"])", &["two values are named `x`", "twice.ron:1:", "x.ron:1:"]),
        (
            "(include: [\"x.ron\"], let: { \"x\": 1 })",
            &["two values are named `x`", "test.ron:1:", "x.ron:1:"],
        ),
        (
            "(include: [\"twice.ron\"], objects: { \"o\": (shape: Sphere()) })",
            &["two objects are named `o`", "twice.ron:1:"],
        ),
        ("(include: \"x.ron\")", &["`include`: expected a list of file names"]),
        ("(include: [\"x.ron\"], include: [\"x.ron\"])", &["the field `include` is given twice"]),
        ("(inclde: [\"x.ron\"])", &["did you mean `include`?"]),
    ] {
        let message = message(text);
        parts.iter().for_each(|part| assert!(message.contains(part), "{text}: {part}\n{message}"));
    }
}

#[test]
fn wrong_repetitions_and_templates_are_refused() {
    for (text, part) in [
        ("objects: { \"b\": Repeat(object: (shape: Sphere())) }", "`Repeat` has no `count`"),
        (
            "objects: { \"b\": Repeat(count: 1.5, object: (shape: Sphere())) }",
            "`count`: expected a whole number",
        ),
        ("objects: { \"b\": Repeat(count: \"=-1\", object: (shape: Sphere())) }", "its value is -1"),
        ("objects: { \"b\": Repeat(count: 3) }", "`Repeat` has no `object`"),
        ("objects: { \"b\": Repaet(count: 3, object: (shape: Sphere())) }", "did you mean `Repeat`?"),
        (
            "objects: { \"b\": Repeat(count: 3, step: 1, object: (shape: Sphere())) }",
            "expected a vector (x, y, z)",
        ),
        (
            "objects: { \"b\": Repeat(count: 3, step: (1, 0, 0), object: (shape: Sphere(), translation: \"=pi\")) }",
            "`step` adds to each coordinate",
        ),
        (
            "objects: { \"b\": Repeat(count: 2, object: Repeat(count: 2, object: (shape: Sphere()))) }",
            "directly in `Repeat`",
        ),
        (
            "objects: { \"b\": Repeat(count: 2, object: (shape: Sphere())), \"b[1]\": (shape: Sphere()) }",
            "two objects are named `b[1]`",
        ),
        ("lights: { \"b\": Repeat(count: 2, object: Point(position: (0, 0, 0))) }", "has no field `object`"),
        ("lights: { \"b\": Repeet(count: 2) }", "did you mean `Repeat`?"),
        ("objects: { \"b\": (template: \"none\") }", "there is no template `none`"),
        ("objects: { \"b\": (shape: Sphere(), with: {}) }", "this object has no `template`"),
        ("let: { \"i\": 1 }", "`i` already has a meaning"),
        ("let: { \"a b\": 1 }", "expressions cannot use this name"),
        ("let: { \"a\": \"=b\", \"b\": 1 }", "there is no value `b`"),
        ("camera: (position: (\"=i\", 0, 0))", "are the numbers of the copies"),
    ] {
        let message = faults(&format!("({text})"));
        assert!(message.contains(part), "{text}: {part}\n{message}");
    }
    for (object, part) in [
        ("template: \"chair\"", "the template `chair` needs `wood`"),
        ("template: \"chiar\", with: { \"wood\": \"oak\" }", "did you mean `chair`?"),
        ("template: \"chair\", with: { \"wod\": \"oak\" }", "did you mean `wood`?"),
        ("template: \"chair\", with: { \"wood\": \"oka\" }", "did you mean `oak`?"),
        (
            "template: \"chair\", with: { \"wood\": \"oak\" }, shape: Sphere()",
            "has the shapes and materials of the template",
        ),
    ] {
        let message = faults(&format!("({CHAIR}, objects: {{ \"c\": ({object}) }})"));
        assert!(message.contains(part), "{object}: {part}\n{message}");
    }
}

#[test]
fn faults_in_values_name_their_uses() {
    let message = faults("(let: { \"a\": [(0, 1), (0, 2)] }, ambient: \"=a\")");
    assert!(
        message.contains("two keys at the same time") && message.contains("the value is used here"),
        "{message}"
    );
}
