//! Numbers of meshes and coordinates as colours.

use crate::support::{folder, sequence_in, shoot};
use kinora::base::color::{Rgb, linear_to_srgb};
use kinora::base::digest::Digest;
use kinora::pipeline::plan::evaluate;
use kinora::sequence::{Sequence, load, parse};
use std::fs;
use std::path::Path;

/// Two squares side by side, from x = -1 to 1 and y = -0.5 to 0.5. The heat of a vertex rises with x.
fn squares(heat: [f64; 3], zones: [f64; 2]) -> String {
    let mut text =
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
        property double heat\nelement face 2\nproperty list uchar int vertex_indices\nproperty float zone\n\
        end_header\n"
            .to_owned();
    for y in [-0.5, 0.5] {
        (0..3).for_each(|k| text.push_str(&format!("{} {y} 0 {}\n", f64::from(k) - 1.0, heat[k as usize])));
    }
    text + &format!("4 0 1 4 3 {}\n4 1 2 5 4 {}\n", zones[0], zones[1])
}

/// The squares of `squares.ply`, 64 pixels wide, in this material.
fn text(material: &str) -> String {
    format!(
        "(output: (size: (64, 32)), quality: (antialias: 1), background: 0,
        camera: (position: (0, 0, 5), projection: Orthographic(height: 1)),
        objects: {{ \"squares\": (shape: Mesh(\"squares.ply\"), material: {material}) }})"
    )
}

fn scene(folder: &Path, material: &str) -> Sequence {
    sequence_in(folder, &text(material))
}

fn codes(color: Rgb) -> [i32; 3] {
    color.to_array().map(|part| (linear_to_srgb(part.into()) * 255.0 + 0.5).floor() as i32)
}

/// Viridis at 0, 1/4, 1/2, 3/4 and 1, as published.
const VIRIDIS: [(f64, [i32; 3]); 5] = [
    (0.0, [68, 1, 84]),
    (0.25, [59, 82, 139]),
    (0.5, [33, 145, 140]),
    (0.75, [94, 201, 98]),
    (1.0, [253, 231, 37]),
];

/// Viridis as matplotlib shows it at the centres of some of 64 pixels, (x + 1/2) / 64.
const COLUMNS: [(u32, [i32; 3]); 8] = [
    (0, [69, 4, 87]),
    (9, [70, 52, 128]),
    (18, [54, 93, 141]),
    (27, [39, 128, 142]),
    (36, [31, 161, 135]),
    (45, [74, 193, 109]),
    (54, [157, 217, 59]),
    (63, [251, 231, 35]),
];

fn assert_near(found: [i32; 3], expected: [i32; 3], what: &str) {
    let far = found.iter().zip(expected).any(|(found, expected)| (found - expected).abs() > 1);
    assert!(!far, "{what}: {found:?} in place of {expected:?}");
}

/// What is seen is the colour of the map to within one code, whatever the light.
#[test]
fn unlit_data_has_the_colors_of_the_map() {
    let folder = folder();
    fs::write(folder.path().join("squares.ply"), squares([10.0, 15.0, 20.0], [0.0, 1.0])).expect("a disk");
    let text = text("Unlit(color: Scalar(of: \"heat\", range: (10, 20)))");
    let lit = "background: 1, lights: { \"sun\": Directional(direction: (0, 0, -1)) }";
    let shot = shoot(&sequence_in(folder.path(), &text.replace("background: 0", lit)), 0..1).remove(0);
    for (x, code) in COLUMNS {
        assert_near(codes(shot.pixel(x, 16)), code, &format!("column {x}"));
    }
}

/// Each cell has one value, whose colour both integrators show.
#[test]
fn cells_have_one_color_each() {
    let folder = folder();
    let text = text("Unlit(color: Scalar(of: \"zone\", range: (0, 1)))");
    for (pair, integrator) in VIRIDIS.windows(2).zip(["Whitted", "Path", "Whitted", "Path"]) {
        let [(left, left_code), (right, right_code)] = [pair[0], pair[1]];
        fs::write(folder.path().join("squares.ply"), squares([0.0; 3], [left, right])).expect("a disk");
        let text =
            text.replace("antialias: 1", &format!("antialias: 1, samples: 1, integrator: {integrator}"));
        let shot = shoot(&sequence_in(folder.path(), &text), 0..1).remove(0);
        for y in [0, 13, 31] {
            for (x, code) in [(0, left_code), (30, left_code), (33, right_code), (63, right_code)] {
                assert_near(codes(shot.pixel(x, y)), code, integrator);
            }
        }
    }
}

#[test]
fn ranges_are_found_over_all_objects() {
    let folder = folder();
    fs::write(folder.path().join("squares.ply"), squares([1.0, 2.0, 3.0], [0.0, 1.0])).expect("a disk");
    fs::write(folder.path().join("hot.ply"), squares([3.0, 4.0, 5.5], [0.0, 1.0])).expect("a disk");
    let two = text("\"heat\"").replace(
        "objects: {",
        "materials: { \"heat\": Unlit(color: Scalar(of: \"heat\", map: Grey, steps: 2)) }, objects: {
        \"hot\": (shape: Mesh(\"hot.ply\"), material: \"heat\", translation: (9, 0, 0)),",
    );
    let path = folder.path().join("two.ron");
    fs::write(&path, &two).expect("a disk");
    let sequence = load(&path).expect("a sequence");
    let note = format!("{}:4: the range of `heat` is (1, 5.5)", path.to_string_lossy());
    assert_eq!(sequence.notes(), [note]);
    // Below 3.25, the lower half of the range.
    let shot = shoot(&sequence, 0..1).remove(0);
    assert_eq!([0, 63].map(|x| codes(shot.pixel(x, 16))), [[0; 3]; 2]);
    let alone = shoot(&scene(folder.path(), "Unlit(color: Scalar(of: \"heat\", map: Grey, steps: 2))"), 0..1)
        .remove(0);
    assert_eq!([0, 31, 32, 63].map(|x| codes(alone.pixel(x, 16))[0]), [0, 0, 255, 255]);
}

#[test]
fn coordinates_are_those_of_the_object() {
    let text = |fields: &str, rest: &str| {
        format!(
            "(output: (size: (2, 2)), quality: (antialias: 1), background: 0,
            camera: (position: (0, 0, 5), projection: Orthographic(height: 2)),
            objects: {{ \"box\": (shape: Box(min: (-1, -1, -1), max: (1, 1, 1)), {rest}
                material: Unlit(color: Scalar(of: {fields}, map: [\"#0a141e\", \"#c8dcf0\"], steps: 2))) }})"
        )
    };
    let pixels = |fields: &str, rest: &str| {
        let shot = shoot(&sequence_in(Path::new(""), &text(fields, rest)), 0..1).remove(0);
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| codes(shot.pixel(x, y)))
    };
    let (low, high) = ([10, 20, 30], [200, 220, 240]);
    assert_eq!(pixels("X", ""), [low, high, low, high]);
    assert_eq!(pixels("Y", ""), [high, high, low, low]);
    assert_eq!(pixels("X, reverse: true", ""), [high, low, high, low]);
    let turned = "rotation: AxisAngle(axis: (0, 0, 1), angle: 90),";
    assert_eq!(pixels("X", turned), [high, high, low, low], "its own space turns with it");
    assert_eq!(pixels("Z, range: (5, 6)", ""), [low; 4], "values outside of the range have the end's colour");
    assert_eq!(pixels("X, scale: Log, range: (0.1, 1), nan: \"#c8dcf0\"", "")[0], high, "no logarithm");
}

fn keys(folder: &Path, material: &str, ply: &str) -> Vec<Digest> {
    fs::write(folder.join("squares.ply"), ply).expect("a disk");
    evaluate(&scene(folder, material), &[0]).frames.into_iter().map(|frame| frame.image_hash).collect()
}

/// A frame is known by the data that it shows, and not by other data.
#[test]
fn frames_are_identified_by_the_data_that_they_show() {
    let folder = folder();
    let heat = "Unlit(color: Scalar(of: \"heat\", range: (0, 9)))";
    let key = |material: &str, heat: [f64; 3], zones: [f64; 2]| {
        keys(folder.path(), material, &squares(heat, zones))
    };
    let first = key(heat, [1.0, 2.0, 3.0], [0.0, 1.0]);
    assert_eq!(first, key(heat, [1.0, 2.0, 3.0], [4.0, 5.0]), "another array");
    assert_ne!(first, key(heat, [1.0, 2.5, 3.0], [0.0, 1.0]));
    let zone = heat.replace("heat", "zone");
    assert_ne!(key(&zone, [1.0; 3], [0.0, 1.0]), key(&zone, [1.0; 3], [0.0, 1.5]));
    let plain = "(color: 0.5)";
    assert_eq!(key(plain, [1.0; 3], [0.0, 1.0]), key(plain, [2.0; 3], [1.0, 0.0]));
}

#[test]
fn missing_data_is_reported_at_the_object() {
    let folder = folder();
    fs::write(folder.path().join("squares.ply"), squares([1.0, 2.0, 3.0], [0.0, 1.0])).expect("a disk");
    let name = folder.path().join("test.ron");
    let fault = |text: &str| parse(&name.to_string_lossy(), text).expect_err(text).to_string();
    for (fields, messages) in [
        (
            "\"heet\"",
            [
                "the mesh of this object has no data `heet`",
                "did you mean `heat`?",
                "the mesh has `heat` and `zone`",
            ],
        ),
        ("of: \"zone\", data: Points", ["no data of points `zone`", "unknown", "the mesh has `heat`"]),
        (
            "of: \"heat\", component: Y",
            ["the data `heat` has no component 1", "it has one, 0", "test.ron:3:60"],
        ),
        (
            "of: heat",
            [
                "`of`: expected the name of a mesh's data in quotes, or the coordinate X, Y or Z",
                "write \"heat\"",
                "",
            ],
        ),
        ("of: X, component: Y", ["a coordinate has no `component`", "only for data of a mesh", ""]),
        (
            "of: X, range: (2, 1)",
            ["`range`: expected a lower and a higher number", "`reverse: true` turns", ""],
        ),
        (
            "of: X, range: (0, 1), scale: Log",
            ["`range`: expected two numbers above 0", "begins above 0", "found 0.0"],
        ),
        ("of: X, map: Viridi", ["there is no colour map `Viridi`", "did you mean `Viridis`?", "`Coolwarm`"]),
        (
            "of: X, map: [1]",
            ["`map`: expected a colour map such as Viridis, or a list of at least two colours", "", ""],
        ),
        ("of: X, steps: 1", ["`steps`: expected a whole number from 2 to 256", "", ""]),
        ("map: Grey", ["`Scalar` has no `of`", "", ""]),
    ] {
        let found = fault(&text(&format!("Unlit(color: Scalar({fields}))")));
        messages.into_iter().for_each(|message| assert!(found.contains(message), "{message}: {found}"));
    }
    let plane = |of: &str| {
        fault(&format!("(objects: {{ \"floor\": (shape: Plane(), material: (color: Scalar({of}))) }})"))
    };
    assert!(plane("\"heat\"").contains("only meshes, particles and instances have data such as `heat`"));
    let endless = plane("X");
    assert!(
        endless.contains("the range of a coordinate cannot be found") && endless.contains("write the range")
    );
}
