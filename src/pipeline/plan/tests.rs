//! Tests of frame states and their digests.

use super::*;
use crate::base::digest::Digest;
use crate::sequence::{Sequence, load, parse};
use std::path::Path;

fn sequence(text: &str) -> Sequence {
    parse("test.ron", text).unwrap_or_else(|faults| panic!("{faults}"))
}

/// A ball on a floor in frames of 4x3 pixels, with keys in frames. `fields` may replace the output.
fn ball(fields: &str, material: &str, object: &str) -> Sequence {
    let output = if fields.contains("output:") { "" } else { "output: (size: (4, 3))," };
    sequence(&format!(
        r#"(timeline: (frames: 12, keys: Frames), {output} {fields}
        materials: {{ "m": ({material}) }},
        objects: {{
            "floor": (shape: Plane()), "ball": (shape: Sphere(center: (0, 1, 0)), material: "m", {object}),
        }})"#
    ))
}

fn digests(sequence: &Sequence) -> Vec<Digest> {
    let frames: Vec<u32> = (0..sequence.timeline.frames).collect();
    evaluate(sequence, &frames).frames.iter().map(crate::pipeline::schedule::FrameState::digest).collect()
}

/// For every frame, the first frame with the same digest.
fn first_like(sequence: &Sequence) -> Vec<usize> {
    let digests = digests(sequence);
    digests.iter().map(|digest| digests.iter().position(|other| other == digest).expect("itself")).collect()
}

const STILL: [usize; 12] = [0; 12];
const ALL: [usize; 12] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];
const LAMP: &str = r#"lights: { "lamp": Point(position: (3, 4, 5)) },"#;

#[test]
fn moving_frames_differ_and_returning_frames_are_equal() {
    let there_and_back = [0, 1, 2, 3, 4, 3, 2, 1, 0, 1, 2, 3];
    assert_eq!(first_like(&ball(LAMP, "", "")), STILL);
    let moves = |repeat: &str| {
        format!("translation: Track(keys: [(0, (0, 0, 0)), (4, (1, 0, 0))], repeat: {repeat})")
    };
    assert_eq!(first_like(&ball(LAMP, "", &moves("PingPong"))), there_and_back);
    assert_eq!(first_like(&ball(LAMP, "", &moves("Loop"))), [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]);
    assert_eq!(first_like(&ball(LAMP, "", &moves("Hold"))), [0, 1, 2, 3, 4, 4, 4, 4, 4, 4, 4, 4]);
    let turn = format!("camera: (path: Orbit(turns: 3)), {LAMP}");
    assert_eq!(first_like(&ball(&turn, "", "")), [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]);
    for keys in [
        "ambient: [(0, 0.1), (11, 0.2)],",
        "background: [(0, 0.1), (11, 0.2)],",
        "background: Gradient(top: [(0, 0.1), (11, 0.2)]),",
        "fog: (density: [(0, 0.1), (11, 0.2)]),",
        "output: (size: (4, 3), exposure: [(0, 0), (11, 1)]),",
        "camera: (roll: [(0, 0), (11, 10)]),",
        "camera: (aperture: [(0, 0.1), (11, 0.2)]),",
        r#"lights: { "lamp": Point(position: [(0, (3, 4, 5)), (11, (3, 5, 5))]) },"#,
        r#"lights: { "lamp": Point(position: (3, 4, 5), intensity: [(0, 0.1), (11, 0.2)]) },"#,
    ] {
        assert_eq!(first_like(&ball(keys, "", "")), ALL, "{keys}");
    }
    for keys in ["diffuse", "mirror", "emission", "transparency", "refraction: 1, ior"] {
        let keys = format!("{keys}: [(0, 0.1), (11, 0.2)]");
        assert_eq!(first_like(&ball(LAMP, &keys, "")), ALL, "{keys}");
    }
}

#[test]
fn lights_change_weights_alone() {
    let keyed = ball(
        r#"lights: { "lamp": Point(position: (3, 4, 5), on: [(0, true), (5, false), (9, true)]) },"#,
        "",
        "",
    );
    let states = evaluate(&keyed, &(0..12).collect::<Vec<_>>());
    assert!(states.frames.iter().all(|state| state.scene_hash == states.frames[0].scene_hash));
    assert_eq!(first_like(&keyed), [0, 0, 0, 0, 0, 5, 5, 5, 5, 0, 0, 0]);
}

/// A film of random samples differs from a film of a regular grid. So switching off an area light changes the scene
/// hash.
#[test]
fn the_kind_of_samples_is_part_of_the_scene_hash() {
    let keyed = |kind: &str| {
        let lights = format!(r#"lights: {{ "lamp": {kind}, on: [(0, true), (6, false)]) }},"#);
        let states = evaluate(&ball(&lights, "", ""), &[0, 6]).frames;
        (states[0].random, states[1].random, states[0].scene_hash == states[1].scene_hash)
    };
    assert_eq!(keyed("Sphere(center: (3, 4, 5), radius: 1"), (true, false, false));
    assert_eq!(keyed("Point(position: (3, 4, 5)"), (false, false, true));
}

#[test]
fn lights_without_shadows_are_other_lights() {
    let lit = |fields: &str| digests(&ball(&LAMP.replace(") }", &format!("{fields}) }}")), "", ""));
    assert_ne!(lit(", shadows: false"), lit(""));
    assert_eq!(lit(", shadows: true"), lit(""));
}

#[test]
fn effects_without_strength_are_ignored() {
    let plain = digests(&ball(LAMP, "", ""));
    for fields in [
        "fog: (density: 0, color: 0.5),",
        "camera: (aperture: 0, focus: 3),",
        "camera: (shutter: 0),",
        "quality: (shutter_steps: 7, samples: 9, seed: 3),",
        "output: (size: (4, 3), exposure: 0),",
    ] {
        assert_eq!(digests(&ball(&format!("{fields} {LAMP}"), "", "")), plain, "{fields}");
    }
    // Nothing moves while the shutter is open.
    assert_eq!(digests(&ball(&format!("camera: (shutter: 0.5), {LAMP}"), "", "")), plain);
    let off =
        r#"lights: { "lamp": Point(position: (3, 4, 5)), "off": Point(position: (1, 4, 5), intensity: 0) },"#;
    assert_eq!(digests(&ball(off, "", "")), plain);
    for material in [
        "mirror: 0, fuzz: 0.5",
        "transparency: 0",
        "emission: 0",
        "specular: 0, shininess: [(0, 3), (11, 9)], highlight: BlinnPhong",
        "refraction: 0, ior: [(0, 1.1), (11, 1.5)], absorption: 2, fresnel: Exact",
    ] {
        assert_eq!(digests(&ball(LAMP, material, "")), plain, "{material}");
    }
    let unused = format!(r#"{LAMP} materials: {{ "m": (), "unused": (mirror: [(0, 0), (11, 1)]) }},"#);
    let ball = |fields: &str| {
        sequence(&format!(
            r#"(timeline: (frames: 12, keys: Frames), output: (size: (4, 3)), {fields} objects: {{
            "floor": (shape: Plane()), "ball": (shape: Sphere(center: (0, 1, 0)), material: "m") }})"#
        ))
    };
    assert_eq!(digests(&ball(&unused)), plain);
}

#[test]
fn hidden_things_may_move() {
    let object = "visible: false, translation: [(0, (0, 0, 0)), (11, (1, 0, 0))]";
    assert_eq!(first_like(&ball(LAMP, "", object)), STILL);
}

#[test]
fn a_shutter_that_sees_something_move_is_open() {
    let moves = "translation: [(0, (0, 0, 0)), (4, (1, 0, 0))]";
    let camera = "camera: (shutter: 0.5), quality: (shutter_steps: 6),";
    let moments = |fields: &str| -> Vec<u32> {
        evaluate(&ball(fields, "", moves), &[0, 3, 4, 5]).frames.iter().map(|state| state.moments).collect()
    };
    assert_eq!(moments(LAMP), [1, 1, 1, 1]);
    assert_eq!(moments(&format!("{camera} {LAMP}")), [6, 6, 1, 1]);
}

/// Digests do not depend on other frames, their order, threads, or addresses of meshes and images.
#[test]
fn digests_depend_on_the_frame_alone() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("sequences/room-effects.ron");
    let (one, other) = (load(&path).expect("a sequence"), load(&path).expect("a sequence"));
    let frames: Vec<u32> = (0..one.timeline.frames).collect();
    let all = evaluate(&one, &frames);
    let order: Vec<u32> = frames.iter().rev().copied().step_by(5).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("a pool");
    for state in pool.install(|| evaluate(&other, &order)).frames {
        assert_eq!(state.digest(), all.frames[state.frame as usize].digest());
    }
}

/// Digests must be stable across versions that render the same.
#[test]
fn digests_are_the_same_in_every_version_that_renders_the_same() {
    assert_eq!(digests(&ball(LAMP, "", ""))[0].to_string(), "9adf5d2b2744344772e22d7271415eab");
}

/// Changes between a frame's start and its first moment are noticed.
#[test]
fn still_frames_show_their_moments_not_their_start() {
    let camera = "camera: (shutter: 1), quality: (shutter_steps: 2),";
    let hidden = "visible: [(0, true), (3.125, false), (4.0625, true)]";
    let states = evaluate(&ball(&format!("{camera} {LAMP}"), "", hidden), &[2, 3, 4]).frames;
    assert!(states.iter().all(|state| state.moments == 1), "{states:?}");
    assert_ne!(states[1].scene_hash, states[0].scene_hash);
    assert_eq!(states[2].scene_hash, states[0].scene_hash);
}

#[test]
fn a_stop_ends_the_evaluation() {
    let stop = crate::base::cancel::Stop::default();
    let sequence = ball(LAMP, "", "");
    let frames: Vec<u32> = (0..12).collect();
    assert_eq!(evaluate_until(&sequence, &frames, &stop), evaluate(&sequence, &frames));
    stop.flag().store(2, std::sync::atomic::Ordering::Relaxed);
    assert_eq!(evaluate_until(&sequence, &frames, &stop).frames, []);
}

#[test]
fn a_part_of_the_states_is_the_states_of_the_part() {
    let sequence = ball(LAMP, "", "translation: [(0, (0, 0, 0)), (11, (1, 0, 0))]");
    let part = [9, 3, 4];
    assert_eq!(evaluate(&sequence, &[9, 1, 3, 0, 4, 2]).only(&part), evaluate(&sequence, &part));
}
