//! Numbers of scenes at the limits of the arithmetic.

use super::{animate, object, read, read_with, try_read};
use crate::base::math::DVec3;
use crate::base::time::Time;
use crate::testing::GltfFixture as Fixture;
use serde_json::json;

const PLAIN: &str =
    "(timeline: (duration: 3, fps: 1), objects: { \"robot\": (shape: Scene(\"robot.glb\")) })";

/// Each number is in range, but their product is not.
#[test]
fn lights_beyond_the_range_are_faults() {
    let lamp = |color: f64, intensity: f64| {
        Fixture::with(json!({
            "nodes": [{ "name": "lamp", "extensions": { "KHR_lights_punctual": { "light": 0 } } }],
            "extensions": { "KHR_lights_punctual": { "lights": [
                { "type": "point", "intensity": intensity, "color": [color, 0, 0] }] } },
        }))
    };
    assert!(
        try_read(lamp(1.0, 1e30), PLAIN)
            .is_err_and(|why| why.contains("the light of `robot/lamp` is too bright"))
    );
    assert!(try_read(lamp(1e20, 1e20), PLAIN).is_err());
    assert!(try_read(lamp(1e10, 1e10), PLAIN).is_ok());
    // Keys, and tangents of curves that lead far beyond them.
    let keyed = |values: &[f32], how: &str| {
        let mut file = lamp(1.0, 1.0);
        let pointer = "/extensions/KHR_lights_punctual/lights/0/intensity";
        let target =
            json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } });
        animate(&mut file, target, how, &[0.0, 2.0], ("SCALAR", 1), values);
        try_read(file, PLAIN)
    };
    assert!(keyed(&[0.0, 1e30], "LINEAR").is_err());
    assert!(keyed(&[0.0, 1.0, 1e30, 0.0, 1.0, 0.0], "CUBICSPLINE").is_err());
    assert!(keyed(&[0.0, 1.0, 1e3, 0.0, 1.0, 0.0], "CUBICSPLINE").is_ok());
}

/// Keys in range, and tangents that lead beyond it between them.
#[test]
fn curves_beyond_the_range_are_faults() {
    for (path, what) in [("scale", "is scaled beyond 1e30"), ("translation", "is moved beyond 1e30")] {
        let mut file = Fixture::with(json!({ "nodes": [{ "name": "arm" }] }));
        let far = [1e31f32; 3];
        let mut values = vec![0.0f32; 3];
        values.extend([1.0; 3]);
        values.extend(far);
        values.extend([0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        animate(
            &mut file,
            json!({ "node": 0, "path": path }),
            "CUBICSPLINE",
            &[0.0, 2.0],
            ("VEC3", 3),
            &values,
        );
        let message = try_read(file, PLAIN).expect_err("out of range");
        assert!(message.contains(what), "{message}");
    }
}

/// Times of fast animations are rounded to billionths of a second, so keys may meet. The later ones count.
#[test]
fn keys_that_meet_do_not_stop_an_animation() {
    let mut file = Fixture::with(json!({ "nodes": [{ "name": "arm" }] }));
    let next = 0.001f32.next_up();
    let values = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0];
    let target = json!({ "node": 0, "path": "translation" });
    animate(&mut file, target, "LINEAR", &[0.0, 0.001, next, 1000.0], ("VEC3", 3), &values);
    let text = "(timeline: (duration: 3, fps: 1), objects: { \"robot\": (shape: Scene(file: \"robot.glb\", speed: 1000)) })";
    let sequence = read_with(file, text);
    let at = |time: Time| object(&sequence, "robot/arm").transform.at(time).translation.x;
    assert_eq!(
        [at(Time::from_integer(0)), at(Time::new(1, 1_000_000)), at(Time::from_integer(1))],
        [0.0, 2.0, 4.0]
    );
}

/// A camera has no size, so scales neither hide nor turn it.
#[test]
fn cameras_keep_their_direction_under_any_scale() {
    for scale in [[0.0, 0.0, 0.0], [1.0, 1.0, -1.0], [1.0, 0.0, 2.0]] {
        let file = Fixture::with(json!({
            "nodes": [{ "name": "eye", "camera": 0, "translation": [0, 0, 5], "scale": scale }],
            "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.7 } }],
        }));
        let sequence = read(file);
        let camera = sequence.cameras[0].value.at(&sequence.timeline.clock(0), None).expect("a camera");
        assert_eq!((camera.position, camera.basis.forward), (DVec3::Z * 5.0, DVec3::NEG_Z), "{scale:?}");
    }
}

/// The visibility of a light is known at any time, however often it changes before.
#[test]
fn lights_switch_after_millions_of_keys() {
    let mut file = Fixture::with(json!({
        "nodes": [{ "name": "lamp", "extensions": { "KHR_lights_punctual": { "light": 0 } } }],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "point" }] } },
    }));
    let pointer = "/nodes/0/extensions/KHR_node_visibility/visible";
    let target =
        json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } });
    animate(&mut file, target, "STEP", &[0.0, 0.0005, 0.001], ("SCALAR", 1), &[1.0, 0.0, 1.0]);
    let text = "(timeline: (duration: 4000, fps: 1), objects: { \"robot\": (shape: Scene(file: \"robot.glb\", loop: true),
        visible: [(0, true), (3500, false)]) })";
    let sequence = read_with(file, text);
    let on = |time: Time| sequence.lights[0].value.on.at(time);
    for second in [1, 2000, 3499] {
        let start = Time::from_integer(second);
        assert_eq!([on(start), on(start + Time::new(6, 10_000))], [true, false], "{second}");
    }
    assert!(!on(Time::from_integer(3500)));
}

#[test]
fn animations_without_a_name_of_their_own_have_numbers() {
    let file = |names: [&str; 3]| {
        let mut file = Fixture::with(json!({ "nodes": [{ "name": "arm" }] }));
        for (number, name) in (1u16..).zip(names) {
            let (input, output) =
                (file.floats("SCALAR", 1, &[0.0]), file.floats("VEC3", 3, &[f32::from(number); 3]));
            file.push(
                "animations",
                json!({ "name": name, "samplers": [{ "input": input, "output": output }],
                "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }] }),
            );
        }
        file
    };
    let text =
        |fields: &str| format!("(objects: {{ \"robot\": (shape: Scene(file: \"robot.glb\"{fields})) }})");
    let notes = |names| read_with(file(names), &text("")).notes().join("\n");
    assert!(notes(["", "", ""]).contains("its animations are `0`, `1` and `2`"));
    assert!(notes(["Walk", "Walk", "Run"]).contains("its animations are `Walk`, `1` and `Run`"));
    let at = |choice: &str| {
        let sequence = read_with(file(["Walk", "Walk", ""]), &text(&format!(", animation: {choice}")));
        object(&sequence, "robot/arm").transform.at(Time::from_integer(0)).translation.x
    };
    assert_eq!(["\"Walk\"", "1", "[2]", "[2, \"Walk\"]"].map(at), [1.0, 2.0, 3.0, 1.0]);
    let wrong = try_read(file(["", "", ""]), &text(", animation: 3")).expect_err("no such animation");
    assert!(wrong.contains("a whole number from 0 to 2"), "{wrong}");
}
