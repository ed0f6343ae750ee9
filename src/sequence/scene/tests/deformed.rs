//! Meshes that morph targets and joints deform, compared with matrices in f64.

use super::{TRIANGLE, animate, numbers, object, random_node, read, read_with, textbook, try_read, world};
use crate::base::math::DVec3;
use crate::base::time::Time;
use crate::geometry::mesh::Normals;
use crate::geometry::shape::Shape;
use crate::sequence::{Object, ShapeTracks};
use crate::testing::{GltfFixture as Fixture, Random};
use glam::DMat4;
use serde_json::json;

/// The positions and normals that an object shows at a time.
fn shown(object: &Object, time: Time) -> Vec<(DVec3, DVec3)> {
    let mesh = match &object.tracks {
        Some(ShapeTracks::Deformed(mesh)) => mesh.loaded(time).expect("in range").expect("a mesh"),
        _ => {
            let Shape::Mesh(mesh) = &object.shape else { panic!("a mesh") };
            mesh.clone()
        }
    };
    let normals = mesh.mesh.corner_normals(0, Normals::File).expect("normals");
    let corners = mesh.mesh.triangles()[0].map(|vertex| mesh.mesh.positions()[vertex as usize]);
    corners.into_iter().zip(normals.map(|normal| normal.as_dvec3())).collect()
}

const NORMALS: [f32; 9] = [0.0, 0.0, 1.0, 0.0, 0.6, 0.8, 0.6, 0.0, 0.8];

#[test]
fn morph_targets_add_differences_by_weights() {
    let mut file = Fixture::with(
        json!({ "nodes": [{ "name": "face", "mesh": 0 }, { "name": "still", "mesh": 0, "weights": [0, 2] }] }),
    );
    file.triangle(TRIANGLE);
    let normals = file.floats("VEC3", 3, &NORMALS);
    let mut random = Random(21);
    let (first, second, turned) = (numbers(&mut random, 9), numbers(&mut random, 9), numbers(&mut random, 9));
    let targets = json!([
        { "POSITION": file.floats("VEC3", 3, &first) },
        { "POSITION": file.floats("VEC3", 3, &second), "NORMAL": file.floats("VEC3", 3, &turned) },
    ]);
    file.json["meshes"][0]["primitives"][0]["targets"] = targets;
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normals);
    file.json["meshes"][0]["weights"] = json!([0.5, 0.25]);
    let target = json!({ "node": 0, "path": "weights" });
    let keys = [0.5f32, 0.25, 1.0, -0.5];
    let (input, output) = (file.floats("SCALAR", 1, &[0.0, 2.0]), file.floats("SCALAR", 1, &keys));
    file.set(json!({ "animations": [{ "samplers": [{ "input": input, "output": output }],
        "channels": [{ "sampler": 0, "target": target }] }] }));
    let sequence = read(file);
    let vector = |list: &[f32], vertex: usize| {
        DVec3::from_array([0, 1, 2].map(|axis| f64::from(list[3 * vertex + axis])))
    };
    let check = |name: &str, time: Time, weights: [f64; 2]| {
        for (vertex, (position, normal)) in shown(object(&sequence, name), time).into_iter().enumerate() {
            let rest = DVec3::from_array(TRIANGLE[vertex].map(f64::from));
            let expected = rest + vector(&first, vertex) * weights[0] + vector(&second, vertex) * weights[1];
            assert!((position - expected).length() < 1e-12, "{name}: {position} {expected}");
            let expected = (vector(&NORMALS, vertex) + vector(&turned, vertex) * weights[1]).normalize();
            assert!((normal - expected).length() < 1e-6, "{name}: {normal} {expected}");
        }
    };
    for step in 0..=4 {
        let s = f64::from(step) / 4.0;
        check("robot/face", Time::new(step.into(), 2), [0.5 + 0.5 * s, 0.25 - 0.75 * s]);
        check("robot/still", Time::new(step.into(), 2), [0.0, 2.0]);
    }
    assert!(object(&sequence, "robot/still").tracks.is_none(), "deformed once");
}

#[test]
fn joints_move_vertices_by_weights() {
    let (half, mut random) = (std::f64::consts::FRAC_1_SQRT_2, Random(4));
    for up in ["Y", "Z"] {
        let mut file = Fixture::with(json!({
            "nodes": [
                { "name": "body", "mesh": 0, "skin": 0, "translation": [100, 0, 0] },
                { "name": "hip", "children": [2], "translation": [0, 1, 0] },
                { "name": "knee", "translation": [0.5, 0, 0.25], "scale": [1, 2, 1] },
            ],
        }));
        file.triangle(TRIANGLE);
        let normals = file.floats("VEC3", 3, &NORMALS);
        // The second vertex has weights that do not add up to 1.
        let weights = [0.25f32, 0.75, 0.0, 0.0, 0.5, 1.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        let joints = file.accessor(&[0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0], 5121, "VEC4", 3);
        let weights_at = file.floats("VEC4", 4, &weights);
        let part = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
        (part["NORMAL"], part["JOINTS_0"], part["WEIGHTS_0"]) =
            (json!(normals), json!(joints), json!(weights_at));
        let rest: Vec<DMat4> = (0..2).map(|index| textbook(&random_node(&mut random, index + 1))).collect();
        let numbers: Vec<f32> =
            rest.iter().flat_map(|matrix| matrix.to_cols_array().map(|v| v as f32)).collect();
        let rest: Vec<DMat4> = numbers
            .chunks(16)
            .map(|m| DMat4::from_cols_array(&std::array::from_fn(|at| f64::from(m[at]))))
            .collect();
        let matrices = file.floats("MAT4", 16, &numbers);
        file.set(json!({ "skins": [{ "joints": [2, 1], "inverseBindMatrices": matrices }] }));
        let turn = [0.0, 0.0, 0.0, 1.0, half as f32, 0.0, 0.0, half as f32];
        animate(&mut file, json!({ "node": 1, "path": "rotation" }), "STEP", &[0.0, 1.0], ("VEC4", 4), &turn);
        let sequence = read_with(
            file,
            &format!(
                "(up: {up}, timeline: (frames: 2, fps: 1), objects: {{ \"robot\": (shape: Scene(\"robot.glb\"), translation: (3, 0, 0)) }})"
            ),
        );
        let body = object(&sequence, "robot/body/skin");
        assert_eq!(object(&sequence, "robot/body").shape, Shape::Group);
        // Only the object and the joints place the mesh, not its own node.
        let place = world(&sequence, body, Time::from_integer(0));
        assert_eq!(place.translation, DVec3::new(3.0, 0.0, 0.0));
        for second in 0..2 {
            let hip = json!({ "translation": [0, 1, 0], "rotation": if second == 0 { [0.0, 0.0, 0.0, 1.0] } else { [f64::from(half as f32), 0.0, 0.0, f64::from(half as f32)] } });
            let knee = json!({ "translation": [0.5, 0, 0.25], "scale": [1, 2, 1] });
            let maps = [textbook(&hip) * textbook(&knee) * rest[0], textbook(&hip) * rest[1]];
            let found = shown(body, Time::from_integer(second));
            for (vertex, shares) in [[0.25, 0.75], [0.75, 0.25], [0.0, 1.0]].into_iter().enumerate() {
                let map = maps[0] * shares[0] + maps[1] * shares[1];
                let position = map.transform_point3(DVec3::from_array(TRIANGLE[vertex].map(f64::from)));
                let rest = DVec3::from_array([0, 1, 2].map(|axis| f64::from(NORMALS[3 * vertex + axis])));
                let normal = map.inverse().transpose().transform_vector3(rest).normalize();
                assert!((found[vertex].0 - position).length() < 1e-6, "{up}: {} {position}", found[vertex].0);
                assert!((found[vertex].1 - normal).length() < 1e-5, "{up}: {} {normal}", found[vertex].1);
            }
        }
    }
}

#[test]
fn joints_must_be_there() {
    let mut file = Fixture::with(
        json!({ "nodes": [{ "name": "body", "mesh": 0, "skin": 0 }, {}], "skins": [{ "joints": [1] }] }),
    );
    file.triangle(TRIANGLE);
    let joints = file.accessor(&[0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0], 5121, "VEC4", 3);
    let weights = file.floats("VEC4", 4, &[1.0; 12]);
    let part = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
    (part["JOINTS_0"], part["WEIGHTS_0"]) = (json!(joints), json!(weights));
    let message =
        try_read(file, "(objects: { \"robot\": (shape: Scene(\"robot.glb\")) })").expect_err("a fault");
    assert!(message.contains("nodes[0]: its mesh names the joint 1, but its skin has 1 joints"), "{message}");
}
