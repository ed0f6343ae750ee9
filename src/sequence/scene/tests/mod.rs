//! Tests of scenes in sequences, with files that they write.

mod animation;
mod carried;
mod deformed;
mod limits;
mod materials;
mod nodes;
mod overrides;
mod skinned;

use crate::base::math::DAffine3;
use crate::base::time::Time;
use crate::sequence::{Object, Sequence, parse};
use crate::testing::{GltfFixture as Fixture, Random};
use glam::{DMat4, DVec4};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Reads a sequence beside a file `robot.glb`, or returns the faults.
fn try_read(file: Fixture, text: &str) -> Result<Sequence, String> {
    let folder: TempDir = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("robot.glb"), file.glb()).expect("a disk");
    parse(&folder.path().join("test.ron").to_string_lossy(), text).map_err(|faults| faults.to_string())
}

fn read_with(file: Fixture, text: &str) -> Sequence {
    try_read(file, text).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Reads a sequence whose only object shows the file.
fn read(file: Fixture) -> Sequence {
    read_with(file, "(objects: { \"robot\": (shape: Scene(\"robot.glb\")) })")
}

fn object<'a>(sequence: &'a Sequence, name: &str) -> &'a Object {
    let found = sequence.objects.iter().find(|object| object.name == name);
    &found.unwrap_or_else(|| panic!("no {name}")).value
}

/// The map from an object to the scene: the product of its own and those above it.
fn world(sequence: &Sequence, object: &Object, time: Time) -> DAffine3 {
    let own = object.transform.at(time);
    object.parent.map_or(own, |parent| world(sequence, &sequence.objects[parent].value, time) * own)
}

const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// The map of a node by textbook matrices in f64, without any code of the renderer's transforms.
fn textbook(node: &Value) -> DMat4 {
    let numbers = |key: &str, default: &[f64]| -> Vec<f64> {
        let given =
            node[key].as_array().map(|list| list.iter().map(|v| v.as_f64().expect("a number")).collect());
        given.unwrap_or_else(|| default.to_vec())
    };
    if let Some(matrix) = node["matrix"].as_array() {
        let matrix: Vec<f64> = matrix.iter().map(|v| v.as_f64().expect("a number")).collect();
        return DMat4::from_cols_slice(&matrix);
    }
    let t = numbers("translation", &[0.0; 3]);
    let s = numbers("scale", &[1.0; 3]);
    let q = numbers("rotation", &[0.0, 0.0, 0.0, 1.0]);
    let n: f64 = q.iter().map(|part| part * part).sum::<f64>().sqrt();
    let (x, y, z, w) = (q[0] / n, q[1] / n, q[2] / n, q[3] / n);
    // The matrix of a unit quaternion.
    let rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    let column = |at: usize| DVec4::new(rows[0][at] * s[at], rows[1][at] * s[at], rows[2][at] * s[at], 0.0);
    DMat4::from_cols(column(0), column(1), column(2), DVec4::new(t[0], t[1], t[2], 1.0))
}

/// A node with a random place, as parts or as a matrix in f32.
fn random_node(random: &mut Random, index: usize) -> Value {
    let mut list = |count: usize| (0..count).map(|_| 2.0 * random.unit() - 1.0).collect::<Vec<f64>>();
    let (translation, rotation) = (list(3), list(4));
    let scale: Vec<f64> = list(3).into_iter().map(|part| part + part.signum() * 0.2).collect();
    let node = json!({ "translation": translation, "rotation": rotation, "scale": scale });
    match index % 3 {
        0 => {
            let matrix = textbook(&node).to_cols_array().map(|v| f64::from(v as f32));
            json!({ "matrix": matrix })
        }
        _ => node,
    }
}

/// Adds an animation of one channel.
fn animate(
    file: &mut Fixture,
    target: Value,
    how: &str,
    times: &[f32],
    (kind, width): (&str, usize),
    values: &[f32],
) {
    let (input, output) = (file.floats("SCALAR", 1, times), file.floats(kind, width, values));
    if file.json["animations"].is_null() {
        file.push("animations", json!({ "name": "Walk", "samplers": [], "channels": [] }));
    }
    let animation = &mut file.json["animations"][0];
    let samplers = animation["samplers"].as_array_mut().expect("a list");
    samplers.push(json!({ "input": input, "output": output, "interpolation": how }));
    let sampler = samplers.len() - 1;
    animation["channels"]
        .as_array_mut()
        .expect("a list")
        .push(json!({ "sampler": sampler, "target": target }));
}

fn numbers(random: &mut Random, count: usize) -> Vec<f32> {
    (0..count).map(|_| (2.0 * random.unit() - 1.0) as f32).collect()
}
