//! Nodes as objects: names, parents, places, instances, and wrong files.

use super::{TRIANGLE, object, random_node, read_with, textbook, try_read, world};
use crate::appearance::material::MaterialBinding;
use crate::base::math::{DAffine3, DQuat, DVec3};
use crate::base::time::Time;
use crate::geometry::shape::{Mesh, Shape};
use crate::testing::{GltfFixture as Fixture, Random};
use glam::{DMat4, DVec4};
use serde_json::{Value, json};
use std::sync::Arc;

#[test]
fn nodes_are_objects_below_the_one_that_names_the_file() {
    let mut file = Fixture::with(json!({ "nodes": [
        { "name": "arm", "children": [1, 2], "translation": [1, 0, 0] },
        { "name": "hand", "mesh": 0 },
        { "name": "hand", "mesh": 0, "extensions": { "KHR_node_visibility": { "visible": false } } },
        {},
    ] }));
    file.triangle(TRIANGLE);
    let text = "(objects: {
        \"robot\": (shape: Scene(\"robot.glb\"), translation: (0, 5, 0)),
        \"robot/node_3\": (shape: Sphere(), parent: \"robot/hand\"),
    })";
    let sequence = read_with(file, text);
    let names: Vec<_> = sequence.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["robot", "robot/node_3", "robot/arm", "robot/node_3_2", "robot/hand", "robot/hand_2"]);
    assert_eq!(object(&sequence, "robot/arm").parent, Some(0));
    assert_eq!(object(&sequence, "robot/hand").parent, Some(2));
    assert_eq!(object(&sequence, "robot/node_3").parent, Some(4));
    let (one, other) = (object(&sequence, "robot/hand"), object(&sequence, "robot/hand_2"));
    assert_eq!((one.visible.clone(), other.visible.clone()), (true.into(), false.into()));
    let (Shape::Mesh(Mesh { mesh: a, .. }), Shape::Mesh(Mesh { mesh: b, .. })) = (&one.shape, &other.shape)
    else {
        panic!("meshes")
    };
    assert!(Arc::ptr_eq(a, b), "one mesh for both");
    let at = world(&sequence, object(&sequence, "robot/node_3"), Time::from_integer(0));
    assert_eq!(at.translation, DVec3::new(1.0, 5.0, 0.0));
}

#[test]
fn two_objects_share_the_meshes_and_materials_of_a_file() {
    let mut file = Fixture::with(json!({ "nodes": [{ "name": "part", "mesh": 0 }], "materials": [{}] }));
    file.triangle(TRIANGLE);
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let text =
        "(objects: { \"a\": (shape: Scene(\"robot.glb\")), \"b\": (shape: Scene(file: \"robot.glb\")) })";
    let sequence = read_with(file, text);
    let (one, other) = (object(&sequence, "a/part"), object(&sequence, "b/part"));
    assert_eq!((&one.shape, one.made_of), (&other.shape, other.made_of));
    assert_eq!(sequence.materials.len(), 2, "one of the file, and that of primitives without one");
}

#[test]
fn wrong_references_are_faults() {
    let message = |text: &str| {
        let mut file = Fixture::with(json!({ "nodes": [{ "name": "part", "mesh": 0 }] }));
        file.triangle(TRIANGLE);
        try_read(file, text).expect_err("a fault")
    };
    let circle = message("(objects: { \"robot\": (shape: Scene(\"robot.glb\"), parent: \"robot/part\") })");
    assert!(circle.contains("parents form a cycle"), "{circle}");
    let missing = message("(objects: { \"robot\": (shape: Scene(\"robot.gltf\")) })");
    assert!(
        missing.contains("cannot read the scene \"robot.gltf\"")
            && missing.contains("relative to the folder")
    );
    let below = message(
        "(objects: { \"robot\": (shape: Scene(\"none.glb\")), \"cup\": (shape: Sphere(), parent: \"robot/hand\") })",
    );
    assert_eq!(below.matches("error:").count(), 1, "{below}");
    let kind = message("(objects: { \"robot\": (shape: Scene(\"robot.obj\")) })");
    assert!(kind.contains("scenes are read from .gltf and .glb files"), "{kind}");
    let field = message("(objects: { \"robot\": (shape: Scene(file: \"robot.glb\", fil: 1)) })");
    assert!(field.contains("`Scene` has no field `fil`"), "{field}");
    let many =
        message("(objects: { \"a\": (shape: Instances(shape: Scene(\"robot.glb\"), file: \"a.csv\")) })");
    assert!(many.contains("a scene is a shape of its own object"), "{many}");
}

#[test]
fn transforms_agree_with_textbook_matrices() {
    let mut random = Random(5);
    for up in ["Y", "Z"] {
        let mut nodes: Vec<Value> = (0..40).map(|index| random_node(&mut random, index)).collect();
        // Every node hangs below an earlier one, at most eight deep.
        let parents: Vec<Option<usize>> =
            (0..40).map(|index: usize| (index > 0).then(|| (index - 1) / 2)).collect();
        for (child, parent) in parents.iter().enumerate() {
            let Some(parent) = *parent else { continue };
            let list = &mut nodes[parent]["children"];
            if list.is_null() {
                *list = json!([]);
            }
            list.as_array_mut().expect("a list").push(child.into());
        }
        for (index, node) in nodes.iter_mut().enumerate() {
            node["name"] = format!("n{index}").into();
        }
        let own = DAffine3::from_scale_rotation_translation(
            DVec3::splat(2.0),
            DQuat::IDENTITY,
            DVec3::new(1.0, 2.0, 3.0),
        );
        let file = Fixture::with(json!({ "nodes": nodes }));
        let text = format!(
            "(up: {up}, objects: {{ \"robot\": (shape: Scene(\"robot.glb\"), scale: 2, translation: (1, 2, 3)) }})"
        );
        let sequence = read_with(file, &text);
        for (index, node) in nodes.iter().enumerate() {
            let mut expected = textbook(node);
            let mut at = parents[index];
            while let Some(parent) = at {
                expected = textbook(&nodes[parent]) * expected;
                at = parents[parent];
            }
            // With z up, (x, y, z) of the file is (x, -z, y).
            let turn = DMat4::from_cols(DVec4::X, DVec4::Z, DVec4::NEG_Y, DVec4::W);
            let turned = if up == "Z" { turn * expected } else { expected };
            let found =
                world(&sequence, object(&sequence, &format!("robot/n{index}")), Time::from_integer(0));
            let expected = DMat4::from(own) * turned;
            let difference = (DMat4::from(found) - expected).to_cols_array().map(f64::abs);
            // Matrices are stored in f32, and the nearest rotation is taken.
            assert!(difference.iter().all(|error| *error < 3e-6), "{index}: {difference:?}");
        }
    }
}

#[test]
fn instances_are_objects_of_one_mesh() {
    let mut file = Fixture::with(
        json!({ "nodes": [{ "name": "tree", "mesh": 0, "translation": [0, 1, 0] }], "materials": [{}] }),
    );
    file.triangle(TRIANGLE);
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let at = file.floats("VEC3", 3, &[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let size = file.floats("VEC3", 3, &[1.0, 1.0, 1.0, 3.0, 3.0, 3.0]);
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] =
        json!({ "attributes": { "TRANSLATION": at, "SCALE": size } });
    let sequence = read_with(
        file,
        "(materials: { \"steel\": Metal() }, objects: {
        \"wood\": (shape: Scene(file: \"robot.glb\", override: { \"tree\": (material: \"steel\") })) })",
    );
    let names: Vec<_> = sequence.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["wood", "wood/tree", "wood/tree[0]", "wood/tree[1]"]);
    let (tree, last) = (object(&sequence, "wood/tree"), object(&sequence, "wood/tree[1]"));
    assert_eq!((&tree.shape, last.made_of), (&Shape::Group, MaterialBinding::One(0)));
    let map = world(&sequence, last, Time::from_integer(0));
    assert_eq!(map.transform_point3(DVec3::X), DVec3::new(5.0, 1.0, 0.0));
}
