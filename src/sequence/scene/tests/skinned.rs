//! Skinned meshes as objects: when they are visible, what names lead to them, and what they share.

use super::{TRIANGLE, animate, object, read, read_with, try_read};
use crate::base::math::DVec3;
use crate::base::time::Time;
use crate::camera::path::Focus;
use crate::geometry::deformation::DeformedMesh;
use crate::geometry::shape::Shape;
use crate::sequence::{Sequence, ShapeTracks};
use crate::testing::GltfFixture as Fixture;
use serde_json::{Value, json};
use std::sync::Arc;

/// A triangle `body` below `rig`, with the joint `joint`, and these members of the root.
fn skinned(members: Value) -> Fixture {
    let mut file = Fixture::with(json!({
        "nodes": [{ "name": "rig", "children": [1, 2] }, { "name": "body", "mesh": 0, "skin": 0 }, { "name": "joint" }],
        "skins": [{ "joints": [2] }],
    }));
    file.set(members);
    file.triangle(TRIANGLE);
    skin(&mut file);
    file
}

/// Lets the first joint alone move the first mesh.
fn skin(file: &mut Fixture) {
    let joints = file.accessor(&[0; 12], 5121, "VEC4", 3);
    let weights = file.floats("VEC4", 4, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let part = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
    (part["JOINTS_0"], part["WEIGHTS_0"]) = (json!(joints), json!(weights));
}

fn index(sequence: &Sequence, name: &str) -> usize {
    sequence.objects.iter().position(|object| object.name == name).expect("an object")
}

fn visible(sequence: &Sequence, name: &str, second: i128) -> bool {
    sequence.is_visible(index(sequence, name), Time::from_integer(second))
}

/// The mesh of an object that changes.
fn deformed<'a>(sequence: &'a Sequence, name: &str) -> &'a Arc<DeformedMesh> {
    let Some(ShapeTracks::Deformed(mesh)) = &object(sequence, name).tracks else { panic!("a deformed mesh") };
    mesh
}

#[test]
fn a_hidden_ancestor_hides_a_skinned_mesh() {
    for up in ["Y", "Z"] {
        let text = |fields: &str| {
            format!("(up: {up}, objects: {{ \"robot\": (shape: Scene(file: \"robot.glb\"{fields})) }})")
        };
        assert!(visible(&read_with(skinned(json!({})), &text("")), "robot/body/skin", 0));
        let mut hidden = skinned(json!({}));
        hidden.json["nodes"][0]["extensions"] = json!({ "KHR_node_visibility": { "visible": false } });
        assert!(!visible(&read_with(hidden, &text("")), "robot/body/skin", 0), "{up}");
        let overridden = text(", override: { \"rig\": (visible: [(0, true), (1, false)]) }");
        let sequence = read_with(skinned(json!({})), &overridden);
        assert_eq!([0, 1].map(|second| visible(&sequence, "robot/body/skin", second)), [true, false], "{up}");
        let mut keyed = skinned(json!({}));
        let pointer = "/nodes/0/extensions/KHR_node_visibility/visible";
        let target =
            json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } });
        animate(&mut keyed, target, "STEP", &[0.0, 2.0], ("SCALAR", 1), &[1.0, 0.0]);
        let sequence = read_with(keyed, &text(""));
        assert_eq!([1, 2].map(|second| visible(&sequence, "robot/body/skin", second)), [true, false], "{up}");
    }
}

#[test]
fn the_name_of_a_node_stands_for_its_skinned_mesh() {
    let text = "(cameras: {
            \"all\": (position: (0, 0, 9), frame: \"robot/body\"),
            \"rig\": (position: (0, 0, 9), frame: \"robot/rig\"),
            \"sharp\": (position: (0, 0, 9), focus: \"robot/body\", aperture: 0.1),
        }, objects: { \"robot\": (shape: Scene(\"robot.glb\")) },
        annotations: { \"tip\": Label(text: \"tip\", at: Object(\"robot/body\")) })";
    let sequence = read_with(skinned(json!({})), text);
    let skin = index(&sequence, "robot/body/skin");
    assert_eq!(object(&sequence, "robot/body").shape, Shape::Group);
    assert_eq!(sequence.cameras[2].value.focus, Focus::Object(skin));
    let fits =
        [0, 1].map(|camera| sequence.fitted_camera(camera).frame.expect("a frame").fit.expect("a fit"));
    assert_eq!(fits[0], fits[1]);
    // The names of nodes that show their meshes themselves stay theirs.
    let mut plain = skinned(json!({}));
    plain.json["nodes"][1] = json!({ "name": "body", "mesh": 0 });
    let sequence = read_with(plain, text);
    assert_eq!(sequence.cameras[2].value.focus, Focus::Object(index(&sequence, "robot/body")));
}

/// A mesh that a joint turns by 45 degrees is framed as one that its node turns: as it is, not as a box around it.
#[test]
fn deformed_meshes_are_framed_as_they_are() {
    let turn = libm::sincos(std::f64::consts::PI / 8.0);
    let turned = json!([0.0, 0.0, turn.0, turn.1]);
    let text = "(cameras: { \"a\": (position: (0, 0, 9), up: (-1, 1, 0), frame: All, margin: 0) },
        objects: { \"robot\": (shape: Scene(\"robot.glb\")) })";
    let fit = |file: Fixture| {
        let frame = read_with(file, text).fitted_camera(0).frame;
        frame.expect("a frame").fit.expect("a fit")
    };
    let mut by_joint = skinned(json!({}));
    by_joint.json["nodes"][2]["rotation"] = turned.clone();
    let mut by_node = skinned(json!({}));
    by_node.json["nodes"][1] = json!({ "name": "body", "mesh": 0, "rotation": turned });
    let (found, expected) = (fit(by_joint), fit(by_node));
    assert!((found.center - expected.center).length() < 1e-12, "{found:?} {expected:?}");
    assert!((found.distance - expected.distance).abs() < 1e-12, "{found:?} {expected:?}");
}

#[test]
fn equal_meshes_are_deformed_once() {
    // Two nodes, and three instances of a third one.
    let mut file = Fixture::with(
        json!({ "nodes": [{ "name": "a", "mesh": 0 }, { "name": "b", "mesh": 0 }, { "name": "c", "mesh": 0 }] }),
    );
    file.triangle(TRIANGLE);
    let places = file.floats("VEC3", 3, TRIANGLE.as_flattened());
    file.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": places }]);
    file.json["meshes"][0]["weights"] = json!([0.5]);
    file.json["nodes"][2]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places } } });
    let still = read(file);
    let mesh = |name: &str| {
        let Shape::Mesh(mesh) = &object(&still, name).shape else { panic!("a mesh") };
        Arc::as_ptr(&mesh.mesh)
    };
    for name in ["robot/b", "robot/c[0]", "robot/c[2]"] {
        assert_eq!(mesh(name), mesh("robot/a"), "{name}");
    }
    // Two nodes with the same joints, also after a program has moved a joint.
    let mut file = skinned(json!({}));
    let nodes = file.json["nodes"].as_array_mut().expect("a list");
    nodes.push(json!({ "name": "other", "mesh": 0, "skin": 0 }));
    let mut sequence = read(file);
    let shared = |sequence: &Sequence| {
        Arc::ptr_eq(deformed(sequence, "robot/body/skin"), deformed(sequence, "robot/other/skin"))
    };
    assert!(shared(&sequence));
    let moved = |sequence: &Sequence| deformed(sequence, "robot/body/skin").positions(Time::from_integer(0));
    let before = moved(&sequence);
    let by = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 7.0]];
    sequence.drive("robot/rig", move |_| by).expect("a rig");
    assert!(shared(&sequence));
    let expected: Vec<DVec3> = before.iter().map(|position| *position + DVec3::Z * 7.0).collect();
    assert_eq!(moved(&sequence), expected);
    // What a program flattens is hidden.
    sequence.drive("robot/joint", |_| [[0.0; 3]; 4]).expect("a joint");
    assert_eq!(moved(&sequence), []);
}

#[test]
fn meshes_that_vanish_are_read_and_those_out_of_range_are_named() {
    // Joints of scale 0 at the start.
    let mut file = skinned(json!({}));
    let target = json!({ "node": 2, "path": "scale" });
    let keys = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    animate(&mut file, target, "STEP", &[0.0, 1.0], ("VEC3", 3), &keys);
    let sequence = read(file);
    let is_there =
        |second| deformed(&sequence, "robot/body/skin").named(Time::from_integer(second)).is_some();
    assert_eq!([0, 1].map(is_there), [false, true]);
    // A mesh that is flat at rest, and grows.
    let flat = |weight: f64| {
        let mut file =
            Fixture::with(json!({ "nodes": [{ "name": "face", "mesh": 0, "weights": [weight] }] }));
        file.triangle([[0.0; 3]; 3]);
        let target = file.floats("VEC3", 3, TRIANGLE.as_flattened());
        file.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": target }]);
        file
    };
    let Shape::Mesh(grown) = object(&read(flat(2.0)), "robot/face").shape.clone() else { panic!("a mesh") };
    assert_eq!(grown.mesh.positions(), [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 2.0]);
    assert_eq!(object(&read(flat(0.0)), "robot/face").shape, Shape::Group);
    let mut growing = flat(0.0);
    animate(
        &mut growing,
        json!({ "node": 0, "path": "weights" }),
        "LINEAR",
        &[0.0, 2.0],
        ("SCALAR", 1),
        &[0.0, 4.0],
    );
    let sequence = read(growing);
    let mesh = deformed(&sequence, "robot/face");
    assert_eq!(mesh.loaded(Time::from_integer(0)).expect("in range"), None);
    assert_eq!(mesh.positions(Time::from_integer(1)), [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 2.0]);
    // Weights that leave nothing, and others that leave the range of the arithmetic.
    let mut collapsed = flat(-1.0);
    let rest = collapsed.floats("VEC3", 3, TRIANGLE.as_flattened());
    collapsed.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(rest);
    let sequence = read(collapsed);
    assert_eq!(object(&sequence, "robot/face").shape, Shape::Group);
    assert!(
        sequence.notes().join(" ").contains("the mesh of `robot/face` is invisible"),
        "{:?}",
        sequence.notes()
    );
    let mut far = flat(1e30);
    let tenfold =
        far.floats("VEC3", 3, &TRIANGLE.as_flattened().iter().map(|part| 10.0 * part).collect::<Vec<_>>());
    far.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": tenfold }]);
    let message =
        try_read(far, "(objects: { \"robot\": (shape: Scene(\"robot.glb\")) })").expect_err("out of range");
    assert!(
        message.contains("cannot show the mesh of `robot/face`") && message.contains("at most 1e30"),
        "{message}"
    );
}
