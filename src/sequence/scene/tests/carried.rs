//! Lights and cameras of scenes.

use super::{animate, object, read, read_with};
use crate::appearance::light::Source;
use crate::base::math::DVec3;
use crate::base::time::Time;
use crate::testing::GltfFixture as Fixture;
use serde_json::json;

/// Exporters write the times of frames as floats, before or after the frame itself.
#[test]
fn lights_switch_in_their_frame() {
    for frame in 1..60u16 {
        let seconds = |frame: u16| (f64::from(frame) / 24.0) as f32;
        let mut file = Fixture::with(json!({
            "nodes": [{ "name": "lamp", "extensions": { "KHR_lights_punctual": { "light": 0 } } }],
            "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 683.0, "color": [1, 0.5, 0] }] } },
        }));
        let pointer = |path: &str| json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": path } } });
        let input = file.floats("SCALAR", 1, &[0.0, seconds(frame)]);
        let output = file.accessor(&[0, 1], 5121, "SCALAR", 2);
        file.set(json!({ "animations": [{ "samplers": [{ "input": input, "output": output, "interpolation": "STEP" }],
            "channels": [{ "sampler": 0, "target": pointer("/nodes/0/extensions/KHR_node_visibility/visible") }] }] }));
        let path = pointer("/extensions/KHR_lights_punctual/lights/0/intensity");
        animate(&mut file, path, "LINEAR", &[0.0, seconds(frame)], ("SCALAR", 1), &[0.0, 683.0]);
        let sequence = read(file);
        assert_eq!(sequence.notes(), [""; 0]);
        let light = &sequence.lights[0];
        assert_eq!(light.name, "robot/lamp");
        let at = |frame: u16| Time::new(frame.into(), 24);
        assert_eq!([frame - 1, frame].map(|frame| light.value.on.at(at(frame))), [false, true], "{frame}");
        let full = 1e4 / std::f64::consts::PI;
        assert!((light.value.intensity.at(at(frame)) - full).abs() < 1e-9 * full);
        assert!(
            (2.0 * light.value.intensity.at(at(frame) / Time::from_integer(2)) - full).abs() < 1e-9 * full
        );
    }
}

#[test]
fn objects_carry_lights_and_cameras() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for up in ["Y", "Z"] {
        // Turned by a quarter about y, so that -z becomes -x.
        let file = Fixture::with(json!({
            "nodes": [
                { "name": "arm", "children": [1, 2], "translation": [0, 1, 0] },
                { "name": "eye", "camera": 0, "rotation": [0, half, 0, half], "translation": [0, 0, 3] },
                { "name": "spot", "extensions": { "KHR_lights_punctual": { "light": 0 } }, "rotation": [0, half, 0, half] },
            ],
            "cameras": [{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }],
            "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "spot" }] } },
        }));
        let text = format!(
            "(up: {up}, timeline: (frames: 2, fps: 1), objects: {{ \"robot\": (shape: Scene(\"robot.glb\"),
                translation: [(0, (0, 0, 0)), (1, (10, 0, 0))]) }}, active_camera: \"robot/eye\")"
        );
        let mut sequence = read_with(file, &text);
        assert_eq!(sequence.cameras.len(), 1);
        let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-12, "{up}: {a} {b}");
        for frame in 0..2 {
            let clock = sequence.timeline.clock(frame);
            let moved = DVec3::new(10.0 * f64::from(frame), 0.0, 0.0);
            let camera = sequence.cameras[0].value.at(&clock, None).expect("a camera");
            near(camera.position, moved + DVec3::new(0.0, 1.0, 3.0));
            near(camera.basis.forward, DVec3::NEG_X);
            near(camera.basis.up, DVec3::Y);
            let Source::Spot { position, cone, .. } = sequence.lights[0].value.kind.at(clock.time) else {
                panic!("a spot")
            };
            near(position, moved + DVec3::Y);
            near(cone.axis, DVec3::NEG_X);
            assert!((cone.cos_falloff_end - half).abs() < 1e-12 && cone.cos_falloff_start == 1.0);
        }
        // A program that moves the object moves what it carries.
        sequence
            .drive("robot", |_| [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
            .expect("a robot");
        sequence
            .drive("robot/arm", |_| [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [7.0, 0.0, 0.0]])
            .expect("an arm");
        let clock = sequence.timeline.clock(0);
        let camera = sequence.cameras[0].value.at(&clock, None).expect("a camera");
        near(camera.position, DVec3::new(7.0, 1.0, 3.0));
    }
}

#[test]
fn hidden_lights_are_off_and_lights_may_be_left_out() {
    let file = || {
        Fixture::with(json!({
            "nodes": [{ "name": "box", "children": [1], "extensions": { "KHR_node_visibility": { "visible": false } } },
                { "name": "lamp", "extensions": { "KHR_lights_punctual": { "light": 0 } } }],
            "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "directional" }] } },
        }))
    };
    assert_eq!(read(file()).lights[0].value.on, false.into());
    let text = "(lights: { \"robot/lamp\": Point(position: (0, 1, 0)) }, objects: { \"robot\": (shape: Scene(\"robot.glb\")) })";
    let names: Vec<_> = read_with(file(), text).lights.into_iter().map(|light| light.name).collect();
    assert_eq!(names, ["robot/lamp", "robot/lamp_2"]);
    let text = "(objects: { \"robot\": (shape: Scene(file: \"robot.glb\", lights: false)) })";
    assert!(read_with(file(), text).lights.is_empty());
}

#[test]
fn looped_visibilities_combine() {
    let file = Fixture::with(json!({
        "nodes": [{ "name": "lamp", "extensions": { "KHR_lights_punctual": { "light": 0 } } }],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "directional" }] } },
    }));
    let text = "(timeline: (duration: 12, fps: 4), objects: {
        \"house\": (shape: Group, visible: Track(keys: [(1, true), (2, false), (4, true)], repeat: Loop)),
        \"robot\": (shape: Scene(\"robot.glb\"), parent: \"house\",
            visible: Track(keys: [(0, false), (2, true), (3, false)], repeat: PingPong)),
    })";
    let sequence = read_with(file, text);
    let on = &sequence.lights[0].value.on;
    for frame in 0..48 {
        let time = sequence.timeline.clock(frame).time;
        let shown = ["house", "robot"].iter().all(|name| object(&sequence, name).visible.at(time));
        assert_eq!(on.at(time), shown, "frame {frame}");
    }
}
