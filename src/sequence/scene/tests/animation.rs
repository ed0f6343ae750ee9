//! Animations of scenes, compared with the formulas of the specification.

use super::{animate, numbers, object, read, read_with, textbook, try_read};
use crate::base::time::Time;
use crate::sequence::Sequence;
use crate::testing::{GltfFixture as Fixture, Random};
use glam::DMat4;
use serde_json::json;

/// A value of a channel at a time by the formulas of appendix C, in f64, with Shoemake's slerp.
fn formula(how: &str, times: &[f32], width: usize, values: &[f32], t: f64) -> Vec<f64> {
    let is_rotation = width == 4;
    let per_key = if how == "CUBICSPLINE" { 3 } else { 1 };
    let at = |index: usize| -> Vec<f64> {
        values[index * width..(index + 1) * width].iter().map(|v| f64::from(*v)).collect()
    };
    let unit = |v: Vec<f64>| {
        let length = v.iter().map(|part| part * part).sum::<f64>().sqrt();
        v.into_iter().map(|part| part / length).collect::<Vec<_>>()
    };
    let key = |k: usize| {
        let value = at(if per_key == 3 { 3 * k + 1 } else { k });
        if is_rotation { unit(value) } else { value }
    };
    let last = times.len() - 1;
    if t <= f64::from(times[0]) {
        return key(0);
    }
    if t >= f64::from(times[last]) {
        return key(last);
    }
    let k = (0..last).rev().find(|k| f64::from(times[*k]) <= t).expect("a segment");
    let length = f64::from(times[k + 1]) - f64::from(times[k]);
    let s = (t - f64::from(times[k])) / length;
    let (a, b) = (key(k), key(k + 1));
    match how {
        "STEP" => a,
        "LINEAR" if is_rotation => {
            let dot: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
            let angle = libm::acos(dot.abs().min(1.0));
            let (of_a, of_b) = (libm::sin((1.0 - s) * angle), libm::sin(s * angle) * dot.signum());
            unit(a.iter().zip(&b).map(|(a, b)| of_a * a + of_b * b).collect())
        }
        "LINEAR" => a.iter().zip(&b).map(|(a, b)| (1.0 - s) * a + s * b).collect(),
        _ => {
            let (leaving, arriving) = (at(3 * k + 2), at(3 * (k + 1)));
            let (s2, s3) = (s * s, s * s * s);
            let value = (0..width).map(|part| {
                (2.0 * s3 - 3.0 * s2 + 1.0) * a[part]
                    + length * (s3 - 2.0 * s2 + s) * leaving[part]
                    + (-2.0 * s3 + 3.0 * s2) * b[part]
                    + length * (s3 - s2) * arriving[part]
            });
            if is_rotation { unit(value.collect()) } else { value.collect() }
        }
    }
}

#[test]
fn animations_follow_the_formulas_of_the_specification() {
    let mut random = Random(8);
    let times = [0.25f32, 0.5, 1.0, 1.75, 2.0, 3.5];
    for how in ["STEP", "LINEAR", "CUBICSPLINE"] {
        let mut file = Fixture::with(json!({ "nodes": [{ "name": "arm" }] }));
        let count = times.len() * if how == "CUBICSPLINE" { 3 } else { 1 };
        let (t, r, s) = (
            numbers(&mut random, 3 * count),
            numbers(&mut random, 4 * count),
            numbers(&mut random, 3 * count),
        );
        animate(&mut file, json!({ "node": 0, "path": "translation" }), how, &times, ("VEC3", 3), &t);
        animate(&mut file, json!({ "node": 0, "path": "rotation" }), how, &times, ("VEC4", 4), &r);
        animate(&mut file, json!({ "node": 0, "path": "scale" }), how, &times, ("VEC3", 3), &s);
        let sequence = read(file);
        for step in 0..=100 {
            let time = Time::new(step, 25);
            let at = step as f64 / 25.0;
            let found = object(&sequence, "robot/arm").transform.at(time);
            let (t, s) = (formula(how, &times, 3, &t, at), formula(how, &times, 3, &s, at));
            let r = formula(how, &times, 4, &r, at);
            let node = json!({ "translation": t, "scale": s, "rotation": r });
            let difference = (DMat4::from(found) - textbook(&node)).to_cols_array();
            let largest = difference.iter().fold(0.0, |largest: f64, error| largest.max(error.abs()));
            assert!(largest < 1e-12, "{how} at {at}: {largest:e}");
        }
    }
}

#[test]
fn animations_are_placed_scaled_and_repeated() {
    let read = |fields: &str| {
        let mut file = Fixture::with(json!({ "nodes": [{ "name": "arm" }, { "name": "leg" }] }));
        let of = |node: usize| json!({ "node": node, "path": "translation" });
        animate(&mut file, of(0), "LINEAR", &[1.0, 2.0], ("VEC3", 3), &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        animate(&mut file, of(1), "LINEAR", &[0.0, 4.0], ("VEC3", 3), &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
        read_with(file, &format!("(objects: {{ \"robot\": (shape: Scene(file: \"robot.glb\"{fields})) }})"))
    };
    let places = |sequence: &Sequence, time: i128| {
        let of = |name: &str| object(sequence, name).transform.at(Time::new(time, 2)).translation.x;
        (of("robot/arm"), of("robot/leg"))
    };
    let plain = read("");
    assert_eq!(
        [0, 3, 5, 9].map(|half| places(&plain, half)),
        [(0.0, 0.0), (0.5, 1.5), (1.0, 2.5), (1.0, 4.0)]
    );
    let later = read(", start: 2, speed: 2");
    assert_eq!(
        [4, 5, 6, 8].map(|half| places(&later, half)),
        [(0.0, 0.0), (0.0, 1.0), (1.0, 2.0), (1.0, 4.0)]
    );
    // Both repeat after the whole animation, not after their own keys.
    let looped = read(", loop: true");
    assert_eq!(
        [3, 7, 8, 11].map(|half| places(&looped, half)),
        [(0.5, 1.5), (1.0, 3.5), (0.0, 0.0), (0.5, 1.5)]
    );
    assert_eq!(places(&read(", animation: Off"), 5), (0.0, 0.0));
    assert_eq!(places(&read(", animation: [\"Walk\"]"), 3), (0.5, 1.5));
}

#[test]
fn animations_are_chosen_by_name() {
    let file = || {
        let mut file = Fixture::with(json!({ "nodes": [{ "name": "arm" }] }));
        let target = json!({ "node": 0, "path": "translation" });
        animate(&mut file, target, "STEP", &[0.0], ("VEC3", 3), &[1.0, 0.0, 0.0]);
        let mut run = file.json["animations"][0].clone();
        run["name"] = json!("Run");
        file.push("animations", run);
        file
    };
    let text =
        |fields: &str| format!("(objects: {{ \"robot\": (shape: Scene(file: \"robot.glb\"{fields})) }})");
    let still = read_with(file(), &text(""));
    assert!(still.notes().join("\n").contains("its animations are `Walk` and `Run`"), "{:?}", still.notes());
    assert_eq!(read_with(file(), &text(", animation: All")).notes(), [""; 0]);
    let wrong = try_read(file(), &text(", animation: \"walk\"")).expect_err("no such animation");
    assert!(wrong.contains("did you mean `Walk`?"), "{wrong}");
    let slow = try_read(file(), &text(", animation: \"Walk\", speed: 0")).expect_err("no speed");
    assert!(slow.contains("a speed from 0.001 to 1000"), "{slow}");
}
